//! How far the limbs of a tracked pose may be believed.

use super::beam::Mode;
use super::lost::Lost;
use super::tracker::{Tracker, watched};
use crate::belief::{self, Conflicts, LimbTrust, Reason, TrustInputs};
use crate::body::{Kinematics, Pose};
use crate::camera::up_of;
use crate::cues::{self, FrameCues, LimbHold};
use crate::fit::{Fit, FitView};

/// A rival's limb is elsewhere if its end is farther off than this, metres.
const ELSEWHERE_M: f64 = 0.1;
/// A limb in a lost frame is at least this likely to be wrong.
const LOST_WRONG: f64 = 0.1;
/// How far a limb is off of which nothing is seen, metres.
const UNKNOWN_ERROR_M: f64 = 0.5;

impl Tracker {
    /// What silhouettes say against a pose.
    pub(super) fn conflicts(&self, pose: &Pose, views: &[FitView]) -> Conflicts {
        let kinematics = Kinematics::new(&self.model, pose);
        Conflicts::new(&self.model, &kinematics, self.options.renderer, views)
    }

    /// How far every limb of a fit that has ended may be believed. What a cue holds is held, where cues were watched (`holds`).
    pub(super) fn trust(
        &self,
        fit: &mut Fit,
        conflicts: &Conflicts,
        holds: &[LimbHold],
        views: &[FitView],
        modes: &[Mode],
        lost: Option<Lost>,
    ) -> Vec<LimbTrust> {
        let (model, renderer) = (&*self.model, self.options.renderer);
        let kinematics = Kinematics::new(model, fit.pose());
        let unheld: Vec<bool> = match holds {
            [] => cues::unheld(model, &kinematics, &watched(views, FrameCues::default()).0, renderer),
            holds => holds.iter().map(LimbHold::is_unsure).collect(),
        };
        let pose = fit.pose().clone();
        let (equations, energies) = fit.free_equations(&pose);
        let seen = views.iter().filter(|view| view.has_data());
        let mut trust = belief::trust(&TrustInputs {
            model,
            kinematics: &kinematics,
            conflicts,
            energies: &energies,
            unheld: &unheld,
            equations: &equations,
            up: up_of(seen.map(|view| &*view.camera)),
        });
        let beside: Vec<(Kinematics, f64)> =
            modes.iter().map(|mode| (Kinematics::new(model, &mode.pose), mode.weight)).collect();
        for limb in &mut trust {
            let end = kinematics.ends()[limb.limb];
            let elsewhere =
                beside.iter().filter(|(rival, _)| rival.ends()[limb.limb].distance(end) > ELSEWHERE_M);
            let rivals = 0.5 * elsewhere.map(|(_, weight)| weight).sum::<f64>();
            let least = if lost.is_some() { LOST_WRONG } else { 0.0 };
            let (wrong, reason) = match limb.reason {
                _ if least > limb.wrong.max(rivals) => (least, Reason::Lost),
                Some(reason) if rivals <= limb.wrong => (limb.wrong, reason),
                _ => (limb.wrong.max(rivals), Reason::Rival),
            };
            *limb = LimbTrust::new(limb.limb, wrong, limb.error_m, reason);
        }
        trust
    }

    /// Of a frame in which nobody is found.
    pub(super) fn nothing_believed(&self) -> Vec<LimbTrust> {
        let limbs = 0..self.model.limbs().len();
        limbs.map(|limb| LimbTrust::new(limb, 1.0, UNKNOWN_ERROR_M, Reason::Lost)).collect()
    }
}
