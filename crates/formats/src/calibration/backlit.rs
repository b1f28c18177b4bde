//! `backlit-cameras 1`: our own JSON (see `docs/formats.md`).

use std::path::Path;

use backlit_tracking::camera::{Camera, CameraFromWorld, Distortion, Intrinsics, Rig};
use glam::{DMat3, DVec3};
use serde::{Deserialize, Serialize};

use super::{CalibrationOptions, rig};
use crate::{FileError, FileProblem, Result, atomic, json_text};

/// Name and version of the format.
pub const FORMAT: &str = "backlit-cameras 1";

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RigSpec {
    format: String,
    cameras: Vec<CameraSpec>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct CameraSpec {
    name: String,
    width: u64,
    height: u64,
    fx: f64,
    fy: f64,
    cx: f64,
    cy: f64,
    #[serde(default)]
    distortion: DistortionSpec,
    rotation: [[f64; 3]; 3],
    translation: [f64; 3],
}

/// Names of the coefficients, in `OpenCV`'s order.
const COEFFICIENTS: [&str; 8] = ["k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"];

#[derive(Serialize, Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct DistortionSpec {
    model: Lens,
    #[serde(skip_serializing_if = "Option::is_none")]
    k1: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    k2: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    p1: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    p2: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    k3: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    k4: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    k5: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    k6: Option<f64>,
}

#[derive(Debug, Serialize, Deserialize, Default, Clone, Copy)]
#[serde(rename_all = "lowercase")]
enum Lens {
    #[default]
    None,
    OpenCv,
    Rational,
    Fisheye,
}

impl DistortionSpec {
    fn new(distortion: &Distortion) -> Self {
        let named = distortion.coefficients();
        let value = |name| named.iter().find(|(found, _)| *found == name).map(|(_, value)| *value);
        let [k1, k2, p1, p2, k3, k4, k5, k6] = COEFFICIENTS.map(value);
        let model = match distortion {
            Distortion::None => Lens::None,
            Distortion::OpenCv { .. } => Lens::OpenCv,
            Distortion::Rational { .. } => Lens::Rational,
            Distortion::Fisheye { .. } => Lens::Fisheye,
        };
        Self { model, k1, k2, p1, p2, k3, k4, k5, k6 }
    }

    fn distortion(&self) -> Distortion {
        let value = |coefficient: Option<f64>| coefficient.unwrap_or(0.0);
        let [k1, k2, p1, p2, k3] = [self.k1, self.k2, self.p1, self.p2, self.k3].map(value);
        let [k4, k5, k6] = [self.k4, self.k5, self.k6].map(value);
        match self.model {
            Lens::None => Distortion::None,
            Lens::OpenCv => Distortion::OpenCv { k1, k2, p1, p2, k3 },
            Lens::Rational => Distortion::Rational { k1, k2, p1, p2, k3, k4, k5, k6 },
            Lens::Fisheye => Distortion::Fisheye { k1, k2, k3, k4 },
        }
    }

    /// The first coefficient of the file that the model does not have.
    fn stray(&self) -> Option<&'static str> {
        let given = [self.k1, self.k2, self.p1, self.p2, self.k3, self.k4, self.k5, self.k6];
        let own: &[&str] = match self.model {
            Lens::None => &[],
            Lens::OpenCv => &COEFFICIENTS[..5],
            Lens::Rational => &COEFFICIENTS,
            Lens::Fisheye => &["k1", "k2", "k3", "k4"],
        };
        let stray = COEFFICIENTS.into_iter().zip(given);
        stray.filter(|(_, value)| value.is_some()).map(|(name, _)| name).find(|name| !own.contains(name))
    }
}

/// Parses the content of such a file; `path` is for the error's message.
pub fn parse(path: &Path, text: &str, options: CalibrationOptions) -> Result<Rig> {
    let spec: RigSpec = json_text::parse_versioned(path, text, FORMAT)?;
    let mut cameras = Vec::with_capacity(spec.cameras.len());
    for (index, spec) in spec.cameras.iter().enumerate() {
        let lens = &spec.distortion;
        if let Some(stray) = lens.stray() {
            let (found, expected) = match lens.model {
                Lens::None => {
                    ("\"none\" beside coefficients".to_owned(), "\"opencv\", or no coefficients".to_owned())
                }
                model => {
                    let model = format!("{model:?}").to_lowercase();
                    (format!("\"{model}\" beside `{stray}`"), format!("no `{stray}`"))
                }
            };
            let field = format!("cameras[{index}].distortion.model");
            return Err(FileProblem::field(field, found, expected).at(path, None));
        }
        let intrinsics = Intrinsics { fx: spec.fx, fy: spec.fy, cx: spec.cx, cy: spec.cy };
        let camera_from_world = CameraFromWorld {
            rotation: DMat3::from_cols_array_2d(&spec.rotation).transpose(),
            translation: DVec3::from_array(spec.translation),
        };
        let size = [spec.width, spec.height];
        let camera = Camera::new(&spec.name, size, intrinsics, lens.distortion(), camera_from_world);
        cameras.push(camera.map_err(|error| {
            let name = if spec.name.is_empty() { format!("cameras[{index}]") } else { spec.name.clone() };
            FileError::new(path, FileProblem::Camera { camera: name, error })
        })?);
    }
    rig(path, cameras, options.size)
}

