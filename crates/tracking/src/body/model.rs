//! A body model: limbs, checked once, in the order of the model file.

use glam::DVec3;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::anatomy::split_side;
use super::limb::{JointLimits, Limb, LimbSphere, SphereLevel};
use crate::names;
use crate::numbers::Brief;

/// Name and version of the model file's format.
pub const FORMAT: &str = "backlit-body 1";
/// Most limbs a model may have: far more than any body needs, few enough to bound the work.
pub const MAX_LIMBS: usize = 256;
/// Lengths and radii above this (metres) are a mistake of units.
pub const MAX_SIZE: f64 = 100.0;
/// Limits beyond this, radians, limit nothing and are a mistake: of degrees, or of something else.
pub const MAX_ANGLE: f64 = 4.0 * std::f64::consts::PI;
/// Names of a long cycle that are told of its beginning and of its end.
const CYCLE_SHOWN: usize = 4;
/// What stands for the root among names of joints, so that no limb may be called so.
pub const ROOT: &str = "root";

/// A body model as files say it: see `docs/formats.md`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelSpec {
    /// [`FORMAT`].
    pub format: String,
    /// What the body is called.
    pub name: String,
    /// The limbs; a parent stands before its children.
    #[serde(rename = "limb")]
    pub limbs: Vec<LimbSpec>,
}

/// One limb as files say it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LimbSpec {
    /// Unique name.
    pub name: String,
    /// Name of the limb it grows from; left out, it grows from the root.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub parent: Option<String>,
    /// Name of the limb whose rotation it follows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rigid_with: Option<String>,
    /// Rest direction, of any length but zero.
    pub direction: DVec3,
    /// Metres.
    pub length: f64,
    /// Metres.
    pub radius: f64,
    /// Anatomical limits.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limits: Option<JointLimits>,
    /// Sphere tree.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub spheres: Vec<LimbSphere>,
    /// Coarser levels of its sphere tree, coarsest first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub coarser: Vec<SphereLevel>,
}

