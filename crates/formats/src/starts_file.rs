//! Starts from a file: the body, cameras by their number, true and start states, and masks packed bit by bit.
//!
//! The file is JSON. `model.limbs` have `name`, `parent` (index or −1), `rot` (index of the rotation followed,
//! in the order in which limbs with `own` introduce them), rest direction `v`, radius `r` and length `s` in
//! metres. `cameras[N]` is a list of N cameras: centre `c`, `R` with the camera's axes as rows, focal length
//! `f`, size `W` × `H`, `cx`, `cy` counted from the picture's corner. `starts` have `angle_deg`, `truth` and
//! `start` (root, then w x y z a rotation) and `masks[N]`: base64 of the pixels row by row, first pixel in the
//! highest bit, 1 = subject. Every start has a mask for every camera of every list of `cameras`, in its order, and no other.
//! Keys that are not known, and keys that are given twice, are refused; `note`, `rot_parent`, `rot_limb`, `chain`, `index` and
//! `root_m` are what the writer noted for people.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use backlit_tracking::body::{self, LimbSpec, Model, ModelSpec, Pose};
use backlit_tracking::camera::{Camera, CameraError, CameraFromWorld, Distortion, Intrinsics};
use backlit_tracking::fit::{Evidence, FitView};
use backlit_tracking::silhouette::{Label, Mask};
use glam::{DMat3, DVec3};
use serde::Deserialize;
use serde::de::IgnoredAny;

use crate::files::{DiskFiles, MAX_TEXT_BYTES, TakeFiles};
use crate::json_text::{self, Entries};
use crate::text::decode;
use crate::{FileProblem, Result, base64};

