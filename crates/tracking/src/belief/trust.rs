//! How far a fitted limb may be believed, told by what is seen without knowing the truth.
//!
//! The end of a limb is *wrong* where it is more than 250 mm off. With features f of the limb in its frame
//!
//! P(wrong) = 1/(1 + exp(−(a + Σ aᵢ fᵢ)))  and, where it is not wrong, ln(error/mm) ≈ b + Σ bᵢ fᵢ, median.
//!
//! | feature | |
//! |---|---|
//! | spurious | root of the share of its chain's inner part that lies on background ([`Conflicts`]) |
//! | missing | root of the share of the subject that no limb covers |
//! | unheld | 1 where silhouettes show too little of its own boundary ([`LimbHold`]) |
//! | unlikely | ln(1 + E/6), E the energy of its part by what motion files say |
//! | unlikely trunk | the same of the trunk |
//! | tilt | how far the trunk is from upright beyond 1.2 rad |
//! | loose | ln(σ/m + 0.001), σ the deviation that silhouettes leave to its end |
//! | alone | 1 where one camera sees the subject |
//!
//! The numbers were fitted once, by logistic regression (D. Cox, "The regression analysis of binary sequences", 1958) and by least
//! squares, outside of this repository, on half of 44 tracks like those of `backlit experiment trust`.

use glam::DVec3;
use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};

use super::conflict::Conflicts;
use crate::body::{Kinematics, Model, Parameters, Sides};
use crate::optimize::NormalEquations;
use crate::residual::learnt_prior::PartEnergy;
use crate::search::Chains;

/// A limb is told as wrong above this probability, and as doubtful above the other.
const WRONG_ABOVE: f64 = 0.25;
const DOUBTFUL_ABOVE: f64 = 0.05;
/// What nothing holds is at least this likely to be wrong: an arm that is lost into the trunk contradicts no silhouette.
const UNHELD_WRONG: f64 = 0.06;
/// Deviation of a pixel's residual, grey levels: model and silhouette err together over whole edges.
const PIXEL_DEVIATION: f64 = 200.0;
/// What is known of a pose before it is seen: deviations of the root, metres, and of a rotation, radians.
const ROOT_DEVIATION_M: f64 = 0.5;
const TURN_DEVIATION: f64 = 0.8;
/// The trunk may lean this far, radians.
const LEANS: f64 = 1.2;
/// An energy of this size is nothing odd.
const USUAL_ENERGY: f64 = 6.0;

/// Features, and what they weigh in P(wrong) and in the logarithm of the error.
const FEATURES: [(Reason, f64, f64); 8] = [
    (Reason::Spurious, 3.766, 1.328),
    (Reason::Uncovered, 8.252, 1.252),
    (Reason::Unheld, 0.834, 0.339),
    (Reason::Unlikely, 1.421, 0.091),
    (Reason::UnlikelyTrunk, 1.170, 0.230),
    (Reason::UpsideDown, 4.016, 6.522),
    (Reason::Loose, 0.731, 0.075),
    (Reason::OneCamera, 2.372, 0.983),
];
const WRONG_BIAS: f64 = -2.859;
const ERROR_BIAS: f64 = 3.464;
/// The features of a limb about which there is nothing to say; a reason is what is farthest above.
const USUAL: [f64; 8] = [0.1, 0.05, 0.0, 0.5, 0.3, 0.0, -5.0, 0.0];

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
    /// One camera alone sees the subject: nothing tells the depth.
    OneCamera,
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
            Self::OneCamera => "one camera does not tell depth",
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
    /// How far its end is off in the median where it is not wrong, metres.
    pub error_m: f64,
}

impl LimbTrust {
    /// The verdict follows from the probability; a good limb has no reason.
    pub fn new(limb: usize, wrong: f64, error_m: f64, reason: Reason) -> Self {
        let verdict = match wrong {
            _ if wrong > WRONG_ABOVE => Verdict::Wrong,
            _ if wrong > DOUBTFUL_ABOVE => Verdict::Doubtful,
            _ => Verdict::Good,
        };
        let reason = (verdict != Verdict::Good).then_some(reason);
        Self { limb, verdict, reason, wrong, error_m }
    }
}

