//! `OpenCV`: `FileStorage` as YAML, XML or JSON, and JSON with the same keys written by hand.
//!
//! No key is fixed, so the usual spellings are known: of `calibration.cpp` before and after 2.4.10, `stereo_calib.cpp`
//! (M1 D1 M2 D2 and R T: camera 2 from camera 1, which is the world), and of scripts. A file holds one camera, a map or
//! a list of them, or a stereo pair; of `OpenPose` one camera, named after the file. Left unread are `extrinsic_parameters`, the board's places, and R1 R2 P1 P2 Q,
//! which belong to rectified pictures. Camera from world; the unit of length is not said; pixel centres at integers.

use std::path::Path;

use backlit_tracking::camera::{CameraFromWorld, Distortion, Intrinsics};
use glam::{DMat3, DVec3};

use super::partial::{PartialCamera, PartialCameras, Pinhole};
use super::tree::{Field, Value};
use super::{easymocap, lens, stem};
use crate::{FileError, FileProblem, Result};

/// Words between spaces.
const MATRIX: &str = "camera_matrix Camera_Matrix cameraMatrix CameraMatrix K intrinsic_matrix intrinsics intrinsic mtx matrix M \
    intrinsicMat";
const LENS: &str = "distortion_coefficients Distortion_Coefficients distortion_coeffs distortion_params dist_coeffs distCoeffs \
    dist_coeff distortions distortion dist D d DistCoeffs DistortionCoeffs Distortion";
const WIDTH: [&str; 4] = ["image_width", "image_Width", "width", "w"];
const HEIGHT: [&str; 4] = ["image_height", "image_Height", "height", "h"];
const SIZE: [&str; 5] = ["image_size", "imageSize", "size", "resolution", "img_size"];
const ROTATION: [&str; 9] =
    ["R", "rotation", "rotation_matrix", "rvec", "Rot", "rotation_vector", "RotationValues", "RVec", "RVecs"];
const TRANSLATION: [&str; 9] =
    ["t", "T", "tvec", "translation", "translation_vector", "trans", "TranslationValues", "TVec", "TVecs"];
/// What `OpenPose` calls the matrix of the lens; its `CameraMatrix` is the place, three rows [R t].
const OPENPOSE: [&str; 1] = ["Intrinsics"];
const FISHEYE: [&str; 3] = ["fisheye_model", "fisheye", "is_fisheye"];
const FIRST: [[&str; 4]; 2] =
    [["M1", "K1", "cameraMatrix1", "camera_matrix_1"], ["M2", "K2", "cameraMatrix2", "camera_matrix_2"]];
const FIRST_LENS: [[&str; 4]; 2] =
    [["D1", "dist1", "distCoeffs1", "dist_coeffs_1"], ["D2", "dist2", "distCoeffs2", "dist_coeffs_2"]];

/// What a tree with such keys says of cameras.
pub(super) fn parts(root: &Field<'_>) -> Result<PartialCameras> {
    if easymocap::is_one(root) {
        return easymocap::parts(root);
    }
    let mut parts = PartialCameras::new(None);
    let pose = root.find(&ROTATION).zip(root.find(&TRANSLATION));
    if root.find(&FIRST[0]).is_some() && root.find(&FIRST[1]).is_some() {
        for index in 0..2 {
            let mut part = PartialCamera::new(["1", "2"][index], root.node.line);
            part.size = size(root)?;
            let matrix = root.need(&FIRST[index], "a 3 × 3 matrix")?;
            part.lens = Some((pinhole(&matrix)?, coefficients(root, &FIRST_LENS[index])?));
            part.place = pose.is_some().then(|| stereo_place(root, index)).transpose()?;
            parts.push(root.path, part)?;
        }
    } else if is_camera(root) {
        parts.push(root.path, camera(root, &name_of(root, &file_name(root.path)))?)?;
    } else if pose.is_some() {
        for index in 0..2 {
            let mut part = PartialCamera::new(["1", "2"][index], root.node.line);
            part.place = Some(stereo_place(root, index)?);
            parts.push(root.path, part)?;
        }
    } else {
        let inner = root.find(&["cameras", "Cameras"]).unwrap_or_else(|| root.clone());
        for item in inner.items() {
            let name = name_of(&item, &format!("{}", parts.cameras.len()));
            parts.push(root.path, camera(&item, &name)?)?;
        }
        for (key, child) in inner.children().filter(|(_, child)| is_camera(child)) {
            parts.push(root.path, camera(&child, &name_of(&child, key))?)?;
        }
    }
    if parts.cameras.is_empty() {
        return Err(FileError::new(root.path, FileProblem::UnknownCalibration));
    }
    Ok(parts)
}

