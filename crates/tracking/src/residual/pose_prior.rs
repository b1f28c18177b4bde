//! Priors on single rotations: stay near a pose, do not twist, keep to the joint's limits.
//!
//! | function | ρ |
//! |---|---|
//! | [`add_proximal`], [`add_proximal_each`] | −log(q q₀⁻¹) per rotation, root₀ − root: near the pose that the fit began with |
//! | [`add_rest`] | −twist of a limb about itself, which shows only in where its children point |
//! | [`add_limits`] | −(how far flexion, sideways swing and twist lie outside their ranges) |
//!
//! Besides steadying what the data say little of, the proximal prior fixes what they do not see at all: along JᵀJ's null
//! directions the pose stays where it was. Residuals are written by the tangent perturbation ω of q in its parent's frame. A
//! raw coefficient turns by ωᵢ of [`raw_rates`], so its columns are linear combinations of the tangent ones.

use glam::{DMat3, DQuat, DVec3};
use nalgebra::{SMatrix, SVector};

use super::loss::Loss;
use crate::body::{JointLimits, Limb, Model, Parameters, Pose};
use crate::geometry::rotation::{left_jacobian_inverse, log, raw_rates, swing_twist, swing_twist_rates};
use crate::optimize::NormalEquations;

/// Adds the proximal prior with a weight for each rotation by itself, squared grey levels per rad², and for the root, per m².
pub fn add_proximal_each(
    equations: &mut NormalEquations,
    parameters: Parameters,
    pose: &Pose,
    reference: &Pose,
    rotation_weights: &[f64],
    root_weight: f64,
) {
    let residual = reference.root - pose.root;
    equations.cost += root_weight * residual.length_squared();
    add_root(equations, residual, root_weight);
    let rotations = pose.rotations.iter().zip(&reference.rotations).zip(rotation_weights);
    for (rotation, ((q, from), weight)) in rotations.enumerate() {
        let phi: DVec3 = log((*q * from.inverse()).normalize());
        add_rotation(equations, parameters, rotation, *q, left_jacobian_inverse(phi), -phi, *weight);
    }
}

/// Adds the proximal prior with a loss of each rotation's angle by itself, radians. `root_factor` is the root's weight per
/// m² relative to a rotation's per rad².
pub fn add_proximal(
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
    add_root(equations, residual, rotation_weight * root_factor * loss.weight(squared));
    for (rotation, (q, from)) in pose.rotations.iter().zip(&reference.rotations).enumerate() {
        let phi: DVec3 = log((*q * from.inverse()).normalize());
        let squared = phi.length_squared();
        let weight = rotation_weight * loss.weight(squared);
        add_rotation(equations, parameters, rotation, *q, left_jacobian_inverse(phi), -phi, weight);
        equations.cost += rotation_weight * loss.cost(squared) - weight * squared;
    }
}

/// Adds the pull of every limb's twist towards none, squared grey levels per rad². Swings, which the cameras see, are left
/// alone, and so is the first rotation, which turns the whole body.
pub fn add_rest(
    equations: &mut NormalEquations,
    parameters: Parameters,
    model: &Model,
    pose: &Pose,
    weight: f64,
) {
    for (rotation, &owner) in model.rotation_owners().iter().enumerate() {
        if model.rotation_parents()[rotation].is_none() {
            continue;
        }
        let axis = model.limbs()[owner].direction;
        let q = pose.rotations[rotation];
        let unit = q.normalize();
        let residual = DVec3::new(-swing_twist(unit, axis).twist, 0.0, 0.0);
        let (rate, _) = swing_twist_rates(unit, axis);
        // One row: the other two components are empty.
        let jacobian = DMat3::from_cols(DVec3::X * rate.x, DVec3::X * rate.y, DVec3::X * rate.z);
        add_rotation(equations, parameters, rotation, q, jacobian, residual, weight);
    }
}

/// Adds the joint limits with a weight in squared grey levels per rad².
pub fn add_limits(
    equations: &mut NormalEquations,
    parameters: Parameters,
    model: &Model,
    pose: &Pose,
    weight: f64,
) {
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
        add_rotation(equations, parameters, rotation, q, jacobian, -excess, weight);
    }
}

/// The cost of the limits alone: Σ weight · |how far outside|².
pub fn limit_cost(model: &Model, pose: &Pose, weight: f64) -> f64 {
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

pub(super) fn add_root(equations: &mut NormalEquations, residual: DVec3, weight: f64) {
    for axis in 0..3 {
        equations.jtj[(axis, axis)] += weight;
        equations.jtr[axis] += weight * residual[axis];
    }
}

/// Adds w ‖ρ‖² with ρ of three components and ∂(prediction)/∂ω = `jacobian`.
fn add_rotation(
    equations: &mut NormalEquations,
    parameters: Parameters,
    rotation: usize,
    q: DQuat,
    jacobian: DMat3,
    residual: DVec3,
    weight: f64,
) {
    equations.cost += weight * residual.length_squared();
    let first = parameters.first_column(rotation);
    match parameters {
        Parameters::Tangent => {
            let columns = [jacobian.x_axis, jacobian.y_axis, jacobian.z_axis];
            add_columns(equations, first, &columns, residual, weight);
        }
        Parameters::Raw => {
            let columns = raw_rates(q).map(|(turn, _)| jacobian * turn);
            add_columns(equations, first, &columns, residual, weight);
        }
    }
}

fn add_columns<const N: usize>(
    equations: &mut NormalEquations,
    first: usize,
    columns: &[DVec3; N],
    residual: DVec3,
    weight: f64,
) {
    let products = SMatrix::<f64, N, N>::from_fn(|i, j| weight * columns[i].dot(columns[j]));
    let forces = SVector::<f64, N>::from_fn(|i, _| weight * columns[i].dot(residual));
    let mut block = equations.jtj.fixed_view_mut::<N, N>(first, first);
    block += products;
    let mut rows = equations.jtr.fixed_rows_mut::<N>(first);
    rows += forces;
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
            add_limits(&mut equations, Parameters::Tangent, &model, &pose, 3.0);
            let alone = limit_cost(&model, &pose, 3.0);
            assert!((alone - equations.cost).abs() <= 1e-9 * alone, "{alone} {}", equations.cost);
            costs += alone;
        }
        assert!(costs > 1.0, "some joint was outside");
    }
}
