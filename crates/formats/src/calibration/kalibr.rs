//! Kalibr's `camchain.yaml`.
//!
//! `T_cn_cnm1` is the camera from the one before it: the products along the chain are camera from world, and the first
//! camera is the world. Metres; pixel centres at integers. `radtan` is k1 k2 p1 p2 of `OpenCV`, `equidistant` its
//! fisheye. `T_cam_imu` is not read. Other cameras than `pinhole`, such as `omni` with xi before fx, are left out.

use backlit_tracking::camera::{CameraFromWorld, Distortion, Intrinsics};
use glam::{DMat3, DVec3};

use super::lens;
use super::opencv::size;
use super::partial::{PartialCamera, PartialCameras, Pinhole};
use super::tree::{Field, Tree};
use crate::Result;

/// Whether a table has Kalibr's `camera_model` and `intrinsics`.
pub(super) fn is_one(node: &Tree) -> bool {
    node.entries()
        .iter()
        .any(|(_, table)| table.get("camera_model").is_some() && table.get("intrinsics").is_some())
}

pub(super) fn parts(root: &Field<'_>) -> Result<PartialCameras> {
    let mut parts = PartialCameras::new(Some(1.0));
    let mut place = CameraFromWorld { rotation: DMat3::IDENTITY, translation: DVec3::ZERO };
    for (index, (name, table)) in root.children().enumerate() {
        if index > 0 {
            let step =
                table.need(&["T_cn_cnm1"], "the camera from the one before it, 4 × 4")?.array::<16>()?;
            let [a, b, c] = [0, 4, 8].map(|row| DVec3::from_slice(&step[row..row + 3]));
            let turn = DMat3::from_cols(a, b, c).transpose();
            place = CameraFromWorld {
                rotation: turn * place.rotation,
                translation: turn * place.translation + DVec3::new(step[3], step[7], step[11]),
            };
        }
        let model = table.need(&["camera_model"], "pinhole")?.text()?;
        if model != "pinhole" {
            parts.leave_out(name, &format!("its `camera_model` is {model}; only pinhole can be used"));
            continue;
        }
        let mut part = PartialCamera::new(name, table.node.line);
        let [fx, fy, cx, cy] = table.need(&["intrinsics"], "[fx, fy, cx, cy]")?.array()?;
        let Some(distortion) = distortion(&table)? else {
            parts.leave_out(name, "its `distortion_model` is none of radtan, equidistant and none");
            continue;
        };
        part.lens = Some((Pinhole::Pixels(Intrinsics { fx, fy, cx, cy }), distortion));
        part.size = size(&table)?;
        part.place = Some(place);
        parts.push(root.path, part)?;
    }
    Ok(parts)
}

fn distortion(table: &Field<'_>) -> Result<Option<Distortion>> {
    let model = table.need(&["distortion_model"], "radtan, equidistant or none")?.text()?;
    let coefficients = || table.need(&["distortion_coeffs"], "four coefficients");
    Ok(Some(match model {
        "none" => Distortion::None,
        "radtan" | "plumb_bob" => lens::opencv(&coefficients()?)?,
        "equidistant" | "equi" => lens::fisheye(&coefficients()?)?,
        _ => return Ok(None),
    }))
}
