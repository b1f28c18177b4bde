//! Nested spheres of real shapes: a closed triangle mesh becomes levels of spheres that cover its surface, coarsest first.
//!
//! After G. Bradshaw and C. O'Sullivan, "Adaptive medial-axis approximation for sphere-tree construction", ACM Transactions on
//! Graphics 23(1), 2004. It knows nothing of people.
//!
//! ```
//! use backlit_sphere_tree::{SphereTree, TreeOptions, isosurface};
//! use glam::DVec3;
//!
//! let egg = |p: DVec3| (p * DVec3::new(1.0, 1.0, 0.6)).length() - 0.5;
//! let mesh = isosurface([DVec3::splat(-1.0), DVec3::splat(1.0)], 0.1, egg)?;
//! let tree = SphereTree::build(&mesh, &TreeOptions { spheres: 8, levels: 2 })?;
//! assert!(tree.levels[1].spheres.len() <= 8);
//! assert!(tree.levels[1].error.outside_greatest < tree.levels[0].error.outside_greatest);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | module | holds |
//! |---|---|
//! | `mesh` | closed meshes, and why triangles are none |
//! | `isosurface` | closed meshes of functions |
//! | `surface` | signed distances to a mesh |
//! | `pieces` | what of the surface is covered as one |
//! | `medial` | balls of the medial axis, adaptively sampled |
//! | `ball` | the sphere about a part of the surface that stands out least |
//! | `groups`, `reduce` | merge, burst, share out again |
//! | `measure` | errors and their bounds |
//! | `tree` | levels, options, guarantees |
//!
//! How a tree differs from the published one: it is built from the leaves up, so that what of the surface a sphere covers its parent
//! covers as well; whole small triangles are covered, not points; and spheres are moved and pieces shared out again after merging
//! and bursting.

mod ball;
mod groups;
mod isosurface;
mod measure;
mod medial;
mod mesh;
mod pieces;
mod reduce;
mod surface;
mod tree;

pub use isosurface::isosurface;
pub use mesh::{ClosedMesh, MAX_ELEMENTS, MeshError};
pub use surface::{MeshSurface, Nearest};
pub use tree::{
    Level, LevelError, MAX_LEVELS, MAX_SPHERES, OptionsError, SphereTree, TreeOptions, TreeSphere,
};
