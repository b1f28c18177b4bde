//! Levels of spheres, coarsest first, each sphere under one of the level above.

use glam::DVec3;
use thiserror::Error;

use crate::ball::Effort;
use crate::groups::{GroupInput, SphereGroup};
use crate::measure::measure;
use crate::medial::medial_balls;
use crate::mesh::ClosedMesh;
use crate::pieces::{Patches, Pieces};
use crate::reduce::reduce;
use crate::surface::MeshSurface;
use rayon::prelude::*;

/// Most spheres of a level.
pub const MAX_SPHERES: usize = 4096;

/// Most levels.
pub const MAX_LEVELS: usize = 12;

/// Spheres reach so much further than they must, in lengths of the mesh's diagonal: files round their numbers.
const MARGIN: f64 = 2e-6;

/// Medial balls that a level of spheres is reduced from, a sphere.
const BALLS_PER_SPHERE: usize = 4;

/// Small triangles that the surface is cut into, a sphere of the last level, and at least.
const PATCHES_PER_SPHERE: usize = 40;
const FEWEST_PATCHES: usize = 2500;

/// What tree is built.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TreeOptions {
    /// Most spheres of the last level, 1 to [`MAX_SPHERES`].
    pub spheres: usize,
    /// Levels, 1 to [`MAX_LEVELS`]. Of n spheres and L levels, level k from 1 has about n^(k/L).
    pub levels: usize,
}

impl Default for TreeOptions {
    /// 8, 64 and 512 spheres.
    fn default() -> Self {
        Self { spheres: 512, levels: 3 }
    }
}

/// Why no tree can be built.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("{what} is {found}; expected 1 to {most}")]
pub struct OptionsError {
    /// The option.
    pub what: &'static str,
    /// What it is.
    pub found: usize,
    /// What it may be at most.
    pub most: usize,
}

/// A sphere of a level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TreeSphere {
    /// Its centre, in the mesh's frame and unit.
    pub centre: DVec3,
    /// Its radius.
    pub radius: f64,
    /// The sphere of the level above that it lies under; none in the first level.
    pub parent: Option<usize>,
}

/// How far the union of a level's spheres stands off the mesh, in the mesh's unit; taken over the union's boundary.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LevelError {
    /// Greatest distance of the boundary outside of the mesh: a bound, a hundredth more than what was found, or less.
    pub outside_greatest: f64,
    /// Its mean, over the area of the boundary outside.
    pub outside_mean: f64,
    /// Greatest distance of the boundary inside of the mesh: voids between spheres. Of points spread evenly.
    pub inside_greatest: f64,
    /// Its mean, over the area of the boundary inside; 0 where there is none.
    pub inside_mean: f64,
    /// Share of the mesh's surface that lies in spheres, of points spread evenly.
    pub coverage: f64,
}

/// The spheres of a level and their error.
#[derive(Debug, Clone, PartialEq)]
pub struct Level {
    /// The spheres; at least one.
    pub spheres: Vec<TreeSphere>,
    /// How good they are.
    pub error: LevelError,
}

/// Spheres at several levels of detail.
///
/// Guaranteed, of the mesh's whole surface and not of samples of it: each level covers all of it, and what of it a sphere covers its
/// parent covers too. A sphere itself may stand out of its parent.
#[derive(Debug, Clone, PartialEq)]
pub struct SphereTree {
    /// Coarsest first.
    pub levels: Vec<Level>,
}

impl SphereTree {
    /// Builds the tree of a mesh. The same for any number of threads.
    ///
    /// # Errors
    /// Options beyond their limits.
    pub fn build(mesh: &ClosedMesh, options: &TreeOptions) -> Result<Self, OptionsError> {
        for (what, found, most) in
            [("spheres", options.spheres, MAX_SPHERES), ("levels", options.levels, MAX_LEVELS)]
        {
            if found == 0 || found > most {
                return Err(OptionsError { what, found, most });
            }
        }
        let surface = MeshSurface::new(mesh);
        let patches = Patches::new(mesh, (PATCHES_PER_SPHERE * options.spheres).max(FEWEST_PATCHES));
        let [low, high] = mesh.bounds();
        let margin = MARGIN * (high - low).length();
        let counts: Vec<usize> = (1..=options.levels)
            .map(|k| {
                (options.spheres as f64).powf(k as f64 / options.levels as f64).round().max(1.0) as usize
            })
            .collect();
        let mut levels: Vec<Vec<TreeSphere>> = Vec::new();
        for &count in counts.iter().rev() {
            let groups = match levels.last() {
                None => finest(&surface, &patches, count),
                Some(children) => {
                    let spheres: Vec<_> = children.iter().map(|child| (child.centre, child.radius)).collect();
                    coarser(&surface, &patches, &spheres, count)
                }
            };
            if let Some(children) = levels.last_mut() {
                for (parent, group) in groups.iter().enumerate() {
                    group.pieces.iter().for_each(|&child| children[child as usize].parent = Some(parent));
                }
            }
            let sphere = |group: &SphereGroup| TreeSphere {
                centre: group.ball.centre,
                radius: group.ball.radius + margin,
                parent: None,
            };
            levels.push(groups.iter().map(sphere).collect());
        }
        levels.reverse();
        let level = |spheres: Vec<TreeSphere>| {
            let plain: Vec<_> = spheres.iter().map(|sphere| (sphere.centre, sphere.radius)).collect();
            Level { error: measure(&surface, &plain), spheres }
        };
        Ok(Self { levels: levels.into_iter().map(level).collect() })
    }
}

/// Spheres that cover all patches, reduced from medial balls.
fn finest(surface: &MeshSurface<'_>, patches: &Patches, count: usize) -> Vec<SphereGroup> {
    let pieces = Pieces::of_patches(patches);
    let input = GroupInput { surface, pieces: &pieces };
    let balls = medial_balls(surface, patches, &pieces, BALLS_PER_SPHERE * count.max(16));
    let groups = balls.into_par_iter().map(|(centre, owned)| input.fit(owned, &[centre], Effort::Quick));
    reduce(input, groups.collect(), count)
}

/// Spheres that cover all that each of their children touches of the surface.
fn coarser(
    surface: &MeshSurface<'_>,
    patches: &Patches,
    children: &[(DVec3, f64)],
    count: usize,
) -> Vec<SphereGroup> {
    let pieces = Pieces::touched(patches, children);
    let input = GroupInput { surface, pieces: &pieces };
    let groups: Vec<SphereGroup> = children
        .par_iter()
        .enumerate()
        .map(|(child, (centre, _))| input.fit(vec![child as u32], &[*centre], Effort::Quick))
        .collect();
    reduce(input, groups, count)
}
