//! One-sided residuals on flexion, sideways swing and twist: ρ = −(how far outside the range).

use glam::{DMat3, DVec3};

use super::rotation_term;
use crate::body::{Model, Parameters, Pose};
use crate::geometry::rotation::swing_twist_rates;
use crate::optimize::NormalEquations;

/// Adds the limits with a weight in squared grey levels per rad².
pub fn add(equations: &mut NormalEquations, parameters: Parameters, model: &Model, pose: &Pose, weight: f64) {
    for (rotation, &owner) in model.rotation_owners().iter().enumerate() {
        let limb = &model.limbs()[owner];
        let Some(limits) = limb.limits else { continue };
        let q = pose.rotations[rotation];
        let unit = q.normalize();
        let angles = limb.angles(unit);
        let excess = DVec3::new(
            limits.flexion.excess(angles.flexion),
            limits.sideways.excess(angles.sideways),
            limits.twist.excess(angles.twist),
        );
        if excess == DVec3::ZERO {
            continue;
        }
        let (twist_rate, swing_rate) = swing_twist_rates(unit, limb.direction);
        let (flexion, sideways) = limb.swing_axes();
        // Rows: flexion, sideways, twist; empty while inside the range.
        let row = |outside: f64, rate: DVec3| if outside == 0.0 { DVec3::ZERO } else { rate };
        let jacobian = DMat3::from_cols(
            row(excess.x, swing_rate.transpose() * flexion),
            row(excess.y, swing_rate.transpose() * sideways),
            row(excess.z, twist_rate),
        )
        .transpose();
        rotation_term::add(equations, parameters, rotation, q, jacobian, -excess, weight);
    }
}
