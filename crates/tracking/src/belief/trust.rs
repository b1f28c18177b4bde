//! How far a fitted limb may be believed, told by what is seen without knowing the truth.
//!
//! The end of a limb is *wrong* where it is more than [`WRONG_M`] off. The [signs](super::signs) of the limb in its frame give the
//! [distribution](super::error_distribution) of its end's error, and that gives the probability that it is wrong, the verdict, and
//! the errors below which it is in half and in 95 of 100 frames. Signs of one kind are a reason; the one that is told is that
//! without which the limb would be believed most.
//!
//! What the network knows was learnt by `backlit experiment trust --learn` from half of its tracks, and is judged on the others.

use serde::{Deserialize, Serialize};

use super::error_distribution::ErrorDistribution;
use super::learnt_errors::LEARNT;
use super::signs::{REASONS, Signs};

/// A limb whose end is farther off than this is wrong, metres.
pub const WRONG_M: f64 = 0.25;
/// A limb is told as wrong above this probability, and as doubtful above the other.
const WRONG_ABOVE: f64 = 0.25;
const DOUBTFUL_ABOVE: f64 = 0.02;
/// The shares of such limbs below whose errors the two errors that are told lie.
const TOLD_SHARES: [f64; 2] = [0.5, 0.95];

/// How far a limb is believed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Verdict {
    /// Nothing speaks against it.
    Good,
    /// It may be wrong.
    Doubtful,
    /// There is at least one chance in four that it is more than 250 mm off.
    Wrong,
}

impl Verdict {
    /// Its name in files and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Doubtful => "doubtful",
            Self::Wrong => "wrong",
        }
    }
}

/// What speaks most against a limb.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Reason {
    /// It lies where the silhouettes have background.
    Spurious,
    /// A part of the subject is covered by no limb.
    Uncovered,
    /// Silhouettes do not hold it: too little of its own boundary is seen.
    Unheld,
    /// People seldom hold it so.
    Unlikely,
    /// People seldom hold their trunk so.
    UnlikelyTrunk,
    /// The trunk is far from upright.
    UpsideDown,
    /// Silhouettes leave its end much room.
    Loose,
    /// Few cameras see the subject: little tells the depth.
    #[serde(alias = "one-camera")]
    FewCameras,
    /// The pose explains the silhouettes worse than others do.
    Residual,
    /// It moves fast.
    Fast,
    /// It lies on background in one camera more than in the others.
    CamerasDisagree,
    /// A rival pose has it elsewhere.
    Rival,
    /// The frame is lost as a whole.
    Lost,
}

impl Reason {
    /// In words, after "because".
    pub fn text(self) -> &'static str {
        match self {
            Self::Spurious => "it lies on background",
            Self::Uncovered => "a part of the subject is uncovered",
            Self::Unheld => "nothing holds it",
            Self::Unlikely => "people seldom hold it so",
            Self::UnlikelyTrunk => "people seldom hold their trunk so",
            Self::UpsideDown => "the body is far from upright",
            Self::Loose => "silhouettes leave it much room",
            Self::FewCameras => "few cameras tell little of depth",
            Self::Residual => "the pose does not explain the silhouettes",
            Self::Fast => "it moves fast",
            Self::CamerasDisagree => "the cameras disagree",
            Self::Rival => "a rival pose has it elsewhere",
            Self::Lost => "the frame is lost",
        }
    }
}

/// How far the end of a limb is believed in one frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimbTrust {
    /// The limb.
    pub limb: usize,
    /// In a word.
    pub verdict: Verdict,
    /// What speaks most against it; `None` where the verdict is good.
    pub reason: Option<Reason>,
    /// Probability that its end is more than 250 mm off, 0 to 1.
    pub wrong: f64,
    /// How far its end is off at most, in half of such frames and in 95 of 100, metres.
    pub error_m: f64,
    /// See [`error_m`](Self::error_m).
    pub error_95_m: f64,
}

impl LimbTrust {
    /// What the distribution of its end's error tells.
    #[must_use]
    pub fn of_error(limb: usize, error: &ErrorDistribution, reason: Reason) -> Self {
        let errors_m = TOLD_SHARES.map(|share| error.quantile(share));
        Self::new(limb, error.beyond(WRONG_M), errors_m, reason)
    }

    /// The verdict follows from the probability; a good limb has no reason.
    pub fn new(limb: usize, wrong: f64, errors_m: [f64; 2], reason: Reason) -> Self {
        let [error_m, error_95_m] = errors_m;
        let verdict = match wrong {
            _ if wrong > WRONG_ABOVE => Verdict::Wrong,
            _ if wrong > DOUBTFUL_ABOVE => Verdict::Doubtful,
            _ => Verdict::Good,
        };
        let reason = (verdict != Verdict::Good).then_some(reason);
        Self { limb, verdict, reason, wrong, error_m, error_95_m }
    }
}

