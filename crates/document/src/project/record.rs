//! A project as its file has it.

use std::collections::BTreeMap;
use std::path::PathBuf;

use backlit_formats::calibration::backlit;
use backlit_formats::json_text::unique_keys;
use backlit_take::demonstration::Demonstration;
use backlit_take::source::TakeSource;
use backlit_tracking::body::{Model, ModelSpec, Pose};
use backlit_tracking::fit::FitOptions;
use backlit_tracking::segment::SegmentOptions;
use serde::{Deserialize, Serialize};

use super::FORMAT;
use super::run_record::{RunRecord, run_record};
use crate::likely_poses;
use crate::run::Run;
use crate::tracking_choices::TrackingChoices;
use crate::{CameraUse, Document, Estimate, Origin};

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ProjectFile {
    pub(crate) format: String,
    pub(crate) take: Option<TakeRecord>,
    pub(crate) model: ModelSpec,
    pub(crate) start: PoseRecord,
    #[serde(default, deserialize_with = "unique_keys")]
    pub(crate) keys: BTreeMap<usize, PoseRecord>,
    #[serde(default, deserialize_with = "unique_keys")]
    pub(crate) estimates: BTreeMap<usize, EstimateRecord>,
    #[serde(default)]
    pub(crate) cameras: Vec<CameraRecord>,
    #[serde(default)]
    pub(crate) fit: FitOptions,
    /// Weight of the prior that comes with the program.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) likely_poses: Option<f64>,
    /// Left out, it is what goes with the fit.
    #[serde(default)]
    pub(crate) tracking: Option<TrackingChoices>,
    #[serde(default)]
    pub(crate) measurement: Vec<SegmentOptions>,
    #[serde(default)]
    pub(crate) pins: Vec<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) calibration: Option<CalibrationRecord>,
    /// By camera's name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty", deserialize_with = "unique_keys")]
    pub(crate) plates: BTreeMap<String, PathBuf>,
    /// By frame, then by camera's name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty", deserialize_with = "unique_keys")]
    pub(crate) masks: BTreeMap<usize, BTreeMap<String, PathBuf>>,
    /// Written apart, a line a run.
    #[serde(default, skip_serializing)]
    pub(crate) runs: Vec<RunRecord>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct CalibrationRecord {
    pub(crate) file: PathBuf,
    /// As in a file `backlit-cameras 1`, so that nothing is lost with the file.
    pub(crate) cameras: serde_json::Value,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum TakeRecord {
    BuiltIn,
    Demonstration(Demonstration),
    Path(PathBuf),
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PoseRecord {
    pub(crate) root: [f64; 3],
    /// w x y z by the limb that owns the rotation; left out where it is at rest.
    #[serde(default, deserialize_with = "unique_keys")]
    pub(crate) rotations: BTreeMap<String, [f64; 4]>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct EstimateRecord {
    pub(crate) pose: PoseRecord,
    pub(crate) origin: OriginRecord,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) cost: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) rms: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) iou: Option<f64>,
    pub(crate) steps: usize,
    pub(crate) lost: bool,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(crate) is_stale: bool,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum OriginRecord {
    Fit,
    Track,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct CameraRecord {
    pub(crate) name: String,
    pub(crate) used: bool,
    pub(crate) weight: f64,
}

pub(crate) fn to_file(document: &Document, runs: &[Run]) -> ProjectFile {
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
        cameras: document.cameras.iter().map(camera_record).collect(),
        fit: (*document.fit).clone(),
        likely_poses: likely_poses::weight(&document.fit),
        tracking: Some(document.tracking),
        measurement: (*document.measurement).clone(),
        pins: document.pins.iter().map(|&limb| model.limbs()[limb].name.clone()).collect(),
        calibration: document.calibration.as_ref().map(|calibration| CalibrationRecord {
            file: calibration.path.clone(),
            cameras: serde_json::from_str(&backlit::to_text(&calibration.rig)).unwrap_or_default(),
        }),
        plates: file_records(document, &document.plates),
        masks: document.masks.iter().map(|(frame, masks)| (*frame, file_records(document, masks))).collect(),
        runs: runs.iter().filter_map(|run| run_record(model, run)).collect(),
    }
}

pub(super) fn camera_record(camera: &CameraUse) -> CameraRecord {
    CameraRecord { name: camera.name.clone(), used: camera.used, weight: camera.weight }
}

/// Files by the names of their cameras.
fn file_records(document: &Document, files: &BTreeMap<usize, PathBuf>) -> BTreeMap<String, PathBuf> {
    let named = |(camera, path): (&usize, &PathBuf)| {
        document.cameras.get(*camera).map(|camera| (camera.name.clone(), path.clone()))
    };
    files.iter().filter_map(named).collect()
}

pub(super) fn pose_record(model: &Model, pose: &Pose) -> PoseRecord {
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
        is_stale: estimate.is_stale,
    }
}
