//! Stay near the pose that the fit began with: ρ = −log(q q₀⁻¹) per rotation, ρ = root₀ − root.
//!
//! Besides steadying what the data say little of, it fixes what they do not see at all: along JᵀJ's null
//! directions the pose stays where it was.

use glam::DVec3;

use super::loss::Loss;
use super::rotation_term;
use crate::body::{Parameters, Pose};
use crate::geometry::rotation::{left_jacobian_inverse, log};
use crate::optimize::NormalEquations;

/// Adds the prior. Weights are in squared grey levels per rad² and per m².
pub fn add(
    equations: &mut NormalEquations,
    parameters: Parameters,
    pose: &Pose,
    reference: &Pose,
    rotation_weight: f64,
    root_weight: f64,
) {
    let root_factor = root_weight / rotation_weight.max(f64::MIN_POSITIVE);
    add_robust(equations, parameters, pose, reference, rotation_weight, root_factor, Loss::Squares);
}

/// The same with a weight for each rotation by itself, per rad².
pub fn add_each(
    equations: &mut NormalEquations,
    parameters: Parameters,
    pose: &Pose,
    reference: &Pose,
    rotation_weights: &[f64],
    root_weight: f64,
) {
    let residual = reference.root - pose.root;
    equations.cost += root_weight * residual.length_squared();
    for axis in 0..3 {
        equations.jtj[(axis, axis)] += root_weight;
        equations.jtr[axis] += root_weight * residual[axis];
    }
    let rotations = pose.rotations.iter().zip(&reference.rotations).zip(rotation_weights);
    for (rotation, ((q, from), weight)) in rotations.enumerate() {
        let phi: DVec3 = log((*q * from.inverse()).normalize());
        let jacobian = left_jacobian_inverse(phi);
        rotation_term::add(equations, parameters, rotation, *q, jacobian, -phi, *weight);
    }
}

/// The same with a loss of each rotation's angle by itself, radians. `root_factor` is the root's weight per m²
/// relative to a rotation's per rad².
pub fn add_robust(
    equations: &mut NormalEquations,
    parameters: Parameters,
    pose: &Pose,
    reference: &Pose,
    rotation_weight: f64,
    root_factor: f64,
    loss: Loss,
) {
    let residual = reference.root - pose.root;
    // The loss is one of angles: the root's distance counts as the angle that costs as much.
    let squared = root_factor * residual.length_squared();
    equations.cost += rotation_weight * loss.cost(squared);
    let weight = rotation_weight * root_factor * loss.weight(squared);
    for axis in 0..3 {
        equations.jtj[(axis, axis)] += weight;
        equations.jtr[axis] += weight * residual[axis];
    }
    for (rotation, (q, from)) in pose.rotations.iter().zip(&reference.rotations).enumerate() {
        let phi: DVec3 = log((*q * from.inverse()).normalize());
        let jacobian = left_jacobian_inverse(phi);
        let squared = phi.length_squared();
        let weight = rotation_weight * loss.weight(squared);
        rotation_term::add(equations, parameters, rotation, *q, jacobian, -phi, weight);
        equations.cost += rotation_weight * loss.cost(squared) - weight * squared;
    }
}
