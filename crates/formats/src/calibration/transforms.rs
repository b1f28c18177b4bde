//! `transforms.json` of `NeRF`, instant-ngp and nerfstudio: a camera a picture.
//!
//! `transform_matrix` is the world from the camera, with OpenGL's axes: x right, y up, z backwards. Pixel centres are at
//! halves: cx and cy are half a pixel more than ours. Lengths have no known unit. Focal lengths stand as `fl_x`,
//! `fl_y`, or as the picture's angle `camera_angle_x`; what a frame has of its own goes before what all share. A
//! camera's name is its `file_path`.

use backlit_tracking::camera::{CameraFromWorld, Distortion, Intrinsics};
use glam::{DMat3, DVec3};

use super::opencv::{named_lens, size};
use super::partial::{PartialCamera, PartialCameras, Pinhole};
use super::tree::{Field, Tree};
use crate::Result;

pub(super) fn is_one(node: &Tree) -> bool {
    node.get("frames").is_some()
}

pub(super) fn parts(root: &Field<'_>) -> Result<PartialCameras> {
    let mut parts = PartialCameras::new(None);
    for frame in root.need(&["frames"], "a list of frames")?.items() {
        let name = frame.need(&["file_path"], "the picture's path")?.text()?;
        let mut part = PartialCamera::new(name, frame.node.line);
        part.size = size(&frame)?.or(size(root)?);
        part.lens = Some((pinhole(root, &frame, part.size)?, distortion(root, &frame)?));
        part.place = Some(place(&frame)?);
        parts.push(root.path, part)?;
    }
    Ok(parts)
}

/// The frame's own value, else that of all.
fn either<'a>(root: &Field<'a>, frame: &Field<'a>, key: &str) -> Result<Option<f64>> {
    frame.find(&[key]).or_else(|| root.find(&[key])).map(|field| field.number()).transpose()
}

fn pinhole(root: &Field<'_>, frame: &Field<'_>, size: Option<[u64; 2]>) -> Result<Pinhole> {
    let number = |key| either(root, frame, key);
    let half = |key| -> Result<Option<f64>> {
        let Some(angle) = number(key)? else { return Ok(None) };
        if !(angle > 0.0 && angle < std::f64::consts::PI) {
            let field = frame.find(&[key]).or_else(|| root.find(&[key])).unwrap_or_else(|| root.clone());
            return Err(field.unexpected("an angle between 0 and π"));
        }
        Ok(Some((0.5 * angle).tan()))
    };
    let (fl_x, fl_y) = (number("fl_x")?, number("fl_y")?);
    let (half_x, half_y) = (half("camera_angle_x")?, half("camera_angle_y")?);
    let (centre_x, centre_y) = (number("cx")?, number("cy")?);
    let no_focal = || root.missing("fl_x", "a focal length in pixels, or the angle `camera_angle_x`");
    let Some([width, height]) = size.map(|sides| sides.map(|side| side as f64)) else {
        // Without the size an angle is all that can be taken, or pixel numbers that are all there.
        return match (fl_x.or(fl_y), half_x, half_y, centre_x.zip(centre_y)) {
            (Some(any), _, _, Some((cx, cy))) => {
                let (fx, fy) = (fl_x.unwrap_or(any), fl_y.unwrap_or(any));
                Ok(Pinhole::Pixels(Intrinsics { fx, fy, cx: cx - 0.5, cy: cy - 0.5 }))
            }
            (None, Some(x), Some(y), None) => Ok(Pinhole::HalfWidths([x, y])),
            (None, Some(x), None, None) => Ok(Pinhole::HalfWidth(x)),
            (None, None, _, _) => Err(no_focal()),
            _ => Err(root.missing("w", "the pictures' width and height")),
        };
    };
    let fx = fl_x.or_else(|| half_x.map(|half| width / 2.0 / half));
    let fy = fl_y.or_else(|| half_y.map(|half| height / 2.0 / half));
    let any = fx.or(fy).ok_or_else(no_focal)?;
    Ok(Pinhole::Pixels(Intrinsics {
        fx: fx.unwrap_or(any),
        fy: fy.unwrap_or(any),
        cx: centre_x.unwrap_or(width / 2.0) - 0.5,
        cy: centre_y.unwrap_or(height / 2.0) - 0.5,
    }))
}

fn distortion(root: &Field<'_>, frame: &Field<'_>) -> Result<Distortion> {
    let model = frame.find(&["camera_model"]).or_else(|| root.find(&["camera_model"]));
    let is_fisheye = match &model {
        None => root.flag(&["is_fisheye"]),
        Some(model) => match model.text()? {
            "OPENCV" | "PINHOLE" | "SIMPLE_PINHOLE" | "RADIAL" | "SIMPLE_RADIAL" | "FULL_OPENCV" => false,
            "OPENCV_FISHEYE" => true,
            _ => return Err(model.unexpected("OPENCV, PINHOLE or OPENCV_FISHEYE")),
        },
    };
    let own = ["k1", "k2", "p1", "p2"].iter().any(|key| frame.find(&[key]).is_some());
    named_lens(if own { frame } else { root }, is_fisheye)
}

fn place(frame: &Field<'_>) -> Result<CameraFromWorld> {
    let matrix = frame.need(&["transform_matrix"], "4 × 4 numbers")?;
    let numbers = matrix.numbers()?;
    if numbers.len() != 16 && numbers.len() != 12 {
        return Err(matrix.other_count(numbers.len(), "4 × 4 numbers"));
    }
    let column = |index: usize| DVec3::new(numbers[index], numbers[4 + index], numbers[8 + index]);
    let world_from_camera = DMat3::from_cols(column(0), -column(1), -column(2));
    if (world_from_camera.determinant() - 1.0).abs() > 1e-2 {
        return Err(matrix.error("a matrix that mirrors or stretches", "a rotation and a place"));
    }
    let rotation = world_from_camera.inverse();
    Ok(CameraFromWorld { rotation, translation: -(rotation * column(3)) })
}
