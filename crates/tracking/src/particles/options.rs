//! How many particles, how far they go, how long.

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::fit::{FitError, FitOptions};
use crate::numbers::Brief;

/// Most particles: each holds a pose.
const MOST_PARTICLES: usize = 1_000_000;
/// Most layers.
const MOST_LAYERS: usize = 1000;

/// How to look with particles.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ParticleOptions {
    /// How many.
    pub particles: usize,
    /// Annealing layers; each samples every part of the body once. They share out the fit's stages, widest ramp first.
    pub layers: usize,
    /// Deviation of the trunk's turns in the first layer, radians about each axis.
    pub trunk_turn_rad: f64,
    /// The same of the rotations of chains.
    pub chain_turn_rad: f64,
    /// Deviation of the root in the first layer, metres along each axis.
    pub move_m: f64,
    /// Every layer's deviations, of the layer before.
    pub decay: f64,
    /// Survival rate: the share of particles that is left alive by the weights, between 0 and 1.
    pub alive: f64,
    /// Whether the trunk is sampled first and every chain after it; otherwise all at once.
    pub partitioned: bool,
    /// Seed of the random numbers.
    pub seed: u64,
    /// The solid, the stages' ramps and the weight of limits.
    pub fit: FitOptions,
}

impl Default for ParticleOptions {
    fn default() -> Self {
        Self {
            particles: 200,
            layers: 8,
            trunk_turn_rad: 0.15,
            chain_turn_rad: 0.3,
            move_m: 0.08,
            decay: 0.75,
            alive: 0.25,
            partitioned: true,
            seed: 1,
            fit: FitOptions::default(),
        }
    }
}

/// Why a particle filter cannot begin.
#[derive(Debug, Error, Clone, PartialEq)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum ParticleError {
    #[error(transparent)]
    Fit(#[from] FitError),
    #[error("`{field}` is {}; expected {expected}", Brief(*.value))]
    Number { field: &'static str, value: f64, expected: &'static str },
    #[error("no start was given; expected at least one pose")]
    NoStart,
}

impl ParticleOptions {
    /// First thing wrong with the numbers, by field. The fit's are checked where the filter begins.
    ///
    /// # Errors
    /// Counts of zero or beyond reason, deviations that are negative or no numbers, shares out of range.
    pub fn check(&self) -> Result<(), ParticleError> {
        let counts = [
            ("particles", self.particles, 2..=MOST_PARTICLES, "2 to 1000000"),
            ("layers", self.layers, 1..=MOST_LAYERS, "1 to 1000"),
        ];
        for (field, count, range, expected) in counts {
            if !range.contains(&count) {
                return Err(ParticleError::Number { field, value: count as f64, expected });
            }
        }
        let widths = [
            ("trunk_turn_rad", self.trunk_turn_rad),
            ("chain_turn_rad", self.chain_turn_rad),
            ("move_m", self.move_m),
        ];
        for (field, value) in widths {
            if !(value.is_finite() && value >= 0.0) {
                return Err(ParticleError::Number { field, value, expected: "0 or more" });
            }
        }
        let shares = [("decay", self.decay, 1.0), ("alive", self.alive, 0.999)];
        for (field, value, most) in shares {
            if !(value > 0.0 && value <= most) {
                return Err(ParticleError::Number { field, value, expected: "more than 0 and less than 1" });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_make_no_sense_are_named() {
        let good = ParticleOptions::default();
        assert_eq!(good.check(), Ok(()));
        type Spoil = fn(&mut ParticleOptions);
        let wrong: [(Spoil, &str); 6] = [
            (|options| options.particles = 1, "particles"),
            (|options| options.particles = usize::MAX, "particles"),
            (|options| options.layers = 0, "layers"),
            (|options| options.move_m = f64::NAN, "move_m"),
            (|options| options.decay = 0.0, "decay"),
            (|options| options.alive = 1.0, "alive"),
        ];
        for (change, expected) in wrong {
            let mut options = good.clone();
            change(&mut options);
            let said = options.check().unwrap_err().to_string();
            assert!(said.contains(expected) && said.contains("expected"), "{said}");
        }
    }
}
