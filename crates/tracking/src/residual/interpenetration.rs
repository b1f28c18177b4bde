//! Limbs are not in the same place: ρ = (r₁ + r₂) − d where two capsules overlap, metres.
//!
//! d is the distance of the two axes, between points p and q fixed in their limbs. The closest points are
//! stationary, so their own motion along the axes drops out: with n = (p − q)/d,
//!
//! ∂d/∂X = nᵀ (∂p/∂X − ∂q/∂X).
//!
//! Pairs that touch at rest (a shoulder and the trunk, the parts of a thigh) are left out, and so are limbs that
//! share a joint or a rotation: what is built into one another may stay so.

use glam::DVec3;

use crate::body::{Kinematics, Model, MovingColumn, Parameters, Pose};
use crate::geometry::segments::closest_fractions;
use crate::optimize::NormalEquations;

/// Axes nearer to each other than this (metres) have no direction in which to part.
const CROSSING_M: f64 = 1e-6;

/// The pairs of limbs of a model that must not overlap.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LimbPairs(
    /// By the limbs' indices.
    pub Vec<(usize, usize)>,
);

impl LimbPairs {
    /// All pairs that lie apart at rest.
    pub fn of(model: &Model) -> Self {
        let rest = Kinematics::new(model, &Pose::rest(model));
        let limbs = model.limbs();
        let mut pairs = Vec::new();
        for second in 0..limbs.len() {
            for first in 0..second {
                let (a, b) = (&limbs[first], &limbs[second]);
                let joined = a.parent == b.parent || a.parent == Some(second) || b.parent == Some(first);
                let apart = contact(model, &rest, first, second).is_none();
                if a.rotation != b.rotation && !joined && apart {
                    pairs.push((first, second));
                }
            }
        }
        Self(pairs)
    }
}

/// Two limbs inside each other.
struct Contact {
    depth: f64,
    normal: DVec3,
    on_first: DVec3,
    on_second: DVec3,
}

fn contact(model: &Model, kinematics: &Kinematics, first: usize, second: usize) -> Option<Contact> {
    let (starts, ends) = (kinematics.starts(), kinematics.ends());
    let (s, t) = closest_fractions(starts[first], ends[first], starts[second], ends[second]);
    let on_first = starts[first].lerp(ends[first], s);
    let on_second = starts[second].lerp(ends[second], t);
    let distance = on_first.distance(on_second);
    let depth = model.limbs()[first].radius + model.limbs()[second].radius - distance;
    let normal = (on_first - on_second) / distance.max(CROSSING_M);
    (depth > 0.0).then_some(Contact { depth, normal, on_first, on_second })
}

/// Adds w ρ² of every pair that overlaps, with a weight in squared grey levels per m². `columns` is memory.
pub fn add(
    equations: &mut NormalEquations,
    parameters: Parameters,
    model: &Model,
    kinematics: &Kinematics,
    pairs: &LimbPairs,
    weight: f64,
    columns: &mut Vec<MovingColumn>,
) {
    let mut row = vec![0.0; equations.columns()];
    let mut entries = Vec::new();
    for &(first, second) in &pairs.0 {
        let Some(contact) = contact(model, kinematics, first, second) else { continue };
        row.fill(0.0);
        for (limb, point, sign) in [(first, contact.on_first, 1.0), (second, contact.on_second, -1.0)] {
            kinematics.moving_columns_into(limb, parameters, columns);
            let arm = point - kinematics.starts()[limb];
            for MovingColumn { index, motion: [vx, vy, vz, wx, wy, wz, scale] } in columns.iter().copied() {
                let turn = DVec3::new(wx, wy, wz);
                let moved = DVec3::new(vx, vy, vz) + turn.cross(arm) + scale * arm;
                row[index] += sign * contact.normal.dot(moved);
            }
        }
        // ρ pushes d up: ∂(prediction)/∂X is the row itself.
        entries.clear();
        entries.extend(row.iter().copied().enumerate().filter(|(_, entry)| *entry != 0.0));
        equations.add_row(&entries, contact.depth, weight);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::builtin;
    use crate::fixtures::{bent, differences, posed};
    use crate::geometry::rotation::exp;

    #[test]
    fn nothing_overlaps_at_rest_and_an_arm_through_the_trunk_does() {
        let model = builtin::upper_body();
        let pairs = LimbPairs::of(&model);
        let limb = |name: &str| model.limb_index(name).unwrap();
        assert!(pairs.0.contains(&(limb("torso"), limb("right forearm"))));
        assert!(!pairs.0.contains(&(limb("torso"), limb("right shoulder"))));
        let cost = |pose: &Pose| {
            let columns = Parameters::Tangent.columns(model.rotation_count());
            let mut equations = NormalEquations::zeros(columns);
            let kinematics = Kinematics::new(&model, pose);
            let tangent = Parameters::Tangent;
            add(&mut equations, tangent, &model, &kinematics, &pairs, 1.0, &mut Vec::new());
            equations.cost
        };
        assert_eq!(cost(&Pose::rest(&model)), 0.0);
        let pose = posed(&model, DVec3::ZERO, &[("right forearm", exp(DVec3::new(0.0, 0.0, 1.2)))]);
        assert!(cost(&pose) > 1e-3, "{}", cost(&pose));
    }

    #[test]
    fn products_match_differences_of_the_depths() {
        let model = builtin::upper_body();
        let pairs = LimbPairs::of(&model);
        let columns = Parameters::Tangent.columns(model.rotation_count());
        let pose = bent(&model, 0.9, 3.0);
        let depths = |pose: &Pose| -> Vec<f64> {
            let kinematics = Kinematics::new(&model, pose);
            let depth =
                |&(a, b): &(usize, usize)| contact(&model, &kinematics, a, b).map_or(0.0, |o| o.depth);
            pairs.0.iter().map(depth).collect()
        };
        assert!(depths(&pose).iter().filter(|&&depth| depth > 0.0).count() >= 2);
        let mut equations = NormalEquations::zeros(columns);
        let kinematics = Kinematics::new(&model, &pose);
        add(&mut equations, Parameters::Tangent, &model, &kinematics, &pairs, 2.0, &mut Vec::new());
        let jacobian = differences(Parameters::Tangent, &pose, depths);
        let numeric = jacobian.tr_mul(&jacobian) * 2.0;
        assert!((&numeric - &equations.jtj).amax() <= 1e-6, "{} for {numeric}", equations.jtj);
    }
}
