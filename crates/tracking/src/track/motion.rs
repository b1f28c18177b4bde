//! How motion is carried from frame to frame.
//!
//! This joins the Kalman filter, which knows no bodies, to poses: the mean pose takes steps by
//! [`Pose::retract`], differences are [`Pose::local`], both in tangent columns.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::body::{Model, Parameters, Pose};
use crate::filter::{Belief, ConstantVelocity, FilterError, Innovation, count_once, update};
use crate::fit::Preset;
use crate::numbers::Brief;
use crate::optimize::NormalEquations;
use crate::prior::Accelerations;
use crate::residual::motion_prior::MotionPrior;

/// How a frame's fit learns from the frames before.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Motion {
    /// It starts from the last pose.
    Still,
    /// It starts where the velocity between the last two frames leads in the time to this one.
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

/// Noise of the filter, and how it is used.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct KalmanOptions {
    /// √R: what a pixel's deviation would be if independent pixels erred as much in the pose, grey levels. `None`: what each frame's
    /// own residuals say.
    pub measurement_deviation: Option<f64>,
    /// √q of joints: what a velocity changes in a second, rad/s^1.5. Where the prior of poses knows how joints move
    /// ([`Accelerations`](crate::prior::Accelerations)), theirs count, as many times larger as this is than the default.
    pub turn_acceleration: f64,
    /// √q of the root, m/s^1.5; likewise.
    pub move_acceleration: f64,
    /// τ: seconds after which 1/e is left of a velocity. What is not seen must not go on for ever.
    pub memory: f64,
    /// Whether a frame's fit begins at the prediction and carries it from its first iteration on. Else it is free, and the
    /// prediction weighs in where it ended.
    pub steers: bool,
}

impl Default for KalmanOptions {
    fn default() -> Self {
        Self {
            measurement_deviation: None,
            turn_acceleration: 3.0,
            move_acceleration: 0.5,
            memory: 0.3,
            steers: false,
        }
    }
}

/// What is wrong with the choices of a motion model.
#[derive(Debug, Error, Clone, PartialEq)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum MotionError {
    #[error("`kalman.{field}` is {}; expected a finite number above 0, {unit}", Brief(*.value))]
    Noise { field: &'static str, value: f64, unit: &'static str },
    #[error("`frame_rate` is {}; expected a finite number above 0, frames a second", Brief(*.0))]
    FrameRate(f64),
}

impl KalmanOptions {
    /// First thing wrong with the numbers, by field.
    ///
    /// # Errors
    /// A deviation that is not finite and above 0: a filter without noise is certain for ever.
    pub fn check(&self) -> Result<(), MotionError> {
        let fields = [
            ("measurement_deviation", self.measurement_deviation.unwrap_or(1.0), "grey levels"),
            ("turn_acceleration", self.turn_acceleration, "rad/s^1.5"),
            ("move_acceleration", self.move_acceleration, "m/s^1.5"),
            ("memory", self.memory, "seconds"),
        ];
        // Squares must be numbers too.
        let is_good = |value: f64| value > 0.0 && (value * value).is_normal();
        match fields.into_iter().find(|&(_, value, _)| !is_good(value)) {
            Some((field, value, unit)) => Err(MotionError::Noise { field, value, unit }),
            None => Ok(()),
        }
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
    /// Before it was seen, where the filter goes on from the frame before: mean pose, belief and the seconds since.
    pub predicted: Option<Predicted>,
    /// How the frame agreed with what was predicted; `None` where nothing was, or nobody was seen.
    pub innovation: Option<Innovation>,
    /// Why the filter began at this frame; `None` where it went on.
    pub begins: Option<Begins>,
    /// What the frame says by itself at its pose; `None` where nobody was seen.
    pub measurement: Option<FrameMeasurement>,
}

/// What a frame says of its pose by itself.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameMeasurement {
    /// JᵀJ, tangent columns × tangent columns.
    pub products: DMatrix<f64>,
    /// Jᵀρ, tangent columns.
    pub pull: DVector<f64>,
    /// R, squared grey levels.
    pub variance: f64,
}

/// Why a filter begins at a frame instead of going on from the one before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Begins {
    /// It is the first one.
    First,
    /// The subject was lost in the frame before.
    AfterLoss,
    /// The fit near what was predicted was lost, and the pose was found elsewhere.
    FoundElsewhere,
    /// What was believed could not be carried on.
    Broken(FilterError),
}

/// What was predicted of a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Predicted {
    /// Mean pose.
    pub mean: Pose,
    /// Velocity and covariance.
    pub belief: Belief,
    /// Since the frame before; negative when tracking backwards.
    pub seconds: f64,
    /// By which it was predicted.
    pub motion: MotionModel,
}

/// What is predicted of a frame with what is always known of poses.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ConditionedPrediction {
    /// By motion alone.
    predicted: Predicted,
    pub(super) mean: Pose,
    belief: Belief,
}

/// How a body's joints move: the filter's noise, column by column.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionModel {
    /// The filter's noise.
    pub noise: KalmanOptions,
    /// √q of each tangent column, if the noise's accelerations are the default.
    accelerations: Arc<DVector<f64>>,
}

impl MotionModel {
    /// Of a body, by the accelerations that were learnt, if any were.
    #[must_use]
    pub fn new(noise: KalmanOptions, model: &Model, learnt: Option<&Accelerations>) -> Self {
        let KalmanOptions { turn_acceleration, move_acceleration, .. } = KalmanOptions::default();
        let name = |column: usize| model.limbs()[model.rotation_owners()[column / 3 - 1]].name.as_str();
        let one = |column: usize, _| match learnt {
            Some(learnt) if column < 3 => learnt.root,
            Some(learnt) => learnt.of_limb(name(column)),
            None if column < 3 => move_acceleration,
            None => turn_acceleration,
        };
        let n = Parameters::Tangent.columns(model.rotation_count());
        Self { noise, accelerations: Arc::new(DVector::from_fn(n, one)) }
    }

