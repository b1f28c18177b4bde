//! Caliscope's `camera_array.toml`: `[cameras.0]`, in older releases `[cam_0]` with `port`.
//!
//! `size` [width, height], `matrix`, `distortions`, `rotation` (a matrix in older files, a vector in newer ones),
//! `translation` in metres; camera from world, pixel centres at integers. `rotation_count` turns pictures for showing
//! only. A camera that could not be linked to the others has no place and is left out.

use super::opencv;
use super::partial::PartialCameras;
use super::tree::{Field, Tree, Value};
use crate::{FileError, FileProblem, Result};

/// Whether the tables are Caliscope's: of older releases only the port tells.
pub(super) fn is_one(node: &Tree) -> bool {
    let is_array = |node: &Tree| {
        node.entries().iter().any(|(_, table)| {
            let has = |key: &str| table.get(key).is_some();
            has("size") && (has("cam_id") || has("port")) && (has("rotation_count") || has("matrix"))
        })
    };
    node.get("cameras").is_some_and(is_array) || is_array(node)
}

/// Whether nothing stands under a key, or a word for nothing: TOML has none of its own.
fn is_unknown(table: &Field<'_>, key: &str) -> bool {
    let Some(found) = table.find(&[key]) else { return true };
    match &found.node.value {
        Value::Text(word) => ["", "null", "None", "nan"].contains(&word.as_str()),
        Value::Plain(word) => word == "nan",
        Value::List(items) => {
            items.iter().all(|item| matches!(&item.value, Value::Plain(word) if word == "nan"))
        }
        Value::Null => true,
        Value::Map(_) => false,
    }
}

pub(super) fn parts(root: &Field<'_>) -> Result<PartialCameras> {
    let cameras = root.find(&["cameras"]).unwrap_or_else(|| root.clone());
    let mut parts = PartialCameras::new(Some(1.0));
    for (key, table) in cameras.children() {
        if table.find(&["size"]).is_none() {
            continue;
        }
        let name = match table.find(&["cam_id", "port"]) {
            Some(name) => name.text()?,
            None => key,
        };
        if table.flag(&["ignore"]) {
            parts.leave_out(name, "the file says that it is to be ignored");
        } else if table.find(&["matrix"]).is_none() {
            parts.leave_out(name, "its lens is not calibrated");
        } else {
            table.need(&["distortions"], "the lens's coefficients")?;
            let has_place = !["rotation", "translation"].iter().any(|key| is_unknown(&table, key));
            let camera = if has_place { opencv::camera } else { opencv::without_place };
            parts.push(root.path, camera(&table, name)?)?;
        }
    }
    if parts.cameras.is_empty() && parts.left_out.is_empty() {
        return Err(FileError::new(root.path, FileProblem::UnknownCalibration));
    }
    Ok(parts)
}
