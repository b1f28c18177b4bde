//! Which cues pull, at what, how strongly: each can be switched by itself.
//!
//! Weights are per m² in the unit of a fit's priors, 255² squared grey levels at stride 1. For comparison: the outline of a
//! forearm 33 pixels long, 130 pixels a metre, weighs some 10⁵ per m² in a fit's last stages, the proximal prior on an elbow
//! some 500.

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::coverage::CoverageOptions;
use crate::numbers::Brief;
use crate::residual::cue::Cue;

/// Largest weight.
const LARGEST_WEIGHT: f64 = 1e12;

/// What cues pull at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CueReach {
    /// Only at limbs that silhouettes do not hold.
    #[default]
    Covered,
    /// At every limb.
    All,
}

/// One cue's strength.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CueStrength {
    /// Per m² and observation; 0 switches the cue off.
    pub weight: f64,
    /// Residuals of more than this are doubted (Cauchy's loss), metres.
    pub scale_m: f64,
}

/// Every choice about cues.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CueOptions {
    /// What cues pull at.
    pub reach: CueReach,
    /// When a limb is covered.
    pub coverage: CoverageOptions,
    /// Keypoints; a weight is for a score of 1.
    pub keypoints: CueStrength,
    /// Points carried from the last frame.
    pub flow: CueStrength,
    /// Edges along the outline; off by default: measured, they do not help (docs/chapter6.md).
    pub edges: CueStrength,
    /// Points in space.
    pub stereo: CueStrength,
    /// Keypoints of a lower score do not pull.
    pub lowest_score: f64,
    /// How far keypoints lie from the joints that they stand for: deviation of the prior at zero, metres.
    pub offset_m: f64,
}

impl Default for CueOptions {
    fn default() -> Self {
        Self {
            reach: CueReach::Covered,
            coverage: CoverageOptions::default(),
            keypoints: CueStrength { weight: 1e5, scale_m: 0.1 },
            flow: CueStrength { weight: 1e4, scale_m: 0.02 },
            edges: CueStrength { weight: 0.0, scale_m: 0.02 },
            stereo: CueStrength { weight: 1e4, scale_m: 0.02 },
            lowest_score: 0.3,
            offset_m: 0.03,
        }
    }
}

/// What is wrong with options.
#[derive(Debug, Error, Clone, PartialEq)]
#[error("`{field}` is {}; expected {expected}", Brief(*.value))]
#[expect(missing_docs, reason = "the message says what each field is")]
pub struct CueOptionsError {
    pub field: &'static str,
    pub value: f64,
    pub expected: &'static str,
}

impl CueOptions {
    /// The same with these cues alone.
    #[must_use]
    pub fn only(mut self, cues: &[Cue]) -> Self {
        for cue in Cue::ALL {
            if !cues.contains(&cue) {
                self.strength_mut(cue).weight = 0.0;
            }
        }
        self
    }

    /// First thing wrong with the numbers, by field.
    ///
    /// # Errors
    /// A weight below 0, a scale that is not above 0, a share outside 0 to 1.
    pub fn check(&self) -> Result<(), CueOptionsError> {
        let error = |field, value, expected| Err(CueOptionsError { field, value, expected });
        for cue in Cue::ALL {
            let CueStrength { weight, scale_m } = self.strength(cue);
            if !(0.0..=LARGEST_WEIGHT).contains(&weight) {
                return error("weight", weight, "a number from 0 to 1e12");
            }
            if !(scale_m.is_finite() && scale_m > 1e-6) {
                return error("scale_m", scale_m, "metres above 0");
            }
        }
        for (field, value) in
            [("lowest_score", self.lowest_score), ("coverage.seen_share", self.coverage.seen_share)]
        {
            if !(0.0..=1.0).contains(&value) {
                return error(field, value, "a number from 0 to 1");
            }
        }
        for (field, value) in [("offset_m", self.offset_m), ("coverage.margin_m", self.coverage.margin_m)] {
            if !(0.0..=1.0).contains(&value) {
                return error(field, value, "metres from 0 to 1");
            }
        }
        Ok(())
    }

    fn strength_mut(&mut self, cue: Cue) -> &mut CueStrength {
        match cue {
            Cue::Keypoints => &mut self.keypoints,
            Cue::Flow => &mut self.flow,
            Cue::Edges => &mut self.edges,
            Cue::Stereo => &mut self.stereo,
        }
    }

    /// How strong a cue is.
    #[must_use]
    pub fn strength(&self, cue: Cue) -> CueStrength {
        match cue {
            Cue::Keypoints => self.keypoints,
            Cue::Flow => self.flow,
            Cue::Edges => self.edges,
            Cue::Stereo => self.stereo,
        }
    }
}
