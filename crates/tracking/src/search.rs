//! Looking for the pose elsewhere than downhill from the start.

#[doc(inline)]
pub use crate::{acquisition, particles, templates, visual_hull};

mod chains;
mod hypotheses;
mod reseed;
pub(crate) mod rivals;
mod sketch;
pub mod start;
mod without_start;

use serde::{Deserialize, Serialize};

use crate::fit::OptionsError;

pub use chains::Chains;
pub use hypotheses::{Hypothesis, Origin, SearchResult, fit_best, search};
pub(crate) use hypotheses::{farthest_m, reseeded};
pub use without_start::{
    Doubt, Heights, WithoutStartError, WithoutStartOptions, WithoutStartResult, hull_scale, standing,
    without_start,
};

pub(crate) use without_start::{Stance, SubjectPlace, mask_of, reduced, turn_whole};

/// How hard to look.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SearchOptions {
    /// Directions tried of every long limb of a chain, evenly over the sphere.
    pub directions: usize,
    /// Fraction of them that is drawn, after a look at a few points of each.
    pub sieve: f64,
    /// Partial chains that go on to the next limb.
    pub beam: usize,
    /// Places of a chain that are refined.
    pub proposals: usize,
    /// Most sweeps over all chains.
    pub sweeps: usize,
    /// Trunks that are tried besides the one found from the start.
    pub trunks: usize,
    /// Samples that these are the best of.
    pub trunk_samples: usize,
    /// Farthest that a sample's rotations are turned, radians.
    pub trunk_angle: f64,
    /// Farthest that a sample's root is moved, metres.
    pub trunk_distance: f64,
    /// Whether the body facing the other way is tried too: the start turned round, and the best pose of all.
    pub turned: bool,
    /// Places of a pair of chains that are refined; 0 leaves pairs out.
    pub pairs: usize,
    /// Pairs are tried where the cost is above this fraction of the subject's pixels.
    pub pairs_above: f64,
    /// Most hypotheses that are kept.
    pub kept: usize,
    /// Seed of the samples.
    pub seed: u64,
}

impl Default for SearchOptions {
    fn default() -> Self {
        Self {
            directions: 80,
            sieve: 0.35,
            beam: 24,
            proposals: 5,
            sweeps: 2,
            trunks: 3,
            trunk_samples: 200,
            trunk_angle: 0.5,
            trunk_distance: 0.15,
            turned: true,
            pairs: 3,
            pairs_above: 0.04,
            kept: 8,
            seed: 1,
        }
    }
}

impl SearchOptions {
    /// First thing wrong with the numbers, by field.
    ///
    /// # Errors
    /// A fraction, angle or distance that is negative or not finite.
    pub fn check(&self) -> Result<(), OptionsError> {
        let numbers = [
            ("sieve", self.sieve),
            ("trunk_angle", self.trunk_angle),
            ("trunk_distance", self.trunk_distance),
            ("pairs_above", self.pairs_above),
        ];
        match numbers.iter().find(|(_, value)| !(value.is_finite() && *value >= 0.0)) {
            Some(&(field, value)) => Err(OptionsError::Number { field, value }),
            None => Ok(()),
        }
    }
}
