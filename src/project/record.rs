//! A project as its file has it.

use std::collections::BTreeMap;
use std::path::PathBuf;

use backlit_formats::calibration::backlit;
use backlit_tracking::body::{Model, ModelSpec, Pose};
use backlit_tracking::segment::SegmentOptions;
use backlit_tracking::track::FitOptions;
use serde::{Deserialize, Serialize};

use super::FORMAT;
use crate::demonstration::Demonstration;
use crate::document::{Document, Estimate, Origin, TakeSource};
use crate::tracking_choices::TrackingChoices;

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ProjectFile {
    pub(super) format: String,
    pub(super) take: Option<TakeRecord>,
    pub(super) model: ModelSpec,
    pub(super) start: PoseRecord,
    #[serde(default)]
    pub(super) keys: BTreeMap<usize, PoseRecord>,
    #[serde(default)]
    pub(super) estimates: BTreeMap<usize, EstimateRecord>,
    #[serde(default)]
    pub(super) cameras: Vec<CameraRecord>,
    #[serde(default)]
    pub(super) fit: FitOptions,
    /// Left out, it is what goes with the fit.
    #[serde(default)]
    pub(super) tracking: Option<TrackingChoices>,
    #[serde(default)]
    pub(super) measurement: Vec<SegmentOptions>,
    #[serde(default)]
    pub(super) pins: Vec<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) calibration: Option<CalibrationRecord>,
    /// By frame, then by camera's name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub(super) masks: BTreeMap<usize, BTreeMap<String, PathBuf>>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CalibrationRecord {
    pub(super) file: PathBuf,
    /// As in a file `backlit-cameras 1`, so that nothing is lost with the file.
    pub(super) cameras: serde_json::Value,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum TakeRecord {
    BuiltIn,
    Demonstration(Demonstration),
    Path(PathBuf),
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PoseRecord {
    pub(super) root: [f64; 3],
    /// w x y z by the limb that owns the rotation; left out where it is at rest.
    #[serde(default)]
    pub(super) rotations: BTreeMap<String, [f64; 4]>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct EstimateRecord {
    pub(super) pose: PoseRecord,
    pub(super) origin: OriginRecord,
    pub(super) cost: f64,
    pub(super) rms: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) iou: Option<f64>,
    pub(super) steps: usize,
    pub(super) lost: bool,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum OriginRecord {
    Fit,
    Track,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CameraRecord {
    pub(super) name: String,
    pub(super) used: bool,
    pub(super) weight: f64,
}

/// The file of a document.
pub(super) fn to_file(document: &Document) -> ProjectFile {
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
