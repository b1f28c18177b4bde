//! Limbs as a tree of bones, as animation has them, and rotations as three angles.
//!
//! A bone is where one or more limbs begin that turn together. Limbs that follow the rotation of the limb they grow
//! from are segments of its bone, not bones. Where limbs of several rotations begin at the root, a bone that never turns
//! stands above them.
//!
//! Angles (a, b, c) and (a + π, π − b, c + π), each plus any whole turns, are the same rotation. Of all of them the one
//! nearest to the frame before is taken, so that curves do not jump.

use std::f64::consts::{PI, TAU};

use backlit_tracking::body::Pose;
use glam::{DQuat, DVec3};

use super::frames::MotionFrames;
use super::{EulerOrder, names};

/// A tree of nodes, parents before children; the first is the root.
#[derive(Debug)]
pub(super) struct BoneTree {
    pub(super) bones: Vec<Bone>,
    /// By limb: where it lies.
    pub(super) limbs: Vec<LimbSegment>,
}

/// One node. Its axes at rest are the file's.
#[derive(Debug)]
pub(super) struct Bone {
    pub(super) name: String,
    pub(super) parent: Option<usize>,
    /// From the parent's node at rest, in the file's axes and unit.
    pub(super) offset: DVec3,
    /// Where it is at rest, with the root at the origin.
    pub(super) place: DVec3,
    /// The limb whose rotation it has.
    pub(super) owner: Option<usize>,
    rotation: Option<usize>,
}

/// Where a limb lies in its node.
#[derive(Debug, Clone, Copy)]
pub(super) struct LimbSegment {
    pub(super) node: usize,
    pub(super) start: DVec3,
    pub(super) end: DVec3,
}

impl BoneTree {
    pub(super) fn new(scene: &MotionFrames<'_>) -> Self {
        let limbs = scene.model.limbs();
        let mut at_root = limbs.iter().filter(|limb| limb.parent.is_none()).map(|limb| limb.rotation);
        let first = at_root.next();
        let rotation = first.filter(|&first| at_root.all(|rotation| rotation == first));
        let mut tree = Self { bones: Vec::new(), limbs: Vec::new() };
        tree.add(scene, None, DVec3::ZERO, rotation);
        for limb in limbs {
            let (within, start) = match limb.parent {
                Some(parent) => (tree.limbs[parent].node, tree.limbs[parent].end),
                None => (0, DVec3::ZERO),
            };
            let (node, start) = if tree.bones[within].rotation == Some(limb.rotation) {
                (within, start)
            } else {
                let same = |node: &Bone| {
                    node.parent == Some(within)
                        && node.rotation == Some(limb.rotation)
                        && node.offset.distance(start) < 1e-9
                };
                let found = tree.bones.iter().position(same);
                let node = found.unwrap_or_else(|| tree.add(scene, Some(within), start, Some(limb.rotation)));
                (node, DVec3::ZERO)
            };
            tree.limbs.push(LimbSegment {
                node,
                start,
                end: start + scene.rest(limb.direction * limb.length),
            });
        }
        let names = names::different(tree.bones.iter().map(|node| node.name.clone()));
        for (node, name) in tree.bones.iter_mut().zip(names) {
            node.name = name;
        }
        tree
    }

    fn add(
        &mut self,
        scene: &MotionFrames<'_>,
        parent: Option<usize>,
        offset: DVec3,
        rotation: Option<usize>,
    ) -> usize {
        let owner = rotation.map(|rotation| scene.model.rotation_owners()[rotation]);
        let name = owner.map_or_else(
            || "root".to_owned(),
            |owner| names::bone(scene.model, scene.names, &scene.model.limbs()[owner].name),
        );
        let place = parent.map_or(DVec3::ZERO, |parent| self.bones[parent].place) + offset;
        self.bones.push(Bone { name, parent, offset, place, owner, rotation });
        self.bones.len() - 1
    }

    /// Nodes that hang on this one.
    pub(super) fn children(&self, node: usize) -> impl Iterator<Item = usize> {
        self.bones
            .iter()
            .enumerate()
            .filter(move |(_, child)| child.parent == Some(node))
            .map(|(child, _)| child)
    }

    /// Where a node without children ends: the end of its lines that lies farthest away.
    pub(super) fn tip(&self, node: usize) -> DVec3 {
        let ends = self.limbs.iter().filter(|line| line.node == node).map(|line| line.end);
        ends.fold(DVec3::ZERO, |far, end| if end.length() > far.length() { end } else { far })
    }

    /// The turn of each node against its parent's in a pose, in the file's axes.
    pub(super) fn turns(&self, scene: &MotionFrames<'_>, pose: &Pose) -> Vec<DQuat> {
        let model = scene.model;
        let mut world = vec![DQuat::IDENTITY; model.rotation_count()];
        for &rotation in model.rotations_parents_first() {
            let parent = model.rotation_parents()[rotation].map_or(DQuat::IDENTITY, |parent| world[parent]);
            world[rotation] = parent * pose.rotations[rotation];
        }
        let in_file = |node: &Bone| {
            let turn = node.rotation.map_or(DQuat::IDENTITY, |rotation| world[rotation]);
            scene.file_from_world * turn * scene.file_from_body.conjugate()
        };
        let local = self.bones.iter().map(|node| {
            let turn = in_file(node);
            match node.parent {
                Some(parent) => (in_file(&self.bones[parent]).conjugate() * turn).normalize(),
                None => turn.normalize(),
            }
        });
        local.collect()
    }
}

/// The angles of a rotation, radians, in the order of the axes; near to those of the frame before, if there are any.
pub(super) fn angles(order: EulerOrder, rotation: DQuat, before: Option<[f64; 3]>) -> [f64; 3] {
    let (a, b, c) = rotation.to_euler(order.intrinsic());
    let Some(before) = before else { return [a, b, c] };
    let near = |angles: [f64; 3]| {
        let mut near = angles;
        for (angle, before) in near.iter_mut().zip(before) {
            *angle += TAU * ((before - *angle) / TAU).round();
        }
        let distance: f64 = near.iter().zip(before).map(|(angle, before)| (angle - before).powi(2)).sum();
        (near, distance)
    };
    let (first, second) = (near([a, b, c]), near([a + PI, PI - b, c + PI]));
    if second.1 < first.1 { second.0 } else { first.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_give_the_rotation_back_and_do_not_jump() {
        for order in EulerOrder::ALL {
            let mut before = None;
            for step in 0..400 {
                let t = f64::from(step) * 0.05;
                let rotation = DQuat::from_rotation_z(t) * DQuat::from_rotation_x((0.7 * t).sin());
                let found = angles(order, rotation, before);
                let again = DQuat::from_euler(order.intrinsic(), found[0], found[1], found[2]);
                assert!(rotation.dot(again).abs() > 1.0 - 1e-12, "{order:?} {t}");
                if order == EulerOrder::Zxy
                    && let Some(before) = before
                {
                    let jump = found.iter().zip(before).map(|(a, b): (&f64, f64)| (a - b).abs());
                    assert!(jump.fold(0.0, f64::max) < 0.2, "{order:?} {t}");
                }
                before = Some(found);
            }
        }
    }
}
