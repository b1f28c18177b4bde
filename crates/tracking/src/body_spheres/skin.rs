//! A body of spheres from a skinned mesh: a limb for every bone of the skeleton, and in it the part of the solid whose surface the
//! bone moves.
//!
//! The skeleton is the file's own. Joints that move nothing are left out, and joints at one place count as one. A joint with several
//! bones has a limb for each of them, which turn together; a joint without any has a limb along what it moves.

use std::collections::HashMap;

use backlit_sphere_tree::{ClosedMesh, MeshError, MeshSurface, OptionsError, isosurface};
use glam::DVec3;
use rayon::prelude::*;
use thiserror::Error;

use super::trees;
use crate::body::{FORMAT, LimbSpec, Model, ModelError, ModelSpec};
use crate::geometry::segments::distance;
use crate::names;

/// Joints nearer to each other than this are at one place, metres.
const ONE_PLACE: f64 = 0.005;
/// Vertices are at whole multiples of this, metres.
const GRID: f64 = 1e-6;
/// Shortest limb and thinnest radius, metres.
const SHORTEST: f64 = 0.02;
const THINNEST: f64 = 0.005;
/// Finest cells that a limb is cut on, as a part of its radius.
const CELLS: f64 = 0.3;

/// A closed triangle mesh that a skeleton moves, in the pose in which both are given.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Skin {
    /// Places, metres.
    pub vertices: Vec<DVec3>,
    /// Vertices of the triangles.
    pub triangles: Vec<[u32; 3]>,
    /// By vertex: the joint that moves it most.
    pub joint_of: Vec<usize>,
    /// The skeleton.
    pub joints: Vec<SkinJoint>,
}

/// A joint of a skeleton.
#[derive(Debug, Clone, PartialEq)]
pub struct SkinJoint {
    /// Its name in the file.
    pub name: String,
    /// The joint that it hangs from.
    pub parent: Option<usize>,
    /// Its place, metres.
    pub place: DVec3,
}

/// How the limbs' trees are made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SkinOptions {
    /// Spheres of the whole body at the finest level.
    pub spheres: usize,
    /// Levels of each limb's tree.
    pub levels: usize,
    /// Side of the cells that limbs are cut on, metres; thin limbs have smaller ones.
    pub step: f64,
}

impl Default for SkinOptions {
    fn default() -> Self {
        Self { spheres: 800, levels: 2, step: 0.01 }
    }
}

