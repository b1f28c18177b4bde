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

use super::coverage::Coverage;
use super::evidence::{FrameCues, JointKeypoint};
use super::options::{CueOptions, CueReach};
use crate::body::{Kinematics, Model};
use crate::camera::Camera;
use crate::residual::Loss;
use crate::residual::cue::{Cue, CuePull, CueTarget};

/// σ: deviation of a keypoint, metres. Neighbouring frames err together, so it is larger than a single one's.
const DEVIATION: f64 = 0.06;
/// A keypoint that is farther from its joint teaches nothing, metres.
const FARTHEST: f64 = 0.15;
/// Where a keypoint is farther than this from its joint, metres, silhouettes do not hold the limb, whatever they show: the fit
/// has taken another limb's boundary for its own.
const ELSEWHERE: f64 = 0.12;
/// Longest offset, in deviations of the prior.
const LONGEST: f64 = 3.0;

/// How far keypoints lie from their joints, learnt from frame to frame.
#[derive(Debug, Clone, PartialEq)]
pub struct KeypointOffsets {
    by_limb: Vec<Normal>,
    deviation: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Normal {
    products: DMat3,
    forces: DVec3,
}

impl KeypointOffsets {
    /// None yet. `deviation` is that of the prior, metres; 0 keeps all offsets at none.
    #[must_use]
    pub fn new(limbs: usize, deviation: f64) -> Self {
        let zero = Normal { products: DMat3::ZERO, forces: DVec3::ZERO };
        Self { by_limb: vec![zero; limbs], deviation }
    }

    /// What was learnt of every limb: nine numbers of products, three of forces.
    pub(super) fn numbers(&self) -> Vec<[f64; 12]> {
        let one = |Normal { products, forces }: &Normal| {
            let (p, f) = (products.to_cols_array(), forces);
            [p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7], p[8], f.x, f.y, f.z]
        };
        self.by_limb.iter().map(one).collect()
    }

    /// Goes on from such numbers.
    pub(super) fn remember(&mut self, numbers: &[[f64; 12]]) {
        for (normal, numbers) in self.by_limb.iter_mut().zip(numbers) {
            let (products, forces) = numbers.split_at(9);
            *normal =
                Normal { products: DMat3::from_cols_slice(products), forces: DVec3::from_slice(forces) };
        }
    }

    /// The offset of a limb's keypoint from its second joint, in the limb's rest frame, metres.
    #[must_use]
    pub fn offset(&self, limb: usize) -> DVec3 {
        let Normal { products, forces } = self.by_limb[limb];
        if products == DMat3::ZERO || self.deviation <= 0.0 {
            return DVec3::ZERO;
        }
        let prior = DMat3::from_diagonal(DVec3::splat(1.0 / (self.deviation * self.deviation)));
        ((products + prior).inverse() * forces).clamp_length_max(LONGEST * self.deviation)
    }

    /// Learns from a frame's keypoints at its fitted pose.
    pub fn learn(
        &mut self,
        model: &Model,
        kinematics: &Kinematics,
        cameras: &[&Camera],
        cues: &FrameCues,
        coverage: &Coverage,
        lowest_score: f64,
    ) {
        for (camera, cues) in cameras.iter().zip(&cues.cameras) {
            for keypoint in &cues.keypoints {
                if !is_usable(keypoint, model, lowest_score) || coverage.is_covered(keypoint.limb) {
                    continue;
                }
                let Some((residual, [across, down])) = seen(model, kinematics, camera, keypoint) else {
                    continue;
                };
                if residual.length() > FARTHEST {
                    continue;
                }
                let weight = keypoint.score.min(1.0) / (DEVIATION * DEVIATION);
                let normal = &mut self.by_limb[keypoint.limb];
                for (row, residual) in [(across, residual.x), (down, residual.y)] {
                    normal.products += DMat3::from_cols(row * row.x, row * row.y, row * row.z) * weight;
                    normal.forces += row * (weight * residual);
                }
            }
        }
    }
}

fn is_usable(keypoint: &JointKeypoint, model: &Model, lowest_score: f64) -> bool {
    keypoint.limb < model.limbs().len()
        && keypoint.pixel.is_finite()
        && keypoint.score >= lowest_score
        && keypoint.score > 0.0
}

/// ρ and the rows of J of a keypoint without an offset.
fn seen(
    model: &Model,
    kinematics: &Kinematics,
    camera: &Camera,
    keypoint: &JointKeypoint,
) -> Option<(DVec2, [DVec3; 2])> {
    let joint = kinematics.ends()[keypoint.limb];
    let place = camera.camera_from_world();
    let p = place.transform(joint);
    let pixel = camera.project(joint)?;
    let metres = metres_per_px(camera, p.z)?;
    let pinhole = camera.intrinsics();
    let rest_from_camera =
        (place.rotation * kinematics.world_rotations()[model.limbs()[keypoint.limb].rotation]).transpose();
    let row = |row: DVec3| rest_from_camera * (row * (metres / p.z));
    let across = row(DVec3::new(pinhole.fx, 0.0, -pinhole.fx * p.x / p.z));
    let down = row(DVec3::new(0.0, pinhole.fy, -pinhole.fy * p.y / p.z));
    Some(((keypoint.pixel - pixel) * metres, [across, down]))
}

/// Metres a pixel at a depth; `None` at the camera.
pub(super) fn metres_per_px(camera: &Camera, depth: f64) -> Option<f64> {
    let metres = depth / camera.intrinsics().mean_focal_px();
    (metres.is_finite() && metres > 1e-9).then_some(metres)
}

/// The pulls of a frame's keypoints.
pub(super) fn pulls(
    model: &Model,
    kinematics: &Kinematics,
    cameras: &[&Camera],
    cues: &FrameCues,
    coverage: &Coverage,
    offsets: &KeypointOffsets,
    options: &CueOptions,
) -> Vec<CuePull> {
    let strength = options.strength(Cue::Keypoints);
    let mut pulls = Vec::new();
    if strength.weight <= 0.0 {
        return pulls;
    }
    // A joint is of the limb that ends there and of those that begin there.
    let is_covered = |limb: usize| {
        let begins = |other: usize| model.limbs()[other].parent == Some(limb);
        (0..model.limbs().len()).any(|other| (other == limb || begins(other)) && coverage.is_covered(other))
    };
    for (index, (camera, cues)) in cameras.iter().zip(&cues.cameras).enumerate() {
        for keypoint in cues.keypoints.iter().filter(|k| is_usable(k, model, options.lowest_score)) {
            let limb = keypoint.limb;
            let depth = camera.depth(kinematics.ends()[limb]);
            let Some(metres_per_px) = metres_per_px(camera, depth) else { continue };
            let is_elsewhere = || {
                seen(model, kinematics, camera, keypoint)
                    .is_some_and(|(off, _)| off.length() > ELSEWHERE + offsets.offset(limb).length())
            };
            if options.reach == CueReach::Covered && !is_covered(limb) && !is_elsewhere() {
                continue;
            }
            let rest = &model.limbs()[limb];
            let arm = rest.direction * rest.length + offsets.offset(limb);
            pulls.push(CuePull {
                cue: Cue::Keypoints,
                limb,
                target: CueTarget::Pixel { camera: index, arm, pixel: keypoint.pixel },
                metres_per_px,
                weight: strength.weight * keypoint.score.min(1.0),
                loss: Loss::Cauchy { scale: strength.scale_m },
            });
        }
    }
    pulls
}
