//! The project file `*.backlit`: a document as versioned JSON.
//!
//! Poses are written by limb name, so that a person can read them; numbers are written so that they are read
//! back to the bit.

use std::collections::{BTreeMap, BTreeSet};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use backlit_tracking::body::{Model, ModelError, ModelSpec, Pose, PoseError};
use backlit_tracking::io::calibration::{CalibrationOptions, backlit};
use backlit_tracking::io::{FileError, atomic, reason};
use backlit_tracking::segment::{SegmentError, SegmentOptions};
use backlit_tracking::track::FitOptions;
use backlit_tracking::track::options::OptionsError;
use glam::{DQuat, DVec3};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::demonstration::Demonstration;
use crate::document::{CameraUse, Document, Estimate, Origin, TakeSource};
use crate::replacement::{Calibration, MaskFiles};
use crate::tracking_choices::TrackingChoices;

/// Name and version of the project file's format.
pub const FORMAT: &str = "backlit-project 1";

/// Files larger than this are not projects.
const MAX_BYTES: u64 = 256 << 20;

/// Why a project cannot be read or written.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum ProjectError {
    #[error("{}: {}", path.display(), said(.source))]
    Io { path: PathBuf, source: std::io::Error },
    #[error(transparent)]
    File(#[from] FileError),
    #[error("{}: the file has {bytes} bytes; a project has at most {MAX_BYTES}", path.display())]
    TooLarge { path: PathBuf, bytes: u64 },
    #[error("{}: {source}", path.display())]
    Json { path: PathBuf, source: serde_json::Error },
    #[error("{}: `format` is \"{found}\"; expected \"{FORMAT}\"", path.display())]
    Format { path: PathBuf, found: String },
    #[error(
        "{}: a newer Backlit wrote this project (\"{found}\"; this one reads \"{FORMAT}\"): open it with that one",
        path.display()
    )]
    Newer { path: PathBuf, found: String },
    #[error("{}, line {line}: the file ends too early: it was cut off", path.display())]
    Cut { path: PathBuf, line: usize },
    #[error("{}: `model`: {source}", path.display())]
    Model { path: PathBuf, source: ModelError },
    #[error("{}: `{field}`: {source}", path.display())]
    Pose { path: PathBuf, field: String, source: PoseError },
    #[error("{}: `{field}` names the limb \"{limb}\", which the model does not have", path.display())]
    Limb { path: PathBuf, field: String, limb: String },
    #[error("{}: `masks.{frame}` names the camera \"{camera}\", which the take does not have", path.display())]
    MaskCamera { path: PathBuf, frame: usize, camera: String },
    #[error("{}: `fit`: {source}", path.display())]
    Fit { path: PathBuf, source: OptionsError },
    #[error("{}: `measurement`, camera {index} counted from 0: {source}", path.display())]
    Measurement { path: PathBuf, index: usize, source: SegmentError },
    #[error("{}: `cameras`: the weight of {camera} is {weight}; expected a number from 0 on", path.display())]
    Weight { path: PathBuf, camera: String, weight: f64 },
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ProjectFile {
    format: String,
    take: Option<TakeRecord>,
    model: ModelSpec,
    start: PoseRecord,
    #[serde(default)]
    keys: BTreeMap<usize, PoseRecord>,
    #[serde(default)]
    estimates: BTreeMap<usize, EstimateRecord>,
    #[serde(default)]
    cameras: Vec<CameraRecord>,
    #[serde(default)]
    fit: FitOptions,
    /// Left out, it is what goes with the fit.
    #[serde(default)]
    tracking: Option<TrackingChoices>,
    #[serde(default)]
    measurement: Vec<SegmentOptions>,
    #[serde(default)]
    pins: Vec<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    calibration: Option<CalibrationRecord>,
    /// By frame, then by camera's name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    masks: BTreeMap<usize, BTreeMap<String, PathBuf>>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct CalibrationRecord {
    file: PathBuf,
    /// As in a file `backlit-cameras 1`, so that nothing is lost with the file.
    cameras: serde_json::Value,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum TakeRecord {
    BuiltIn,
    Demonstration(Demonstration),
    Path(PathBuf),
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct PoseRecord {
    root: [f64; 3],
    /// w x y z by the limb that owns the rotation; left out where it is at rest.
    #[serde(default)]
    rotations: BTreeMap<String, [f64; 4]>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct EstimateRecord {
    pose: PoseRecord,
    origin: OriginRecord,
    cost: f64,
    rms: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    iou: Option<f64>,
    steps: usize,
    lost: bool,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum OriginRecord {
    Fit,
    Track,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct CameraRecord {
    name: String,
    used: bool,
    weight: f64,
}

/// Writes a document. The file appears whole or not at all.
///
/// # Errors
/// The file system says no.
pub fn write_project(path: &Path, document: &Document) -> Result<(), ProjectError> {
    let file = to_file(document);
    let json = serde_json::to_vec_pretty(&file)
        .map_err(|source| ProjectError::Json { path: path.to_owned(), source })?;
    Ok(atomic::write(path, &json)?)
}

/// Reads a document; it is equal to the one that was written.
///
/// # Errors
/// The first thing that is wrong, with the file and the field.
pub fn read_project(path: &Path) -> Result<Document, ProjectError> {
    let io = |source| ProjectError::Io { path: path.to_owned(), source };
    let bytes = std::fs::metadata(path).map_err(io)?.len();
    if bytes > MAX_BYTES {
        return Err(ProjectError::TooLarge { path: path.to_owned(), bytes });
    }
    let text = std::fs::read(path).map_err(io)?;
    let json = |source: serde_json::Error| {
        let path = path.to_owned();
        if source.is_eof() {
            ProjectError::Cut { path, line: source.line() }
        } else {
            ProjectError::Json { path, source }
        }
    };
    // The version first: another version's fields would only confuse.
    let header: Header = serde_json::from_slice(&text).map_err(json)?;
    if header.format != FORMAT {
        let (path, found) = (path.to_owned(), header.format);
        let is_newer = version(&found) > version(FORMAT);
        return Err(if is_newer {
            ProjectError::Newer { path, found }
        } else {
            ProjectError::Format { path, found }
        });
    }
    let file: ProjectFile = serde_json::from_slice(&text).map_err(json)?;
    Reader { path }.document(file)
}

/// What the system says of a file that cannot be read.
fn said(error: &std::io::Error) -> String {
    if error.kind() == ErrorKind::NotFound { "there is no such file".to_owned() } else { reason(error) }
}

/// The version of a project's format; none of another format's.
fn version(format: &str) -> Option<u64> {
    let (name, version) = format.split_once(' ')?;
    version.parse().ok().filter(|_| FORMAT.split_once(' ').is_some_and(|(ours, _)| ours == name))
}

#[derive(Debug, Deserialize)]
struct Header {
    format: String,
}

fn to_file(document: &Document) -> ProjectFile {
    let model = &*document.model;
    ProjectFile {
        format: FORMAT.to_owned(),
        take: document.take.as_ref().map(|take| match take {
            TakeSource::BuiltIn => TakeRecord::BuiltIn,
            TakeSource::Demonstration(which) => TakeRecord::Demonstration(*which),
            TakeSource::Path(path) => TakeRecord::Path(path.clone()),
        }),
        model: model.to_spec(),
        start: pose_record(model, &document.start),
        keys: document.keys.iter().map(|(frame, pose)| (*frame, pose_record(model, pose))).collect(),
        estimates: document
            .estimates
            .iter()
            .map(|(frame, estimate)| (*frame, estimate_record(model, estimate)))
            .collect(),
        cameras: document
            .cameras
            .iter()
            .map(|camera| CameraRecord {
                name: camera.name.clone(),
                used: camera.used,
                weight: camera.weight,
            })
            .collect(),
        fit: (*document.fit).clone(),
        tracking: Some(document.tracking),
        measurement: (*document.measurement).clone(),
        pins: document.pins.iter().map(|&limb| model.limbs()[limb].name.clone()).collect(),
        calibration: document.calibration.as_ref().map(|calibration| CalibrationRecord {
            file: calibration.path.clone(),
            cameras: serde_json::from_str(&backlit::to_text(&calibration.rig)).unwrap_or_default(),
        }),
        masks: document.masks.iter().map(|(frame, masks)| (*frame, mask_records(document, masks))).collect(),
    }
}

fn mask_records(document: &Document, masks: &BTreeMap<usize, PathBuf>) -> BTreeMap<String, PathBuf> {
    let named = |(camera, path): (&usize, &PathBuf)| {
        document.cameras.get(*camera).map(|camera| (camera.name.clone(), path.clone()))
    };
    masks.iter().filter_map(named).collect()
}

fn pose_record(model: &Model, pose: &Pose) -> PoseRecord {
    let owners = model.rotation_owners().iter();
    let rotations = owners
        .zip(&pose.rotations)
        .map(|(&owner, q)| (model.limbs()[owner].name.clone(), [q.w, q.x, q.y, q.z]))
        .collect();
    PoseRecord { root: pose.root.to_array(), rotations }
}

fn estimate_record(model: &Model, estimate: &Estimate) -> EstimateRecord {
    EstimateRecord {
        pose: pose_record(model, &estimate.pose),
        origin: match estimate.origin {
            Origin::Fit => OriginRecord::Fit,
            Origin::Track => OriginRecord::Track,
        },
        cost: estimate.cost,
        rms: estimate.rms,
        iou: estimate.iou,
        steps: estimate.steps,
        lost: estimate.lost,
    }
}

struct Reader<'a> {
    path: &'a Path,
}

impl Reader<'_> {
    fn document(&self, file: ProjectFile) -> Result<Document, ProjectError> {
        let model = Model::new(&file.model)
            .map_err(|source| ProjectError::Model { path: self.path.to_owned(), source })?;
        let wrong = |source| ProjectError::Fit { path: self.path.to_owned(), source };
        file.fit.check().map_err(wrong)?;
        for (index, options) in file.measurement.iter().enumerate() {
            let path = self.path.to_owned();
            options.check().map_err(|source| ProjectError::Measurement { path, index, source })?;
        }
        let start = self.pose(&model, "start", &file.start)?;
        let mut keys = BTreeMap::new();
        for (frame, record) in &file.keys {
            keys.insert(*frame, self.pose(&model, &format!("keys.{frame}"), record)?);
        }
        let mut estimates = BTreeMap::new();
        for (frame, record) in &file.estimates {
            let pose = self.pose(&model, &format!("estimates.{frame}.pose"), &record.pose)?;
            estimates.insert(*frame, Arc::new(estimate(pose, record)));
        }
        let mut pins = BTreeSet::new();
        for name in &file.pins {
            pins.insert(self.limb(&model, "pins", name)?);
        }
        let cameras = self.cameras(file.cameras)?;
        let masks = self.masks(&cameras, file.masks)?;
        let calibration = file.calibration.map(|record| self.calibration(record)).transpose()?;
        Ok(Document {
            take: file.take.map(|take| match take {
                TakeRecord::BuiltIn => TakeSource::BuiltIn,
                TakeRecord::Demonstration(which) => TakeSource::Demonstration(which),
                TakeRecord::Path(path) => TakeSource::Path(path),
            }),
            model: Arc::new(model),
            start: Arc::new(start),
            keys: Arc::new(keys),
            estimates: Arc::new(estimates),
            cameras: Arc::new(cameras),
            tracking: file.tracking.unwrap_or_else(|| TrackingChoices::of_preset(file.fit.as_preset())),
            fit: Arc::new(file.fit),
            measurement: Arc::new(file.measurement),
            pins: Arc::new(pins),
            calibration,
            masks: Arc::new(masks),
        })
    }

    fn cameras(&self, records: Vec<CameraRecord>) -> Result<Vec<CameraUse>, ProjectError> {
        let camera = |record: CameraRecord| {
            if record.weight.is_finite() && record.weight >= 0.0 {
                Ok(CameraUse { name: record.name, used: record.used, weight: record.weight })
            } else {
                let path = self.path.to_owned();
                Err(ProjectError::Weight { path, camera: record.name, weight: record.weight })
            }
        };
        records.into_iter().map(camera).collect()
    }

    fn calibration(&self, record: CalibrationRecord) -> Result<Arc<Calibration>, ProjectError> {
        let json = |source| ProjectError::Json { path: self.path.to_owned(), source };
        let text = serde_json::to_string(&record.cameras).map_err(json)?;
        let rig = backlit::parse(self.path, &text, CalibrationOptions::default())?;
        Ok(Arc::new(Calibration { path: record.file, rig }))
    }

    fn masks(
        &self,
        cameras: &[CameraUse],
        records: BTreeMap<usize, BTreeMap<String, PathBuf>>,
    ) -> Result<MaskFiles, ProjectError> {
        let mut masks = MaskFiles::new();
        for (frame, record) in records {
            for (name, path) in record {
                let camera = cameras.iter().position(|camera| camera.name == name);
                let camera = camera.ok_or_else(|| ProjectError::MaskCamera {
                    path: self.path.to_owned(),
                    frame,
                    camera: name.clone(),
                })?;
                masks.entry(frame).or_default().insert(camera, path);
            }
        }
        Ok(masks)
    }

    fn pose(&self, model: &Model, field: &str, record: &PoseRecord) -> Result<Pose, ProjectError> {
        let mut pose = Pose::rest(model);
        pose.root = DVec3::from_array(record.root);
        for (name, [w, x, y, z]) in &record.rotations {
            let limb = self.limb(model, field, name)?;
            pose.rotations[model.limbs()[limb].rotation] = DQuat::from_xyzw(*x, *y, *z, *w);
        }
        let wrong =
            |source| ProjectError::Pose { path: self.path.to_owned(), field: field.to_owned(), source };
        pose.check(model).map_err(wrong)?;
        Ok(pose)
    }

    fn limb(&self, model: &Model, field: &str, name: &str) -> Result<usize, ProjectError> {
        model.limb_index(name).ok_or_else(|| ProjectError::Limb {
            path: self.path.to_owned(),
            field: field.to_owned(),
            limb: name.to_owned(),
        })
    }
}

fn estimate(pose: Pose, record: &EstimateRecord) -> Estimate {
    Estimate {
        pose,
        origin: match record.origin {
            OriginRecord::Fit => Origin::Fit,
            OriginRecord::Track => Origin::Track,
        },
        cost: record.cost,
        rms: record.rms,
        iou: record.iou,
        steps: record.steps,
        lost: record.lost,
    }
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::{Parameters, builtin};

    use backlit_tracking::track::Search;

    use super::*;
    use crate::edit::Edit;
    use crate::tracking_choices::Following;

    fn example() -> Document {
        let mut document = Document::new(builtin::upper_body());
        document.take = Some(TakeSource::Path(PathBuf::from("/takes/balancing")));
        document.cameras =
            Arc::new(vec![CameraUse { name: "cam01".to_owned(), used: true, weight: 1.0 / 3.0 }]);
        let step: Vec<f64> = (0..27).map(|i| 0.3 * (f64::from(i) * 1.7).sin()).collect();
        let pose = document.start.retract(Parameters::Tangent, &step);
        let estimate = Estimate {
            pose: pose.clone(),
            origin: Origin::Track,
            cost: 1.25e8,
            rms: 20.5,
            iou: Some(0.83),
            steps: 21,
            lost: false,
        };
        document.measurement = Arc::new(vec![SegmentOptions::default()]);
        for edit in [
            Edit::SetPose { frame: 3, pose, what: "Move".to_owned() },
            Edit::AddEstimate { frame: 4, estimate: Arc::new(estimate) },
            Edit::UseCamera { camera: 0, used: false },
            Edit::SetTracking(TrackingChoices {
                motion: Following::Smoothed { lag: Some(3) },
                search: Search::Never,
            }),
            Edit::Pin { limb: 5, pinned: true },
            Edit::SetSize { limb: 2, length: 0.2, radius: 0.05, both_sides: true },
            Edit::SetCalibration(Some(calibration())),
            Edit::SetMasks { frame: 4, masks: BTreeMap::from([(0, PathBuf::from("/masks/cam01.png"))]) },
        ] {
            document.apply(edit).unwrap();
        }
        document
    }

    fn calibration() -> Arc<Calibration> {
        use backlit_tracking::camera::{Camera, CameraFromWorld, Distortion, Intrinsics, Rig};
        let intrinsics = Intrinsics { fx: 410.123_456_789, fy: 1e3 / 3.0, cx: 135.5, cy: 0.1 + 0.2 };
        let place = CameraFromWorld::looking_at(DVec3::new(0.1, -2.7, 1.3), DVec3::ZERO, DVec3::Z);
        let lens = Distortion::OpenCv { k1: -0.1, k2: 1e-9, p1: 0.0, p2: 0.7, k3: 0.0 };
        let camera = Camera::new("cam01", [272, 480], intrinsics, lens, place).unwrap();
        Arc::new(Calibration { path: PathBuf::from("/c.qca.txt"), rig: Rig::new(vec![camera]).unwrap() })
    }

    #[test]
    fn a_project_is_read_back_equal() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.backlit");
        let document = example();
        write_project(&path, &document).unwrap();
        assert_eq!(read_project(&path).unwrap(), document);
        let names: Vec<_> =
            std::fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
        assert_eq!(names, ["a.backlit"], "nothing else is left in the folder");
    }

    #[test]
    fn a_project_from_before_the_choices_of_tracking_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("old.backlit");
        write_project(&path, &example()).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        let mut json: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert!(json.as_object_mut().unwrap().remove("tracking").is_some());
        std::fs::write(&path, json.to_string()).unwrap();
        let tracking = read_project(&path).unwrap().tracking;
        assert_eq!(tracking, TrackingChoices { motion: Following::Velocity, search: Search::WhenPoor });
    }

    #[test]
    fn errors_name_file_and_field() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("b.backlit");
        write_project(&path, &example()).unwrap();
        let good = std::fs::read_to_string(&path).unwrap();
        for (from, to, expected) in [
            ("backlit-project 1", "backlit-project 9", "a newer Backlit wrote this project"),
            ("backlit-project 1", "backlit-pose 9", "`format` is \"backlit-pose 9\""),
            ("\"weight\": 0.3333333333333333", "\"weight\": -1", "weight of cam01 is -1"),
            ("\"pins\": [", "\"pins\": [\"tail\",", "`pins` names the limb \"tail\""),
            ("\"z_threshold\": 3", "\"z_threshold\": -3", "`measurement`, camera 0 counted from 0: "),
            ("\"lost\": false", "\"lost\": false, \"colour\": 1", "unknown field `colour`"),
        ] {
            assert!(good.contains(from), "{from}");
            std::fs::write(&path, good.replacen(from, to, 1)).unwrap();
            let message = read_project(&path).unwrap_err().to_string();
            assert!(message.contains(expected) && message.contains("b.backlit"), "{message}");
        }
        for cut in [0, 1, good.len() / 2, good.trim_end().len() - 1] {
            std::fs::write(&path, &good[..cut]).unwrap();
            let message = read_project(&path).unwrap_err().to_string();
            assert!(message.contains("b.backlit, line") && message.contains("was cut off"), "{message}");
        }
        let message = read_project(&folder.path().join("none.backlit")).unwrap_err().to_string();
        assert!(message.contains("none.backlit: there is no such file"), "{message}");
    }
}
