//! Signs of how far off the end of a limb is, read from a frame without knowing the truth.
//!
//! | | sign |
//! |---|---|
//! | 0 | root of the share of its chain's inner part that lies on background ([`Conflicts`]) |
//! | 1 | how much larger that share is in the worst camera than in all |
//! | 2, 3 | roots of the share of the subject that no limb covers, and of what is uncovered near its chain |
//! | 4, 5 | whether silhouettes show too little of its own boundary; how much of its chain's inner part is hidden |
//! | 6, 7 | ln(1 + E/6), E the energy of its part, and of the trunk, by what motion files say |
//! | 8 | how far the trunk is from upright beyond 1.2 rad |
//! | 9 | ln(σ/m + 0.001), σ the deviation that silhouettes leave to its end |
//! | 10 | one over the number of cameras that see the subject |
//! | 11 | logarithm of the frame's residual |
//! | 12 | how far rivals have it elsewhere, by their weights |
//! | 13 | whether the frame is lost |
//! | 14 to 16 | its place in its chain; how long the chain is, and as far as the limb, of the longest one |
//! | 17 | logarithm of its speed |
//! | 18, 19 | as 0 with 3, and as 5, of the limb alone |
//! | 20 | share of its chain up to it that nothing holds |
//! | 21 | ln(d/m + 0.001), d how far its end goes with the camera left out that holds it most |
//! | 22 | logarithm of the pixels that a metre of it has, the mean over cameras |

use glam::DVec3;

use super::conflict::Conflicts;
use super::spread::{deviation_m, end_covariances, end_jacobians, left_out_shifts};
use super::trust::Reason;
use crate::body::{Kinematics, Model, Sides};
use crate::optimize::NormalEquations;
use crate::residual::learnt_prior::PartEnergy;
use crate::search::Chains;

/// The trunk may lean this far, radians.
const LEANS: f64 = 1.2;
/// An energy of this size is nothing odd.
const USUAL_ENERGY: f64 = 6.0;
/// A speed below this is rest, metres a second.
const REST: f64 = 0.05;
/// A rival's end that is this far off counts in full, metres.
const FAR_M: f64 = 0.3;

/// A residual below this is as good as none, grey levels.
const LEAST_RMS: f64 = 20.0;

/// How many signs there are.
pub(crate) const SIGNS: usize = 23;

/// The signs of one limb, as the module lists them.
pub type Signs = [f64; SIGNS];

/// The reason that each sign is; which limb it is, is none.
pub(crate) const REASONS: [Option<Reason>; SIGNS] = [
    Some(Reason::Spurious),
    Some(Reason::CamerasDisagree),
    Some(Reason::Uncovered),
    Some(Reason::Uncovered),
    Some(Reason::Unheld),
    Some(Reason::Unheld),
    Some(Reason::Unlikely),
    Some(Reason::UnlikelyTrunk),
    Some(Reason::UpsideDown),
    Some(Reason::Loose),
    Some(Reason::FewCameras),
    Some(Reason::Residual),
    Some(Reason::Rival),
    Some(Reason::Lost),
    None,
    None,
    None,
    Some(Reason::Fast),
    Some(Reason::Spurious),
    Some(Reason::Unheld),
    Some(Reason::Unheld),
    Some(Reason::CamerasDisagree),
    Some(Reason::Loose),
];

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
    /// What the silhouettes of each camera say of it, likewise.
    pub(crate) cameras: &'a [NormalEquations],
    /// Root mean square residual, grey levels.
    pub(crate) rms: f64,
    /// Up in the world, where the cameras tell it.
    pub(crate) up: Option<DVec3>,
    /// Rivals of the pose with their weights.
    pub(crate) rivals: &'a [(Kinematics, f64)],
    /// The frame before, and the seconds since; `None` where the track began or was lost.
    pub(crate) before: Option<(Kinematics, f64)>,
    /// Whether the frame is lost as a whole.
    pub(crate) is_lost: bool,
}

