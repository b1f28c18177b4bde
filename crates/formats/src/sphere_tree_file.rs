//! Sphere trees of meshes as JSON (see `docs/formats.md`).

use std::path::Path;

use backlit_sphere_tree::{Level, SphereTree};
use serde::Serialize;

use crate::{Result, atomic};

#[derive(Serialize)]
struct TreeJson {
    levels: Vec<LevelJson>,
}

#[derive(Serialize)]
struct LevelJson {
    spheres: Vec<SphereJson>,
    error: ErrorJson,
}

#[derive(Serialize)]
struct SphereJson {
    centre: [f64; 3],
    radius: f64,
    parent: Option<usize>,
}

#[derive(Serialize)]
struct ErrorJson {
    outside_greatest: f64,
    outside_mean: f64,
    inside_greatest: f64,
    inside_mean: f64,
    coverage: f64,
}

impl From<&Level> for LevelJson {
    fn from(level: &Level) -> Self {
        let sphere = |sphere: &backlit_sphere_tree::TreeSphere| SphereJson {
            centre: sphere.centre.to_array(),
            radius: sphere.radius,
            parent: sphere.parent,
        };
        let error = &level.error;
        Self {
            spheres: level.spheres.iter().map(sphere).collect(),
            error: ErrorJson {
                outside_greatest: error.outside_greatest,
                outside_mean: error.outside_mean,
                inside_greatest: error.inside_greatest,
                inside_mean: error.inside_mean,
                coverage: error.coverage,
            },
        }
    }
}

/// The content of a tree's file.
#[must_use]
pub fn to_text(tree: &SphereTree) -> String {
    let tree = TreeJson { levels: tree.levels.iter().map(LevelJson::from).collect() };
    #[expect(clippy::expect_used, reason = "a tree has only lists and finite numbers")]
    let text = serde_json::to_string(&tree).expect("a tree can be written as JSON");
    text + "\n"
}

/// Writes a tree's file; see [`atomic`].
pub fn write(path: &Path, tree: &SphereTree) -> Result<()> {
    atomic::write(path, to_text(tree).as_bytes())
}
