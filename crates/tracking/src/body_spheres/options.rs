//! Every choice of a body of spheres. The defaults were set on the balancing footage, all of whose frames they were judged by too.

use crate::numbers::{OptionError, Range, check_options};
use crate::render::MAX_SPHERES;

/// How a body of spheres is made.
#[derive(Debug, Clone, PartialEq)]
pub struct SphereBodyOptions {
    /// Spheres of the whole body at the finest level; each limb gets its share by its surface, and two at least.
    pub spheres: usize,
    /// Levels of each limb's tree.
    pub levels: usize,
    /// Side of the cells that limbs are carved on, metres.
    pub step: f64,
    /// A place is a limb's if it is in the hull in this share of the frames that can say.
    pub share: f64,
    /// How many metres of distance a share of 1 is taken for.
    pub softness: f64,
    /// How far from its capsule a limb may reach, in radii.
    pub margin: f64,
    /// What is deeper in the capsule than this, in radii, is the limb's whatever silhouettes say.
    pub core: f64,
    /// How far a limb reaches into its neighbours, metres: where joints bend there is no gap.
    pub overlap: f64,
    /// Rounds of moving spheres by the silhouettes, and between them poses.
    pub rounds: usize,
    /// Steps of a round.
    pub steps: usize,
    /// Every n pixels are looked at.
    pub stride: usize,
    /// Standard deviation of a centre about where the tree put it, metres.
    pub centre_deviation: f64,
    /// Standard deviation of the logarithm of a radius about the tree's.
    pub radius_deviation: f64,
}

impl Default for SphereBodyOptions {
    fn default() -> Self {
        Self {
            spheres: 800,
            levels: 2,
            step: 0.0125,
            share: 0.75,
            softness: 0.1,
            margin: 0.6,
            core: 0.5,
            overlap: 0.015,
            rounds: 5,
            steps: 12,
            stride: 2,
            centre_deviation: 0.06,
            radius_deviation: 0.7,
        }
    }
}

impl SphereBodyOptions {
    /// Checks every number.
    ///
    /// # Errors
    /// The first that is out of range.
    pub fn check(&self) -> Result<(), OptionError> {
        let above = Range(|value| value > 1e-3 && value.is_finite(), "a number above 0.001");
        let share = Range(|value| (0.0..=1.0).contains(&value), "0 to 1");
        let spheres = Range(|value| (1.0..=4.0 * MAX_SPHERES as f64).contains(&value), "1 to 4096");
        check_options([
            ("spheres", self.spheres as f64, spheres),
            ("levels", self.levels as f64, Range(|value| (1.0..=6.0).contains(&value), "1 to 6")),
            ("stride", self.stride as f64, Range(|value| (1.0..=64.0).contains(&value), "1 to 64")),
            ("step", self.step, above),
            ("softness", self.softness, above),
            ("margin", self.margin, above),
            ("centre_deviation", self.centre_deviation, above),
            ("radius_deviation", self.radius_deviation, above),
            ("share", self.share, share),
            ("core", self.core, share),
        ])
    }
}
