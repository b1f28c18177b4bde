//! Qualisys Track Manager's calibration, `.qca.txt`: XML.
//!
//! Pixel numbers are in 1/64 pixel, lengths in millimetres. `transform` has the camera's axes in rows, y up and z
//! backwards, and the camera's place in the world: R = diag(1, −1, −1) `R_q`, t = −R c. Distortion coefficients are
//! OpenCV's. A camera's name is its serial. Left out are cameras that are not active, and those whose model only sees
//! markers: of Qualisys' models "Miqus Video", "Miqus Video Underwater", "Miqus Video Plus" and the like film.
//!
//! All numbers are of the sensor, which is how QTM writes the videos of a camera that lies on its side. `viewrotation`
//! says by how many degrees clockwise its picture must be turned to stand upright. Where the pictures asked for have the
//! proportions of the turned picture, they were turned, and the camera is turned with them:
//! (u, v) → (height − 1 − v, u) for 90°. A half turn leaves the proportions as they are: such pictures are taken to be
//! the sensor's own.

use std::path::Path;

use backlit_tracking::camera::{CameraFromWorld, Distortion, Intrinsics};
use glam::{DMat3, DVec3};

use super::partial::{PartialCamera, PartialCameras, Pinhole};
use super::xml::{self, Element};
use crate::{FileError, Result};

/// The file's pixel numbers in one pixel.
const PER_PIXEL: f64 = 64.0;

/// The cameras that film, turned as pictures of this size are.
pub(super) fn parts(path: &Path, text: &str, size: Option<[u64; 2]>) -> Result<PartialCameras> {
    let document = xml::document(path, text)?;
    let mut parts = PartialCameras::new(Some(1.0));
    for node in document.descendants().filter(|node| node.has_tag_name("camera")) {
        let element = Element { path, node };
        if films(element) {
            parts.push(path, camera(element, size)?)?;
        }
    }
    Ok(parts)
}

/// Whether a camera takes pictures. A file that other tools have made need not say the model.
fn films(camera: Element<'_, '_>) -> bool {
    let model = camera.attribute("model").unwrap_or_default().trim().to_lowercase();
    let takes_video = model.is_empty() || model == "none" || model.contains("video");
    camera.attribute("active") != Some("0") && takes_video
}

fn camera(element: Element<'_, '_>, pictures: Option<[u64; 2]>) -> Result<PartialCamera> {
    let side = |first, last| -> Result<(u64, f64)> {
        let [first, last]: [i32; 2] =
            [element.child_number("fov_video", first)?, element.child_number("fov_video", last)?];
        Ok(((i64::from(last) - i64::from(first) + 1).max(0).unsigned_abs(), f64::from(first)))
    };
    let ((width, left), (height, top)) = (side("left", "right")?, side("top", "bottom")?);
    let lens = |field| element.child_number::<f64>("intrinsic", field);
    let px = |field| lens(field).map(|value| value / PER_PIXEL);
    let intrinsics = Intrinsics {
        fx: px("focalLengthU")?,
        fy: px("focalLengthV")?,
        cx: px("centerPointU")? - left,
        cy: px("centerPointV")? - top,
    };
    let distortion = Distortion::OpenCv {
        k1: lens("radialDistortion1")?,
        k2: lens("radialDistortion2")?,
        p1: lens("tangentalDistortion1")?,
        p2: lens("tangentalDistortion2")?,
        k3: lens("radialDistortion3")?,
    };
    let place = |field| element.child_number::<f64>("transform", field);
    let row = |a, b, c| Ok::<_, FileError>(DVec3::new(place(a)?, place(b)?, place(c)?));
    let rows =
        DMat3::from_cols(row("r11", "r12", "r13")?, -row("r21", "r22", "r23")?, -row("r31", "r32", "r33")?);
    let rotation = rows.transpose();
    let centre = row("x", "y", "z")? * 0.001;
    let camera_from_world = CameraFromWorld { rotation, translation: -(rotation * centre) };
    let mut part = PartialCamera::new(element.attribute("serial").unwrap_or_default(), element.line());
    part.size = Some([width, height]);
    part.lens = Some((Pinhole::Pixels(intrinsics), distortion));
    part.place = Some(camera_from_world);
    let turns = quarter_turns(element)?;
    if turns % 2 == 1 && pictures.is_some_and(|size| is_portrait(size) != is_portrait([width, height])) {
        (0..turns).for_each(|_| part = clockwise(&part));
    }
    Ok(part)
}

/// Clockwise, from the sensor's picture to the upright one.
fn quarter_turns(camera: Element<'_, '_>) -> Result<u32> {
    match camera.attribute("viewrotation").map(str::trim) {
        None | Some("" | "0") => Ok(0),
        Some("90") => Ok(1),
        Some("180") => Ok(2),
        Some("270") => Ok(3),
        Some(other) => Err(camera.error("viewrotation", &format!("{other:?}"), "0, 90, 180 or 270")),
    }
}

fn is_portrait([width, height]: [u64; 2]) -> bool {
    height > width
}

