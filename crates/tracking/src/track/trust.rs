//! How far the limbs of a tracked pose may be believed.

use super::beam::Mode;
use super::lost::Lost;
use super::tracker::{Tracker, watched};
use crate::belief::{self, Conflicts, LimbTrust, Reason, Signs, TrustInputs};
use crate::body::{Kinematics, Pose};
use crate::camera::up_of;
use crate::cues::{self, FrameCues, LimbHold};
use crate::fit::{Fit, FitView};

/// How far a limb is off of which nothing is seen, in half of such frames and in 95 of 100, metres.
const UNKNOWN_ERROR_M: [f64; 2] = [0.5, 2.0];

/// What else is known of a frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct FrameContext<'a> {
    pub(super) holds: &'a [LimbHold],
    pub(super) modes: &'a [Mode],
    pub(super) lost: Option<Lost>,
    pub(super) rms: f64,
}

impl Tracker {
    /// What silhouettes say against a pose.
    pub(super) fn conflicts(&self, pose: &Pose, views: &[FitView]) -> Conflicts {
        let kinematics = Kinematics::new(&self.model, pose);
        Conflicts::new(&self.model, &kinematics, self.options.renderer, views)
    }

    /// The signs of every limb of a fit that has ended, before the tracker goes on to the next frame. What a cue holds is held, where
    /// cues were watched (`holds`).
    pub(super) fn signs(
        &self,
        frame: usize,
        fit: &mut Fit,
        conflicts: &Conflicts,
        beside: FrameContext<'_>,
        views: &[FitView],
    ) -> Vec<Signs> {
        let (model, renderer) = (&*self.model, self.options.renderer);
        let kinematics = Kinematics::new(model, fit.pose());
        let unheld: Vec<bool> = match beside.holds {
            [] => cues::unheld(model, &kinematics, &watched(views, FrameCues::default()).0, renderer),
            holds => holds.iter().map(LimbHold::is_unsure).collect(),
        };
        let pose = fit.pose().clone();
        let (equations, energies) = fit.free_equations(&pose);
        let cameras = fit.camera_equations();
        let seen = views.iter().filter(|view| view.has_data());
        let rivals: Vec<(Kinematics, f64)> =
            beside.modes.iter().map(|mode| (Kinematics::new(model, &mode.pose), mode.weight)).collect();
        let last = self.last.as_ref().filter(|last| !last.lost);
        let before =
            last.map(|last| (Kinematics::new(model, &last.pose), self.seconds_between(last.frame, frame)));
        belief::signs(&TrustInputs {
            model,
            kinematics: &kinematics,
            conflicts,
            energies: &energies,
            unheld: &unheld,
            equations: &equations,
            cameras: &cameras,
            rms: beside.rms,
            up: up_of(seen.map(|view| &*view.camera)),
            rivals: &rivals,
            before,
            is_lost: beside.lost.is_some(),
        })
    }

    /// Of a frame in which nobody is found.
    pub(super) fn nothing_believed(&self) -> Vec<LimbTrust> {
        let limbs = 0..self.model.limbs().len();
        limbs.map(|limb| LimbTrust::new(limb, 1.0, UNKNOWN_ERROR_M, Reason::Lost)).collect()
    }
}
