//! From a project's file to a document that holds together.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use backlit_formats::calibration::{CalibrationOptions, backlit};
use backlit_take::replacement::{Calibration, MaskFiles, PlateFiles};
use backlit_take::source::TakeSource;
use backlit_tracking::body::{Model, Pose};
use glam::{DQuat, DVec3};

use super::record::{
    CalibrationRecord, CameraRecord, EstimateRecord, OriginRecord, PoseRecord, ProjectFile, TakeRecord,
};
use super::{Project, ProjectError};
use crate::tracking_choices::TrackingChoices;
use crate::{CameraUse, Document, Estimate, Origin, likely_poses};

/// Reads what a file says; its path is for the messages.
pub(crate) struct Reader<'a> {
    pub(crate) path: &'a Path,
}

impl Reader<'_> {
    pub(crate) fn project(&self, file: ProjectFile) -> Result<Project, ProjectError> {
        let model = Model::new(&file.model)
            .map_err(|error| ProjectError::Model { path: self.path.to_owned(), error })?;
        let wrong = |error| ProjectError::Fit { path: self.path.to_owned(), error };
        let mut fit = file.fit;
        likely_poses::set_weight(&mut fit, file.likely_poses.unwrap_or(0.0));
        fit.check().map_err(wrong)?;
        for (index, options) in file.measurement.iter().enumerate() {
            let path = self.path.to_owned();
            options.check().map_err(|error| ProjectError::Measurement { path, index, error })?;
        }
        let start = self.pose(&model, "start", &file.start)?;
        let mut keys = BTreeMap::new();
        for (frame, record) in &file.keys {
            keys.insert(*frame, self.pose(&model, &format!("keys.{frame}"), record)?);
        }
        let mut estimates = BTreeMap::new();
        for (frame, record) in &file.estimates {
            let pose = self.pose(&model, &format!("estimates.{frame}.pose"), &record.pose)?;
            self.check_numbers(*frame, record)?;
            estimates.insert(*frame, Arc::new(estimate(pose, record)));
        }
        let mut pins = BTreeSet::new();
        for name in &file.pins {
            pins.insert(self.limb(&model, "pins", name)?);
        }
        let cameras = self.cameras(file.cameras)?;
        let count = file.measurement.len();
        if count > 0 && count != cameras.len() {
            return Err(ProjectError::Measurements {
                path: self.path.to_owned(),
                count,
                cameras: cameras.len(),
            });
        }
        let plates = self.plates(&cameras, file.plates)?;
        let masks = self.masks(&cameras, file.masks)?;
        let calibration = file.calibration.map(|record| self.calibration(record)).transpose()?;
        let runs = self.runs(&model, file.runs)?;
        let document = Document {
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
            tracking: file.tracking.unwrap_or_else(|| TrackingChoices::of_preset(fit.as_preset())),
            fit: Arc::new(fit),
            measurement: Arc::new(file.measurement),
            pins: Arc::new(pins),
            calibration,
            plates: Arc::new(plates),
            masks: Arc::new(masks),
        };
        Ok(Project { document, runs })
    }

    pub(super) fn cameras(&self, records: Vec<CameraRecord>) -> Result<Vec<CameraUse>, ProjectError> {
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
        let json = |error| ProjectError::Json { path: self.path.to_owned(), error };
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
            let wrong = |camera| ProjectError::MaskCamera { path: self.path.to_owned(), frame, camera };
            masks.insert(frame, self.files(cameras, record).map_err(wrong)?);
        }
        Ok(masks)
    }

    fn plates(
        &self,
        cameras: &[CameraUse],
        record: BTreeMap<String, PathBuf>,
    ) -> Result<PlateFiles, ProjectError> {
        let wrong = |camera| ProjectError::PlateCamera { path: self.path.to_owned(), camera };
        self.files(cameras, record).map_err(wrong)
    }

    /// Files by camera; those whose path is not whole lie beside the project.
    ///
    /// # Errors
    /// A name that no camera has.
    fn files(
        &self,
        cameras: &[CameraUse],
        record: BTreeMap<String, PathBuf>,
    ) -> Result<BTreeMap<usize, PathBuf>, String> {
        let folder = self.path.parent().unwrap_or(Path::new(""));
        let file = |(name, path): (String, PathBuf)| {
            let camera = cameras.iter().position(|camera| camera.name == name).ok_or(name)?;
            Ok((camera, folder.join(path)))
        };
        record.into_iter().map(file).collect()
    }

    pub(super) fn pose(&self, model: &Model, field: &str, record: &PoseRecord) -> Result<Pose, ProjectError> {
        let mut pose = Pose::rest(model);
        pose.root = DVec3::from_array(record.root);
        for (name, [w, x, y, z]) in &record.rotations {
            let limb = &model.limbs()[self.limb(model, field, name)?];
            if !limb.has_own_rotation {
                let (path, field) = (self.path.to_owned(), format!("{field}.rotations"));
                return Err(ProjectError::Rigid { path, field, limb: name.clone() });
            }
            pose.rotations[limb.rotation] = DQuat::from_xyzw(*x, *y, *z, *w);
        }
        let wrong = |error| ProjectError::Pose { path: self.path.to_owned(), field: field.to_owned(), error };
        pose.check(model).map_err(wrong)?;
        Ok(pose)
    }

    /// What a fit has measured of a frame.
    fn check_numbers(&self, frame: usize, record: &EstimateRecord) -> Result<(), ProjectError> {
        let numbers = [
            ("cost", record.cost, f64::INFINITY, "a number, 0 or above"),
            ("rms", record.rms, f64::INFINITY, "a number, 0 or above"),
            ("iou", record.iou, 1.0, "a number from 0 to 1"),
        ];
        for (name, value, most, expected) in numbers {
            if let Some(value) = value.filter(|value| !(0.0..=most).contains(value)) {
                return Err(self.number(format!("estimates.{frame}.{name}"), value, expected));
            }
        }
        Ok(())
    }

    pub(super) fn number(&self, field: String, value: f64, expected: &'static str) -> ProjectError {
        ProjectError::Number { path: self.path.to_owned(), field, value, expected }
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
    // Earlier files say cost 0 where there was nobody to fit.
    let was_fitted = |_: &f64| record.steps > 0 || !record.lost;
    Estimate {
        pose,
        origin: match record.origin {
            OriginRecord::Fit => Origin::Fit,
            OriginRecord::Track => Origin::Track,
        },
        cost: record.cost.filter(was_fitted),
        rms: record.rms.filter(was_fitted),
        iou: record.iou,
        steps: record.steps,
        lost: record.lost,
        is_stale: record.is_stale,
    }
}