/// Why a model is not one. Every variant names the limb and the field.
#[derive(Debug, Error, Clone, PartialEq)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum ModelError {
    #[error("`format` is \"{found}\"; expected \"{FORMAT}\"")]
    Format { found: String },
    #[error("the model has no limb; expected at least one [[limb]]")]
    NoLimbs,
    #[error("the model has {count} limbs; expected at most {MAX_LIMBS}")]
    TooManyLimbs { count: usize },
    #[error("limb {number}: `name` is empty")]
    EmptyName { number: usize },
    #[error("limb {number}: `name` is \"{}\"; expected {}", names::excerpt(.name), names::EXPECTED)]
    Name { number: usize, name: String },
    #[error("the body's `name` is \"{}\"; expected {}", names::excerpt(.name), names::EXPECTED)]
    BodyName { name: String },
    #[error("limb {number}: `name` is \"{ROOT}\", which stands for the root; expected another name")]
    Root { number: usize },
    #[error("limb \"{limb}\": `name` is used twice; expected every name once")]
    DuplicateName { limb: String },
    #[error("limb \"{limb}\": `{field}` names \"{}\", and no limb has that name", names::excerpt(.target))]
    UnknownLimb { limb: String, field: &'static str, target: String },
    #[error("limb \"{limb}\": `{field}` = \"{target}\" makes a cycle: {cycle}")]
    Cycle { limb: String, field: &'static str, target: String, cycle: String },
    #[error(
        "limb \"{limb}\": `direction` is [{:?}, {:?}, {:?}]; expected three finite numbers, not all zero",
        value.x, value.y, value.z
    )]
    Direction { limb: String, value: DVec3 },
    #[error(
        "limb \"{limb}\": `{field}` is {}; expected a number of metres above 0 and at most {MAX_SIZE}",
        Brief(*.value)
    )]
    Size { limb: String, field: &'static str, value: f64 },
    #[error("limb \"{limb}\": `limits.{field}` {problem}")]
    Limits { limb: String, field: &'static str, problem: &'static str },
    #[error("limb \"{limb}\": `spheres[{index}]` {problem}")]
    Sphere { limb: String, index: usize, problem: &'static str },
    #[error("limb \"{limb}\": `coarser[{level}]` {problem}")]
    Level { limb: String, level: usize, problem: &'static str },
}

/// A body: limbs in an arena, every parent before its children.
///
/// Guaranteed: at least one limb, unit directions, finite positive lengths and radii, parents of smaller
/// index, and rotations numbered in the order of the limbs that own them.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    name: String,
    pub(super) limbs: Vec<Limb>,
    rotation_owners: Vec<usize>,
    rotation_parents: Vec<Option<usize>>,
    rotations_parents_first: Vec<usize>,
    /// By limb, the one on the other side of the body: views ask for it in every frame.
    mirrored: Vec<usize>,
    /// Indices of the limbs in the order of the file: in another one, rotations would be counted in another order.
    of_file: Vec<usize>,
}

impl Model {
    /// Checks a model and puts its limbs in order: a limb may stand before its parent in a file.
    ///
    /// # Errors
    /// The first thing that is wrong, by limb and field.
    pub fn new(spec: &ModelSpec) -> Result<Self, ModelError> {
        if spec.format != FORMAT {
            return Err(ModelError::Format { found: spec.format.clone() });
        }
        if spec.limbs.is_empty() {
            return Err(ModelError::NoLimbs);
        }
        if spec.limbs.len() > MAX_LIMBS {
            return Err(ModelError::TooManyLimbs { count: spec.limbs.len() });
        }
        if !spec.name.is_empty() && !names::is_name(&spec.name) {
            return Err(ModelError::BodyName { name: spec.name.clone() });
        }
        for (index, limb) in spec.limbs.iter().enumerate() {
            check_limb(index, limb)?;
            if spec.limbs[..index].iter().any(|other| other.name == limb.name) {
                return Err(ModelError::DuplicateName { limb: limb.name.clone() });
            }
        }
        let find = |limb: &LimbSpec, field, target: &Option<String>| {
            let index_of = |target: &String| spec.limbs.iter().position(|other| other.name == *target);
            let unknown = |target: &String| ModelError::UnknownLimb {
                limb: limb.name.clone(),
                field,
                target: target.clone(),
            };
            target.as_ref().map(|target| index_of(target).ok_or_else(|| unknown(target))).transpose()
        };
        let mut parents = Vec::with_capacity(spec.limbs.len());
        let mut rigid = Vec::with_capacity(spec.limbs.len());
        for limb in &spec.limbs {
            parents.push(find(limb, "parent", &limb.parent)?);
            rigid.push(find(limb, "rigid_with", &limb.rigid_with)?);
        }
        check_cycles(spec, "rigid_with", &rigid)?;
        check_cycles(spec, "parent", &parents)?;
        // A limb that owns a rotation must not grow from one that follows it.
        let owner = |limb: usize| std::iter::successors(Some(limb), |&l| rigid[l]).last().unwrap_or(limb);
        let owners: Vec<usize> = (0..spec.limbs.len()).map(owner).collect();
        let turns_with: Vec<Option<usize>> =
            owners.iter().map(|&owner| parents[owner].map(|parent| owners[parent])).collect();
        check_cycles(spec, "parent", &turns_with)?;
        Ok(Self::assemble(spec, &parents, &owners))
    }

    fn assemble(spec: &ModelSpec, parents: &[Option<usize>], owners: &[usize]) -> Self {
        // Parents first, otherwise the file's order.
        let mut order: Vec<usize> = Vec::with_capacity(spec.limbs.len());
        let mut place = vec![usize::MAX; spec.limbs.len()];
        for start in 0..spec.limbs.len() {
            let mut path = Vec::new();
            let mut next = Some(start);
            while let Some(limb) = next.filter(|&limb| place[limb] == usize::MAX && !path.contains(&limb)) {
                path.push(limb);
                next = parents[limb];
            }
            for limb in path.into_iter().rev() {
                place[limb] = order.len();
                order.push(limb);
            }
        }
        // Rotations in the order of the file, as the state's columns are.
        let rotation_owners: Vec<usize> =
            (0..spec.limbs.len()).filter(|&index| owners[index] == index).collect();
        let mut rotation_of = vec![0; spec.limbs.len()];
        rotation_owners.iter().enumerate().for_each(|(rotation, &owner)| rotation_of[owner] = rotation);
        let rotation_of = |limb: usize| rotation_of[owners[limb]];
        let rotation_parents: Vec<Option<usize>> =
            rotation_owners.iter().map(|&owner| parents[owner].map(rotation_of)).collect();
        let depth = |rotation: usize| std::iter::successors(Some(rotation), |&r| rotation_parents[r]).count();
        let mut rotations_parents_first: Vec<usize> = (0..rotation_owners.len()).collect();
        rotations_parents_first.sort_by_key(|&rotation| depth(rotation));
        let limb = |&index: &usize| {
            let limb = &spec.limbs[index];
            let mut limb = Limb {
                name: limb.name.clone(),
                parent: parents[index].map(|parent| place[parent]),
                rotation: rotation_of(index),
                has_own_rotation: owners[index] == index,
                direction: unit(limb.direction),
                length: limb.length,
                radius: limb.radius,
                limits: limb.limits,
                spheres: limb.spheres.clone(),
                coarser: limb.coarser.clone(),
            };
            limb.measure_tree();
            limb
        };
        let limbs: Vec<Limb> = order.iter().map(limb).collect();
        let mirrored = mirrored_limbs(&limbs);
        Self {
            name: spec.name.clone(),
            limbs,
            rotation_owners: rotation_owners.into_iter().map(|owner| place[owner]).collect(),
            rotation_parents,
            rotations_parents_first,
            mirrored,
            of_file: place,
        }
    }

    /// The model as its file said it, limbs in the same order.
    pub fn to_spec(&self) -> ModelSpec {
        let name = |index: usize| self.limbs[index].name.clone();
        let limbs = self.of_file.iter().map(|&index| &self.limbs[index]).map(|limb| LimbSpec {
            name: limb.name.clone(),
            parent: limb.parent.map(name),
            rigid_with: (!limb.has_own_rotation).then(|| name(self.rotation_owners[limb.rotation])),
            direction: limb.direction,
            length: limb.length,
            radius: limb.radius,
            limits: limb.limits,
            spheres: limb.spheres.clone(),
            coarser: limb.coarser.clone(),
        });
        ModelSpec { format: FORMAT.into(), name: self.name.clone(), limbs: limbs.collect() }
    }

    /// The same body with other lengths and radii; a limb's spheres keep their places on it and scale with its radius.
    ///
    /// `sizes(limb)` gives length and radius in metres.
    ///
    /// # Errors
    /// If a size is out of range.
    pub fn with_sizes(&self, sizes: impl Fn(usize) -> [f64; 2]) -> Result<Self, ModelError> {
        let mut resized = self.clone();
        for (index, limb) in resized.limbs.iter_mut().enumerate() {
            let [length, radius] = sizes(index);
            check_sizes(&limb.name, length, radius)?;
            let thicker = radius / limb.radius;
            let levels = limb.coarser.iter_mut().map(|level| {
                level.error *= thicker;
                &mut level.spheres
            });
            for sphere in levels.chain([&mut limb.spheres]).flatten() {
                sphere.radius *= thicker;
                sphere.offset *= thicker;
            }
            (limb.length, limb.radius) = (length, radius);
            limb.measure_tree();
        }
        Ok(resized)
    }

    /// The same body under another name.
    pub fn renamed(mut self, name: &str) -> Self {
        name.clone_into(&mut self.name);
        self
    }

    /// What the body is called.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The limbs, parents before children.
    pub fn limbs(&self) -> &[Limb] {
        &self.limbs
    }

    /// Index of the limb with this name.
    pub fn limb_index(&self, name: &str) -> Option<usize> {
        self.limbs.iter().position(|limb| limb.name == name)
    }

    /// Number of rotations of the pose.
    pub fn rotation_count(&self) -> usize {
        self.rotation_owners.len()
    }

    /// The limb that owns each rotation.
    pub fn rotation_owners(&self) -> &[usize] {
        &self.rotation_owners
    }

    /// The rotation that each rotation is relative to; `None` for the world.
    pub fn rotation_parents(&self) -> &[Option<usize>] {
        &self.rotation_parents
    }

    /// Rotations in an order in which each stands after the one it is relative to.
    pub fn rotations_parents_first(&self) -> &[usize] {
        &self.rotations_parents_first
    }

    /// Whether `rotation` turns with `ancestor` (every rotation turns with itself).
    pub fn rotation_follows(&self, rotation: usize, ancestor: usize) -> bool {
        let mut carriers = std::iter::successors(Some(rotation), |&next| self.rotation_parents[next]);
        carriers.any(|carrier| carrier == ancestor)
    }

    /// The limb on the other side of the body ("right …" and "left …"); itself when there is none.
    pub fn mirrored_limb(&self, limb: usize) -> usize {
        self.mirrored[limb]
    }
}

/// By limb, the index of the limb on the other side; its own where there is none.
fn mirrored_limbs(limbs: &[Limb]) -> Vec<usize> {
    let other = |limb: &Limb| match split_side(&limb.name) {
        ("right ", part) => Some(format!("left {part}")),
        ("left ", part) => Some(format!("right {part}")),
        _ => None,
    };
    let index_of = |name: String| limbs.iter().position(|limb| limb.name == name);
    limbs.iter().enumerate().map(|(index, limb)| other(limb).and_then(index_of).unwrap_or(index)).collect()
}

/// A unit direction is kept to the bit, so that a model written and read again is the same.
fn unit(direction: DVec3) -> DVec3 {
    if (direction.length_squared() - 1.0).abs() < 1e-14 { direction } else { direction.normalize() }
}

pub(super) fn is_size(value: f64) -> bool {
    value.is_finite() && value > 1e-6 && value <= MAX_SIZE
}

/// Checks a limb's length and radius.
fn check_sizes(limb: &str, length: f64, radius: f64) -> Result<(), ModelError> {
    match [("length", length), ("radius", radius)].into_iter().find(|(_, value)| !is_size(*value)) {
        Some((field, value)) => Err(ModelError::Size { limb: limb.to_owned(), field, value }),
        None => Ok(()),
    }
}

fn check_limb(index: usize, limb: &LimbSpec) -> Result<(), ModelError> {
    let name = || limb.name.clone();
    let limits_error = |field, problem| Err(ModelError::Limits { limb: name(), field, problem });
    if limb.name.trim().is_empty() {
        return Err(ModelError::EmptyName { number: index + 1 });
    }
    if !names::is_name(&limb.name) {
        return Err(ModelError::Name { number: index + 1, name: limb.name.clone() });
    }
    if limb.name == ROOT {
        return Err(ModelError::Root { number: index + 1 });
    }
    let direction_length = limb.direction.length();
    if !direction_length.is_finite() || direction_length < 1e-9 {
        return Err(ModelError::Direction { limb: name(), value: limb.direction });
    }
    check_sizes(&limb.name, limb.length, limb.radius)?;
    if let Some(limits) = limb.limits {
        for (field, range) in
            [("flexion", limits.flexion), ("sideways", limits.sideways), ("twist", limits.twist)]
        {
            if !range.is_valid() || range.0.abs().max(range.1.abs()) > MAX_ANGLE {
                let problem =
                    "is not a range; expected [smallest, largest] in radians, none beyond two whole turns";
                return limits_error(field, problem);
            }
        }
        let across = limits.axis.reject_from(limb.direction);
        if !(across.is_finite() && across.length() > 1e-6) {
            return limits_error("axis", "lies along the limb; expected a direction across it");
        }
    }
    super::model_trees::check_tree(&limb.name, &limb.spheres, &limb.coarser)
}

fn check_cycles(spec: &ModelSpec, field: &'static str, next: &[Option<usize>]) -> Result<(), ModelError> {
    for start in 0..next.len() {
        let mut path = vec![start];
        let mut current = start;
        while let Some(target) = next[current] {
            path.push(target);
            if target == start {
                let mut names: Vec<&str> = path.iter().map(|&limb| spec.limbs[limb].name.as_str()).collect();
                if names.len() > 2 * CYCLE_SHOWN {
                    names.splice(CYCLE_SHOWN..names.len() - CYCLE_SHOWN, ["…"]);
                }
                return Err(ModelError::Cycle {
                    limb: spec.limbs[start].name.clone(),
                    field,
                    target: spec.limbs[path[1]].name.clone(),
                    cycle: names.join(" → "),
                });
            }
            if path.len() > next.len() {
                break; // runs into a cycle that does not hold `start`; that cycle is reported from within
            }
            current = target;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
