//! Stay near the pose that the fit began with: ρ = −log(q q₀⁻¹) per rotation, ρ = root₀ − root.
//!
//! Besides steadying what the data say little of, it fixes what they do not see at all: along JᵀJ's null
//! directions the pose stays where it was.

use glam::DVec3;

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
    let residual = reference.root - pose.root;
    equations.cost += root_weight * residual.length_squared();
    for axis in 0..3 {
        equations.jtj[(axis, axis)] += root_weight;
        equations.jtr[axis] += root_weight * residual[axis];
    }
    for (rotation, (q, from)) in pose.rotations.iter().zip(&reference.rotations).enumerate() {
        let phi: DVec3 = log((*q * from.inverse()).normalize());
        let jacobian = left_jacobian_inverse(phi);
        rotation_term::add(equations, parameters, rotation, *q, jacobian, -phi, rotation_weight);
    }
}
