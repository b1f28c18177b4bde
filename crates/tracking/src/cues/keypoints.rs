//! 2-D keypoints as pulls at joints, and how far each lies from its joint.
//!
//! What a tool calls a wrist is not where the model's forearm ends. The difference o is fixed in the limb, and is learnt in
//! frames in which silhouettes hold the limb: with ρ = m (u − π(p)) metres, J = m ∂π/∂p R, scores s, deviation σ of a
//! keypoint and σₒ of the prior at zero,
//!
//! ```text
//! o = argmin Σ s |ρ − J o|² / σ² + |o|² / σₒ²  =  (Σ s JᵀJ / σ² + I / σₒ²)⁻¹ Σ s Jᵀρ / σ²
//! ```
//!
//! and never longer than three deviations of the prior. A keypoint of a limb that is covered teaches nothing: it would
//! confirm itself.
//!
//! Keypoints pull at covered limbs, and at those that are nowhere near them: there a boundary was mistaken.

use glam::{DMat3, DVec2, DVec3};

use super::options::{CueReach, CueStrength};
use super::source::{CueFrame, CueSource, JointKeypoint, metres_per_px};
use super::watch::CueMemory;
use crate::body::Model;
use crate::camera::Camera;
use crate::residual::cue::{Cue, CuePull, CueTarget};

/// σ: deviation of a keypoint, metres. Neighbouring frames err together, so it is larger than a single one's.
const DEVIATION: f64 = 0.06;
/// A keypoint that is farther from its joint teaches nothing, metres.
const FARTHEST: f64 = 0.15;
/// Where a keypoint is farther than this from its joint, metres, silhouettes do not hold the limb, whatever they show: the fit
/// has taken another limb's boundary for its own.
const BOUNDARY_MISTAKEN: f64 = 0.12;
/// Longest offset, in deviations of the prior.
const LONGEST: f64 = 3.0;

/// Keypoints of another tool, and how far they lie from their joints, learnt from frame to frame.
#[derive(Debug, Clone, PartialEq)]
pub struct KeypointOffsets {
    by_limb: Vec<OffsetEquations>,
    deviation: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct OffsetEquations {
    products: DMat3,
    forces: DVec3,
}

impl KeypointOffsets {
    /// None yet. `deviation` is that of the prior, metres; 0 keeps all offsets at none.
    #[must_use]
    pub fn new(limbs: usize, deviation: f64) -> Self {
        let zero = OffsetEquations { products: DMat3::ZERO, forces: DVec3::ZERO };
        Self { by_limb: vec![zero; limbs], deviation }
    }

    /// Goes on from [`CueMemory::offsets`].
    pub fn remember(&mut self, numbers: &[[f64; 12]]) {
        for (normal, numbers) in self.by_limb.iter_mut().zip(numbers) {
            let (products, forces) = numbers.split_at(9);
            *normal = OffsetEquations {
                products: DMat3::from_cols_slice(products),
                forces: DVec3::from_slice(forces),
            };
        }
    }

    /// The offset of a limb's keypoint from its second joint, in the limb's rest frame, metres.
    #[must_use]
    pub fn offset(&self, limb: usize) -> DVec3 {
        let OffsetEquations { products, forces } = self.by_limb[limb];
        if products == DMat3::ZERO || self.deviation <= 0.0 {
            return DVec3::ZERO;
        }
        let prior = DMat3::from_diagonal(DVec3::splat(1.0 / (self.deviation * self.deviation)));
        ((products + prior).inverse() * forces).clamp_length_max(LONGEST * self.deviation)
    }