/// Why a skin is no body.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum SkinError {
    #[error("the skin has no joint that moves anything")]
    NoJoints,
    #[error("joint {joint} (\"{}\") hangs from joint {parent}; expected another joint, without a circle", names::excerpt(.name))]
    Parent { joint: usize, name: String, parent: usize },
    #[error("vertex {vertex} is moved by joint {joint}; there are {count}")]
    Vertex { vertex: usize, joint: usize, count: usize },
    #[error("there are {vertices} vertices, and joints for {joints}; expected as many")]
    Count { vertices: usize, joints: usize },
    #[error("the surface {0}")]
    MeshSurface(MeshError),
    #[error(transparent)]
    Tree(#[from] OptionsError),
    #[error(transparent)]
    Model(#[from] ModelError),
}

/// A limb to be made.
#[derive(Debug, Clone)]
struct Bone {
    name: String,
    /// The joint that it turns about.
    joint: usize,
    from: DVec3,
    to: DVec3,
    /// The bone at whose end it begins.
    parent: Option<usize>,
}

impl Bone {
    fn distance(&self, point: DVec3) -> f64 {
        distance(point, self.from, self.to)
    }
}

/// The body of a skin. At rest, with its root at the skeleton's, it stands as the skin does.
///
/// # Errors
/// A skeleton without bones, a surface that bounds no solid, or a body that cannot hold its trees.
pub fn body_of_skin(skin: &Skin, name: &str, options: &SkinOptions) -> Result<Model, SkinError> {
    // Seams of a surface are written twice, and differ by rounding.
    let snapped = skin.vertices.iter().map(|place| (*place / GRID).round() * GRID).collect();
    let skin = &Skin { vertices: snapped, ..skin.clone() };
    let skeleton = Skeleton::of(skin)?;
    let bones = skeleton.bones(skin);
    if bones.is_empty() {
        return Err(SkinError::NoJoints);
    }
    let bone_of = owners(skin, &skeleton, &bones);
    let whole = ClosedMesh::new(&skin.vertices, &skin.triangles).map_err(SkinError::MeshSurface)?;
    let solid = Solid::new(whole.parts(), skin, &bone_of);
    let radii: Vec<f64> = (0..bones.len()).map(|bone| mean_radius(skin, &bone_of, &bones, bone)).collect();
    let model = Model::new(&spec(name, &bones, &radii))?;
    let surfaces: Vec<MeshSurface<'_>> = solid.parts.iter().map(MeshSurface::new).collect();
    let cut = |bone: usize| {
        let own: Vec<DVec3> = (0..skin.vertices.len())
            .filter(|&vertex| bone_of[vertex] == bone)
            .map(|vertex| skin.vertices[vertex])
            .collect();
        let step = options.step.min(CELLS * radii[bone]);
        let [low, high] = own
            .iter()
            .fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], at| [low.min(*at), high.max(*at)]);
        let bounds = [low - 2.0 * step, high + 2.0 * step];
        let value = |place: DVec3| {
            let (signed, owner) = solid.at(&surfaces, place);
            signed.max(if owner == bone { -step } else { step })
        };
        // A limb that carving left empty has no shape of its own.
        let mesh = isosurface(bounds, step, value).ok().filter(|_| !own.is_empty());
        mesh.and_then(|mesh| mesh.largest_part().map(|place| place - bones[bone].from).ok())
    };
    let meshes: Vec<Option<ClosedMesh>> = (0..bones.len()).into_par_iter().map(cut).collect();
    let trees = trees::of_meshes(&model, &meshes, options.spheres, options.levels)?;
    Ok(model.with_trees(trees)?)
}

/// The joints that count.
struct Skeleton {
    /// By joint: the one at its place that stands for it.
    stands_for: Vec<usize>,
    /// By joint that stands for others: those that hang from it and move something.
    children: Vec<Vec<usize>>,
    /// Those that hang from none.
    roots: Vec<usize>,
}

impl Skeleton {
    fn of(skin: &Skin) -> Result<Self, SkinError> {
        let joints = &skin.joints;
        let count = joints.len();
        if skin.joint_of.len() != skin.vertices.len() {
            return Err(SkinError::Count { vertices: skin.vertices.len(), joints: skin.joint_of.len() });
        }
        if let Some((vertex, &joint)) = skin.joint_of.iter().enumerate().find(|(_, joint)| **joint >= count) {
            return Err(SkinError::Vertex { vertex, joint, count });
        }
        let order = downwards(joints)?;
        let mut moves = vec![false; count];
        skin.joint_of.iter().for_each(|&joint| moves[joint] = true);
        let is_owner = moves.clone();
        for &joint in order.iter().rev() {
            if let Some(parent) = joints[joint].parent {
                moves[parent] |= moves[joint];
            }
        }
        let mut stands_for: Vec<usize> = (0..count).collect();
        let mut children = vec![Vec::new(); count];
        let mut roots = Vec::new();
        for joint in order.into_iter().filter(|&joint| moves[joint]) {
            let parent = joints[joint].parent.map(|parent| stands_for[parent]);
            match parent {
                Some(parent) if joints[joint].place.distance(joints[parent].place) < ONE_PLACE => {
                    stands_for[joint] = parent;
                }
                Some(parent) => children[parent].push(joint),
                None => roots.push(joint),
            }
        }
        // A joint above the body, which only carries it, is no limb.
        let owns = |joint: usize| (0..count).any(|other| is_owner[other] && stands_for[other] == joint);
        for root in &mut roots {
            while let [only] = children[*root][..]
                && !owns(*root)
            {
                *root = only;
            }
        }
        Ok(Self { stands_for, children, roots })
    }

