//! TOML with one table a camera: Anipose, and `Pose2Sim` and `FreeMoCap` after it.
//!
//! `name`, `size` [width, height] (`Pose2Sim` may write 1088.0), `matrix`, `distortions`, `rotation` (a vector),
//! `translation`, `fisheye`; camera from world, pixel centres at integers. The name is the key, not the table's.
//! `Pose2Sim` writes metres and four coefficients. Anipose's unit is that of its board, which the file does not say.
//! `FreeMoCap`'s is the millimetre, told by the board's square in `metadata.charuco_square_size`; where that is 1 it
//! is the square.

use super::opencv;
use super::partial::PartialCameras;
use super::tree::Field;
use crate::{FileError, FileProblem, Result};

/// Metres in a millimetre.
const MILLIMETRE: f64 = 0.001;

pub(super) fn parts(root: &Field<'_>) -> Result<PartialCameras> {
    let mut parts = PartialCameras::new(metres_per_unit(root)?);
    for (key, table) in root.children() {
        if key == "metadata" || table.node.entries().is_empty() {
            continue;
        }
        if table.find(&["matrix"]).is_none() && table.find(&["size", "translation"]).is_none() {
            continue;
        }
        table.need(&["matrix"], "a 3 × 3 matrix")?;
        table.need(&["distortions"], "the lens's coefficients")?;
        let name = match table.find(&["name"]) {
            Some(name) => name.text()?,
            None => key,
        };
        parts.push(root.path, opencv::camera(&table, name)?)?;
    }
    if parts.cameras.is_empty() {
        return Err(FileError::new(root.path, FileProblem::UnknownCalibration));
    }
    Ok(parts)
}

fn metres_per_unit(root: &Field<'_>) -> Result<Option<f64>> {
    let square = root.find(&["metadata"]).and_then(|metadata| metadata.find(&["charuco_square_size"]));
    let Some(square) = square else { return Ok(None) };
    Ok((square.number()? != 1.0).then_some(MILLIMETRE))
}
