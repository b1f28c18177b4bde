//! How far a reference itself scatters, from distances that cannot vary.
//!
//! Two joints that one rotation carries, as a knee and its ankle, stay at one distance L from each other. If each marker is off by σ
//! in every axis, their distance varies by var(L) = 2σ², and a marker is off by σ√(8/π) in the mean (Maxwell). A rod of known
//! length judges motion capture in the same way (Chiari et al., Gait & Posture 21, 2005). It counts errors that last for many
//! frames, which second differences in time do not, but none that both markers share, and none across the rod.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use glam::DVec3;

use super::ReferenceJoints;
use super::placement::FEWEST_FRAMES;
use crate::body::Model;

/// Lengths of one rod: how many, their mean, and the sum of squares about it (Welford 1962), metres.
type Lengths = (usize, f64, f64);

/// Distances of a reference's joints that one rotation carries.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Rods(BTreeMap<[Option<usize>; 2], Lengths>);

impl Rods {
    /// Adds one frame.
    pub(super) fn add(&mut self, model: &Model, reference: &ReferenceJoints) {
        let carried: Vec<(Vec<usize>, Option<usize>, DVec3)> =
            reference.iter().map(|&(limb, place)| (carriers(model, limb), limb, place)).collect();
        for (index, (carriers, one, place)) in carried.iter().enumerate() {
            for (others, other, end) in &carried[..index] {
                if carriers.iter().any(|rotation| others.contains(rotation)) {
                    let (count, mean, squares) = self.0.entry([*one, *other]).or_default();
                    let length = place.distance(*end);
                    let off = length - *mean;
                    *count += 1;
                    *mean += off / *count as f64;
                    *squares += off * (length - *mean);
                }
            }
        }
    }

    /// Mean distance of a marker from where it should be, millimetres; `None` where no rod was seen often.
    pub(super) fn noise_mm(&self) -> Option<f64> {
        let often = self.0.values().filter(|lengths| lengths.0 >= FEWEST_FRAMES);
        let (free, squares) = often
            .fold((0.0, 0.0), |(free, sum), &(count, _, squares)| (free + count as f64 - 1.0, sum + squares));
        (free > 0.0).then(|| 1000.0 * (squares / (2.0 * free)).sqrt() * (8.0 / PI).sqrt())
    }
}

/// The rotations in whose frames a joint (a limb's second one, or the root) has a fixed place.
fn carriers(model: &Model, joint: Option<usize>) -> Vec<usize> {
    let limbs = model.limbs();
    let of_children = limbs.iter().filter(|limb| limb.parent == joint && limb.has_own_rotation);
    let mut carriers: Vec<usize> = of_children.map(|limb| limb.rotation).collect();
    let Some(joint) = joint else { return carriers };
    let rotation = limbs[joint].rotation;
    let mut before = limbs[joint].parent;
    while let Some(limb) = before.filter(|&limb| limbs[limb].rotation == rotation) {
        before = limbs[limb].parent;
    }
    // A limb may follow the rotation of one that turns elsewhere.
    if before == limbs[model.rotation_owners()[rotation]].parent {
        carriers.push(rotation);
    }
    carriers
}