    fn bones(&self, skin: &Skin) -> Vec<Bone> {
        let mut bones: Vec<Bone> = Vec::new();
        let mut left: Vec<(usize, Option<usize>)> =
            self.roots.iter().rev().map(|&root| (root, None)).collect();
        while let Some((joint, parent)) = left.pop() {
            let SkinJoint { name, place, .. } = &skin.joints[joint];
            let children = &self.children[joint];
            let first = bones.len();
            for &child in children {
                let name = match children.len() {
                    1 => name.clone(),
                    _ => format!("{name} to {}", skin.joints[child].name),
                };
                bones.push(Bone { name, joint, from: *place, to: skin.joints[child].place, parent });
            }
            left.extend(
                children.iter().enumerate().rev().map(|(index, &child)| (child, Some(first + index))),
            );
            if children.is_empty() {
                let before = parent.map_or(DVec3::Y, |parent| bones[parent].to - bones[parent].from);
                let to = self.tip(skin, joint, before);
                bones.push(Bone { name: name.clone(), joint, from: *place, to, parent });
            }
        }
        for index in 0..bones.len() {
            let is_taken = |name: &str| bones[..index].iter().any(|other| other.name == name);
            let name = if names::is_name(&bones[index].name) {
                bones[index].name.clone()
            } else {
                format!("bone {}", index + 1)
            };
            let numbered = (2..).map(|number| format!("{name} {number}"));
            let free = std::iter::once(name.clone()).chain(numbered).find(|name| !is_taken(name));
            bones[index].name = free.unwrap_or(name);
        }
        bones
    }

    /// The end of a limb that ends in no joint: as far as what it moves reaches, less its thickness.
    fn tip(&self, skin: &Skin, joint: usize, before: DVec3) -> DVec3 {
        let place = skin.joints[joint].place;
        let own = || {
            let vertices = skin.vertices.iter().zip(&skin.joint_of);
            vertices.filter(|(_, of)| self.stands_for[**of] == joint).map(|(at, _)| *at - place)
        };
        let middle = own().sum::<DVec3>() / own().count().max(1) as f64;
        let direction = middle.try_normalize().unwrap_or_else(|| before.normalize_or(DVec3::Y));
        let reach = own().map(|at| at.dot(direction)).fold(0.0, f64::max);
        let thickness =
            own().map(|at| at.reject_from(direction).length()).sum::<f64>() / own().count().max(1) as f64;
        place + direction * (reach - thickness).max(SHORTEST)
    }
}

/// The joints, each after the one that it hangs from.
fn downwards(joints: &[SkinJoint]) -> Result<Vec<usize>, SkinError> {
    let mut order = Vec::with_capacity(joints.len());
    let mut is_placed = vec![false; joints.len()];
    for first in 0..joints.len() {
        let mut chain = Vec::new();
        let mut at = Some(first);
        while let Some(joint) = at.filter(|&joint| !is_placed[joint]) {
            let parent = joints[joint].parent;
            if let Some(parent) =
                parent.filter(|&parent| parent >= joints.len() || chain.contains(&parent) || parent == joint)
            {
                return Err(SkinError::Parent { joint, name: joints[joint].name.clone(), parent });
            }
            chain.push(joint);
            at = parent;
        }
        for joint in chain.into_iter().rev() {
            is_placed[joint] = true;
            order.push(joint);
        }
    }
    Ok(order)
}

/// By vertex: of the bones of the joint that moves it the nearest.
fn owners(skin: &Skin, skeleton: &Skeleton, bones: &[Bone]) -> Vec<usize> {
    let mut by_joint: HashMap<usize, Vec<usize>> = HashMap::new();
    for (index, bone) in bones.iter().enumerate() {
        by_joint.entry(bone.joint).or_default().push(index);
    }
    let owner = |(place, joint): (&DVec3, &usize)| {
        let near = |a: &usize, b: &usize| bones[*a].distance(*place).total_cmp(&bones[*b].distance(*place));
        let of_joint = by_joint.get(&skeleton.stands_for[*joint]);
        of_joint.and_then(|bones| bones.iter().copied().min_by(|a, b| near(a, b))).unwrap_or(0)
    };
    skin.vertices.iter().zip(&skin.joint_of).map(owner).collect()
}

