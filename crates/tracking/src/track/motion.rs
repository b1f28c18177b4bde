//! How motion is carried from frame to frame.
//!
//! `MotionFilter` joins the Kalman filter, which knows no bodies, to poses: the mean pose takes steps by
//! [`Pose::retract`], differences are [`Pose::local`], both in tangent columns.

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use crate::body::{Model, Parameters, Pose};
use crate::filter::{Belief, ConstantVelocity, update};
use crate::fit::Preset;
use crate::residual::motion_prior::MotionPrior;

/// How a frame's fit learns from the frames before.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Motion {
    /// It starts from the last pose.
    Still,
    /// It starts where the motion between the last two frames leads.
    #[default]
    Velocity,
    /// The iterated extended Kalman filter (6.1): pose and velocity, and how sure they are.
    Kalman(KalmanOptions),
}

impl Motion {
    /// What goes with a preset: in the report every frame begins at the last one's pose (section 5.2).
    #[must_use]
    pub fn of_preset(preset: Option<Preset>) -> Self {
        if preset == Some(Preset::Report) { Self::Still } else { Self::default() }
    }
}

/// Noise of the filter.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct KalmanOptions {
    /// √R: deviation of a pixel's residual, grey levels. Model and silhouette err together over whole edges, so it is
    /// larger than one pixel's own noise.
    pub measurement_deviation: f64,
    /// √q of joints: what a velocity changes in a second, rad/s^1.5.
    pub turn_acceleration: f64,
    /// √q of the root, m/s^1.5.
    pub move_acceleration: f64,
}

impl Default for KalmanOptions {
    fn default() -> Self {
        Self { measurement_deviation: 200.0, turn_acceleration: 8.0, move_acceleration: 2.0 }
    }
}

/// Deviations of the first frame's pose and velocity, radians (per second) and metres (per second).
const START_TURN: f64 = 0.1;
const START_MOVE: f64 = 0.05;
const START_TURN_VELOCITY: f64 = 3.0;
const START_MOVE_VELOCITY: f64 = 1.0;

/// What the filter believed at a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameBelief {
    /// After the frame was seen: velocity, and covariance of pose and velocity in tangent columns.
    pub belief: Belief,
    /// Before it was seen, where there was a frame before: mean pose, belief and the seconds since.
    pub predicted: Option<Predicted>,
}

/// What was foretold of a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Predicted {
    /// Mean pose.
    pub mean: Pose,
    /// Velocity and covariance.
    pub belief: Belief,
    /// Since the frame before; negative when tracking backwards.
    pub seconds: f64,
}

/// The filter of one track.
#[derive(Debug, Clone)]
pub(super) struct MotionFilter {
    options: KalmanOptions,
    model: ConstantVelocity,
    belief: Option<Belief>,
}

/// Root and rotations of n tangent columns.
fn columns(n: usize, of_root: f64, of_turns: f64) -> DVector<f64> {
    DVector::from_fn(n, |column, _| if column < 3 { of_root } else { of_turns })
}

impl MotionFilter {
    pub(super) fn new(model: &Model, options: KalmanOptions) -> Self {
        let n = Parameters::Tangent.columns(model.rotation_count());
        let acceleration = columns(n, options.move_acceleration, options.turn_acceleration);
        Self { options, model: ConstantVelocity { acceleration }, belief: None }
    }

    /// What is foretold `seconds` after a frame whose pose was `last`.
    pub(super) fn predict(&self, last: &Pose, seconds: f64) -> Option<Predicted> {
        let (step, belief) = self.model.predict(self.belief.as_ref()?, seconds);
        let mean = last.retract(Parameters::Tangent, step.as_slice());
        Some(Predicted { mean, belief, seconds })
    }

    /// The prior of a fit. `None` if the numbers ran out.
    pub(super) fn prior(&self, predicted: &Predicted) -> Option<MotionPrior> {
        let information = predicted.belief.pose_information()?;
        let variance = self.options.measurement_deviation.powi(2);
        Some(MotionPrior { mean: predicted.mean.clone(), information, variance })
    }

    /// Learns a frame's pose and JᵀJ; `products` is `None` where there was nothing to see.
    pub(super) fn learn(
        &mut self,
        pose: &Pose,
        products: Option<&DMatrix<f64>>,
        predicted: Option<Predicted>,
    ) -> FrameBelief {
        let n = self.model.acceleration.len();
        let start = || {
            let pose = columns(n, START_MOVE, START_TURN);
            Belief::at_rest(&pose, &columns(n, START_MOVE_VELOCITY, START_TURN_VELOCITY))
        };
        let (prior, step) = match &predicted {
            Some(predicted) => (predicted.belief.clone(), DVector::from_vec(pose.local(&predicted.mean))),
            None => (start(), DVector::zeros(n)),
        };
        let variance = self.options.measurement_deviation.powi(2);
        let belief = match products {
            Some(products) => update::update(&prior, &step, products, variance).unwrap_or_else(start),
            None => prior,
        };
        self.belief = Some(belief.clone());
        FrameBelief { belief, predicted }
    }
}
