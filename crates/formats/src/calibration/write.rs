//! Cameras in the formats of other tools, as text. What a format cannot hold is refused, never rounded away.
//!
//! | format | lenses | what else is refused |
//! |---|---|---|
//! | ours, `OpenCV`'s three | all | in XML a name with a quotation mark |
//! | matrices JSON, `Pose2Sim`, `EasyMocap` | plain; of `Pose2Sim` without k3 | names that the keys cannot hold |
//! | Anipose | plain, fisheye | a camera called `metadata` |
//! | Kalibr | plain without k3, fisheye | other names than cam0, cam1, …; a first camera that is not the world |
//! | `transforms.json` | plain, or all fisheye | |

use backlit_tracking::camera::{Camera, Distortion, Rig};
use thiserror::Error;

use super::backlit;

mod storage;
mod tables;

/// A format that cameras can be written in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// `backlit-cameras 1`.
    Backlit,
    /// `OpenCV`'s `FileStorage` as YAML.
    OpenCvYaml,
    /// `OpenCV`'s `FileStorage` as XML.
    OpenCvXml,
    /// `OpenCV`'s `FileStorage` as JSON.
    OpenCvJson,
    /// `Pose2Sim`'s `Calib.toml`.
    Pose2Sim,
    /// Anipose's `calibration.toml`.
    Anipose,
    /// Kalibr's camchain.
    Kalibr,
    /// `EasyMocap`'s `intri.yml` and `extri.yml`.
    EasyMocap,
    /// JSON of camera matrices.
    Matrices,
    /// `transforms.json`.
    Transforms,
}

impl Format {
    /// All formats.
    pub const ALL: [Self; 10] = [
        Self::Backlit,
        Self::OpenCvYaml,
        Self::OpenCvXml,
        Self::OpenCvJson,
        Self::Pose2Sim,
        Self::Anipose,
        Self::Kalibr,
        Self::EasyMocap,
        Self::Matrices,
        Self::Transforms,
    ];

    /// What it is called on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        const NAMES: &str = "backlit opencv-yaml opencv-xml opencv-json pose2sim anipose kalibr easymocap matrices transforms";
        NAMES.split(' ').nth(self as usize).unwrap_or_default()
    }

    /// The format of this name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|format| format.name() == name)
    }
}

/// Why a format cannot hold a rig.
#[derive(Debug, Error, Clone, PartialEq)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum Refusal {
    #[error("camera \"{camera}\": {format} cannot hold {lens}")]
    Lens { camera: String, format: &'static str, lens: &'static str },
    #[error("camera \"{camera}\": {format} cannot hold this name; expected {expected}")]
    Name { camera: String, format: &'static str, expected: String },
    #[error("camera \"{camera}\" is not the world; {format} has no other world than its first camera")]
    Place { camera: String, format: &'static str },
}

/// The content of such a file; of [`Format::EasyMocap`] of two, `intri.yml` and `extri.yml`. Reading them gives the
/// same rig again, but for rounding.
pub fn to_text(rig: &Rig, format: Format) -> Result<Vec<String>, Refusal> {
    let text = match format {
        Format::Backlit => backlit::to_text(rig),
        Format::OpenCvYaml => storage::yaml(rig),
        Format::OpenCvXml => storage::xml(rig)?,
        Format::OpenCvJson => storage::json(rig),
        Format::EasyMocap => return storage::easymocap(rig).map(Vec::from),
        Format::Pose2Sim => tables::pose2sim(rig)?,
        Format::Anipose => tables::anipose(rig)?,
        Format::Kalibr => tables::kalibr(rig)?,
        Format::Matrices => tables::matrices(rig)?,
        Format::Transforms => tables::transforms(rig)?,
    };
    Ok(vec![text])
}

/// Numbers with all their digits, between commas.
fn list(numbers: &[f64]) -> String {
    numbers.iter().map(|number| format!("{number:?}")).collect::<Vec<_>>().join(", ")
}

/// In quotes, as JSON, TOML and YAML have them alike.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

/// fx 0 cx, 0 fy cy, 0 0 1.
fn matrix(camera: &Camera) -> [f64; 9] {
    let k = camera.intrinsics();
    [k.fx, 0.0, k.cx, 0.0, k.fy, k.cy, 0.0, 0.0, 1.0]
}

/// Row after row.
fn rotation(camera: &Camera) -> [f64; 9] {
    camera.camera_from_world().rotation.transpose().to_cols_array()
}

fn lens_name(lens: &Distortion) -> &'static str {
    match lens {
        Distortion::None => "an ideal lens",
        Distortion::OpenCv { k3, .. } if *k3 != 0.0 => "a lens with k3",
        Distortion::OpenCv { .. } => "a plain lens",
        Distortion::Rational { .. } => "a rational lens",
        Distortion::Fisheye { .. } => "a fisheye",
    }
}

