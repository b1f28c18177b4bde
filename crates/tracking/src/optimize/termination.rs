//! When a solver has converged, and why it stopped.

use std::fmt;

use serde::{Deserialize, Serialize};

/// When a solver counts as converged, by three tests; `None` leaves one out.
///
/// No test is passed because a step was short: damping and [`cap`](super::LeastSquares::cap) shorten steps anywhere.
/// Where they did, the step of the lowest damping that is trusted everywhere is judged in its place.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Tolerances {
    /// A step is predicted to lower the cost by at most this fraction of it. Gauss-Newton's method, which trusts its
    /// model whatever comes of it: the last step changed the cost by at most this fraction.
    pub gain: Option<f64>,
    /// No entry of a step is larger, in the columns' own units: metres and radians for poses.
    pub step: Option<f64>,
    /// No column of J has a larger cosine with the residuals: |Jⱼᵀρ| ≤ `gradient` · ‖Jⱼ‖ ‖ρ‖.
    pub gradient: Option<f64>,
}

impl Tolerances {
    /// A picometre or a picoradian: rounding.
    const LEAST_STEP: f64 = 1e-12;
    /// Residuals that are right angles to all columns but for rounding.
    const LEAST_GRADIENT: f64 = 1e-12;

    /// Ends by this gain, or where rounding ends everything; never for `None`.
    pub fn by_gain(gain: Option<f64>) -> Self {
        let with_gain = |least| gain.map(|_| least);
        Self { gain, step: with_gain(Self::LEAST_STEP), gradient: with_gain(Self::LEAST_GRADIENT) }
    }
}

/// Why a solver stopped. Not converging is an answer.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Termination {
    /// By [`Tolerances::gain`].
    #[serde(alias = "converged")]
    ConvergedByGain {
        /// The fraction of the cost asked for.
        tolerance: f64,
    },
    /// By [`Tolerances::step`].
    ConvergedByStep {
        /// The length asked for.
        tolerance: f64,
    },
    /// By [`Tolerances::gradient`].
    ConvergedByGradient {
        /// The cosine asked for.
        tolerance: f64,
    },
    /// All steps asked for are done.
    StepLimit {
        /// How many.
        steps: usize,
    },
    /// No step lowered the cost, however short.
    NoDecrease,
    /// Nothing pulls: the gradient is zero.
    NoGradient,
    /// Somebody asked to stop.
    Cancelled,
    /// The cost or a step was not a finite number; the last good point is kept.
    NotFinite,
}

impl Termination {
    /// Its word in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::ConvergedByGain { .. } => "converged-by-gain",
            Self::ConvergedByStep { .. } => "converged-by-step",
            Self::ConvergedByGradient { .. } => "converged-by-gradient",
            Self::StepLimit { .. } => "step-limit",
            Self::NoDecrease => "no-decrease",
            Self::NoGradient => "no-gradient",
            Self::Cancelled => "cancelled",
            Self::NotFinite => "not-finite",
        }
    }
}

impl fmt::Display for Termination {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ConvergedByGain { tolerance } => {
                write!(f, "converged: a step gains less than {tolerance:e} of the cost")
            }
            Self::ConvergedByStep { tolerance } => {
                write!(f, "converged: a step moves nothing by more than {tolerance:e}")
            }
            Self::ConvergedByGradient { tolerance } => {
                write!(f, "converged: the gradient is less than {tolerance:e} of its scale")
            }
            Self::StepLimit { steps: 1 } => write!(f, "1 step done"),
            Self::StepLimit { steps } => write!(f, "{steps} steps done"),
            Self::NoDecrease => write!(f, "no step lowered the cost"),
            Self::NoGradient => write!(f, "the gradient is zero"),
            Self::Cancelled => write!(f, "cancelled"),
            Self::NotFinite => write!(f, "the numbers ran out of range"),
        }
    }
}
