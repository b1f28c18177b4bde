//! JSON of camera matrices, as scripts around OpenCV write it.
//!
//! `cameras` maps names to `size` [width, height], `K` (3 × 3), `dist` [k1, k2, p1, p2] or [k1, k2, p1, p2, k3],
//! `R` and `t` (`x_camera` = R · `x_world` + t). `K_WIDTHxHEIGHT` is the matrix for scaled pictures. Other keys are
//! notes and not read.

use std::path::Path;

use backlit_tracking::camera::{Camera, CameraFromWorld, Distortion, Intrinsics, Rig};
use glam::{DMat3, DVec3};
use serde::Deserialize;
use serde_json::Value;

use super::node::{Node, Value as Tree};
use super::{CalibrationOptions, rig};
use crate::json_text::{self, Entries};
use crate::{FileError, FileProblem, plain_words};

#[derive(Deserialize)]
struct RigSpec {
    cameras: Entries<Entries<Value>>,
}

/// Whether `cameras` is a map as this reader knows it: `OpenCV`'s own matrices are objects, not lists.
pub(super) fn is_one(cameras: &Node) -> bool {
    let is_other = |camera: &Node| camera.get("K").is_none_or(|matrix| matrix.get("data").is_some());
    let entries = cameras.entries();
    matches!(cameras.value, Tree::Map(_))
        && (entries.is_empty() || !entries.iter().all(|(_, camera)| is_other(camera)))
}

/// Parses the content of such a file; `path` is for the error's message.
///
/// # Errors
/// Not such a file, or not valid cameras. The error names the line, the camera and the field.
pub fn parse(path: &Path, text: &str, options: CalibrationOptions) -> Result<Rig, FileError> {
    let spec: RigSpec = json_text::parse(path, text)?;
    let mut cameras = Vec::with_capacity(spec.cameras.0.len());
    for (name, entries) in &spec.cameras.0 {
        let source = Source { path, text, name, entries };
        cameras.push(source.camera(options)?);
    }
    rig(path, cameras, options.size)
}

/// One camera's entries and where they stand.
struct Source<'a> {
    path: &'a Path,
    text: &'a str,
    name: &'a str,
    entries: &'a Entries<Value>,
}