/// The camera of the picture turned by a quarter clockwise: (u, v) becomes (height − 1 − v, u).
fn clockwise(part: &PartialCamera) -> PartialCamera {
    let turn = DMat3::from_cols(DVec3::Y, -DVec3::X, DVec3::Z);
    let lens = part.size.zip(part.lens).map(|([_, height], (pinhole, distortion))| {
        let pinhole = match pinhole {
            Pinhole::Pixels(Intrinsics { fx, fy, cx, cy }) => {
                Pinhole::Pixels(Intrinsics { fx: fy, fy: fx, cx: height as f64 - 1.0 - cy, cy: cx })
            }
            other => other,
        };
        let distortion = match distortion {
            // Radial terms look the same from all sides; the tangential pair turns with the picture.
            Distortion::OpenCv { k1, k2, p1, p2, k3 } => Distortion::OpenCv { k1, k2, p1: p2, p2: -p1, k3 },
            other => other,
        };
        (pinhole, distortion)
    });
    PartialCamera {
        size: part.size.map(|[width, height]| [height, width]),
        lens,
        place: part.place.map(|place| CameraFromWorld {
            rotation: turn * place.rotation,
            translation: turn * place.translation,
        }),
        ..part.clone()
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use backlit_tracking::camera::{Camera, Rig};
    use glam::DVec3;

    use super::super::{CalibrationOptions, parse};
    use crate::damaged::assert_refused;

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
        let rig = parse(Path::new("c.qca.txt"), GOOD.as_bytes(), CalibrationOptions::default()).unwrap();
        assert_eq!(rig.count(), 1);
        let camera = &rig.cameras()[0];
        assert_eq!((camera.name(), camera.width(), camera.height()), ("cam01", 1088, 1920));
        assert_eq!(camera.intrinsics().fx, 1681.0);
        assert!(camera.centre().distance(DVec3::new(2.0, 0.1, 1.5)) < 1e-12);
        // The world's x axis points out of the back of this camera, its y axis to the right, z up.
        let point = camera.camera_from_world().transform(DVec3::new(1.0, 0.3, 1.7));
        assert!(point.distance(DVec3::new(0.2, -0.2, 1.0)) < 1e-12, "{point}");
    }

    fn read(text: &str, size: Option<[u64; 2]>) -> Rig {
        let options = CalibrationOptions { size, ..CalibrationOptions::default() };
        parse(Path::new("c.qca.txt"), text.as_bytes(), options).unwrap()
    }

    #[test]
    fn cameras_that_only_see_markers_are_left_out() {
        for (model, films) in [
            ("Miqus Video", true),
            ("Miqus Video UnderWater", true),
            ("Miqus Video Plus", true),
            ("none", true),
            ("", true),
            ("Miqus M3", false),
            ("Oqus 300+", false),
            ("Arqus A12", false),
        ] {
            let [from, to] =
                ["<camera active=\"1\"", "<camera active=\"0\""].map(|tag| GOOD.find(tag).unwrap());
            let said = format!("model=\"{model}\" serial=\"other\"");
            let other = GOOD[from..to].replace("serial=\"cam01\"", &said);
            let both = GOOD.replace("</cameras>", &format!("{other}</cameras>"));
            let rig = read(&both, None);
            let names: Vec<&str> = rig.cameras().iter().map(Camera::name).collect();
            assert_eq!(names, if films { vec!["cam01", "other"] } else { vec!["cam01"] }, "{model}");
        }
        // A marker camera is left out before its numbers are looked at.
        let marker =
            GOOD.replace("active=\"0\" serial=\"off\"", "active=\"1\" model=\"Miqus M5\" serial=\"m\"");
        assert_eq!(read(&marker, None).count(), 1);
    }

    #[test]
    fn a_camera_on_its_side_is_turned_with_its_pictures() {
        let [width, height] = [1088.0, 1920.0];
        let upright = &read(GOOD, None).cameras()[0].clone();
        for (degrees, turn) in [(90, 1), (270, 3), (180, 0), (0, 0)] {
            let text = GOOD.replace("viewrotation=\"0\"", &format!("viewrotation=\"{degrees}\""));
            // As the sensor has it, unless the pictures lie the other way.
            assert_eq!(read(&text, None).cameras()[0], *upright, "{degrees}°");
            assert_eq!(read(&text, Some([1088, 1920])).cameras()[0], *upright, "{degrees}°");
            let options = CalibrationOptions { size: Some([1920, 1088]), ..CalibrationOptions::default() };
            let turned = parse(Path::new("c"), text.as_bytes(), options);
            if turn == 0 {
                let message = turned.unwrap_err().to_string();
                assert!(message.contains("the proportions of 1920×1088"), "{message}");
                continue;
            }
            let rig = turned.unwrap();
            let camera = &rig.cameras()[0];
            assert_eq!((camera.width(), camera.height()), (1920, 1088));
            assert!(camera.centre().distance(upright.centre()) < 1e-12);
            for point in [DVec3::new(1.0, 0.3, 1.7), DVec3::new(-1.0, -0.2, 1.1), DVec3::new(0.5, 0.0, 1.3)] {
                let (before, after) = (upright.project(point).unwrap(), camera.project(point).unwrap());
                let expected = match turn {
                    1 => glam::DVec2::new(height - 1.0 - before.y, before.x),
                    _ => glam::DVec2::new(before.y, width - 1.0 - before.x),
                };
                assert!(after.distance(expected) < 1e-9, "{degrees}°: {after} for {expected}");
            }
        }
    }

    #[test]
    fn errors_name_line_and_field() {
        assert_refused(
            GOOD,
            |text| parse(Path::new("c.txt"), text.as_bytes(), CalibrationOptions::default()),
            r#"
            "2000" ⇒ "two" ⇒ line 5: `transform.x` is "two"; expected a number
            r33="0" ⇒ ⇒ line 5: `transform.r33` is missing
            r33="0" ⇒ r33="5" ⇒ line 3: camera "cam01": `rotation`
            right="1087" ⇒ right="-7" ⇒ line 3: camera "cam01": `width` is 0
            </cameras> ⇒ ⇒ line 10: is not valid XML
            viewrotation="0" ⇒ viewrotation="45" ⇒ line 3: `camera.viewrotation` is "45"; expected 0, 90, 180 or 270
            <calibration/> ⇒ there is no camera
            "#,
        );
    }
}
