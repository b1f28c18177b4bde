//! Limbs as a tree of turning nodes, which is what animation knows.
//!
//! A node is where one or more limbs begin that turn together. Limbs that follow the rotation of the limb they grow
//! from are lines in its node, not nodes. Where limbs of several rotations begin at the root, a node that never turns
//! stands above them.

use backlit_tracking::body::Pose;
use glam::{DQuat, DVec3};

use super::names;
use super::scene::Scene;

/// A tree of nodes, parents before children; the first is the root.
#[derive(Debug)]
pub(super) struct Skeleton {
    pub(super) nodes: Vec<Node>,
    /// By limb: where it lies.
    pub(super) limbs: Vec<Line>,
}

/// One node. Its axes at rest are the file's.
#[derive(Debug)]
pub(super) struct Node {
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
pub(super) struct Line {
    pub(super) node: usize,
    pub(super) start: DVec3,
    pub(super) end: DVec3,
}

impl Skeleton {
    pub(super) fn new(scene: &Scene<'_>) -> Self {
        let limbs = scene.model.limbs();
        let mut at_root = limbs.iter().filter(|limb| limb.parent.is_none()).map(|limb| limb.rotation);
        let first = at_root.next();
        let rotation = first.filter(|&first| at_root.all(|rotation| rotation == first));
        let mut tree = Self { nodes: Vec::new(), limbs: Vec::new() };
        tree.add(scene, None, DVec3::ZERO, rotation);
        for limb in limbs {
            let (within, start) = match limb.parent {
                Some(parent) => (tree.limbs[parent].node, tree.limbs[parent].end),
                None => (0, DVec3::ZERO),
            };
            let (node, start) = if tree.nodes[within].rotation == Some(limb.rotation) {
                (within, start)
            } else {
                let same = |node: &Node| {
                    node.parent == Some(within)
                        && node.rotation == Some(limb.rotation)
                        && node.offset.distance(start) < 1e-9
                };
                let found = tree.nodes.iter().position(same);
                let node = found.unwrap_or_else(|| tree.add(scene, Some(within), start, Some(limb.rotation)));
                (node, DVec3::ZERO)
            };
            tree.limbs.push(Line { node, start, end: start + scene.rest(limb.direction * limb.length) });
        }
        let names = names::different(tree.nodes.iter().map(|node| node.name.clone()));
        for (node, name) in tree.nodes.iter_mut().zip(names) {
            node.name = name;
        }
        tree
    }

    fn add(
        &mut self,
        scene: &Scene<'_>,
        parent: Option<usize>,
        offset: DVec3,
        rotation: Option<usize>,
    ) -> usize {
        let owner = rotation.map(|rotation| scene.model.rotation_owners()[rotation]);
        let name = owner.map_or_else(
            || "root".to_owned(),
            |owner| names::bone(scene.model, scene.names, &scene.model.limbs()[owner].name),
        );
        let place = parent.map_or(DVec3::ZERO, |parent| self.nodes[parent].place) + offset;
        self.nodes.push(Node { name, parent, offset, place, owner, rotation });
        self.nodes.len() - 1
    }

    /// Nodes that hang on this one.
    pub(super) fn children(&self, node: usize) -> impl Iterator<Item = usize> {
        self.nodes
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
    pub(super) fn turns(&self, scene: &Scene<'_>, pose: &Pose) -> Vec<DQuat> {
        let model = scene.model;
        let mut world = vec![DQuat::IDENTITY; model.rotation_count()];
        for &rotation in model.rotations_parents_first() {
            let parent = model.rotation_parents()[rotation].map_or(DQuat::IDENTITY, |parent| world[parent]);
            world[rotation] = parent * pose.rotations[rotation];
        }
        let in_file = |node: &Node| {
            let turn = node.rotation.map_or(DQuat::IDENTITY, |rotation| world[rotation]);
            scene.file_from_world * turn * scene.file_from_body.conjugate()
        };
        let local = self.nodes.iter().map(|node| {
            let turn = in_file(node);
            match node.parent {
                Some(parent) => (in_file(&self.nodes[parent]).conjugate() * turn).normalize(),
                None => turn.normalize(),
            }
        });
        local.collect()
    }
}
