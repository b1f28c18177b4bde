//! How a body is acquired.

use crate::search::WithoutStart;
use crate::templates::{TemplateError, TemplateOptions};

/// By what the first pose is found.
#[derive(Debug, Clone, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "one of them is made a run")]
pub enum FirstPose {
    /// Templates, one after the other.
    Templates(TemplateOptions),
    /// The program's own search from the hull.
    Search(WithoutStart),
}

/// How to acquire a body.
#[derive(Debug, Clone, PartialEq)]
pub struct AcquireOptions {
    /// By what the first pose is found.
    pub pose: FirstPose,
    /// The share of a template's pixels, in the camera that sees most of it, that is background where growing ends.
    pub background: f64,
    /// By how much a template grows or shrinks at a time, as a share.
    pub step: f64,
    /// How much smaller and larger than it began a size may become, as factors.
    pub range: [f64; 2],
    /// Rounds of growing, each after a fit of the pose; at least one.
    pub rounds: usize,
}

impl Default for AcquireOptions {
    fn default() -> Self {
        Self {
            pose: FirstPose::Search(WithoutStart { scale_body: true, ..WithoutStart::default() }),
            background: 0.05,
            step: 0.02,
            range: [0.6, 1.7],
            rounds: 2,
        }
    }
}

impl AcquireOptions {
    /// First thing wrong with the numbers, by field.
    ///
    /// # Errors
    /// Shares that are none, a range without the size itself.
    pub fn check(&self) -> Result<(), TemplateError> {
        for (field, value) in [("background", self.background), ("step", self.step)] {
            if !(value > 0.0 && value < 0.5) {
                return Err(TemplateError::Number {
                    field,
                    value,
                    expected: "more than 0 and less than 0.5",
                });
            }
        }
        let [low, high] = self.range;
        if !(low > 0.0 && low < 1.0) {
            return Err(TemplateError::Number { field: "range[0]", value: low, expected: "between 0 and 1" });
        }
        if !(high > 1.0 && high.is_finite()) {
            return Err(TemplateError::Number { field: "range[1]", value: high, expected: "more than 1" });
        }
        if self.rounds == 0 {
            return Err(TemplateError::Number { field: "rounds", value: 0.0, expected: "1 or more" });
        }
        Ok(())
    }
}
