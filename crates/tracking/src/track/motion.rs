//! How motion is carried from frame to frame.
//!
//! [`KalmanOptions`] joins the Kalman filter, which knows no bodies, to poses: the mean pose takes steps by
//! [`Pose::retract`], differences are [`Pose::local`], both in tangent columns.

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::body::{Parameters, Pose};
use crate::filter::{Belief, ConstantVelocity, FilterError, Innovation, update};
use crate::fit::Preset;
use crate::numbers::Brief;
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
    /// τ: seconds after which 1/e is left of a velocity. What is not seen must not go on for ever.
    pub memory: f64,
}

impl Default for KalmanOptions {
    fn default() -> Self {
        Self { measurement_deviation: 200.0, turn_acceleration: 8.0, move_acceleration: 2.0, memory: 0.3 }
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
            ("measurement_deviation", self.measurement_deviation, "grey levels"),
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
    /// How the frame agreed with what was foretold; `None` where nothing was, or nobody was seen.
    pub innovation: Option<Innovation>,
    /// Why the filter began at this frame; `None` where it went on.
    pub begins: Option<Begins>,
    /// What the frame says by itself at its pose; `None` where nobody was seen.
    pub seen: Option<Seen>,
}

/// What a frame says of its pose by itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Seen {
    /// JᵀJ, tangent columns × tangent columns.
    pub products: DMatrix<f64>,
    /// Jᵀρ, tangent columns.
    pub pull: DVector<f64>,
}

/// Why a filter begins at a frame instead of going on from the one before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Begins {
    /// It is the first one.
    First,
    /// The subject was lost in the frame before.
    AfterLoss,
    /// The fit near what was foretold was lost, and the pose was found elsewhere.
    FoundElsewhere,
    /// What was believed could not be carried on.
    Broken(FilterError),
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
    /// By which it was foretold.
    pub noise: KalmanOptions,
}

impl Predicted {
    /// What the belief predicts this many seconds after its frame.
    pub(super) fn after(noise: &KalmanOptions, pose: &Pose, belief: &Belief, seconds: f64) -> Self {
        let (step, belief) = noise.model(belief.columns()).predict(belief, seconds);
        let mean = pose.retract(Parameters::Tangent, step.as_slice());
        Self { mean, belief, seconds, noise: *noise }
    }

    /// What it says of a frame's pose.
    ///
    /// # Errors
    /// The covariance is certain of a direction.
    pub(super) fn prior(&self) -> Result<MotionPrior, FilterError> {
        let information = self.belief.pose_information().ok_or(FilterError::Certain)?;
        let variance = self.noise.measurement_deviation.powi(2);
        Ok(MotionPrior { mean: self.mean.clone(), information, variance })
    }
}

impl KalmanOptions {
    /// The motion model of a body with n tangent columns.
    pub(super) fn model(&self, n: usize) -> ConstantVelocity {
        let acceleration = columns(n, self.move_acceleration, self.turn_acceleration);
        ConstantVelocity { acceleration, memory: self.memory }
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

impl KalmanOptions {
    /// What is believed after a frame of this pose; `seen` is `None` where there was nothing to see. Without a prediction the filter
    /// begins, for the reason given.
    pub(super) fn learn(
        &self,
        pose: &Pose,
        seen: Option<Seen>,
        predicted: Result<Predicted, Begins>,
    ) -> FrameBelief {
        let products = seen.as_ref().map(|seen| &seen.products);
        let learned = match predicted {
            Ok(predicted) => self
                .go_on(pose, products, predicted)
                .unwrap_or_else(|error| self.begin(pose, products, Begins::Broken(error))),
            Err(begins) => self.begin(pose, products, begins),
        };
        FrameBelief { seen, ..learned }
    }

    fn go_on(
        &self,
        pose: &Pose,
        products: Option<&DMatrix<f64>>,
        predicted: Predicted,
    ) -> Result<FrameBelief, FilterError> {
        let step = DVector::from_vec(pose.local(&predicted.mean));
        let (belief, innovation) = match products {
            Some(products) => {
                let variance = self.measurement_deviation.powi(2);
                let (belief, innovation) = update::update(&predicted.belief, &step, products, variance)?;
                (belief, Some(innovation))
            }
            None => (predicted.belief.clone(), None),
        };
        Ok(FrameBelief { belief, predicted: Some(predicted), innovation, begins: None, seen: None })
    }

    fn begin(&self, pose: &Pose, products: Option<&DMatrix<f64>>, begins: Begins) -> FrameBelief {
        let n = Parameters::Tangent.columns(pose.rotations.len());
        let start = start_belief(n);
        let variance = self.measurement_deviation.powi(2);
        // Where even this cannot be learned, what is believed is what a start is.
        let belief = products
            .and_then(|products| update::update(&start, &DVector::zeros(n), products, variance).ok())
            .map_or(start, |(belief, _)| belief);
        FrameBelief { belief, predicted: None, innovation: None, begins: Some(begins), seen: None }
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
                (KalmanOptions { measurement_deviation: bad, ..good }, "measurement_deviation"),
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
