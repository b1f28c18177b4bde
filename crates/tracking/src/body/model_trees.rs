//! Sphere trees of a model's limbs.

use glam::DVec3;

use super::kinematics::Kinematics;
use super::limb::{LimbSphere, SphereLevel};
use super::model::{MAX_SIZE, Model, ModelError, is_size};

/// Most levels above the finest.
const MAX_COARSER: usize = 8;

/// A sphere of a body where it is in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlacedSphere {
    /// Index of its limb.
    pub limb: usize,
    /// Its centre, metres.
    pub centre: DVec3,
    /// Its radius, metres.
    pub radius: f64,
}

/// Checks the spheres of a limb, level by level.
pub(super) fn check_tree(
    limb: &str,
    finest: &[LimbSphere],
    coarser: &[SphereLevel],
) -> Result<(), ModelError> {
    let wrong = |level: usize, problem| ModelError::Level { limb: limb.to_owned(), level, problem };
    if coarser.len() > MAX_COARSER {
        return Err(wrong(MAX_COARSER, "is one level too many; expected at most 8"));
    }
    let mut above = None;
    for (index, level) in coarser.iter().enumerate() {
        if !(level.error >= 0.0 && level.error <= MAX_SIZE) {
            return Err(wrong(index, "has no `error` of 0 or more; expected metres"));
        }
        if level.spheres.is_empty() || finest.is_empty() {
            return Err(wrong(index, "or the finest level has no spheres; expected at least one"));
        }
        if level.spheres.iter().any(|sphere| sphere_problem(sphere, above).is_some()) {
            return Err(wrong(
                index,
                "has a sphere without radius, off its limb, or under no sphere of the level above",
            ));
        }
        above = Some(level.spheres.len());
    }
    for (index, sphere) in finest.iter().enumerate() {
        if let Some(problem) = sphere_problem(sphere, above) {
            return Err(ModelError::Sphere { limb: limb.to_owned(), index, problem });
        }
    }
    Ok(())
}

/// What is wrong with a sphere; `above` says how many there are in the level above.
fn sphere_problem(sphere: &LimbSphere, above: Option<usize>) -> Option<&'static str> {
    if !is_size(sphere.radius) {
        return Some("has no radius above 0; expected metres");
    }
    if !(0.0..=1.0).contains(&sphere.at) {
        return Some("does not lie on the limb; expected `at` from 0, its first joint, to 1, its second");
    }
    if !sphere.offset.abs().cmple(DVec3::splat(MAX_SIZE)).all() {
        return Some("lies far off the limb; expected an `offset` of three numbers in metres, at most 100");
    }
    match (sphere.parent, above) {
        (None, None) => None,
        (Some(parent), Some(count)) if parent < count => None,
        (None, Some(_)) => Some("has no `parent`; expected the number of a sphere of the level above"),
        (Some(_), _) => {
            Some("has a `parent` that is not there; expected the number of a sphere of the level above")
        }
    }
}

impl Model {
    /// The same body with sphere trees: of every limb its levels, coarsest first, the last of which is its finest.
    ///
    /// # Errors
    /// If a limb's tree is not valid.
    pub fn with_trees(&self, trees: Vec<Vec<SphereLevel>>) -> Result<Self, ModelError> {
        let mut body = self.clone();
        for (limb, mut levels) in body.limbs.iter_mut().zip(trees) {
            limb.spheres = levels.pop().map_or_else(Vec::new, |finest| finest.spheres);
            limb.coarser = levels;
            check_tree(&limb.name, &limb.spheres, &limb.coarser)?;
            limb.measure_tree();
        }
        Ok(body)
    }

    /// The body with the spheres of one level alone, counted from the coarsest.
    ///
    /// # Errors
    /// Never for a valid body.
    pub fn at_level(&self, level: usize) -> Result<Self, ModelError> {
        let alone = self.limbs.iter().map(|limb| {
            let spheres =
                limb.level(level).iter().map(|sphere| LimbSphere { parent: None, ..*sphere }).collect();
            vec![SphereLevel { error: 0.0, spheres, reaches: Vec::new() }]
        });
        self.with_trees(alone.collect())
    }

    /// The same body with other finest spheres: limb, number and sphere give the sphere. It must be one.
    pub(crate) fn with_spheres(
        &self,
        mut sphere: impl FnMut(usize, usize, &LimbSphere) -> LimbSphere,
    ) -> Self {
        let mut body = self.clone();
        for (index, limb) in body.limbs.iter_mut().enumerate() {
            limb.spheres.iter_mut().enumerate().for_each(|(number, old)| *old = sphere(index, number, old));
            limb.measure_tree();
        }
        body
    }

    /// Spheres of all limbs, level by level, coarsest first. Empty without trees.
    pub fn spheres_by_level(&self) -> Vec<usize> {
        let levels = self.limbs.iter().map(|limb| limb.coarser.len() + 1).max().unwrap_or(0);
        if self.limbs.iter().all(|limb| limb.spheres.is_empty()) {
            return Vec::new();
        }
        (0..levels).map(|level| self.limbs.iter().map(|limb| limb.level(level).len()).sum()).collect()
    }

    /// The spheres of a level, counted from the coarsest, where a pose puts them: to be drawn. Limbs without a tree have none.
    pub fn placed_spheres(&self, kinematics: &Kinematics, level: usize) -> Vec<PlacedSphere> {
        let of_limb = |(index, limb): (usize, &super::limb::Limb)| {
            let (start, turn) = (kinematics.starts()[index], kinematics.world_rotations()[limb.rotation]);
            let place = |sphere: &LimbSphere| PlacedSphere {
                limb: index,
                centre: start + turn * limb.centre(sphere),
                radius: sphere.radius,
            };
            limb.level(level).iter().map(place).collect::<Vec<_>>()
        };
        self.limbs.iter().enumerate().flat_map(of_limb).collect()
    }
}
