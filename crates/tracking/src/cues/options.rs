//! Which cues pull, at what, how strongly: each can be switched by itself.
//!
//! Weights are per m² in the unit of a fit's priors, 255² squared grey levels at stride 1. For comparison: the outline of a
//! forearm 33 pixels long, 130 pixels a metre, weighs some 10⁵ per m² in a fit's last stages, the proximal prior on an elbow
//! some 500.

use serde::{Deserialize, Serialize};

use super::coverage::CoverageOptions;
use crate::numbers::{OptionError, Range, check_options};
use crate::residual::cue::Cue;

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

    /// Checks the numbers.
    ///
    /// # Errors
    /// The first option that is out of range.
    pub fn check(&self) -> Result<(), OptionError> {
        const WEIGHT: Range = Range(|value| (0.0..=1e12).contains(&value), "a number from 0 to 1e12");
        const SCALE: Range = Range(|value| value.is_finite() && value > 1e-6, "metres above 0");
        const SHARE: Range = Range(|value| (0.0..=1.0).contains(&value), "a number from 0 to 1");
        const METRES: Range = Range(SHARE.0, "metres from 0 to 1");
        let strengths = Cue::ALL.into_iter().flat_map(|cue| {
            let CueStrength { weight, scale_m } = self.strength(cue);
            [("weight", weight, WEIGHT), ("scale_m", scale_m, SCALE)]
        });
        check_options(strengths.chain([
            ("lowest_score", self.lowest_score, SHARE),
            ("coverage.seen_share", self.coverage.seen_share, SHARE),
            ("offset_m", self.offset_m, METRES),
            ("coverage.margin_m", self.coverage.margin_m, METRES),
        ]))
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
    pub fn strength(mut self, cue: Cue) -> CueStrength {
        *self.strength_mut(cue)
    }
}