/// How far limbs with these signs are believed.
pub(crate) fn trust(signs: &[Signs]) -> Vec<LimbTrust> {
    let of_limb = |(limb, signs): (usize, &Signs)| {
        let error = LEARNT.distribution(signs);
        let told = LimbTrust::of_error(limb, &error, Reason::Loose);
        if told.verdict == Verdict::Good { told } else { LimbTrust { reason: reason(signs), ..told } }
    };
    signs.iter().enumerate().map(of_limb).collect()
}

/// The reason without whose signs a limb would be believed most.
fn reason(signs: &Signs) -> Option<Reason> {
    let without = |reason: Reason| {
        let is_of = |sign: usize| REASONS[sign] == Some(reason);
        let usual = std::array::from_fn(|sign| if is_of(sign) { LEARNT.usual[sign] } else { signs[sign] });
        LEARNT.distribution(&usual).beyond(WRONG_M)
    };
    REASONS.into_iter().flatten().min_by(|a, b| without(*a).total_cmp(&without(*b)))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{DQuat, DVec3};

    use super::*;
    use crate::belief::{Conflicts, TrustInputs, signs};
    use crate::body::{Kinematics, Model, Pose, builtin};
    use crate::fit::{Fit, FitOptions, FitView, PreparedFit};
    use crate::fixtures;
    use crate::render::RendererKind;

    fn judged(model: &Arc<Model>, fitted: &Pose, truth: &Pose, is_unheld: bool) -> Vec<LimbTrust> {
        let camera = |x: f64, y: f64| {
            let at = DVec3::new(x, y, 1.1);
            fixtures::camera([180, 260], [320.0, 320.0, 89.5, 129.5], at, DVec3::Z * 0.9, DVec3::Z)
        };
        let cameras = [camera(-1.2, 2.7), camera(0.7, 2.9), camera(2.9, 0.2)];
        let views: Vec<FitView> = cameras.map(|camera| fixtures::fit_view(model, truth, camera)).to_vec();
        let kinematics = Kinematics::new(model, fitted);
        let conflicts = Conflicts::new(model, &kinematics, RendererKind::Capsule, &views);
        let options = FitOptions::default().near_at_scale(model, &views, fitted);
        let prepared = PreparedFit::new(model, views, fitted, &options, |_, _, _| 0.0).unwrap();
        let mut fit = Fit::at_last_stage(model.clone(), prepared, options, fitted);
        let (equations, _) = fit.free_equations(fitted);
        let cameras = fit.camera_equations();
        let unheld = vec![is_unheld; model.rotation_count()];
        trust(&signs(&TrustInputs {
            model,
            kinematics: &kinematics,
            conflicts: &conflicts,
            energies: &[],
            unheld: &unheld,
            equations: &equations,
            cameras: &cameras,
            rms: fit.summary().final_rms,
            up: Some(DVec3::Z),
            rivals: &[],
            before: Some((Kinematics::new(model, fitted), 1.0 / 30.0)),
            is_lost: false,
        }))
    }

    /// The truth is believed; an arm that points elsewhere is not, and the reason is where it lies; who stands on his head
    /// is not believed at all.
    #[test]
    fn what_silhouettes_contradict_is_not_believed() {
        let model = Arc::new(builtin::full_body());
        let posed = |angle: f64| {
            let turns = [
                ("right upper arm", DQuat::from_rotation_y(angle)),
                ("left upper arm", DQuat::from_rotation_y(0.5)),
            ];
            fixtures::posed(&model, DVec3::Z * 0.92, &turns)
        };
        let truth = posed(-0.5);
        let hand = model.limb_index("right forearm").unwrap();
        let right = judged(&model, &truth, &truth, false);
        for limb in &right {
            assert!(limb.verdict == Verdict::Good && limb.reason.is_none(), "{limb:?}");
        }
        let arm = judged(&model, &posed(-2.2), &truth, false)[hand];
        assert!(arm.verdict > Verdict::Good && arm.wrong > 3.0 * right[hand].wrong, "{arm:?}");
        assert!(matches!(arm.reason, Some(Reason::Spurious | Reason::Uncovered)), "{arm:?}");
        // What nothing holds is believed less.
        let unheld = judged(&model, &truth, &truth, true)[hand];
        assert!(unheld.wrong > 1.5 * right[hand].wrong, "{unheld:?} {:?}", right[hand]);
        let mut over = truth.clone();
        let root = model.rotation_parents().iter().position(Option::is_none).unwrap();
        over.rotations[root] = DQuat::from_rotation_y(3.1) * over.rotations[root];
        let over = judged(&model, &over, &truth, false);
        let wrong = over.iter().filter(|limb| limb.verdict == Verdict::Wrong).count();
        assert!(wrong * 10 > over.len() * 9, "{wrong} of {}", over.len());
    }
}