/// The content of such a file. [`parse`] gives the same rig again.
#[must_use]
pub fn to_text(rig: &Rig) -> String {
    let cameras = rig.cameras().iter().map(|camera| {
        let k = camera.intrinsics();
        let place = camera.camera_from_world();
        CameraSpec {
            name: camera.name().to_owned(),
            width: camera.width() as u64,
            height: camera.height() as u64,
            fx: k.fx,
            fy: k.fy,
            cx: k.cx,
            cy: k.cy,
            distortion: DistortionSpec::new(camera.distortion()),
            rotation: place.rotation.transpose().to_cols_array_2d(),
            translation: place.translation.to_array(),
        }
    });
    let spec = RigSpec { format: FORMAT.to_owned(), cameras: cameras.collect() };
    #[expect(clippy::expect_used, reason = "the cameras hold only strings and finite numbers")]
    let text = serde_json::to_string_pretty(&spec).expect("cameras can be written as JSON");
    text + "\n"
}

/// Writes such a file; see [`atomic`].
pub fn write(path: &Path, rig: &Rig) -> Result<()> {
    atomic::write(path, to_text(rig).as_bytes())
}

#[cfg(test)]
mod tests {
    use super::super::lens::opencv_lens;
    use super::*;
    use crate::damaged::assert_refused;

    fn sample() -> Rig {
        let place = CameraFromWorld::looking_at(DVec3::new(3.0, -1.0, 1.5), DVec3::Z, DVec3::Z);
        let intrinsics = Intrinsics { fx: 420.25, fy: 421.0, cx: 134.1, cy: 238.5 };
        let lens = Distortion::OpenCv { k1: -0.05, k2: 0.14, p1: 6e-4, p2: 7e-4, k3: 0.0 };
        let camera = |name, lens| Camera::new(name, [272, 480], intrinsics, lens, place).unwrap();
        let rational = opencv_lens(&[0.2, 0.1, 6e-4, 7e-4, 0.01, 0.25, 0.02, 0.001]).unwrap();
        let fisheye = Distortion::Fisheye { k1: -0.06, k2: 0.01, k3: -0.004, k4: 3e-4 };
        let cameras = [("b", lens), ("a", Distortion::None), ("r", rational), ("f", fisheye)];
        Rig::new(cameras.map(|(name, lens)| camera(name, lens)).to_vec()).unwrap()
    }

    #[test]
    fn a_rig_survives_its_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cameras.json");
        write(&path, &sample()).unwrap();
        assert_eq!(super::super::read(&path, CalibrationOptions::default()).unwrap(), sample());
        let half = CalibrationOptions { size: Some([136, 240]), ..CalibrationOptions::default() };
        let rig = super::super::read(&path, half).unwrap();
        assert_eq!((rig.cameras()[0].width(), rig.cameras()[0].height()), (136, 240));
        assert!((rig.cameras()[0].intrinsics().cx - (134.6 / 2.0 - 0.5)).abs() < 1e-12);
    }

    #[test]
    fn errors_name_line_camera_and_field() {
        let good = to_text(&sample());
        let read = |text: &str| {
            super::super::parse(Path::new("c.json"), text.as_bytes(), CalibrationOptions::default())
        };
        assert_refused(
            &good,
            read,
            r#"
            "fx": 420.25 ⇒ "fx": -1.0 ⇒ c.json: camera "b": `fx` is -1
            "fx": 420.25 ⇒ "fx": 0 ⇒ c.json: camera "b": `fx` is 0
            "fy": 421.0 ⇒ "fy": -41 ⇒ `fy` is -41
            "width": 272 ⇒ "width": 0 ⇒ `width`
            "height": 480 ⇒ "height": 2147483648 ⇒ `height`
            "fx": 420.25 ⇒ "fx": null ⇒ line 8: `cameras[0].fx` is null; expected a number
            "fx": 420.25, ⇒ ⇒ .fx` is missing; expected a value
            "b" ⇒ "a" ⇒ camera name "a" is used twice
            "fy" ⇒ "f_y" ⇒ unknown field `f_y`
            "opencv" ⇒ "none" ⇒ `cameras[0].distortion.model` is "none" beside
            "opencv" ⇒ "fish" ⇒ in `cameras[0].distortion.model`: unknown word `fish`
            "opencv" ⇒ "fisheye" ⇒ is "fisheye" beside `p1`; expected no `p1`
            cameras 1 ⇒ cameras 9 ⇒ line 2: `format` is "backlit-cameras 9"
            {"format": "backlit-cameras 1", "cameras": []} ⇒ there is no camera
            "#,
        );
        let wide = CalibrationOptions { size: Some([480, 272]), ..CalibrationOptions::default() };
        let message = parse(Path::new("c.json"), &good, wide).unwrap_err().to_string();
        assert!(message.contains("272×480; expected the proportions of 480×272"), "{message}");
    }
}
