//! JSON of camera matrices, as scripts around OpenCV write it.
//!
//! `cameras` maps names to `size` [width, height], `K` (3 × 3), `dist` [k1, k2, p1, p2] or [k1, k2, p1, p2, k3],
//! `R` and `t` (`x_camera` = R · `x_world` + t). `K_WIDTHxHEIGHT` is the matrix for scaled pictures. Other keys are
//! notes and not read.

use glam::DVec3;

use backlit_tracking::camera::CameraFromWorld;

use super::partial::{PartialCamera, PartialCameras};
use super::tree::{Field, Tree, Value};
use super::{lens, opencv};
use crate::Result;

/// Whether `cameras` is a map as this reader knows it: `OpenCV`'s own matrices are objects, not lists.
pub(super) fn is_one(cameras: &Tree) -> bool {
    let is_other = |camera: &Tree| camera.get("K").is_none_or(|matrix| matrix.get("data").is_some());
    let entries = cameras.entries();
    matches!(cameras.value, Value::Map(_))
        && (entries.is_empty() || !entries.iter().all(|(_, camera)| is_other(camera)))
}

/// The cameras, with the matrices for pictures of `size` where the file has them.
pub(super) fn parts(root: &Field<'_>, size: Option<[u64; 2]>) -> Result<PartialCameras> {
    let mut parts = PartialCameras::new(None);
    for (name, camera) in root.need(&["cameras"], "a table of cameras")?.children() {
        parts.push(root.path, partial(name, &camera, size)?)?;
    }
    Ok(parts)
}

fn partial(name: &str, camera: &Field<'_>, wanted: Option<[u64; 2]>) -> Result<PartialCamera> {
    const LENS: &str = "[k1, k2, p1, p2] or [k1, k2, p1, p2, k3]";
    const ROWS: &str = "three rows of three numbers";
    let sides = camera.need(&["size"], "[width, height] in pixels")?;
    let mut size = match sides.items().as_slice() {
        [width, height] => [width.pixels()?, height.pixels()?],
        _ => return Err(sides.unexpected("[width, height] in pixels")),
    };
    let mut k = camera.find(&["K"]);
    if let Some(wanted) = wanted
        && let Some(scaled) = camera.find(&[&format!("K_{}x{}", wanted[0], wanted[1])])
    {
        (size, k) = (wanted, Some(scaled));
    }
    let k = k.ok_or_else(|| camera.missing("K", ROWS))?;
    let lens = camera.need(&["dist"], LENS)?;
    let translation = camera.need(&["t"], "three numbers")?;
    let rotation = camera.need(&["R"], ROWS)?;
    for matrix in [&k, &rotation] {
        let rows = matrix.items();
        if rows.len() != 3 || rows.iter().any(|row| row.items().len() != 3) {
            return Err(matrix.unexpected(ROWS));
        }
    }
    let count = lens.numbers()?.len();
    if !(4..=5).contains(&count) {
        return Err(lens.error(&format!("{count} numbers"), LENS));
    }
    Ok(PartialCamera {
        size: Some(size),
        lens: Some((opencv::pinhole(&k)?, lens::opencv(&lens)?)),
        place: Some(CameraFromWorld {
            rotation: rotation.matrix()?,
            translation: DVec3::from_array(translation.array()?),
        }),
        ..PartialCamera::new(name, camera.node.line)
    })
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use backlit_tracking::camera::Camera;
    use glam::DVec3;

    use super::super::{CalibrationOptions, parse as parse_any};
    use crate::damaged::assert_refused;

    const GOOD: &str = r#"{"note": "by hand", "cameras": {
        "right": {"size": [1088, 1920],
            "K": [[1680.0, 0, 536.0], [0, 1681.0, 955.0], [0, 0, 1]],
            "K_272x480": [[420.5, 0, 134.0], [0, 420.75, 239.0], [0, 0, 1]],
            "dist": [-0.05, 0.14, 0.001, 0.002],
            "R": [[0, 1, 0], [0, 0, -1], [-1, 0, 0]],
            "t": [1, 2, 3]},
        "left": {"size": [1088, 1920], "K": [[1680.0, 0, 536.0], [0, 1681.0, 955.0], [0, 0, 1]],
            "dist": [0, 0, 0, 0, 0], "R": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "t": [0, 0, 4]}}}"#;

    fn options(size: Option<[u64; 2]>) -> CalibrationOptions {
        CalibrationOptions { size, ..CalibrationOptions::default() }
    }

    #[test]
    fn the_matrix_of_the_size_is_taken_else_scaled() {
        let path = Path::new("c.json");
        let rig = parse_any(path, GOOD.as_bytes(), options(None)).unwrap();
        let names: Vec<&str> = rig.cameras().iter().map(Camera::name).collect();
        assert_eq!(names, ["right", "left"], "the file's order");
        assert_eq!(rig.cameras()[0].width(), 1088);
        assert_eq!(rig.cameras()[0].camera_from_world().transform(DVec3::Z), DVec3::new(1.0, 1.0, 3.0));
        assert!(rig.cameras()[1].distortion().is_none());

        let rig = parse_any(path, GOOD.as_bytes(), options(Some([272, 480]))).unwrap();
        assert_eq!(rig.cameras()[0].intrinsics().fx, 420.5);
        assert_eq!(rig.cameras()[1].intrinsics().fx, 420.0);
        assert_eq!(rig.cameras()[1].intrinsics().cx, 536.5 / 4.0 - 0.5);

        let millimetres = CalibrationOptions { metres_per_unit: 0.001, ..options(None) };
        let rig = parse_any(path, GOOD.as_bytes(), millimetres).unwrap();
        assert!((rig.cameras()[1].camera_from_world().translation.z - 0.004).abs() < 1e-15);
    }

    #[test]
    fn errors_name_line_camera_and_field() {
        assert_refused(
            GOOD,
            |text| parse_any(Path::new("c.json"), text.as_bytes(), options(None)),
            r#"
            "t": [1, 2, 3] ⇒ "t": [1, 2] ⇒ line 7: `cameras.right.t` is 2 numbers; expected 3
            "t": [1, 2, 3] ⇒ "x": 1 ⇒ line 2: `cameras.right.t` is missing
            536.0 ⇒ "a" ⇒ line 3: `cameras.right.K[0][2]` is "a"; expected a finite number
            "K": [[1680.0, 0, ⇒ "K": [[1680.0, 1, ⇒ line 3: `cameras.right.K` is another matrix; expected [[fx
            [0, 1, 0] ⇒ [0, 2, 0] ⇒ line 2: camera "right": `rotation` is not a rotation
            [1088, 1920] ⇒ [-1, 1920] ⇒ line 2: `cameras.right.size[0]` is -1; expected a whole number
            -0.05 ⇒ NaN ⇒ line 5: is not valid JSON: in `cameras.right.dist[0]`: NaN
            "left" ⇒ "right" ⇒ `right` is given twice
            {} ⇒ `cameras` is missing; expected a table of cameras
            "#,
        );
    }
}