    /// The same joints with other noise.
    pub(super) fn with_noise(&self, noise: KalmanOptions) -> Self {
        Self { noise, ..self.clone() }
    }

    pub(super) fn constant_velocity(&self) -> ConstantVelocity {
        let (default, noise) = (KalmanOptions::default(), &self.noise);
        let n = self.accelerations.len();
        let of_moves = noise.move_acceleration / default.move_acceleration;
        let of_turns = noise.turn_acceleration / default.turn_acceleration;
        let acceleration = self.accelerations.component_mul(&columns(n, of_moves, of_turns));
        ConstantVelocity { acceleration, memory: noise.memory }
    }
}

impl Predicted {
    /// What the belief predicts this many seconds after its frame.
    pub(super) fn after(motion: MotionModel, pose: &Pose, belief: &Belief, seconds: f64) -> Self {
        let (step, belief) = motion.constant_velocity().predict(belief, seconds);
        let mean = pose.retract(Parameters::Tangent, step.as_slice());
        Self { mean, belief, seconds, motion }
    }

    /// With what is always known of poses: its information and its pull at the mean, tangent columns.
    ///
    /// # Errors
    /// The covariance is certain of a direction.
    pub(super) fn conditioned_on(
        self,
        known: &NormalEquations,
    ) -> Result<ConditionedPrediction, FilterError> {
        let (step, belief) = count_once(&self.belief, &known.jtj, &known.jtr)?;
        let mean = self.mean.retract(Parameters::Tangent, step.as_slice());
        Ok(ConditionedPrediction { predicted: self, mean, belief })
    }
}

impl ConditionedPrediction {
    /// What it says of a frame's pose, with R of the frame.
    ///
    /// # Errors
    /// The covariance is certain of a direction.
    pub(super) fn prior(&self, variance: f64) -> Result<MotionPrior, FilterError> {
        let information = self.belief.pose_information().ok_or(FilterError::Certain)?;
        Ok(MotionPrior { mean: self.mean.clone(), information, variance })
    }
}

impl From<Predicted> for ConditionedPrediction {
    fn from(predicted: Predicted) -> Self {
        Self { mean: predicted.mean.clone(), belief: predicted.belief.clone(), predicted }
    }
}

/// Root and rotations of n tangent columns.
fn columns(n: usize, of_root: f64, of_turns: f64) -> DVector<f64> {
    DVector::from_fn(n, |column, _| if column < 3 { of_root } else { of_turns })
}

/// What is believed before the first frame of n tangent columns.
pub(super) fn start_belief(n: usize) -> Belief {
    let pose = columns(n, START_MOVE, START_TURN);
    Belief::at_rest(&pose, &columns(n, START_MOVE_VELOCITY, START_TURN_VELOCITY))
}

impl FrameBelief {
    /// What is believed after a frame of this pose; `measurement` is `None` where nobody was seen. Without a prediction the filter
    /// begins, for the reason given.
    pub(super) fn learnt(
        pose: &Pose,
        measurement: Option<FrameMeasurement>,
        prediction: Result<ConditionedPrediction, Begins>,
    ) -> Self {
        let learnt = match prediction {
            Ok(prediction) => Self::going_on(pose, measurement.as_ref(), prediction)
                .unwrap_or_else(|error| Self::beginning(pose, measurement.as_ref(), Begins::Broken(error))),
            Err(begins) => Self::beginning(pose, measurement.as_ref(), begins),
        };
        Self { measurement, ..learnt }
    }

    fn going_on(
        pose: &Pose,
        measurement: Option<&FrameMeasurement>,
        prediction: ConditionedPrediction,
    ) -> Result<Self, FilterError> {
        let ConditionedPrediction { predicted, mean, belief } = prediction;
        let (belief, innovation) = match measurement {
            Some(FrameMeasurement { products, variance, .. }) => {
                let step = DVector::from_vec(pose.local(&mean));
                let (belief, innovation) = update::update(&belief, &step, products, *variance)?;
                (belief, Some(innovation))
            }
            None => (belief, None),
        };
        Ok(Self { belief, predicted: Some(predicted), innovation, begins: None, measurement: None })
    }

    fn beginning(pose: &Pose, measurement: Option<&FrameMeasurement>, begins: Begins) -> Self {
        let n = Parameters::Tangent.columns(pose.rotations.len());
        let start = start_belief(n);
        // Where even this cannot be learned, what is believed is what a start is.
        let belief = measurement
            .and_then(|measurement| {
                update::update(&start, &DVector::zeros(n), &measurement.products, measurement.variance).ok()
            })
            .map_or(start, |(belief, _)| belief);
        Self { belief, predicted: None, innovation: None, begins: Some(begins), measurement: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_that_makes_no_sense_is_named() {
        let good = KalmanOptions::default();
        assert_eq!(good.check(), Ok(()));
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e200, 1e-200] {
            for (options, field) in [
                (KalmanOptions { measurement_deviation: Some(bad), ..good }, "measurement_deviation"),
                (KalmanOptions { turn_acceleration: bad, ..good }, "turn_acceleration"),
                (KalmanOptions { move_acceleration: bad, ..good }, "move_acceleration"),
                (KalmanOptions { memory: bad, ..good }, "memory"),
            ] {
                let message = options.check().unwrap_err().to_string();
                assert!(message.contains(field), "{bad}: {message}");
            }
        }
    }
}