/// What is seen of a pose in a frame.
#[derive(Debug)]
pub(crate) struct TrustInputs<'a> {
    pub(crate) model: &'a Model,
    pub(crate) kinematics: &'a Kinematics,
    pub(crate) conflicts: &'a Conflicts,
    /// What motion files say of the pose.
    pub(crate) energies: &'a [PartEnergy],
    /// By rotation, whether nothing holds it.
    pub(crate) unheld: &'a [bool],
    /// What the frame says of the pose by itself, tangent columns.
    pub(crate) equations: &'a NormalEquations,
    /// Up in the world, where the cameras tell it.
    pub(crate) up: Option<DVec3>,
}

/// How far every limb is believed.
pub(crate) fn trust(inputs: &TrustInputs<'_>) -> Vec<LimbTrust> {
    let TrustInputs { model, kinematics, conflicts, energies, .. } = *inputs;
    let parts = Chains::new(model);
    let tilt = inputs
        .up
        .zip(Sides::of(model, kinematics))
        .map_or(0.0, |(up, sides)| (sides.up.dot(up).clamp(-1.0, 1.0).acos() - LEANS).max(0.0));
    let unlikely = |energy: f64| (energy / USUAL_ENERGY).ln_1p();
    let energy_where = |is_of: &dyn Fn(usize) -> bool| {
        let of_part = |part: &&PartEnergy| part.rotations.iter().any(|&rotation| is_of(rotation));
        energies.iter().find(of_part).map(|part| part.energy)
    };
    let trunk = energy_where(&|rotation| parts.trunk.contains(&rotation)).unwrap_or_default();
    let deviations = deviations(model, kinematics, inputs.equations);
    let missing = conflicts.missing_share().clamp(0.0, 1.0).sqrt();
    let alone = f64::from(u8::from(conflicts.cameras <= 1));
    let of_limb = |limb: usize| {
        let rotation = model.limbs()[limb].rotation;
        let chain = parts.chains.iter().find(|chain| chain.contains(&rotation)).unwrap_or(&parts.trunk);
        let members =
            || model.limbs().iter().zip(&conflicts.limbs).filter(|(limb, _)| chain.contains(&limb.rotation));
        let inner: f64 = members().map(|(_, conflict)| conflict.inner).sum();
        let spurious: f64 = members().map(|(_, conflict)| conflict.spurious).sum();
        let followed = |other: usize| model.rotation_follows(rotation, other) && chain.contains(&other);
        let energy = energy_where(&followed).unwrap_or(trunk);
        let is_unheld = inputs.unheld.get(rotation).copied().unwrap_or_default();
        let features = [
            (spurious / inner.max(1e-4)).clamp(0.0, 1.0).sqrt(),
            missing,
            f64::from(u8::from(is_unheld)),
            unlikely(energy),
            unlikely(trunk),
            tilt,
            (deviations[limb] + 1e-3).ln(),
            alone,
        ];
        let sum = |weight: fn(&(Reason, f64, f64)) -> f64| -> f64 {
            FEATURES.iter().zip(features).map(|(feature, value)| weight(feature) * value).sum()
        };
        let wrong = 1.0 / (1.0 + (-(WRONG_BIAS + sum(|feature| feature.1))).exp());
        let error_m = 1e-3 * (ERROR_BIAS + sum(|feature| feature.2)).exp();
        if is_unheld && wrong < UNHELD_WRONG {
            return LimbTrust::new(limb, UNHELD_WRONG, error_m, Reason::Unheld);
        }
        let above = |index: usize| FEATURES[index].1 * (features[index] - USUAL[index]);
        let most = (0..FEATURES.len()).max_by(|&a, &b| above(a).total_cmp(&above(b)));
        LimbTrust::new(limb, wrong, error_m, FEATURES[most.unwrap_or_default()].0)
    };
    (0..model.limbs().len()).map(of_limb).collect()
}