/// k1 k2 p1 p2 k3 of a plain lens.
fn plain(camera: &Camera, format: &'static str) -> Result<[f64; 5], Refusal> {
    match *camera.distortion() {
        Distortion::None => Ok([0.0; 5]),
        Distortion::OpenCv { k1, k2, p1, p2, k3 } => Ok([k1, k2, p1, p2, k3]),
        ref other => Err(no_lens(camera, format, other)),
    }
}

/// k1 k2 p1 p2 of a plain lens without k3.
fn plain_four(camera: &Camera, format: &'static str) -> Result<[f64; 4], Refusal> {
    match plain(camera, format)? {
        [k1, k2, p1, p2, 0.0] => Ok([k1, k2, p1, p2]),
        _ => Err(no_lens(camera, format, camera.distortion())),
    }
}

fn no_lens(camera: &Camera, format: &'static str, lens: &Distortion) -> Refusal {
    Refusal::Lens { camera: camera.name().to_owned(), format, lens: lens_name(lens) }
}

fn no_name(camera: &Camera, format: &'static str, expected: &str) -> Refusal {
    Refusal::Name { camera: camera.name().to_owned(), format, expected: expected.to_owned() }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use backlit_tracking::camera::{CameraFromWorld, Intrinsics};
    use glam::{DMat3, DVec3};

    use super::super::{CalibrationOptions, load_pair, parse};
    use super::*;

    const PLAIN: Distortion = Distortion::OpenCv { k1: -0.05, k2: 0.14, p1: 6e-4, p2: -7e-4, k3: 0.0 };
    const WITH_K3: Distortion = Distortion::OpenCv { k1: -0.05, k2: 0.14, p1: 6e-4, p2: -7e-4, k3: 1e-7 };
    const FISHEYE: Distortion = Distortion::Fisheye { k1: -0.06, k2: 0.01, k3: -0.004, k4: 3e-4 };
    const RATIONAL: Distortion =
        Distortion::Rational { k1: 0.2, k2: 0.1, p1: 6e-4, p2: 7e-4, k3: 0.01, k4: 0.2, k5: 0.02, k6: 0.001 };

    /// Cameras round the world with these lenses.
    fn rig(names: [&str; 2], lenses: [Distortion; 2]) -> Rig {
        let camera = |index: usize, at| {
            let place = CameraFromWorld::looking_at(at, DVec3::new(0.1, 0.2, 1.0), DVec3::Z);
            let k = Intrinsics { fx: 1681.24, fy: 1680.75, cx: 532.97, cy: 948.13 };
            Camera::new(names[index], [1088, 1920], k, lenses[index], place).unwrap()
        };
        Rig::new(vec![camera(0, DVec3::new(3.0, -1.0, 1.5)), camera(1, DVec3::new(-2.2, 1.0, 1.1))]).unwrap()
    }

    fn again(rig: &Rig, format: Format) -> Rig {
        let texts = to_text(rig, format).unwrap();
        if let [intri, extri] = texts.as_slice() {
            let folder = tempfile::tempdir().unwrap();
            let [a, b] = ["intri.yml", "extri.yml"].map(|name| folder.path().join(name));
            std::fs::write(&a, intri).unwrap();
            std::fs::write(&b, extri).unwrap();
            return load_pair(&a, &b, CalibrationOptions::default()).unwrap().rig;
        }
        parse(Path::new("written"), texts[0].as_bytes(), CalibrationOptions::default())
            .unwrap_or_else(|error| panic!("{}: {error}\n{}", format.name(), texts[0]))
    }

    fn assert_same(a: &Rig, b: &Rig, format: Format) {
        assert_eq!(a.count(), b.count(), "{}", format.name());
        for (a, b) in a.cameras().iter().zip(b.cameras()) {
            let numbers = |camera: &Camera| {
                let mut numbers = vec![camera.width() as f64, camera.height() as f64];
                numbers.extend(matrix(camera));
                numbers.extend(rotation(camera));
                numbers.extend(camera.camera_from_world().translation.to_array());
                numbers.extend(camera.distortion().coefficients().iter().map(|(_, value)| value));
                numbers
            };
            assert_eq!(a.name(), b.name());
            assert_eq!(lens_name(a.distortion()), lens_name(b.distortion()), "{}", format.name());
            let (found, wanted) = (numbers(b), numbers(a));
            assert_eq!(found.len(), wanted.len(), "{}", format.name());
            for (found, wanted) in found.iter().zip(&wanted) {
                assert!((found - wanted).abs() < 1e-9, "{}: {found} {wanted}", format.name());
            }
        }
    }

    #[test]
    fn every_format_gives_the_rig_again() {
        use Format as F;
        let cases: [(F, &[Distortion]); 9] = [
            (F::Backlit, &[PLAIN, WITH_K3, FISHEYE, RATIONAL]),
            (F::OpenCvYaml, &[PLAIN, WITH_K3, FISHEYE, RATIONAL]),
            (F::OpenCvXml, &[PLAIN, WITH_K3, FISHEYE, RATIONAL]),
            (F::OpenCvJson, &[PLAIN, WITH_K3, FISHEYE, RATIONAL]),
            (F::Pose2Sim, &[PLAIN]),
            (F::Anipose, &[PLAIN, WITH_K3, FISHEYE]),
            (F::EasyMocap, &[PLAIN, WITH_K3]),
            (F::Matrices, &[PLAIN, WITH_K3]),
            (F::Transforms, &[PLAIN, WITH_K3]),
        ];
        for (format, lenses) in cases {
            for &lens in lenses {
                let rig = rig(["left 1", "2"], [lens, Distortion::None]);
                assert_same(&rig, &again(&rig, format), format);
            }
        }
        let fisheyes = rig(["a/b.png", "c.png"], [FISHEYE, FISHEYE]);
        assert_same(&fisheyes, &again(&fisheyes, Format::Transforms), Format::Transforms);
    }

    #[test]
    fn kalibr_holds_rigs_whose_first_camera_is_the_world() {
        for lens in [PLAIN, FISHEYE, Distortion::None] {
            let free = rig(["cam0", "cam1"], [lens, lens]);
            let refused = to_text(&free, Format::Kalibr).unwrap_err();
            assert!(matches!(refused, Refusal::Place { ref camera, .. } if camera == "cam0"), "{refused}");
            let origin = CameraFromWorld { rotation: DMat3::IDENTITY, translation: DVec3::ZERO };
            let first = &free.cameras()[0];
            let first = Camera::new("cam0", [1088, 1920], *first.intrinsics(), lens, origin).unwrap();
            let bound = Rig::new(vec![first, free.cameras()[1].clone()]).unwrap();
            assert_same(&bound, &again(&bound, Format::Kalibr), Format::Kalibr);
        }
    }

    #[test]
    fn what_a_format_cannot_hold_is_refused() {
        use Format as F;
        let lenses: [(F, &[Distortion]); 6] = [
            (F::Pose2Sim, &[WITH_K3, FISHEYE, RATIONAL]),
            (F::Anipose, &[RATIONAL]),
            (F::Kalibr, &[WITH_K3, RATIONAL]),
            (F::EasyMocap, &[FISHEYE, RATIONAL]),
            (F::Matrices, &[FISHEYE, RATIONAL]),
            (F::Transforms, &[FISHEYE, RATIONAL]),
        ];
        for (format, lenses) in lenses {
            for &lens in lenses {
                let refused = to_text(&rig(["cam0", "cam1"], [PLAIN, lens]), format).unwrap_err();
                let is_place = format == F::Kalibr && matches!(refused, Refusal::Place { .. });
                assert!(matches!(refused, Refusal::Lens { .. }) || is_place, "{}: {refused}", format.name());
            }
        }
        for (format, name) in [
            (F::Pose2Sim, "metadata"),
            (F::Anipose, "metadata"),
            (F::EasyMocap, "a/b"),
            (F::OpenCvXml, "a\"b"),
            (F::Kalibr, "left"),
        ] {
            let refused = to_text(&rig([name, "cam1"], [PLAIN, PLAIN]), format).unwrap_err();
            assert!(matches!(refused, Refusal::Name { .. }), "{}: {refused}", format.name());
        }
    }

    #[test]
    fn formats_have_names() {
        for format in Format::ALL {
            assert_eq!(Format::from_name(format.name()), Some(format));
        }
        assert_eq!(Format::from_name("obj"), None);
    }
}