fn mean_radius(skin: &Skin, bone_of: &[usize], bones: &[Bone], bone: usize) -> f64 {
    let own = skin.vertices.iter().zip(bone_of).filter(|(_, of)| **of == bone);
    let (sum, count) =
        own.fold((0.0, 0_usize), |(sum, count), (at, _)| (sum + bones[bone].distance(*at), count + 1));
    (sum / count.max(1) as f64).max(THINNEST)
}

fn spec(name: &str, bones: &[Bone], radii: &[f64]) -> ModelSpec {
    let limb = |(index, bone): (usize, &Bone)| {
        let first = bones[..index].iter().find(|other| other.joint == bone.joint);
        LimbSpec {
            name: bone.name.clone(),
            parent: bone.parent.map(|parent| bones[parent].name.clone()),
            rigid_with: first.map(|first| first.name.clone()),
            direction: bone.to - bone.from,
            length: bone.from.distance(bone.to),
            radius: radii[index],
            ..LimbSpec::default()
        }
    };
    let limbs = bones.iter().enumerate().map(limb).collect();
    ModelSpec { format: FORMAT.to_owned(), name: name.to_owned(), limbs }
}

/// The solid that the surface bounds: parts that hang together, which may lie in one another.
struct Solid {
    parts: Vec<ClosedMesh>,
    /// By part and triangle: the bone that moves most of its corners.
    bones: Vec<Vec<usize>>,
}

impl Solid {
    fn new(parts: Vec<ClosedMesh>, skin: &Skin, bone_of: &[usize]) -> Self {
        let key = |place: DVec3| (place + DVec3::ZERO).to_array().map(f64::to_bits);
        let places: HashMap<[u64; 3], usize> =
            skin.vertices.iter().zip(bone_of).map(|(place, bone)| (key(*place), *bone)).collect();
        let of_triangle = |part: &ClosedMesh, triangle: usize| {
            let [a, b, c] = part.corners(triangle).map(|at| places.get(&key(at)).copied().unwrap_or(0));
            if b == c { b } else { a }
        };
        let of_part = |part: &ClosedMesh| {
            (0..part.triangles().len()).map(|triangle| of_triangle(part, triangle)).collect()
        };
        Self { bones: parts.iter().map(of_part).collect(), parts }
    }