/// Bits behind a mask's last pixel: up to 7 fill its byte, up to 4 the last character.
const PADDING_BITS: usize = 12;

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

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StartsJson {
    #[serde(default, rename = "note")]
    _note: IgnoredAny,
    model: ModelJson,
    cameras: Entries<Vec<CameraJson>>,
    starts: Vec<StartJson>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ModelJson {
    limbs: Vec<LimbJson>,
    #[serde(default, rename = "rot_parent")]
    _rot_parent: IgnoredAny,
    #[serde(default, rename = "rot_limb")]
    _rot_limb: IgnoredAny,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LimbJson {
    name: String,
    #[serde(default, rename = "chain")]
    _chain: IgnoredAny,
    #[serde(default, rename = "index")]
    _index: IgnoredAny,
    parent: i64,
    rot: i64,
    own: bool,
    v: DVec3,
    r: f64,
    s: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
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
#[serde(deny_unknown_fields)]
struct StartJson {
    angle_deg: f64,
    #[serde(default, rename = "root_m")]
    _root_m: IgnoredAny,
    truth: Vec<f64>,
    start: Vec<f64>,
    masks: Entries<Vec<String>>,
}

type Cameras = BTreeMap<usize, Vec<Arc<Camera>>>;

/// Reads all starts.
pub fn read(path: &Path) -> Result<Vec<Start>> {
    parse(path, &DiskFiles.read(path, MAX_TEXT_BYTES)?)
}

/// The same from bytes; `path` is for the error's message.
pub fn parse(path: &Path, bytes: &[u8]) -> Result<Vec<Start>> {
    let file: StartsJson = json_text::parse(path, decode(path, bytes)?)?;
    file.starts().map_err(|problem| problem.at(path, None))
}

/// A key that says how many cameras a list is for.
fn counted(field: &str, key: &str) -> Result<usize, FileProblem> {
    let count = key.parse::<usize>().ok().filter(|count| count.to_string() == key);
    count.ok_or_else(|| FileProblem::field(field, format!("with the key \"{key}\""), "a number of cameras"))
}

/// What another type says is wrong with a field.
fn wrong(field: String) -> impl FnOnce(&dyn std::fmt::Display) -> FileProblem {
    move |error| FileProblem::Option { field, message: error.to_string() }
}

impl StartsJson {
    fn starts(&self) -> Result<Vec<Start>, FileProblem> {
        if self.starts.is_empty() {
            return Err(FileProblem::field("starts", "empty", "at least one"));
        }
        let model = Arc::new(self.model.model()?);
        let mut cameras = BTreeMap::new();
        for (key, list) in &self.cameras.0 {
            let count = counted("cameras", key)?;
            if list.len() != count {
                let found = format!("a list of {}", list.len());
                return Err(FileProblem::field(format!("cameras.{key}"), found, format!("{count} cameras")));
            }
            let camera = |(index, camera): (usize, &CameraJson)| camera.camera(index).map(Arc::new);
            let list = list.iter().enumerate().map(camera).collect::<Result<Vec<_>, _>>();
            cameras.insert(count, list.map_err(|error| wrong(format!("cameras.{count}"))(&error))?);
        }
        let starts = self.starts.iter().enumerate();
        starts.map(|(index, start)| start.start(&format!("starts[{index}]"), &model, &cameras)).collect()
    }
}

impl ModelJson {
    fn model(&self) -> Result<Model, FileProblem> {
        let owners: Vec<&str> =
            self.limbs.iter().filter(|limb| limb.own).map(|limb| limb.name.as_str()).collect();
        let mut limbs = Vec::with_capacity(self.limbs.len());
        for (index, limb) in self.limbs.iter().enumerate() {
            let wrong = |field: &str, value: i64| {
                let field = format!("model.limbs[{index}].{field}");
                FileProblem::field(field, value.to_string(), "the index of another")
            };
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
                coarser: Vec::new(),
            });
        }
        let spec = ModelSpec { format: body::FORMAT.to_owned(), name: "starts".to_owned(), limbs };
        Model::new(&spec).map_err(|error| wrong("model".to_owned())(&error))
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
    /// The start, which stands at `field` of the file.
    fn start(&self, field: &str, model: &Arc<Model>, cameras: &Cameras) -> Result<Start, FileProblem> {
        let pose = |name: &str, state: &[f64]| {
            let pose = Pose::from_state(model, state).map(|pose| pose.normalized());
            pose.map_err(|error| wrong(format!("{field}.{name}"))(&error))
        };
        if !(0.0..=360.0).contains(&self.angle_deg) {
            let (field, found) = (format!("{field}.angle_deg"), self.angle_deg.to_string());
            return Err(FileProblem::field(field, found, "degrees from 0 to 360"));
        }
        let mut views = BTreeMap::new();
        for (key, masks) in &self.masks.0 {
            let field = format!("{field}.masks");
            let count = counted(&field, key)?;
            let cameras = cameras.get(&count).ok_or_else(|| {
                let found = format!("with masks of {count} cameras");
                FileProblem::field(&*field, found, "as many as a list of `cameras` has")
            })?;
            views.insert(count, masks_of(&format!("{field}.{count}"), count, cameras, masks)?);
        }
        if let Some((&count, cameras)) = cameras.iter().find(|(count, _)| !views.contains_key(*count)) {
            masks_of(&format!("{field}.masks.{count}"), count, cameras, &[])?;
        }
        Ok(Start {
            model: Arc::clone(model),
            degrees: self.angle_deg.round() as u32,
            truth: pose("truth", &self.truth)?,
            start: pose("start", &self.start)?,
            views,
        })
    }
}

/// What a list of cameras sees.
fn masks_of(
    field: &str,
    count: usize,
    cameras: &[Arc<Camera>],
    masks: &[String],
) -> Result<Vec<FitView>, FileProblem> {
    let (found, expected) = (masks.len(), cameras.len());
    if found != expected {
        let expected = format!("{expected}, one a camera of `cameras.{count}`");
        return Err(FileProblem::field(field, format!("a list of {found} masks"), expected));
    }
    let view = |(at, (camera, text)): (usize, (&Arc<Camera>, &String))| {
        let (width, height) = (camera.width(), camera.height());
        let (bits, expected) = (bits(text), width * height);
        // Bytes are whole, and so are the characters of six bits.
        if !(expected..expected + PADDING_BITS).contains(&bits.len()) {
            let found = format!("a mask of {} pixels", bits.len());
            return Err(FileProblem::field(format!("{field}[{at}]"), found, expected.to_string()));
        }
        let mask = Mask::new(width, height, bits[..expected].to_vec());
        let mask = mask.map_err(|error| wrong(field.to_owned())(&error))?;
        Ok(FitView { camera: Arc::clone(camera), evidence: Evidence::Mask(Arc::new(mask)), weight: 1.0 })
    };
    cameras.iter().zip(masks).enumerate().map(view).collect()
}

/// The bits of a base64 text as labels, highest first; other characters are left out.
fn bits(text: &str) -> Vec<Label> {
    let label = |bit: bool| if bit { Label::Subject } else { Label::Background };
    base64::sixes(text).flat_map(|six| (0..6).rev().map(move |bit| label(six >> bit & 1 == 1))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::damaged::assert_refused;

    const FILE: &str = r#"{
        "model": {"limbs": [
            {"name": "a", "parent": -1, "rot": 0, "own": true, "v": [0, 1, 0], "r": 0.1, "s": 0.5},
            {"name": "b", "parent": 0, "rot": 0, "own": false, "v": [0, 1, 0], "r": 0.1, "s": 0.2}]},
        "cameras": {"1": [{"c": [0, 0, -2], "R": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "f": 4, "W": 4, "H": 2,
            "cx": 2, "cy": 1}]},
        "starts": [{"angle_deg": 5, "truth": [0, 0, 0, 1, 0, 0, 0], "start": [0, 0, 0, 1, 0, 0, 0],
            "masks": {"1": ["Bg=="]}}]}"#;

    fn read_text(text: &str) -> Result<Vec<Start>> {
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
        assert_refused(
            FILE,
            read_text,
            r#"
            "parent": 0 ⇒ "parent": 7 ⇒ `model.limbs[1].parent` is 7
            "rot": 0, "own": false ⇒ "rot": 3, "own": false ⇒ `model.limbs[1].rot` is 3
            "f": 4 ⇒ "f": 0 ⇒ `cameras.1`: `fx` is 0
            Bg== ⇒ ⇒ `starts[0].masks.1[0]` is a mask of 0 pixels; expected 8
            "truth": [0, 0, ⇒ "truth": [0, ⇒ `starts[0].truth`
            "starts": [{ ⇒ "starts": { ⇒ `starts` is a table; expected a list
            ["Bg=="] ⇒ [] ⇒ `starts[0].masks.1` is a list of 0 masks; expected 1, one a camera of `cameras.1`
            ["Bg=="] ⇒ ["Bg==", "Bg=="] ⇒ `starts[0].masks.1` is a list of 2 masks; expected 1
            {"1": ["Bg=="]} ⇒ {} ⇒ `starts[0].masks.1` is a list of 0 masks; expected 1
            {"1": ["Bg=="]} ⇒ {"1": ["Bg=="], "3": []} ⇒ is with masks of 3 cameras
            {"1": ["Bg=="]} ⇒ {"1": ["Bg=="], "1": ["Bg=="]} ⇒ "1" is given twice
            {"1": ["Bg=="]} ⇒ {"01": ["Bg=="]} ⇒ with the key "01"
            Bg== ⇒ BgAAAAAA ⇒ is a mask of 48 pixels; expected 8
            "angle_deg" ⇒ "angles_deg" ⇒ unknown field `angles_deg`
            "angle_deg": 5 ⇒ "angle_deg": -5 ⇒ `starts[0].angle_deg` is -5; expected degrees
            "cameras": {"1" ⇒ "cameras": {"2" ⇒ `cameras.2` is a list of 1; expected 2 cameras
            "name": "b" ⇒ "name": "b", "name": "b" ⇒ given twice: `name`
            "#,
        );
    }
}
