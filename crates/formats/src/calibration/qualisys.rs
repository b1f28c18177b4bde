//! Qualisys Track Manager's calibration, `.qca.txt`: XML.
//!
//! Pixel numbers are in 1/64 pixel, lengths in millimetres. `transform` has the camera's axes in rows, y up and z
//! backwards, and the camera's place in the world: R = diag(1, −1, −1) `R_q`, t = −R c. Distortion coefficients are
//! OpenCV's. Cameras that are not active are left out; a camera's name is its serial.

use std::path::Path;
use std::str::FromStr;

use backlit_tracking::camera::{Camera, CameraFromWorld, Distortion, Intrinsics, Rig};
use glam::{DMat3, DVec3};
use roxmltree::{Document, Node, ParsingOptions};

use super::{CalibrationOptions, rig};
use crate::{FileError, FileProblem, TextFormat};

/// The file's pixel numbers in one pixel.
const PER_PIXEL: f64 = 64.0;
/// Most XML nodes that are read.
const MAX_NODES: u32 = 200_000;

/// Parses the content of such a file; `path` is for the error's message.
///
/// # Errors
/// Not such a file, or not valid cameras. The error names the line, the camera and the field.
pub fn parse(path: &Path, text: &str, options: CalibrationOptions) -> Result<Rig, FileError> {
    let limits = ParsingOptions { nodes_limit: MAX_NODES, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, limits).map_err(|error| {
        let problem =
            FileProblem::Syntax { format: TextFormat::Xml, field: None, message: error.to_string() };
        FileError::new(path, problem).at_line(Some(error.pos().row as usize))
    })?;
    let mut cameras = Vec::new();
    for node in document.descendants().filter(|node| node.has_tag_name("camera")) {
        if node.attribute("active") != Some("0") {
            cameras.push(Source { path, node }.camera()?);
        }
    }
    rig(path, cameras, options.size)
}

struct Source<'a, 'input> {
    path: &'a Path,
    node: Node<'a, 'input>,
}

impl Source<'_, '_> {
    fn camera(&self) -> Result<Camera, FileError> {
        let name = self.node.attribute("serial").unwrap_or_default();
        let side = |first, last| -> Result<(u64, f64), FileError> {
            let (first, last): (i32, i32) =
                (self.number("fov_video", first)?, self.number("fov_video", last)?);
            Ok(((i64::from(last) - i64::from(first) + 1).max(0).unsigned_abs(), f64::from(first)))
        };
        let ((width, left), (height, top)) = (side("left", "right")?, side("top", "bottom")?);
        let px = |field| self.number::<f64>("intrinsic", field).map(|value| value / PER_PIXEL);
        let intrinsics = Intrinsics {
            fx: px("focalLengthU")?,
            fy: px("focalLengthV")?,
            cx: px("centerPointU")? - left,
            cy: px("centerPointV")? - top,
        };
        let lens = |field| self.number::<f64>("intrinsic", field);
        let distortion = Distortion::OpenCv {
            k1: lens("radialDistortion1")?,
            k2: lens("radialDistortion2")?,
            p1: lens("tangentalDistortion1")?,
            p2: lens("tangentalDistortion2")?,
            k3: lens("radialDistortion3")?,
        };
        let place = |field| self.number::<f64>("transform", field);
        let row = |a, b, c| Ok::<_, FileError>(DVec3::new(place(a)?, place(b)?, place(c)?));
        let rows = DMat3::from_cols(
            row("r11", "r12", "r13")?,
            -row("r21", "r22", "r23")?,
            -row("r31", "r32", "r33")?,
        );
        let rotation = rows.transpose();
        let centre = row("x", "y", "z")? * 0.001;
        let camera_from_world = CameraFromWorld { rotation, translation: -(rotation * centre) };
        Camera::new(name, [width, height], intrinsics, distortion, camera_from_world).map_err(|error| {
            let problem = FileProblem::Camera { camera: name.to_owned(), error };
            FileError::new(self.path, problem).at_line(Some(self.line(self.node)))
        })
    }

    fn number<T: FromStr>(&self, element: &str, attribute: &str) -> Result<T, FileError> {
        let child = self.node.children().find(|child| child.has_tag_name(element));
        let found = child.and_then(|child| child.attribute(attribute));
        found.and_then(|text| text.trim().parse().ok()).ok_or_else(|| {
            let problem = FileProblem::Field {
                field: format!("{element}.{attribute}"),
                found: found.map_or_else(|| "missing".to_owned(), |text| format!("{text:?}")),
                expected: "a number".to_owned(),
            };
            FileError::new(self.path, problem).at_line(Some(self.line(child.unwrap_or(self.node))))
        })
    }

    fn line(&self, node: Node<'_, '_>) -> usize {
        node.document().text_pos_at(node.range().start).row as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = r#"<?xml version='1.0' encoding='ASCII'?>
<calibration source="x"><cameras>
  <camera active="1" serial="cam01" viewrotation="0">
    <fov_video bottom="1919" left="0" right="1087" top="0"/>
    <transform r11="0" r12="1" r13="0" r21="0" r22="0" r23="1" r31="1" r32="0" r33="0" x="2000" y="100" z="1500"/>
    <intrinsic centerPointU="34110.4" centerPointV="60680.7" focalLengthU="107584" focalLengthV="107520"
      radialDistortion1="-0.05" radialDistortion2="0.14" radialDistortion3="0.0" tangentalDistortion1="0.001" tangentalDistortion2="0.002"/>
  </camera>
  <camera active="0" serial="off"/>
</cameras></calibration>"#;

    #[test]
    fn cameras_look_along_their_backwards_axis() {
        let rig = parse(Path::new("c.qca.txt"), GOOD, CalibrationOptions::default()).unwrap();
        assert_eq!(rig.count(), 1);
        let camera = &rig.cameras()[0];
        assert_eq!((camera.name(), camera.width(), camera.height()), ("cam01", 1088, 1920));
        assert_eq!(camera.intrinsics().fx, 1681.0);
        assert!(camera.centre().distance(DVec3::new(2.0, 0.1, 1.5)) < 1e-12);
        // The world's x axis points out of the back of this camera, its y axis to the right, z up.
        let point = camera.camera_from_world().transform(DVec3::new(1.0, 0.3, 1.7));
        assert!(point.distance(DVec3::new(0.2, -0.2, 1.0)) < 1e-12, "{point}");
    }

    #[test]
    fn errors_name_line_and_field() {
        let cases = [
            (GOOD.replace("\"2000\"", "\"two\""), "line 5: `transform.x` is \"two\"; expected a number"),
            (GOOD.replace("r33=\"0\" ", ""), "line 5: `transform.r33` is missing"),
            (GOOD.replace("r33=\"0\"", "r33=\"5\""), "line 3: camera \"cam01\": `rotation`"),
            (GOOD.replace("right=\"1087\"", "right=\"-7\""), "line 3: camera \"cam01\": `width` is 0"),
            (GOOD.replace("</cameras>", ""), "line 10: is not valid XML"),
            ("<calibration/>".to_owned(), "there is no camera"),
        ];
        for (text, expected) in cases {
            let message =
                parse(Path::new("c.txt"), &text, CalibrationOptions::default()).unwrap_err().to_string();
            assert!(message.contains(expected), "{message:?} should contain {expected:?}");
        }
    }
}
