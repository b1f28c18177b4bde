//! Robust losses: how much a residual costs when it is too large to be believed.
//!
//! With s = ‖ρ‖² and a scale k, in the residual's own units:
//!
//! | loss | cost c(s) | weight c′(s) |
//! |---|---|---|
//! | squares | s | 1 |
//! | Huber | s up to k², then 2k√s − k² | 1, then k/√s |
//! | Cauchy | k² ln(1 + s/k²) | 1/(1 + s/k²) |
//! | Tukey | k²/3 · (1 − (1 − s/k²)³) up to k², then k²/3 | (1 − s/k²)², then 0 |
//!
//! A step takes the weight at where it begins (iteratively reweighted least squares): JᵀJ and Jᵀρ are
//! multiplied by c′, the cost is c. See P. J. Huber, "Robust Statistics" (1981), and Z. Zhang, "Parameter
//! estimation techniques" (1997).

use serde::{Deserialize, Serialize};

/// How a residual's size becomes a cost.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Loss {
    /// Plain least squares.
    #[default]
    Squares,
    /// Linear beyond the scale.
    Huber {
        /// k, in the residual's units.
        scale: f64,
    },
    /// Logarithmic beyond the scale.
    Cauchy {
        /// k, in the residual's units.
        scale: f64,
    },
    /// Constant beyond the scale: such a residual pulls no more.
    Tukey {
        /// k, in the residual's units.
        scale: f64,
    },
}

impl Loss {
    /// Whether its scale is finite and above zero.
    pub fn is_valid(self) -> bool {
        match self {
            Self::Squares => true,
            Self::Huber { scale } | Self::Cauchy { scale } | Self::Tukey { scale } => {
                scale.is_finite() && scale > 1e-9
            }
        }
    }

    /// c(s) of a squared residual.
    pub fn cost(self, squared: f64) -> f64 {
        match self {
            Self::Squares => squared,
            Self::Huber { scale } if squared <= scale * scale => squared,
            Self::Huber { scale } => 2.0 * scale * squared.sqrt() - scale * scale,
            Self::Cauchy { scale } => scale * scale * (squared / (scale * scale)).ln_1p(),
            Self::Tukey { scale } => {
                let left = (1.0 - squared / (scale * scale)).max(0.0);
                scale * scale / 3.0 * (1.0 - left.powi(3))
            }
        }
    }

    /// c′(s), 0 to 1.
    pub fn weight(self, squared: f64) -> f64 {
        match self {
            Self::Squares => 1.0,
            Self::Huber { scale } if squared <= scale * scale => 1.0,
            Self::Huber { scale } => scale / squared.sqrt(),
            Self::Cauchy { scale } => 1.0 / (1.0 + squared / (scale * scale)),
            Self::Tukey { scale } => (1.0 - squared / (scale * scale)).max(0.0).powi(2),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOSSES: [Loss; 4] =
        [Loss::Squares, Loss::Huber { scale: 0.3 }, Loss::Cauchy { scale: 0.3 }, Loss::Tukey { scale: 0.3 }];

    #[test]
    fn weights_are_the_costs_derivatives() {
        for loss in LOSSES {
            for residual in [0.0_f64, 0.01, 0.1, 0.25, 0.299, 0.301, 0.5, 2.0] {
                let (s, h) = (residual * residual, 1e-7);
                let low = (s - h).max(0.0);
                let numeric = (loss.cost(s + h) - loss.cost(low)) / (s + h - low);
                assert!((numeric - loss.weight(s)).abs() < 1e-5, "{loss:?} at {residual}: {numeric}");
            }
        }
    }

    #[test]
    fn small_residuals_are_squares_and_large_ones_cost_less() {
        for loss in &LOSSES[1..] {
            assert!((loss.cost(1e-8) / 1e-8 - 1.0).abs() < 1e-6, "{loss:?}");
            assert!(loss.cost(4.0) < 0.3 * 4.0, "{loss:?}");
            assert!(loss.is_valid());
        }
        assert!(!Loss::Cauchy { scale: 0.0 }.is_valid() && !Loss::Tukey { scale: f64::NAN }.is_valid());
    }
}
