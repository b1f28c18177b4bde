//! Starts from a file: the body, cameras by their number, true and start states, and masks packed bit by bit.
//!
//! The file is JSON. `model.limbs` have `name`, `parent` (index or −1), `rot` (index of the rotation followed,
//! in the order in which limbs with `own` introduce them), rest direction `v`, radius `r` and length `s` in
//! metres. `cameras[N]` is a list of N cameras: centre `c`, `R` with the camera's axes as rows, focal length
//! `f`, size `W` × `H`, `cx`, `cy` counted from the picture's corner. `starts` have `angle_deg`, `truth` and
//! `start` (root, then w x y z a rotation) and `masks[N]`: base64 of the pixels row by row, first pixel in the
//! highest bit, 1 = subject.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use backlit_tracking::body::{self, LimbSpec, Model, ModelError, ModelSpec, Pose, PoseError};
use backlit_tracking::camera::{Camera, CameraError, CameraFromWorld, Distortion, Intrinsics};
use backlit_tracking::fit::{Evidence, FitView};
use backlit_tracking::silhouette::{Label, Mask, MaskError};
use glam::{DMat3, DVec3};
use serde::Deserialize;
use thiserror::Error;

use crate::FileError;
use crate::files::{DiskFiles, MAX_TEXT_BYTES, TakeFiles};

/// A start, its truth, and what the cameras see of the truth.
#[derive(Debug, Clone)]
pub struct Start {
    /// The body.
    pub model: Arc<Model>,
    /// Degrees that every joint is off.
    pub degrees: u32,
    /// Where it is.
    pub truth: Pose,
    /// Where the fit begins.
    pub start: Pose,
    /// By number of cameras, what each sees.
    pub views: BTreeMap<usize, Vec<FitView>>,
}

