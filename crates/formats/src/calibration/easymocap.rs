//! `EasyMocap`: `intri.yml` and `extri.yml`, two `FileStorage`s with the cameras' names in the keys.
//!
//! `K_NAME` and `dist_NAME` (k1 k2 p1 p2 k3); `R_NAME` is a rotation vector and `Rot_NAME` the matrix; `T_NAME`. Camera
//! from world, by habit in metres. The size stands in `H_NAME` and `W_NAME`, and often nowhere. The files may list
//! different cameras.

use glam::DVec3;

use backlit_tracking::camera::{CameraFromWorld, Distortion};

use super::partial::{PartialCamera, PartialCameras};
use super::tree::Field;
use super::{MAX_CAMERAS, lens, opencv};
use crate::Result;

const PREFIXES: [&str; 3] = ["K_", "Rot_", "R_"];

/// Whether keys have the cameras' names in them.
pub(super) fn is_one(root: &Field<'_>) -> bool {
    let named = |prefix: &str| root.children().any(|(key, _)| key.starts_with(prefix));
    named("K_") || (named("Rot_") || named("R_")) && named("T_")
}

pub(super) fn parts(root: &Field<'_>) -> Result<PartialCameras> {
    let mut names: Vec<&str> = Vec::new();
    for name in root.find(&["names"]).map(|names| names.items()).unwrap_or_default() {
        names.push(match name.node.value {
            super::tree::Value::Plain(ref text) | super::tree::Value::Text(ref text) => text,
            _ => return Err(name.unexpected("a camera's name")),
        });
    }
    if names.is_empty() {
        for (key, _) in root.children() {
            let name = PREFIXES.iter().find_map(|prefix| key.strip_prefix(prefix));
            names.extend(name.filter(|name| !names.contains(name)));
            // One more than can be read: that is found out below.
            if names.len() > MAX_CAMERAS {
                break;
            }
        }
    }
    let mut parts = PartialCameras::new(None);
    for name in names {
        let find = |prefix: &str| root.find(&[&format!("{prefix}_{name}")]);
        let need = |prefix: &str, expected| root.need(&[&format!("{prefix}_{name}")], expected);
        let mut part = PartialCamera::new(name, root.node.line);
        if let Some(matrix) = find("K") {
            part.line = matrix.node.line;
            let distortion = find("dist").map_or(Ok(Distortion::None), |found| lens::opencv(&found))?;
            part.lens = Some((opencv::pinhole(&matrix)?, distortion));
        }
        if let (Some(width), Some(height)) = (find("W"), find("H")) {
            part.size = Some([width.pixels()?, height.pixels()?]);
        }
        // The matrix first: the vector has fewer digits in some files.
        let rotation = match (find("Rot"), find("R")) {
            (Some(matrix), _) => Some(matrix.matrix()?),
            (None, Some(vector)) => Some(vector.rotation()?),
            (None, None) => None,
        };
        if let Some(rotation) = rotation {
            let translation = DVec3::from_array(need("T", "three numbers")?.array()?);
            part.place = Some(CameraFromWorld { rotation, translation });
        }
        if part.lens.is_none() && part.place.is_none() {
            need("K", "of each of `names` K, or Rot and T")?;
        }
        parts.push(root.path, part)?;
    }
    Ok(parts)
}
