//! How templates are placed.

use glam::DVec3;
use thiserror::Error;

use crate::fit::{FitError, FitOptions};
use crate::numbers::Brief;
use crate::search::WithoutStartError;

/// How to place templates.
#[derive(Debug, Clone, PartialEq)]
pub struct TemplateOptions {
    /// Up in world axes, of any length; `None` asks the cameras ([`up_of`](crate::camera::up_of)).
    pub up: Option<DVec3>,
    /// Places of the head that are gone on with, best first, at least one: 1 as Mikić et al. do it.
    pub heads: usize,
    /// Ways to face that are tried of a trunk, and how many of them limbs are put on; each at least one.
    pub headings: [usize; 2],
    /// Directions tried of a limb, evenly over the sphere.
    pub directions: usize,
    /// Most turns of one template.
    pub turns: usize,
    /// A template rests when it turns by less, radians.
    pub rest_rad: f64,
    /// By what whole bodies are judged.
    pub fit: FitOptions,
}

impl Default for TemplateOptions {
    fn default() -> Self {
        Self {
            up: None,
            heads: 3,
            headings: [16, 4],
            directions: 80,
            turns: 30,
            rest_rad: 0.01,
            fit: FitOptions::default(),
        }
    }
}

/// Why templates could not be placed.
#[derive(Debug, Error, Clone, PartialEq)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum TemplateError {
    #[error(transparent)]
    Fit(#[from] FitError),
    #[error(transparent)]
    Place(#[from] WithoutStartError),
    #[error("`{field}` is {}; expected {expected}", Brief(*.value))]
    Number { field: &'static str, value: f64, expected: &'static str },
    #[error("the body \"{model}\" is one chain of limbs; expected a trunk with a head on it")]
    NoHead { model: String },
    #[error("no place inside all silhouettes can be the head")]
    NowhereInside,
    #[error("placing templates was stopped")]
    Cancelled,
}

impl TemplateOptions {
    /// First thing wrong with the numbers, by field.
    ///
    /// # Errors
    /// Counts of zero, a rest that is no angle.
    pub fn check(&self) -> Result<(), TemplateError> {
        let counts = [
            ("heads", self.heads),
            ("headings", self.headings[0].min(self.headings[1])),
            ("directions", self.directions),
            ("turns", self.turns),
        ];
        if let Some(&(field, value)) = counts.iter().find(|(_, count)| *count == 0) {
            return Err(TemplateError::Number { field, value: value as f64, expected: "1 or more" });
        }
        if !(self.rest_rad.is_finite() && self.rest_rad > 0.0) {
            let value = self.rest_rad;
            return Err(TemplateError::Number { field: "rest_rad", value, expected: "more than 0" });
        }
        Ok(())
    }
}
