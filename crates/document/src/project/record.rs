//! A project as its file has it, and the document, both ways.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use backlit_formats::calibration::{CalibrationOptions, backlit};
use backlit_formats::footage::BrushStroke;
use backlit_formats::footage::replacement::Calibration;
use backlit_formats::json_text::unique_keys;
use backlit_take::source::TakeSource;
use backlit_tracking::body::{Model, ModelSpec, Pose};
use backlit_tracking::fit::FitOptions;
use backlit_tracking::people::FollowedPerson;
use backlit_tracking::segment::SegmentOptions;
use backlit_tracking::segment::changes::BackgroundChange;
use backlit_tracking::silhouette::{Label, Stroke};
use glam::{DQuat, DVec3};
use serde::{Deserialize, Serialize};

use super::bookmark_record::BookmarkRecord;
use super::frame_trust_record::FrameTrustRecord;
use super::run_record::{RunRecord, read_runs};
use super::{FORMAT, Project, ProjectProblem};
use crate::bookmark::Bookmark;
use crate::frame_trust::FrameTrust;
use crate::run::Run;
use crate::tracking_choices::TrackingChoices;
use crate::{CameraUse, Document, Estimate, likely_poses};

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ProjectFile {
    pub(crate) format: String,
    pub(crate) take: Option<TakeSource>,
    pub(crate) model: ModelSpec,
    pub(crate) start: PoseRecord,
    #[serde(default, deserialize_with = "unique_keys")]
    pub(crate) keys: BTreeMap<usize, PoseRecord>,
    #[serde(default, deserialize_with = "unique_keys")]
    pub(crate) estimates: BTreeMap<usize, Estimate<PoseRecord>>,
    #[serde(default)]
    pub(crate) cameras: Vec<CameraUse>,
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
    /// Files that poses are compared with; those whose path is relative lie beside the project.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) references: Vec<PathBuf>,
    /// Written apart, a line a stroke.
    #[serde(default, skip_serializing)]
    pub(crate) brush: Vec<StrokeRecord>,
    /// Written apart, a line a bookmark.
    #[serde(default, skip_serializing)]
    pub(crate) bookmarks: Vec<BookmarkRecord>,
    /// Written apart, in one line.
    #[serde(default, skip_serializing)]
    pub(crate) person: Option<FollowedPerson>,
    /// Written apart, a line a change.
    #[serde(default, skip_serializing)]
    pub(crate) background_changes: Vec<BackgroundChange>,
    /// Written apart, a line a frame.
    #[serde(default, rename = "told", skip_serializing, deserialize_with = "unique_keys")]
    pub(crate) trust: BTreeMap<usize, FrameTrustRecord>,
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
#[serde(deny_unknown_fields)]
pub(crate) struct StrokeRecord {
    camera: String,
    frames: [usize; 2],
    label: Label,
    radius_px: f32,
    points: Vec<[f32; 2]>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PoseRecord {
    pub(crate) root: [f64; 3],
    /// w x y z by the limb that owns the rotation; left out where it is at rest.
    #[serde(default, deserialize_with = "unique_keys")]
    pub(crate) rotations: BTreeMap<String, [f64; 4]>,
}

impl ProjectFile {
    pub(super) fn of(document: &Document, runs: &[Run]) -> Self {
        let model = &*document.model;
        let pose = |(frame, pose): (&usize, &Pose)| (*frame, PoseRecord::of(model, pose));
        let estimate = |(frame, estimate): (&usize, &Arc<Estimate>)| {
            (*frame, estimate.with_pose(PoseRecord::of(model, &estimate.pose)))
        };
        let trust = |(frame, trust): (&usize, &Arc<FrameTrust>)| {
            let found = document.estimates.get(frame).map(|found| &found.pose);
            (*frame, FrameTrustRecord::of(model, trust, found))
        };
        Self {
            format: FORMAT.to_owned(),
            take: document.take.clone(),
            model: model.to_spec(),
            start: PoseRecord::of(model, &document.start),
            keys: document.keys.iter().map(pose).collect(),
            estimates: document.estimates.iter().map(estimate).collect(),
            cameras: (*document.cameras).clone(),
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
            masks: document
                .masks
                .iter()
                .map(|(frame, masks)| (*frame, file_records(document, masks)))
                .collect(),
            references: (*document.references).clone(),
            bookmarks: document.bookmarks.iter().map(|mark| BookmarkRecord::of(document, mark)).collect(),
            brush: document.brush.iter().filter_map(|one| StrokeRecord::of(document, one)).collect(),
            person: document.person.as_deref().cloned(),
            background_changes: (*document.changes).clone(),
            trust: document.trust.iter().map(trust).collect(),
            runs: runs.iter().filter_map(|run| RunRecord::of(model, run)).collect(),
        }
    }

    /// The document of the file at this path. It holds together.
    pub(super) fn into_project(self, path: &Path) -> Result<Project, ProjectProblem> {
        let model = Model::new(&self.model).map_err(ProjectProblem::Model)?;
        let fit = read_fit(self.fit, self.likely_poses, "fit")?;
        for (index, options) in self.measurement.iter().enumerate() {
            options.check().map_err(|error| ProjectProblem::Measurement { index, error })?;
        }
        let start = self.start.pose(&model, "start")?;
        let mut keys = BTreeMap::new();
        for (frame, record) in &self.keys {
            keys.insert(*frame, record.pose(&model, &format!("keys.{frame}"))?);
        }
        let mut estimates = BTreeMap::new();
        for (frame, record) in &self.estimates {
            estimates.insert(*frame, Arc::new(read_estimate(&model, *frame, record)?));
        }
        let mut trust = BTreeMap::new();
        for (frame, record) in self.trust {
            let found = estimates.get(&frame).map(|found: &Arc<Estimate>| &found.pose);
            trust.insert(frame, Arc::new(record.read(&model, &format!("told.{frame}"), found)?));
        }
        let pins = self.pins.iter().map(|name| limb_index(&model, "pins", name)).collect::<Result<_, _>>()?;
        let cameras = checked_cameras(self.cameras)?;
        let count = self.measurement.len();
        if count > 0 && count != cameras.len() {
            return Err(ProjectProblem::Measurements { count, cameras: cameras.len() });
        }
        let plates = read_files(path, &cameras, self.plates, "plates")?;
        let mut masks = BTreeMap::new();
        for (frame, record) in self.masks {
            masks.insert(frame, read_files(path, &cameras, record, &format!("masks.{frame}"))?);
        }
        let brush = self.brush.into_iter().enumerate();
        let brush: Result<Vec<BrushStroke>, _> =
            brush.map(|(index, record)| record.read(&cameras, &format!("brush[{index}]"))).collect();
        let brush = Arc::new(brush?);
        let marks = self.bookmarks.into_iter().enumerate();
        let bookmarks: Result<Vec<Bookmark>, _> =
            marks.map(|(index, mark)| mark.read(&model, &cameras, &format!("bookmarks[{index}]"))).collect();
        let mut bookmarks = bookmarks?;
        bookmarks.sort_by_key(|mark| mark.frame);
        if let Some(wrong) = self.background_changes.iter().find(|change| change.camera >= cameras.len()) {
            let (field, camera) = ("background_changes".to_owned(), wrong.camera.to_string());
            return Err(ProjectProblem::Camera { field, camera });
        }
        let folder = path.parent().unwrap_or(Path::new(""));
        let references = self.references.into_iter().map(|reference| folder.join(reference)).collect();
        let calibration = self.calibration.map(|record| record.read(path)).transpose()?;
        let runs = read_runs(&model, self.runs)?;
        let document = Document {
            take: self.take,
            model: Arc::new(model),
            start: Arc::new(start),
            keys: Arc::new(keys),
            estimates: Arc::new(estimates),
            trust: Arc::new(trust),
            cameras: Arc::new(cameras),
            tracking: self.tracking.unwrap_or_else(|| TrackingChoices::of_preset(fit.as_preset())),
            fit: Arc::new(fit),
            measurement: Arc::new(self.measurement),
            pins: Arc::new(pins),
            calibration,
            plates: Arc::new(plates),
            masks: Arc::new(masks),
            brush,
            person: self.person.map(Arc::new),
            changes: Arc::new(self.background_changes),
            bookmarks: Arc::new(bookmarks),
            references: Arc::new(references),
        };
        Ok(Project { document, runs })
    }
}

/// A fit with the prior that comes with the program, at its weight.
pub(super) fn read_fit(
    mut fit: FitOptions,
    likely_poses: Option<f64>,
    field: &str,
) -> Result<FitOptions, ProjectProblem> {
    likely_poses::set_weight(&mut fit, likely_poses.unwrap_or(0.0));
    fit.check().map_err(|error| ProjectProblem::Fit { field: field.to_owned(), error })?;
    Ok(fit)
}

pub(super) fn checked_cameras(cameras: Vec<CameraUse>) -> Result<Vec<CameraUse>, ProjectProblem> {
    match cameras.iter().find(|camera| !(camera.weight.is_finite() && camera.weight >= 0.0)) {
        Some(camera) => Err(ProjectProblem::Weight { camera: camera.name.clone(), weight: camera.weight }),
        None => Ok(cameras),
    }
}

/// Checks numbers that are there: name, value, the largest that is allowed. All are 0 or above.
pub(super) fn check_numbers(field: &str, numbers: &[(&str, Option<f64>, f64)]) -> Result<(), ProjectProblem> {
    for (name, value, most) in numbers {
        if let Some(value) = value.filter(|value| !(0.0..=*most).contains(value)) {
            let expected = if *most == 1.0 { "a number from 0 to 1" } else { "a number, 0 or above" };
            return Err(ProjectProblem::Number { field: format!("{field}.{name}"), value, expected });
        }
    }
    Ok(())
}

fn read_estimate(
    model: &Model,
    frame: usize,
    record: &Estimate<PoseRecord>,
) -> Result<Estimate, ProjectProblem> {
    let pose = record.pose.pose(model, &format!("estimates.{frame}.pose"))?;
    let numbers =
        [("cost", record.cost, f64::INFINITY), ("rms", record.rms, f64::INFINITY), ("iou", record.iou, 1.0)];
    check_numbers(&format!("estimates.{frame}"), &numbers)?;
    let mut estimate = record.with_pose(pose);
    if estimate.steps == 0 && estimate.lost {
        // Earlier files say cost 0 where there was nobody to fit.
        (estimate.cost, estimate.rms) = (None, None);
    }
    Ok(estimate)
}

impl CalibrationRecord {
    fn read(self, path: &Path) -> Result<Arc<Calibration>, ProjectProblem> {
        let text = self.cameras.to_string();
        let rig = backlit::parse(path, &text, CalibrationOptions::default());
        Ok(Arc::new(Calibration { path: self.file, rig: rig.map_err(ProjectProblem::Calibration)? }))
    }
}

impl StrokeRecord {
    fn of(document: &Document, one: &BrushStroke) -> Option<Self> {
        let (camera, Stroke { label, radius_px, points }) =
            (document.cameras.get(one.camera)?.name.clone(), one.stroke.clone());
        Some(Self { camera, frames: one.frames, label, radius_px, points })
    }

    fn read(self, cameras: &[CameraUse], field: &str) -> Result<BrushStroke, ProjectProblem> {
        let Self { camera, frames, label, radius_px, points } = self;
        if frames[0] > frames[1] {
            let expected = "the last frame, which is not before the first";
            return Err(ProjectProblem::Number {
                field: format!("{field}.frames[1]"),
                value: frames[1] as f64,
                expected,
            });
        }
        let camera = camera_index(cameras, &format!("{field}.camera"), camera)?;
        let stroke = Stroke { label, radius_px, points };
        stroke.check().map_err(|error| ProjectProblem::Stroke { field: field.to_owned(), error })?;
        Ok(BrushStroke { camera, frames, stroke })
    }
}

impl PoseRecord {
    pub(super) fn of(model: &Model, pose: &Pose) -> Self {
        let owners = model.rotation_owners().iter();
        let rotations = owners
            .zip(&pose.rotations)
            .map(|(&owner, q)| (model.limbs()[owner].name.clone(), [q.w, q.x, q.y, q.z]))
            .collect();
        Self { root: pose.root.to_array(), rotations }
    }

    pub(super) fn pose(&self, model: &Model, field: &str) -> Result<Pose, ProjectProblem> {
        let mut pose = Pose::rest(model);
        pose.root = DVec3::from_array(self.root);
        for (name, [w, x, y, z]) in &self.rotations {
            let limb = &model.limbs()[limb_index(model, field, name)?];
            if !limb.has_own_rotation {
                return Err(ProjectProblem::Rigid {
                    field: format!("{field}.rotations"),
                    limb: name.clone(),
                });
            }
            pose.rotations[limb.rotation] = DQuat::from_xyzw(*x, *y, *z, *w);
        }
        pose.check(model).map_err(|error| ProjectProblem::Pose { field: field.to_owned(), error })?;
        Ok(pose)
    }
}

pub(super) fn limb_index(model: &Model, field: &str, name: &str) -> Result<usize, ProjectProblem> {
    let unknown = || ProjectProblem::Limb { field: field.to_owned(), limb: name.to_owned() };
    model.limb_index(name).ok_or_else(unknown)
}

/// Files by camera; those whose path is relative lie beside the project.
fn read_files(
    path: &Path,
    cameras: &[CameraUse],
    record: BTreeMap<String, PathBuf>,
    field: &str,
) -> Result<BTreeMap<usize, PathBuf>, ProjectProblem> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let file = |(name, path)| Ok((camera_index(cameras, field, name)?, folder.join(path)));
    record.into_iter().map(file).collect()
}

pub(super) fn camera_index(
    cameras: &[CameraUse],
    field: &str,
    name: String,
) -> Result<usize, ProjectProblem> {
    let camera = cameras.iter().position(|camera| camera.name == name);
    camera.ok_or_else(|| ProjectProblem::Camera { field: field.to_owned(), camera: name })
}

/// Files by the names of their cameras.
fn file_records(document: &Document, files: &BTreeMap<usize, PathBuf>) -> BTreeMap<String, PathBuf> {
    let named = |(camera, path): (&usize, &PathBuf)| {
        document.cameras.get(*camera).map(|camera| (camera.name.clone(), path.clone()))
    };
    files.iter().filter_map(named).collect()
}
