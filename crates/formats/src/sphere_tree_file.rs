//! Sphere trees of meshes as JSON (see `docs/formats.md`).

use std::path::Path;

use backlit_sphere_tree::{Level, SphereTree, TreeSphere};
use serde_json::json;

use crate::{Result, atomic};

/// The content of a tree's file.
#[must_use]
pub fn to_text(tree: &SphereTree) -> String {
    let levels: Vec<String> = tree.levels.iter().map(level).collect();
    format!("{{\"levels\":[{}]}}\n", levels.join(","))
}

fn level(level: &Level) -> String {
    let sphere = |sphere: &TreeSphere| {
        let (centre, radius) = (json!(sphere.centre.to_array()), json!(sphere.radius));
        format!("{{\"centre\":{centre},\"radius\":{radius},\"parent\":{}}}", json!(sphere.parent))
    };
    let (spheres, error) = (level.spheres.iter().map(sphere).collect::<Vec<_>>(), &level.error);
    let error = [
        ("outside_greatest", error.outside_greatest),
        ("outside_mean", error.outside_mean),
        ("inside_greatest", error.inside_greatest),
        ("inside_mean", error.inside_mean),
        ("coverage", error.coverage),
    ];
    let error = error.map(|(key, value)| format!("\"{key}\":{}", json!(value)));
    format!("{{\"spheres\":[{}],\"error\":{{{}}}}}", spheres.join(","), error.join(","))
}

/// Writes a tree's file; see [`atomic`].
pub fn write(path: &Path, tree: &SphereTree) -> Result<()> {
    atomic::write(path, to_text(tree).as_bytes())
}
