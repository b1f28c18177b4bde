//! Every choice of a body of spheres.

use thiserror::Error;

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

/// What of the options cannot be.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error("`{field}` is {found}; expected {expected}")]
pub struct SphereOptionsError {
    /// The field.
    pub field: &'static str,
    /// What it is.
    pub found: f64,
    /// What it may be.
    pub expected: &'static str,
}

impl SphereBodyOptions {
    /// Checks every number.
    ///
    /// # Errors
    /// The first that is out of range.
    pub fn check(&self) -> Result<(), SphereOptionsError> {
        let count = |field, found: usize, expected, is_valid: bool| match is_valid {
            true => Ok(()),
            false => Err(SphereOptionsError { field, found: found as f64, expected }),
        };
        count("spheres", self.spheres, "1 to 4096", (1..=4 * MAX_SPHERES).contains(&self.spheres))?;
        count("levels", self.levels, "1 to 6", (1..=6).contains(&self.levels))?;
        count("stride", self.stride, "1 to 64", (1..=64).contains(&self.stride))?;
        let numbers = [
            ("step", self.step),
            ("softness", self.softness),
            ("margin", self.margin),
            ("centre_deviation", self.centre_deviation),
            ("radius_deviation", self.radius_deviation),
        ];
        for (field, found) in numbers {
            if !(found > 1e-3 && found.is_finite()) {
                return Err(SphereOptionsError { field, found, expected: "a number above 0.001" });
            }
        }
        for (field, found) in [("share", self.share), ("core", self.core)] {
            if !(0.0..=1.0).contains(&found) {
                return Err(SphereOptionsError { field, found, expected: "0 to 1" });
            }
        }
        Ok(())
    }
}