/// The deviation that a frame leaves to the end of every limb, metres: the root of the trace of K H⁻¹ Kᵀ.
fn deviations(model: &Model, kinematics: &Kinematics, equations: &NormalEquations) -> Vec<f64> {
    let mut information = &equations.jtj / (PIXEL_DEVIATION * PIXEL_DEVIATION);
    for column in 0..information.nrows() {
        let deviation = if column < 3 { ROOT_DEVIATION_M } else { TURN_DEVIATION };
        information[(column, column)] += 1.0 / (deviation * deviation);
    }
    let factor = information.cholesky();
    let of_limb = |limb: usize| {
        let by_step: DMatrix<f64> = kinematics.end_jacobian(limb, Parameters::Tangent);
        let spread =
            factor.as_ref().map(|factor| by_step.dot(&factor.solve(&by_step.transpose()).transpose()));
        spread.map_or(1.0, |spread| spread.max(0.0).sqrt())
    };
    (0..model.limbs().len()).map(of_limb).collect()
}

#[cfg(test)]
mod tests {
    use glam::DQuat;

    use super::*;
    use crate::body::{Pose, builtin};
    use crate::fit::{Fit, FitOptions, FitView};
    use crate::fixtures;
    use crate::render::RendererKind;

    fn judged(fitted: &Pose, truth: &Pose, is_unheld: bool) -> Vec<LimbTrust> {
        let model = std::sync::Arc::new(builtin::full_body());
        let camera = |x: f64, y: f64| {
            let at = DVec3::new(x, y, 1.1);
            fixtures::camera([180, 260], [320.0, 320.0, 89.5, 129.5], at, DVec3::Z * 0.9, DVec3::Z)
        };
        let cameras = [camera(-1.2, 2.7), camera(0.7, 2.9), camera(2.9, 0.2)];
        let views: Vec<FitView> = cameras.map(|camera| fixtures::fit_view(&model, truth, camera)).to_vec();
        let kinematics = Kinematics::new(&model, fitted);
        let conflicts = Conflicts::new(&model, &kinematics, RendererKind::Capsule, &views);
        let mut fit = Fit::new(model.clone(), views, fitted.clone(), FitOptions::default()).unwrap();
        let equations = fit.frame_equations();
        let unheld = vec![is_unheld; model.rotation_count()];
        trust(&TrustInputs {
            model: &model,
            kinematics: &kinematics,
            conflicts: &conflicts,
            energies: &[],
            unheld: &unheld,
            equations: &equations,
            up: Some(DVec3::Z),
        })
    }

    /// The truth is believed; an arm that points elsewhere is not, and the reason is where it lies; who stands on his head
    /// is not believed at all.
    #[test]
    fn what_silhouettes_contradict_is_not_believed() {
        let model = builtin::full_body();
        let posed = |angle: f64| {
            let turns = [
                ("right upper arm", DQuat::from_rotation_y(angle)),
                ("left upper arm", DQuat::from_rotation_y(0.5)),
            ];
            fixtures::posed(&model, DVec3::Z * 0.92, &turns)
        };
        let truth = posed(-0.5);
        let hand = model.limb_index("right forearm").unwrap();
        let right = judged(&truth, &truth, false);
        assert!(right.iter().all(|limb| limb.verdict == Verdict::Good && limb.reason.is_none()), "{right:?}");
        let arm = judged(&posed(-2.2), &truth, false)[hand];
        assert!(arm.verdict > Verdict::Good && arm.wrong > 3.0 * right[hand].wrong, "{arm:?}");
        assert!(matches!(arm.reason, Some(Reason::Spurious | Reason::Uncovered)), "{arm:?}");
        // What nothing holds may be anywhere.
        let unheld = judged(&truth, &truth, true)[hand];
        assert_eq!((unheld.verdict, unheld.reason), (Verdict::Doubtful, Some(Reason::Unheld)));
        let mut over = truth.clone();
        let root = model.rotation_parents().iter().position(Option::is_none).unwrap();
        over.rotations[root] = DQuat::from_rotation_y(3.1) * over.rotations[root];
        let over = judged(&over, &truth, false);
        let wrong = over.iter().filter(|limb| limb.verdict == Verdict::Wrong).count();
        assert!(wrong * 10 > over.len() * 9, "{wrong} of {}", over.len());
    }
}
