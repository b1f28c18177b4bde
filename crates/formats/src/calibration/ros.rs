//! ROS `camera_info` YAML: one camera's lens, as `camera_calibration` saves it or `rostopic echo` prints it.
//!
//! `camera_matrix` (K) is of the picture as it is taken. `rectification_matrix` (R) is no place and
//! `projection_matrix` (P) is of the rectified picture: neither is read. `plumb_bob` and `rational_polynomial` are
//! `OpenCV`'s lenses, `equidistant` its fisheye. Pixel centres at integers.

use backlit_tracking::camera::Distortion;

use super::partial::{PartialCamera, PartialCameras};
use super::tree::{Field, Tree};
use super::{lens, opencv, stem};
use crate::Result;

pub(super) fn is_one(node: &Tree) -> bool {
    node.get("distortion_model").is_some()
}

pub(super) fn parts(root: &Field<'_>) -> Result<PartialCameras> {
    let header = root.find(&["header"]).and_then(|header| header.find(&["frame_id"]));
    let name = match root.find(&["camera_name"]).or(header) {
        Some(name) => name.text()?.to_owned(),
        None => stem(root.path),
    };
    let mut part = PartialCamera::new(&name, root.node.line);
    part.size = opencv::size(root)?;
    let matrix = root.need(&["camera_matrix", "K", "k"], "a 3 × 3 matrix")?;
    let model = root.need(&["distortion_model"], "the name of a model")?;
    let coefficients = || root.need(&["distortion_coefficients", "D", "d"], "the lens's coefficients");
    let distortion = match model.text()? {
        "plumb_bob" | "rational_polynomial" => lens::opencv(&coefficients()?)?,
        "equidistant" | "fisheye" => lens::fisheye(&coefficients()?)?,
        "none" | "" => Distortion::None,
        _ => return Err(model.unexpected("plumb_bob, rational_polynomial or equidistant")),
    };
    part.lens = Some((opencv::pinhole(&matrix)?, distortion));
    let mut parts = PartialCameras::new(None);
    parts.push(root.path, part)?;
    Ok(parts)
}