    /// Distance from the surface, negative inside, and the bone that moves the surface there: of parts that lie in one another that
    /// of the one in which the place is deepest.
    fn at(&self, surfaces: &[MeshSurface<'_>], place: DVec3) -> (f64, usize) {
        let mut best = (f64::INFINITY, 0);
        for (surface, bones) in surfaces.iter().zip(&self.bones) {
            let nearest = surface.nearest(place);
            if nearest.signed < best.0 {
                best = (nearest.signed, bones[nearest.triangle]);
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::{Kinematics, Pose};

    /// An arm of two bones along x, of one surface, thicker at the shoulder; a joint above it and one at the elbow's place.
    fn arm() -> Skin {
        let radius = |x: f64| 0.06 - 0.03 * x.clamp(0.0, 0.6);
        let solid = |p: DVec3| {
            let along = p.x.clamp(0.0, 0.6);
            p.distance(DVec3::new(along, 0.0, 1.0)) - radius(along)
        };
        let mesh =
            isosurface([DVec3::new(-0.1, -0.1, 0.9), DVec3::new(0.7, 0.1, 1.1)], 0.012, solid).unwrap();
        let joint = |name: &str, parent, x: f64, z: f64| SkinJoint {
            name: name.to_owned(),
            parent,
            place: DVec3::new(x, 0.0, z),
        };
        Skin {
            joint_of: mesh.vertices().iter().map(|at| if at.x < 0.3 { 1 } else { 3 }).collect(),
            vertices: mesh.vertices().to_vec(),
            triangles: mesh.triangles().to_vec(),
            joints: vec![
                joint("armature", None, 0.0, 0.0),
                joint("upper arm", Some(0), 0.0, 1.0),
                joint("elbow", Some(1), 0.3, 1.0),
                joint("forearm", Some(2), 0.301, 1.0),
                joint("finger", Some(3), 0.5, 1.0),
            ],
        }
    }

    #[test]
    fn bones_that_move_something_are_limbs() {
        let body =
            body_of_skin(&arm(), "arm", &SkinOptions { spheres: 80, ..SkinOptions::default() }).unwrap();
        let names: Vec<&str> = body.limbs().iter().map(|limb| limb.name.as_str()).collect();
        assert_eq!(names, ["upper arm", "elbow"], "the armature and the finger are no limbs");
        let [upper, fore] = [&body.limbs()[0], &body.limbs()[1]];
        let lengths = [upper.length, fore.length];
        assert!((lengths[0] - 0.3).abs() < 1e-9 && (lengths[1] - 0.3).abs() < 0.02, "{lengths:?}");
        assert!(upper.radius > fore.radius && (0.04..0.065).contains(&upper.radius), "{}", upper.radius);
        assert_ne!(upper.rotation, fore.rotation);
    }

    #[test]
    fn its_spheres_fill_the_solid_and_turn_with_their_limb() {
        let skin = arm();
        let body =
            body_of_skin(&skin, "arm", &SkinOptions { spheres: 200, ..SkinOptions::default() }).unwrap();
        let rest = Pose { root: DVec3::new(0.0, 0.0, 1.0), ..Pose::rest(&body) };
        let spheres = |pose: &Pose| -> Vec<(DVec3, f64)> {
            let kinematics = Kinematics::new(&body, pose);
            let placed = body.placed_spheres(&kinematics, usize::MAX);
            placed.into_iter().map(|sphere| (sphere.centre, sphere.radius)).collect()
        };
        let distance = |spheres: &[(DVec3, f64)], at: DVec3| {
            spheres.iter().map(|(centre, radius)| at.distance(*centre) - radius).fold(f64::INFINITY, f64::min)
        };
        let at_rest = spheres(&rest);
        let far = skin.vertices.iter().map(|at| distance(&at_rest, *at).abs()).fold(0.0, f64::max);
        assert!(far < 0.02, "the surface is {far} m from the spheres'");
        let mean: f64 = skin.vertices.iter().map(|at| distance(&at_rest, *at).abs()).sum::<f64>()
            / skin.vertices.len() as f64;
        assert!(mean < 0.006, "{mean} m");
        // Bent at the elbow, the forearm's surface goes with it.
        let mut bent = rest.clone();
        let turn = glam::DQuat::from_rotation_y(0.9);
        bent.rotations[body.limbs()[1].rotation] = turn;
        let moved = spheres(&bent);
        let elbow = DVec3::new(0.3, 0.0, 1.0);
        for at in skin.vertices.iter().filter(|at| at.x > 0.36) {
            let to = elbow + turn * (*at - elbow);
            assert!(distance(&moved, to).abs() < 0.02, "{to}: {}", distance(&moved, to));
        }
    }

    #[test]
    fn what_is_no_skeleton_is_told_in_words() {
        let message = |change: &dyn Fn(&mut Skin)| {
            let mut skin = arm();
            change(&mut skin);
            body_of_skin(&skin, "arm", &SkinOptions::default()).unwrap_err().to_string()
        };
        let circle = message(&|skin| skin.joints[0].parent = Some(3));
        assert!(circle.contains("hangs from joint") && circle.contains("without a circle"), "{circle}");
        assert!(message(&|skin| skin.joint_of[7] = 9).contains("vertex 7 is moved by joint 9; there are 5"));
        assert!(message(&|skin| skin.triangles.truncate(9)).contains("is not closed"));
        assert!(message(&|skin| skin.joint_of.truncate(9)).contains("expected as many"));
        let none = body_of_skin(&Skin::default(), "none", &SkinOptions::default());
        assert!(matches!(none, Err(SkinError::NoJoints)), "{none:?}");
    }
}