/// The name of a file; of a `config.xml`, which lies in a folder for each camera, the folder's.
fn file_name(path: &Path) -> String {
    let folder = path.parent().and_then(Path::file_name);
    match (stem(path).as_str(), folder) {
        ("config", Some(folder)) => folder.to_string_lossy().into_owned(),
        (stem, _) => stem.to_owned(),
    }
}

fn matrix_of<'a>(field: &Field<'a>) -> Option<Field<'a>> {
    let openpose = field.find(&OPENPOSE);
    openpose.or_else(|| field.find(&MATRIX.split(' ').collect::<Vec<_>>()))
}

fn is_camera(field: &Field<'_>) -> bool {
    matrix_of(field).is_some() || field.find(&["fx"]).is_some()
}

/// The camera's own name, else what it stands under.
fn name_of(field: &Field<'_>, otherwise: &str) -> String {
    let named = field.find(&["camera_name", "name", "cam_id", "port", "serial"]);
    match named.map(|name| name.text()) {
        Some(Ok(name)) if !name.trim().is_empty() => name.to_owned(),
        _ => otherwise.to_owned(),
    }
}

/// One camera with its keys in a map.
pub(super) fn camera(field: &Field<'_>, name: &str) -> Result<PartialCamera> {
    Ok(PartialCamera { place: place(field)?, ..without_place(field, name)? })
}

/// The same, wherever it stands.
pub(super) fn without_place(field: &Field<'_>, name: &str) -> Result<PartialCamera> {
    let mut part = PartialCamera::new(name, field.node.line);
    part.size = size(field)?;
    part.lens = Some(match matrix_of(field) {
        Some(matrix) => (pinhole(&matrix)?, coefficients(field, &LENS.split(' ').collect::<Vec<_>>())?),
        None => flat(field)?,
    });
    Ok(part)
}

/// Where the camera stands, if both numbers are there.
pub(super) fn place(field: &Field<'_>) -> Result<Option<CameraFromWorld>> {
    if field.find(&OPENPOSE).is_some() {
        let Some(matrix) = field.find(&["CameraMatrix"]) else { return Ok(None) };
        let [a, b, c, x, d, e, f, y, g, h, i, z] = matrix.array()?;
        let rotation = DMat3::from_cols_array(&[a, d, g, b, e, h, c, f, i]);
        return Ok(Some(CameraFromWorld { rotation, translation: DVec3::new(x, y, z) }));
    }
    let (rotation, translation) = match (field.find(&ROTATION), field.find(&TRANSLATION)) {
        (None, None) => return Ok(None),
        (Some(rotation), None) if rotation.numbers().is_ok_and(|numbers| numbers.is_empty()) => {
            return Ok(None);
        }
        (None, Some(_)) => {
            return Err(field.missing("rotation", "beside the translation a rotation"));
        }
        (Some(rotation), _) => (rotation, field.need(&TRANSLATION, "three numbers")?),
    };
    let rotation = rotation.rotation()?;
    Ok(Some(CameraFromWorld { rotation, translation: DVec3::from_array(translation.array()?) }))
}

