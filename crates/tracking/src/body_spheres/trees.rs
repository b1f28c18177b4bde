//! From carved limbs to sphere trees of the model.

use backlit_sphere_tree::{ClosedMesh, OptionsError, SphereTree, TreeOptions, TreeSphere, isosurface};
use glam::DVec3;
use rayon::prelude::*;

use super::carve::Witnesses;
use super::options::SphereBodyOptions;
use super::{PosedViews, SphereBodyError};
use crate::body::{Limb, LimbSphere, Model, SphereLevel};

/// Fewest spheres of a limb's finest level.
const FEWEST: usize = 2;

/// Limbs carved from frames, each with a tree of its own.
///
/// # Errors
/// A limb that carving left empty, or a body that cannot hold its trees.
pub(super) fn carved(
    model: &Model,
    frames: &[PosedViews],
    options: &SphereBodyOptions,
) -> Result<Model, SphereBodyError> {
    let witnesses = Witnesses::new(model, frames);
    let carve = |(index, limb): (usize, &Limb)| {
        let field = witnesses.field(index, options);
        let step = options.step.min(0.4 * limb.radius);
        let mesh = isosurface(field.bounds(), step, |place| field.value(place));
        let mesh = mesh.map_err(|error| SphereBodyError::Limb { limb: limb.name.clone(), error })?;
        Ok(Some(mesh.largest_part()))
    };
    let meshes: Result<Vec<_>, SphereBodyError> = model.limbs().iter().enumerate().map(carve).collect();
    let meshes = meshes?;
    Ok(model.with_trees(of_meshes(model, &meshes, options.spheres, options.levels)?)?)
}

/// A tree for each limb's surface, with its share of the spheres by area; a thin row of spheres where it has none.
///
/// # Errors
/// Levels that cannot be.
pub(super) fn of_meshes(
    model: &Model,
    meshes: &[Option<ClosedMesh>],
    spheres: usize,
    levels: usize,
) -> Result<Vec<Vec<SphereLevel>>, OptionsError> {
    let areas: Vec<f64> = meshes.iter().map(|mesh| mesh.as_ref().map_or(0.0, ClosedMesh::area)).collect();
    let total: f64 = areas.iter().sum();
    let of_limb = |((mesh, area), limb): ((&Option<ClosedMesh>, &f64), &Limb)| {
        let Some(mesh) = mesh else { return Ok(vec![thin(limb)]) };
        let count = (spheres as f64 * area / total).round().max(FEWEST as f64) as usize;
        let tree = SphereTree::build(mesh, &TreeOptions { spheres: count, levels })?;
        Ok(levels_of(&tree, limb))
    };
    meshes.par_iter().zip(&areas).zip(model.limbs()).map(of_limb).collect()
}

/// A limb without a shape of its own: small spheres at its ends.
fn thin(limb: &Limb) -> SphereLevel {
    let end = |at| LimbSphere { at, radius: 0.5 * limb.radius, offset: DVec3::ZERO, parent: None };
    SphereLevel { error: 0.0, spheres: vec![end(0.0), end(1.0)], reaches: Vec::new() }
}

/// A tree's levels as a limb's: children stand beside those of the same parent.
pub(super) fn levels_of(tree: &SphereTree, limb: &Limb) -> Vec<SphereLevel> {
    let finest = tree.levels.last().map_or(0.0, |level| level.error.outside_mean);
    // Places of the spheres of the level above in its new order.
    let mut places: Vec<usize> = Vec::new();
    let mut levels = Vec::with_capacity(tree.levels.len());
    for level in &tree.levels {
        let parent = |sphere: &TreeSphere| sphere.parent.map(|parent| places[parent]);
        let mut order: Vec<usize> = (0..level.spheres.len()).collect();
        order.sort_by_key(|&index| (parent(&level.spheres[index]), index));
        let spheres = order.iter().map(|&index| {
            let TreeSphere { centre, radius, .. } = level.spheres[index];
            on_limb(limb, centre, radius, parent(&level.spheres[index]))
        });
        let spheres = spheres.collect();
        let error = (level.error.outside_mean - finest).max(0.0);
        levels.push(SphereLevel { error, spheres, reaches: Vec::new() });
        let mut new_places = vec![0; order.len()];
        order.iter().enumerate().for_each(|(place, &index)| new_places[index] = place);
        places = new_places;
    }
    levels
}

/// A sphere about a place in the limb's frame (metres from its first joint, axes of the body at rest).
pub(super) fn on_limb(limb: &Limb, centre: DVec3, radius: f64, parent: Option<usize>) -> LimbSphere {
    let at = (centre.dot(limb.direction) / limb.length).clamp(0.0, 1.0);
    LimbSphere { at, radius, offset: centre - limb.direction * (at * limb.length), parent }
}