/// The signs of every limb.
pub(crate) fn signs(inputs: &TrustInputs<'_>) -> Vec<Signs> {
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
    let ends = end_jacobians(model, kinematics);
    let covariances = end_covariances(&ends, inputs.equations);
    let shifts = left_out_shifts(&ends, inputs.equations, inputs.cameras);
    let missing = conflicts.missing_share().clamp(0.0, 1.0).sqrt();
    let cameras = conflicts.cameras.max(1) as f64;
    let length_of = |rotations: &[usize]| -> f64 {
        let limbs = model.limbs().iter().filter(|limb| rotations.contains(&limb.rotation));
        limbs.map(|limb| limb.length).sum()
    };
    let longest = parts.chains.iter().map(|chain| length_of(chain)).fold(1e-3, f64::max);
    let is_one = |is: bool| f64::from(u8::from(is));
    let of_limb = |limb: usize| {
        let rotation = model.limbs()[limb].rotation;
        let chain = parts.chains.iter().find(|chain| chain.contains(&rotation)).unwrap_or(&parts.trunk);
        let members =
            || model.limbs().iter().zip(&conflicts.limbs).filter(|(limb, _)| chain.contains(&limb.rotation));
        let inner: f64 = members().map(|(_, conflict)| conflict.inner).sum::<f64>().max(1e-4);
        let spurious: f64 = members().map(|(_, conflict)| conflict.spurious).sum();
        let uncovered: f64 = members().map(|(_, conflict)| conflict.missing).sum();
        let whole: f64 = members().map(|(limb, _)| limb.length * limb.radius).sum();
        let worst = members().map(|(_, conflict)| conflict.worst_share).fold(0.0, f64::max);
        let followed = |other: usize| model.rotation_follows(rotation, other) && chain.contains(&other);
        let energy = energy_where(&followed).unwrap_or(trunk);
        let depth = chain.iter().position(|&member| member == rotation).map_or(0.0, |at| 1.0 + at as f64);
        let is_trunk = parts.trunk.contains(&rotation);
        let own = conflicts.limbs[limb];
        let own_whole = model.limbs()[limb].length * model.limbs()[limb].radius;
        let is_unheld = |rotation: &usize| inputs.unheld.get(*rotation).copied().unwrap_or_default();
        let unheld_before =
            chain[..depth as usize].iter().filter(|rotation| is_unheld(rotation)).count() as f64;
        let end = kinematics.ends()[limb];
        let elsewhere = |(rival, weight): &(Kinematics, f64)| {
            weight * (rival.ends()[limb].distance(end) / FAR_M).min(1.0)
        };
        let speed = inputs
            .before
            .as_ref()
            .map_or(0.0, |(before, seconds)| before.ends()[limb].distance(end) / seconds.abs().max(1e-3));
        [
            (spurious / inner).clamp(0.0, 1.0).sqrt(),
            (worst - spurious / inner).clamp(0.0, 1.0),
            missing,
            (uncovered / inner).clamp(0.0, 2.0).sqrt(),
            is_one(is_unheld(&rotation)),
            (1.0 - inner / (cameras * whole).max(1e-6)).clamp(0.0, 1.0),
            unlikely(energy),
            unlikely(trunk),
            tilt,
            (deviation_m(&covariances[limb]) + 1e-3).ln(),
            1.0 / cameras,
            inputs.rms.clamp(LEAST_RMS, 255.0).ln(),
            inputs.rivals.iter().map(elsewhere).sum::<f64>(),
            is_one(inputs.is_lost),
            if is_trunk { 0.0 } else { depth },
            if is_trunk { 0.0 } else { length_of(chain) / longest },
            if is_trunk { 0.0 } else { length_of(&chain[..depth as usize]) / longest },
            (REST + speed).ln(),
            ((own.spurious + own.missing) / own.inner.max(1e-4)).clamp(0.0, 2.0).sqrt(),
            (1.0 - own.inner / (cameras * own_whole).max(1e-6)).clamp(0.0, 1.0),
            unheld_before / depth.max(1.0),
            (shifts[limb] + 1e-3).ln(),
            conflicts.mean_px_per_metre().max(1.0).ln(),
        ]
    };
    (0..model.limbs().len()).map(of_limb).collect()
}
