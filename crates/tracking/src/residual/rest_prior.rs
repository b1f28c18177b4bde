//! A weak pull of every limb's twist about itself towards none: ρ = −twist.
//!
//! A round limb's own twist shows only in where its children point, so noise drifts it. Swings, which the
//! cameras see, are left alone. The first rotation, which turns the whole body, has no such prior.

use glam::{DMat3, DVec3};

use super::rotation_term;
use crate::body::{Model, Parameters, Pose};
use crate::geometry::rotation::{swing_twist, swing_twist_rates};
use crate::optimize::NormalEquations;

/// Adds the prior with a weight in squared grey levels per rad².
pub fn add(equations: &mut NormalEquations, parameters: Parameters, model: &Model, pose: &Pose, weight: f64) {
    for (rotation, &owner) in model.rotation_owners().iter().enumerate() {
        if model.rotation_parents()[rotation].is_none() {
            continue;
        }
        let axis = model.limbs()[owner].direction;
        let q = pose.rotations[rotation];
        let unit = q.normalize();
        let twist = swing_twist(unit, axis).twist;
        let (rate, _) = swing_twist_rates(unit, axis);
        // One row: the other two components are empty.
        let jacobian = DMat3::from_cols(DVec3::X * rate.x, DVec3::X * rate.y, DVec3::X * rate.z);
        rotation_term::add(
            equations,
            parameters,
            rotation,
            q,
            jacobian,
            DVec3::new(-twist, 0.0, 0.0),
            weight,
        );
    }
}