/// Why a file of starts could not be read.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum StartsFileError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error("{}: {error}", path.display())]
    Json { path: PathBuf, error: serde_json::Error },
    #[error("{}: `model`: {error}", path.display())]
    Model { path: PathBuf, error: ModelError },
    #[error("{}: `model.limbs[{limb}].{field}` is {value}; expected the index of another", path.display())]
    Limb { path: PathBuf, limb: usize, field: &'static str, value: i64 },
    #[error("{}: `cameras.{count}`: {error}", path.display())]
    Camera { path: PathBuf, count: usize, error: CameraError },
    #[error("{}: `starts[{start}].{field}`: {error}", path.display())]
    Pose { path: PathBuf, start: usize, field: &'static str, error: PoseError },
    #[error("{}: `starts[{start}].masks.{count}[{camera}]` has {found} pixels; expected {expected}", path.display())]
    Pixels { path: PathBuf, start: usize, count: usize, camera: usize, found: usize, expected: usize },
    #[error("{}: `starts[{start}].masks.{count}`: {error}", path.display())]
    Mask { path: PathBuf, start: usize, count: usize, error: MaskError },
    #[error("{}: `starts` is empty; expected at least one", path.display())]
    Empty { path: PathBuf },
}

#[derive(Deserialize)]
struct StartsJson {
    model: ModelJson,
    cameras: BTreeMap<usize, Vec<CameraJson>>,
    starts: Vec<StartJson>,
}

#[derive(Deserialize)]
struct ModelJson {
    limbs: Vec<LimbJson>,
}

#[derive(Deserialize)]
struct LimbJson {
    name: String,
    parent: i64,
    rot: i64,
    own: bool,
    v: DVec3,
    r: f64,
    s: f64,
}

#[derive(Deserialize)]
#[expect(non_snake_case, reason = "the file's names")]
struct CameraJson {
    c: DVec3,
    R: [DVec3; 3],
    f: f64,
    W: u64,
    H: u64,
    cx: f64,
    cy: f64,
}

#[derive(Deserialize)]
struct StartJson {
    angle_deg: f64,
    truth: Vec<f64>,
    start: Vec<f64>,
    masks: BTreeMap<usize, Vec<String>>,
}

/// Reads all starts.
///
/// # Errors
/// The first thing that is wrong, by field.
pub fn read(path: &Path) -> Result<Vec<Start>, StartsFileError> {
    let bytes = DiskFiles.read(path, MAX_TEXT_BYTES)?;
    let json = |error| StartsFileError::Json { path: path.to_owned(), error };
    let file: StartsJson = serde_json::from_slice(&bytes).map_err(json)?;
    if file.starts.is_empty() {
        return Err(StartsFileError::Empty { path: path.to_owned() });
    }
    let model = Arc::new(file.model.model(path)?);
    let mut cameras = BTreeMap::new();
    for (&count, list) in &file.cameras {
        let camera = |(index, camera): (usize, &CameraJson)| camera.camera(index).map(Arc::new);
        let list = list.iter().enumerate().map(camera).collect::<Result<Vec<_>, _>>();
        let failed = |error| StartsFileError::Camera { path: path.to_owned(), count, error };
        cameras.insert(count, list.map_err(failed)?);
    }
    let starts = file.starts.iter().enumerate();
    starts.map(|(index, start)| start.start(path, index, &model, &cameras)).collect()
}

impl ModelJson {
    fn model(&self, path: &Path) -> Result<Model, StartsFileError> {
        let owners: Vec<&str> =
            self.limbs.iter().filter(|limb| limb.own).map(|limb| limb.name.as_str()).collect();
        let mut limbs = Vec::with_capacity(self.limbs.len());
        for (index, limb) in self.limbs.iter().enumerate() {
            let wrong =
                |field, value| StartsFileError::Limb { path: path.to_owned(), limb: index, field, value };
            let parent = match usize::try_from(limb.parent) {
                Ok(parent) => {
                    let other = self.limbs.get(parent).ok_or_else(|| wrong("parent", limb.parent))?;
                    Some(other.name.clone())
                }
                Err(_) => None,
            };
            let owner = usize::try_from(limb.rot).ok().and_then(|rot| owners.get(rot));
            let owner = owner.ok_or_else(|| wrong("rot", limb.rot))?;
            limbs.push(LimbSpec {
                name: limb.name.clone(),
                parent,
                rigid_with: (!limb.own).then(|| (*owner).to_owned()),
                direction: limb.v,
                length: limb.s,
                radius: limb.r,
                limits: None,
                spheres: Vec::new(),
            });
        }
        let spec = ModelSpec { format: body::FORMAT.to_owned(), name: "starts".to_owned(), limbs };
        Model::new(&spec).map_err(|error| StartsFileError::Model { path: path.to_owned(), error })
    }
}

impl CameraJson {
    fn camera(&self, index: usize) -> Result<Camera, CameraError> {
        let [x, y, z] = self.R;
        let rotation = DMat3::from_cols(x, y, z).transpose();
        // Here the centre of the first pixel is at (0, 0), there at (½, ½).
        let pinhole = Intrinsics { fx: self.f, fy: self.f, cx: self.cx - 0.5, cy: self.cy - 0.5 };
        let place = CameraFromWorld { rotation, translation: -(rotation * self.c) };
        Camera::new(&format!("cam{:02}", index + 1), [self.W, self.H], pinhole, Distortion::None, place)
    }
}

impl StartJson {
    fn start(
        &self,
        path: &Path,
        index: usize,
        model: &Arc<Model>,
        cameras: &BTreeMap<usize, Vec<Arc<Camera>>>,
    ) -> Result<Start, StartsFileError> {
        let pose = |field, state: &[f64]| {
            let failed = |error| StartsFileError::Pose { path: path.to_owned(), start: index, field, error };
            Pose::from_state(model, state).map(|pose| pose.normalized()).map_err(failed)
        };
        let mut views = BTreeMap::new();
        for (&count, masks) in &self.masks {
            let Some(cameras) = cameras.get(&count) else { continue };
            let mut list = Vec::with_capacity(cameras.len());
            for (at, (camera, text)) in cameras.iter().zip(masks).enumerate() {
                let (width, height) = (camera.width(), camera.height());
                let (bits, expected) = (bits(text), width * height);
                if bits.len() < expected {
                    return Err(StartsFileError::Pixels {
                        path: path.to_owned(),
                        start: index,
                        count,
                        camera: at,
                        found: bits.len(),
                        expected,
                    });
                }
                let failed =
                    |error| StartsFileError::Mask { path: path.to_owned(), start: index, count, error };
                let mask = Mask::new(width, height, bits[..expected].to_vec()).map_err(failed)?;
                let evidence = Evidence::Mask(Arc::new(mask));
                list.push(FitView { camera: Arc::clone(camera), evidence, weight: 1.0 });
            }
            views.insert(count, list);
        }
        Ok(Start {
            model: Arc::clone(model),
            // A float cast saturates.
            degrees: self.angle_deg.round() as u32,
            truth: pose("truth", &self.truth)?,
            start: pose("start", &self.start)?,
            views,
        })
    }
}

/// The bits of a base64 text as labels, highest first; characters of no meaning are left out.
fn bits(text: &str) -> Vec<Label> {
    let digit = |byte: u8| match byte {
        b'A'..=b'Z' => Some(byte - b'A'),
        b'a'..=b'z' => Some(byte - b'a' + 26),
        b'0'..=b'9' => Some(byte - b'0' + 52),
        b'+' => Some(62),
        b'/' => Some(63),
        _ => None,
    };
    let sixes = text.bytes().filter_map(digit);
    let label = |bit: bool| if bit { Label::Subject } else { Label::Background };
    sixes.flat_map(|six| (0..6).rev().map(move |bit| label(six >> bit & 1 == 1))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = r#"{
        "model": {"limbs": [
            {"name": "a", "parent": -1, "rot": 0, "own": true, "v": [0, 1, 0], "r": 0.1, "s": 0.5},
            {"name": "b", "parent": 0, "rot": 0, "own": false, "v": [0, 1, 0], "r": 0.1, "s": 0.2}]},
        "cameras": {"1": [{"c": [0, 0, -2], "R": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "f": 4, "W": 4, "H": 2,
            "cx": 2, "cy": 1}]},
        "starts": [{"angle_deg": 5, "truth": [0, 0, 0, 1, 0, 0, 0], "start": [0, 0, 0, 1, 0, 0, 0],
            "masks": {"1": ["Bg=="]}}]}"#;

    fn read_text(text: &str) -> Result<Vec<Start>, StartsFileError> {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), text).unwrap();
        read(file.path())
    }

    #[test]
    fn masks_cameras_and_bodies_are_read() {
        let starts = read_text(FILE).unwrap();
        let view = &starts[0].views[&1][0];
        let Evidence::Mask(mask) = &view.evidence else { panic!("no mask") };
        assert_eq!(mask.to_string().trim(), "....\n.##.");
        assert_eq!((view.camera.intrinsics().cx, view.camera.intrinsics().cy), (1.5, 0.5));
        assert_eq!(starts[0].model.rotation_count(), 1);
    }

    #[test]
    fn what_is_wrong_is_named() {
        let cases = [
            ("\"parent\": 0", "\"parent\": 7", "`model.limbs[1].parent` is 7"),
            ("\"rot\": 0, \"own\": false", "\"rot\": 3, \"own\": false", "`model.limbs[1].rot` is 3"),
            ("\"f\": 4", "\"f\": 0", "`cameras.1`: `fx` is 0"),
            ("Bg==", "", "`starts[0].masks.1[0]` has 0 pixels; expected 8"),
            ("\"truth\": [0, 0,", "\"truth\": [0,", "`starts[0].truth`"),
            ("\"starts\": [{", "\"starts\": {", "expected a sequence"),
        ];
        for (from, to, expected) in cases {
            let message = read_text(&FILE.replace(from, to)).unwrap_err().to_string();
            assert!(message.contains(expected), "{message:?} should contain {expected:?}");
        }
    }
}