impl Source<'_> {
    fn camera(&self, options: CalibrationOptions) -> Result<Camera, FileError> {
        let mut size = self.numbers::<u64>("size", "[width, height] in pixels", 2..=2)?;
        let mut matrix_key = "K".to_owned();
        if let Some([width, height]) = options.size {
            let scaled = format!("K_{width}x{height}");
            if self.entries.0.iter().any(|(key, _)| *key == scaled) {
                (matrix_key, size) = (scaled, vec![width, height]);
            }
        }
        let k = self.matrix(&matrix_key)?;
        let intrinsics = Intrinsics { fx: k.x_axis.x, fy: k.y_axis.y, cx: k.z_axis.x, cy: k.z_axis.y };
        let pinhole = DMat3::from_cols_array(&[
            intrinsics.fx,
            0.0,
            0.0,
            0.0,
            intrinsics.fy,
            0.0,
            intrinsics.cx,
            intrinsics.cy,
            1.0,
        ]);
        if k != pinhole {
            let expected = "[[fx, 0, cx], [0, fy, cy], [0, 0, 1]]";
            return Err(self.problem(&matrix_key, "another matrix", expected));
        }
        let lens = self.numbers::<f64>("dist", "[k1, k2, p1, p2] or [k1, k2, p1, p2, k3]", 4..=5)?;
        let distortion = if lens.iter().all(|coefficient| *coefficient == 0.0) {
            Distortion::None
        } else {
            let k3 = lens.get(4).copied().unwrap_or(0.0);
            Distortion::OpenCv { k1: lens[0], k2: lens[1], p1: lens[2], p2: lens[3], k3 }
        };
        let translation = self.numbers::<f64>("t", "three numbers", 3..=3)?;
        let camera_from_world = CameraFromWorld {
            rotation: self.matrix("R")?,
            translation: DVec3::from_slice(&translation) * options.metres_per_unit,
        };
        let size = [size[0], size[1]];
        Camera::new(self.name, size, intrinsics, distortion, camera_from_world).map_err(|error| {
            let problem = FileProblem::Camera { camera: self.name.to_owned(), error };
            FileError::new(self.path, problem).at_line(json_text::line_of(self.text, &["cameras", self.name]))
        })
    }

    fn value(&self, key: &str, expected: &str) -> Result<&Value, FileError> {
        let entry = self.entries.0.iter().find(|(found, _)| found == key);
        entry.map(|(_, value)| value).ok_or_else(|| self.problem(key, "missing", expected))
    }

    fn numbers<T: serde::de::DeserializeOwned>(
        &self,
        key: &str,
        expected: &str,
        count: std::ops::RangeInclusive<usize>,
    ) -> Result<Vec<T>, FileError> {
        match Vec::<T>::deserialize(self.value(key, expected)?) {
            Ok(numbers) if count.contains(&numbers.len()) => Ok(numbers),
            Ok(numbers) => Err(self.problem(key, &format!("{} numbers", numbers.len()), expected)),
            Err(error) => Err(self.problem(key, &plain_words::found(&error.to_string()), expected)),
        }
    }

    fn matrix(&self, key: &str) -> Result<DMat3, FileError> {
        let expected = "three rows of three numbers";
        match <[[f64; 3]; 3]>::deserialize(self.value(key, expected)?) {
            Ok(rows) => Ok(DMat3::from_cols_array_2d(&rows).transpose()),
            Err(error) => Err(self.problem(key, &plain_words::found(&error.to_string()), expected)),
        }
    }

    fn problem(&self, key: &str, found: &str, expected: &str) -> FileError {
        let problem = FileProblem::Field {
            field: format!("cameras.{}.{key}", self.name),
            found: found.to_owned(),
            expected: expected.to_owned(),
        };
        let keys = ["cameras", self.name, key];
        let line = json_text::line_of(self.text, &keys).or_else(|| json_text::line_of(self.text, &keys[..2]));
        FileError::new(self.path, problem).at_line(line)
    }
}

#[cfg(test)]
mod tests {
    use super::super::parse as parse_any;
    use super::*;

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
        let cases = [
            (
                GOOD.replacen("\"t\": [1, 2, 3]", "\"t\": [1, 2]", 1),
                "line 7: `cameras.right.t` is 2 numbers; expected three",
            ),
            (GOOD.replacen("\"t\": [1, 2, 3]", "\"x\": 1", 1), "line 2: `cameras.right.t` is missing"),
            (GOOD.replacen("536.0", "\"a\"", 1), "line 3: `cameras.right.K` is \"a\"; expected three rows"),
            (
                GOOD.replacen("\"K\": [[1680.0, 0,", "\"K\": [[1680.0, 1,", 1),
                "line 3: `cameras.right.K` is another matrix; expected [[fx",
            ),
            (
                GOOD.replacen("[0, 1, 0]", "[0, 2, 0]", 1),
                "line 2: camera \"right\": `rotation` is not a rotation",
            ),
            (GOOD.replacen("[1088, 1920]", "[-1, 1920]", 1), "line 2: `cameras.right.size`"),
            (GOOD.replacen("-0.05", "NaN", 1), "line 5: is not valid JSON: in `cameras.right.dist[0]`: NaN"),
            (GOOD.replacen("\"left\"", "\"right\"", 1), "`right` is given twice"),
            ("{}".to_owned(), "missing field `cameras`"),
        ];
        for (text, expected) in cases {
            let message =
                parse_any(Path::new("c.json"), text.as_bytes(), options(None)).unwrap_err().to_string();
            assert!(message.contains(expected), "{message:?} should contain {expected:?}");
        }
    }
}