    /// Whether a keypoint is nowhere near its joint.
    fn is_far(&self, frame: &CueFrame<'_>, camera: &Camera, keypoint: &JointKeypoint) -> bool {
        let most = BOUNDARY_MISTAKEN + self.offset(keypoint.limb).length();
        linearised(frame, camera, keypoint).is_some_and(|(off, _)| off.length() > most)
    }
}

fn is_usable(keypoint: &JointKeypoint, frame: &CueFrame<'_>) -> bool {
    keypoint.limb < frame.model.limbs().len()
        && keypoint.pixel.is_finite()
        && keypoint.score >= frame.options.lowest_score
        && keypoint.score > 0.0
}

/// ρ and the rows of J of a keypoint without an offset.
fn linearised(
    frame: &CueFrame<'_>,
    camera: &Camera,
    keypoint: &JointKeypoint,
) -> Option<(DVec2, [DVec3; 2])> {
    let joint = frame.kinematics.ends()[keypoint.limb];
    let place = camera.camera_from_world();
    let p = place.transform(joint);
    let pixel = camera.project(joint)?;
    let metres = metres_per_px(camera, p.z)?;
    let pinhole = camera.intrinsics();
    let turn = frame.kinematics.world_rotations()[frame.model.limbs()[keypoint.limb].rotation];
    let rest_from_camera = (place.rotation * turn).transpose();
    let row = |row: DVec3| rest_from_camera * (row * (metres / p.z));
    let across = row(DVec3::new(pinhole.fx, 0.0, -pinhole.fx * p.x / p.z));
    let down = row(DVec3::new(0.0, pinhole.fy, -pinhole.fy * p.y / p.z));
    Some(((keypoint.pixel - pixel) * metres, [across, down]))
}

impl CueSource for KeypointOffsets {
    fn cue(&self) -> Cue {
        Cue::Keypoints
    }

    fn pulls(&self, frame: &CueFrame<'_>, index: usize, strength: CueStrength) -> Vec<CuePull> {
        let limbs = frame.model.limbs();
        // A joint is of the limb that ends there and of those that begin there.
        let is_covered = |limb: usize| {
            let begins = |other: usize| limbs[other].parent == Some(limb);
            (0..limbs.len()).any(|other| (other == limb || begins(other)) && frame.coverage.is_covered(other))
        };
        let camera = frame.cameras[index];
        let pull = |keypoint: &JointKeypoint| {
            let limb = keypoint.limb;
            let metres_per_px = metres_per_px(camera, camera.depth(frame.kinematics.ends()[limb]))?;
            let is_held = || !is_covered(limb) && !self.is_far(frame, camera, keypoint);
            if frame.options.reach == CueReach::Covered && is_held() {
                return None;
            }
            let arm = limbs[limb].direction * limbs[limb].length + self.offset(limb);
            let target = CueTarget::Pixel { camera: index, arm, pixel: keypoint.pixel };
            let strength = CueStrength { weight: strength.weight * keypoint.score.min(1.0), ..strength };
            Some(strength.pull(Cue::Keypoints, limb, target, metres_per_px))
        };
        let keypoints = frame.cues.cameras.get(index).map_or(&[][..], |cues| &cues.keypoints);
        keypoints.iter().filter(|keypoint| is_usable(keypoint, frame)).filter_map(pull).collect()
    }

    fn learn(&mut self, frame: &CueFrame<'_>) {
        for (camera, cues) in frame.cameras.iter().zip(&frame.cues.cameras) {
            for keypoint in &cues.keypoints {
                if !is_usable(keypoint, frame) || frame.coverage.is_covered(keypoint.limb) {
                    continue;
                }
                let Some((residual, [across, down])) = linearised(frame, camera, keypoint) else {
                    continue;
                };
                if residual.length() > FARTHEST {
                    continue;
                }
                let weight = keypoint.score.min(1.0) / (DEVIATION * DEVIATION);
                let equations = &mut self.by_limb[keypoint.limb];
                for (row, residual) in [(across, residual.x), (down, residual.y)] {
                    equations.products += DMat3::from_cols(row * row.x, row * row.y, row * row.z) * weight;
                    equations.forces += row * (weight * residual);
                }
            }
        }
    }

    fn store(&self, memory: &mut CueMemory) {
        let one = |OffsetEquations { products, forces }: &OffsetEquations| {
            let (p, f) = (products.to_cols_array(), forces);
            [p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7], p[8], f.x, f.y, f.z]
        };
        memory.offsets = self.by_limb.iter().map(one).collect();
    }

    fn restore(&mut self, _: &Model, memory: &CueMemory) {
        self.remember(&memory.offsets);
    }
}