/// Of a stereo pair the first camera is the world.
fn stereo_place(root: &Field<'_>, index: usize) -> Result<CameraFromWorld> {
    if index == 0 {
        return Ok(CameraFromWorld { rotation: DMat3::IDENTITY, translation: DVec3::ZERO });
    }
    let rotation = root.need(&ROTATION, "a 3 × 3 matrix")?.rotation()?;
    let translation = DVec3::from_array(root.need(&TRANSLATION, "three numbers")?.array()?);
    Ok(CameraFromWorld { rotation, translation })
}

/// The pinhole of a camera matrix.
pub(super) fn pinhole(field: &Field<'_>) -> Result<Pinhole> {
    let matrix = field.matrix()?;
    let intrinsics =
        Intrinsics { fx: matrix.x_axis.x, fy: matrix.y_axis.y, cx: matrix.z_axis.x, cy: matrix.z_axis.y };
    let rest = [matrix.x_axis.y, matrix.x_axis.z, matrix.y_axis.x, matrix.y_axis.z, matrix.z_axis.z - 1.0];
    if rest != [0.0; 5] {
        return Err(field.error("another matrix", "[[fx, 0, cx], [0, fy, cy], [0, 0, 1]]"));
    }
    Ok(Pinhole::Pixels(intrinsics))
}

fn coefficients(field: &Field<'_>, keys: &[&str]) -> Result<Distortion> {
    match field.find(keys) {
        None if field.flag(&FISHEYE) => Err(field.missing(keys[0], "the four coefficients of a fisheye")),
        None => Ok(Distortion::None),
        Some(found) if field.flag(&FISHEYE) => lens::fisheye(&found),
        Some(found) => lens::opencv(&found),
    }
}

/// `fx`, `fy`, `cx`, `cy` and coefficients by their names.
fn flat(field: &Field<'_>) -> Result<(Pinhole, Distortion)> {
    let number = |key| field.need(&[key], "a number")?.number();
    let intrinsics =
        Intrinsics { fx: number("fx")?, fy: number("fy")?, cx: number("cx")?, cy: number("cy")? };
    Ok((Pinhole::Pixels(intrinsics), named_lens(field, field.flag(&FISHEYE))?))
}

/// The lens of coefficients that have names; those left out are 0.
pub(super) fn named_lens(field: &Field<'_>, is_fisheye: bool) -> Result<Distortion> {
    let lens = |key| field.find(&[key]).map_or(Ok(0.0), |value| value.number());
    if is_fisheye {
        return Ok(Distortion::Fisheye {
            k1: lens("k1")?,
            k2: lens("k2")?,
            k3: lens("k3")?,
            k4: lens("k4")?,
        });
    }
    let mut numbers = [0.0; 8];
    for (number, key) in numbers.iter_mut().zip(["k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"]) {
        *number = lens(key)?;
    }
    lens::opencv_lens(&numbers).ok_or_else(|| field.unexpected("coefficients of OpenCV"))
}

/// The pictures' size: two keys, or [width, height], or the [height, width, channels] of an array.
pub(super) fn size(field: &Field<'_>) -> Result<Option<[u64; 2]>> {
    if let (Some(width), Some(height)) = (field.find(&WIDTH), field.find(&HEIGHT)) {
        return Ok(Some([width.pixels()?, height.pixels()?]));
    }
    let Some(both) = field.find(&SIZE) else { return Ok(None) };
    let sides = match &both.node.value {
        Value::Map(_) if both.find(&["data"]).is_none() => return size(&both),
        _ => both.numbers()?,
    };
    let side = |side: f64| {
        let is_whole = side >= 0.0 && side.fract() == 0.0 && side <= f64::from(u32::MAX);
        if is_whole {
            Ok(side as u64)
        } else {
            Err(both.error(&side.to_string(), "a whole number of pixels"))
        }
    };
    match *sides.as_slice() {
        [width, height] => Ok(Some([side(width)?, side(height)?])),
        [height, width, _channels] => Ok(Some([side(width)?, side(height)?])),
        _ => Err(both.other_count(sides.len(), "[width, height]")),
    }
}
