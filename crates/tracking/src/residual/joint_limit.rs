//! One-sided residuals on flexion, sideways swing and twist: ρ = −(how far outside the range).

use glam::{DMat3, DQuat, DVec3};

use super::rotation_term;
use crate::body::{JointLimits, Limb, Model, Parameters, Pose};
use crate::geometry::rotation::swing_twist_rates;
use crate::optimize::NormalEquations;

/// Adds the limits with a weight in squared grey levels per rad².
pub fn add(equations: &mut NormalEquations, parameters: Parameters, model: &Model, pose: &Pose, weight: f64) {
    for (rotation, &owner) in model.rotation_owners().iter().enumerate() {
        let limb = &model.limbs()[owner];
        let Some(limits) = limb.limits else { continue };
        let q = pose.rotations[rotation];
        let unit = q.normalize();
        let excess = outside(limb, limits, unit);
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

/// Their cost alone: Σ weight · |how far outside|².
#[must_use]
pub fn cost(model: &Model, pose: &Pose, weight: f64) -> f64 {
    let one = |(&owner, turn): (&usize, &DQuat)| {
        let limb = &model.limbs()[owner];
        limb.limits.map_or(0.0, |limits| outside(limb, limits, turn.normalize()).length_squared())
    };
    weight * model.rotation_owners().iter().zip(&pose.rotations).map(one).sum::<f64>()
}

/// How far flexion, sideways swing and twist of a unit rotation lie outside their ranges, radians.
fn outside(limb: &Limb, limits: JointLimits, turn: DQuat) -> DVec3 {
    let angles = limb.angles(turn);
    DVec3::new(
        limits.flexion.excess(angles.flexion),
        limits.sideways.excess(angles.sideways),
        limits.twist.excess(angles.twist),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::builtin;
    use crate::search::start::perturb;

    #[test]
    fn the_cost_alone_is_that_of_the_equations() {
        let model = builtin::full_body();
        let mut costs = 0.0;
        for seed in 0..5 {
            let pose = perturb(&model, &Pose::rest(&model), 1.2, 0.0, seed);
            let columns = Parameters::Tangent.columns(model.rotation_count());
            let mut equations = NormalEquations::zeros(columns);
            add(&mut equations, Parameters::Tangent, &model, &pose, 3.0);
            let alone = cost(&model, &pose, 3.0);
            assert!((alone - equations.cost).abs() <= 1e-9 * alone, "{alone} {}", equations.cost);
            costs += alone;
        }
        assert!(costs > 1.0, "some joint was outside");
    }
}
