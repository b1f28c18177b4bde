//! Options that choose how frames are followed.

use std::path::{Path, PathBuf};

use anyhow::bail;
use backlit_document::tracking_choices::Following;
use backlit_formats::Take;
use backlit_formats::prior_file::{self, PEOPLE};
use backlit_runs::track::{Smoothing, TrackPlan};
use backlit_tracking::body::Pose;
use backlit_tracking::fit::{FitOptions, Preset};
use backlit_tracking::residual::learnt_prior::LearntPrior;
use backlit_tracking::track::{KalmanOptions, Motion, WhenToSearch};
use clap::Args;

use crate::fit_options::{SolverArguments, Words, one_of};
use crate::numbers::within;

/// How frames are followed.
#[derive(Debug, Args)]
pub(crate) struct FollowArguments {
    /// The fit of a frame.
    #[command(flatten)]
    pub(crate) solver: SolverArguments,
    /// The prior learnt from motion that says which poses are likely: a file of backlit prior; people, the one that comes
    /// with the program; or none [default: people, with the report preset none]
    #[arg(long, value_name = "FILE")]
    pub(crate) prior: Option<PathBuf>,
    /// How motion is carried from frame to frame [default: velocity, with the report preset still]
    #[arg(long, value_parser = one_of(&Following::NAMED), value_name = "MOTION")]
    pub(crate) motion: Option<Following>,
    /// The Kalman filter's noise, as --tune prints it: a pixel's deviation (grey levels), accelerations of joints (rad/s^1.5)
    /// and root (m/s^1.5) [0.000001 to 1000000] [default: what each frame's residuals say, what the prior has learnt]
    #[arg(long, value_name = "R,TURN,MOVE", value_delimiter = ',', value_parser = within(1e-6..=1e6_f64))]
    pub(crate) noise: Option<Vec<f64>>,
    /// Smooth every frame by only this many frames after it, as a live track with that delay could [0 to 1000]
    #[arg(long, value_name = "FRAMES", value_parser = within(0..=1000_usize))]
    pub(crate) lag: Option<usize>,
    /// Carry this many hypotheses from frame to frame where silhouettes do not decide [1 to 16] [default: 8, with the
    /// report preset 1]
    #[arg(long, value_name = "N", value_parser = within(1..=16_u8))]
    pub(crate) hypotheses: Option<u8>,
    /// When to look for other poses than the one downhill, in the first frame and after a lost one
    /// [default: poor, with the report preset never]
    #[arg(long, value_parser = one_of(SEARCHES), value_name = "WHEN", num_args = 0..=1, default_missing_value = "always")]
    pub(crate) search: Option<WhenToSearch>,
}

impl FollowArguments {
    /// The fit of a frame, with its prior if it has one.
    pub(crate) fn fit(&self) -> anyhow::Result<FitOptions> {
        let mut fit = self.solver.options()?;
        let default = match self.solver.preset {
            Preset::Robust => PEOPLE,
            Preset::Report => NO_PRIOR,
        };
        let path = self.prior.as_deref().unwrap_or(Path::new(default));
        if path != Path::new(NO_PRIOR) {
            fit.prior = Some(LearntPrior::new(prior_file::read_or_built_in(path)?));
        }
        Ok(fit)
    }

    /// How these frames of a take are followed from this pose.
    pub(crate) fn plan(&self, take: &Take, start: Pose, frames: &[usize]) -> anyhow::Result<TrackPlan> {
        let preset = self.solver.preset;
        let usual = TrackPlan::of_preset(preset, self.fit()?, take, start, frames.to_vec().into());
        let noise = self.noise()?;
        let motion = match self.motion.map(Following::motion) {
            None => usual.motion,
            Some(Motion::Kalman(_)) => Motion::Kalman(noise),
            Some(motion) => motion,
        };
        Ok(TrackPlan {
            motion,
            search: self.search.unwrap_or(usual.search),
            rivals: self.hypotheses.map_or(usual.rivals, |most| usize::from(most) - 1),
            smoothing: self.smoothing()?,
            ..usual
        })
    }

    pub(crate) fn is_kalman(&self) -> bool {
        self.motion.is_some_and(|motion| matches!(motion.motion(), Motion::Kalman(_)))
    }

    pub(crate) fn noise(&self) -> anyhow::Result<KalmanOptions> {
        let steers = self.motion == Some(Following::Steered);
        let default = KalmanOptions { steers, ..KalmanOptions::default() };
        match self.noise.as_deref() {
            None => Ok(default),
            Some(_) if !self.is_kalman() => bail!("--noise is for --motion kalman, steered or smoothed"),
            Some(&[deviation, turn_acceleration, move_acceleration]) => {
                let measurement_deviation = Some(deviation);
                Ok(KalmanOptions { measurement_deviation, turn_acceleration, move_acceleration, ..default })
            }
            Some(numbers) => bail!("--noise has {} numbers; expected three: R,TURN,MOVE", numbers.len()),
        }
    }

    /// How later frames smooth earlier ones, if they do.
    pub(crate) fn smoothing(&self) -> anyhow::Result<Option<Smoothing>> {
        let is_smoothed = matches!(self.motion, Some(Following::Smoothed { .. }));
        if self.lag.is_some() && !is_smoothed {
            bail!("--lag is for --motion smoothed");
        }
        Ok(is_smoothed.then_some(Smoothing { lag: self.lag }))
    }
}

/// The word for no prior.
const NO_PRIOR: &str = "none";

/// When to look for other poses.
const SEARCHES: Words<WhenToSearch> = &[
    ("never", "Never", WhenToSearch::Never),
    ("poor", "Where the fit overlaps poorly: IoU below 0.9", WhenToSearch::WhenPoor),
    ("always", "Always", WhenToSearch::Always),
];
