//! A joint that should be at a point in the world: ρ = target − p(X), metres.

use glam::DVec3;

use super::pose_prior;
use crate::body::{Kinematics, Parameters};
use crate::optimize::NormalEquations;

/// A limb's second joint, where it should be, and how much that matters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointTarget {
    /// The limb; `None` for the root.
    pub limb: Option<usize>,
    /// World, metres.
    pub target: DVec3,
    /// Per m².
    pub weight: f64,
}

/// Adds w ‖target − p(X)‖².
pub fn add(
    equations: &mut NormalEquations,
    parameters: Parameters,
    kinematics: &Kinematics,
    root: DVec3,
    point: &PointTarget,
) {
    let Some(limb) = point.limb else {
        let residual = point.target - root;
        equations.cost += point.weight * residual.length_squared();
        pose_prior::add_root(equations, residual, point.weight);
        return;
    };
    let residual = point.target - kinematics.ends()[limb];
    let jacobian = kinematics.end_jacobian(limb, parameters);
    equations.cost += point.weight * residual.length_squared();
    equations.jtj += jacobian.tr_mul(&jacobian) * point.weight;
    equations.jtr += jacobian.tr_mul(&nalgebra::Vector3::from(residual.to_array())) * point.weight;
}
