//! A run of the fit as a project's file has it.

use std::sync::Arc;

use backlit_tracking::body::Model;
use backlit_tracking::fit::{FitOptions, Stage};
use backlit_tracking::optimize::Iteration;
use serde::{Deserialize, Serialize};

use super::ProjectError;
use super::reader::Reader;
use super::record::{CameraRecord, PoseRecord, camera_record, pose_record};
use crate::likely_poses;
use crate::run::{Run, RunChoices, RunEnding, RunStep};
use crate::runs::StepRef;

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RunRecord {
    number: usize,
    frame: usize,
    /// Only where it was given by hand.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    detail: String,
    fit: FitOptions,
    /// Weight of the prior that comes with the program.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    likely_poses: Option<f64>,
    cameras: Vec<CameraRecord>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    part: Option<String>,
    /// Number and step of the run that it began at.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    branched_from: Option<[usize; 2]>,
    /// The stage by which its steps are measured, where it is not the last of its own fit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    measured_by: Option<Stage>,
    colour: usize,
    shown: bool,
    /// Words for the stages of the annealing.
    stages: Vec<String>,
    /// The solver's words; left out where the user stopped it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    ending: Option<String>,
    /// The start, then every step.
    steps: Vec<StepRecord>,
}

/// A number that ran out of range is null.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct StepRecord {
    pose: PoseRecord,
    mismatch: f64,
    rms: f64,
    iou: Option<f64>,
    joint_error_mm: Option<f64>,
    cost: f64,
    trial_cost: Option<f64>,
    foretold: Option<f64>,
    fell: Option<f64>,
    damping: Option<f64>,
    step_norm: Option<f64>,
    seconds: f64,
    stage: usize,
    accepted: bool,
}

/// A run whose poses are the body's; one of another body cannot be shown.
pub(crate) fn run_record(model: &Model, run: &Run) -> Option<RunRecord> {
    run.steps.iter().all(|step| step.iteration.point.check(model).is_ok()).then(|| RunRecord {
        number: run.number,
        frame: run.frame,
        name: run.is_named.then(|| run.name.clone()),
        detail: run.detail.clone(),
        fit: (*run.choices.fit).clone(),
        likely_poses: likely_poses::weight(&run.choices.fit),
        cameras: run.choices.cameras.iter().map(camera_record).collect(),
        part: run.choices.part.clone(),
        branched_from: run.choices.branched_from.map(|from| [from.run, from.step]),
        measured_by: run.measured_by,
        colour: run.colour,
        shown: run.is_shown,
        stages: run.stages.clone(),
        ending: match &run.ending {
            Some(RunEnding::Solver(words)) => Some(words.clone()),
            // What is running now cannot go on in another window.
            Some(RunEnding::Stopped) | None => None,
        },
        steps: run.steps.iter().map(|step| step_record(model, step)).collect(),
    })
}

fn step_record(model: &Model, step: &RunStep) -> StepRecord {
    let finite = |value: f64| Some(value).filter(|value| value.is_finite());
    let iteration = &step.iteration;
    StepRecord {
        pose: pose_record(model, &iteration.point),
        mismatch: step.mismatch,
        rms: step.rms,
        iou: step.iou,
        joint_error_mm: step.joint_error_mm,
        cost: iteration.cost,
        trial_cost: finite(iteration.trial_cost),
        foretold: finite(iteration.predicted_decrease),
        fell: finite(iteration.actual_decrease),
        damping: finite(iteration.damping),
        step_norm: finite(iteration.step_norm),
        seconds: step.seconds,
        stage: iteration.stage,
        accepted: iteration.accepted,
    }
}

impl Reader<'_> {
    /// The runs, by number.
    pub(super) fn runs(&self, model: &Model, records: Vec<RunRecord>) -> Result<Vec<Run>, ProjectError> {
        let mut runs: Vec<Run> = Vec::with_capacity(records.len());
        for (index, record) in records.into_iter().enumerate() {
            let field = format!("runs[{index}]");
            let after = runs.last().map_or(0, |last| last.number);
            if record.number <= after {
                let expected = "a number above those of the runs before it";
                return Err(self.number(format!("{field}.number"), record.number as f64, expected));
            }
            runs.push(self.run(model, &field, record)?);
        }
        Ok(runs)
    }

    fn run(&self, model: &Model, field: &str, record: RunRecord) -> Result<Run, ProjectError> {
        let wrong =
            |error| ProjectError::RunFit { path: self.path.to_owned(), field: field.to_owned(), error };
        let mut fit = record.fit;
        likely_poses::set_weight(&mut fit, record.likely_poses.unwrap_or(0.0));
        fit.check().map_err(wrong)?;
        let stages = record.stages.len();
        let mut steps = Vec::with_capacity(record.steps.len());
        for (index, step) in record.steps.into_iter().enumerate() {
            let field = format!("{field}.steps[{index}]");
            if step.stage >= stages.max(1) {
                let expected = "the index of a stage of the run";
                return Err(self.number(format!("{field}.stage"), step.stage as f64, expected));
            }
            steps.push(self.step(model, &field, &step)?);
        }
        Ok(Run {
            number: record.number,
            is_named: record.name.is_some(),
            name: record.name.unwrap_or_default(),
            choices: RunChoices {
                fit: Arc::new(fit),
                cameras: Arc::new(self.cameras(record.cameras)?),
                part: record.part,
                branched_from: record.branched_from.map(|[run, step]| StepRef { run, step }),
            },
            detail: record.detail,
            frame: record.frame,
            measured_by: record.measured_by,
            colour: record.colour,
            steps,
            stages: record.stages,
            ending: Some(record.ending.map_or(RunEnding::Stopped, RunEnding::Solver)),
            is_shown: record.shown,
        })
    }

    fn step(&self, model: &Model, field: &str, record: &StepRecord) -> Result<RunStep, ProjectError> {
        for (name, value, most, expected) in [
            ("mismatch", Some(record.mismatch), f64::INFINITY, "a number, 0 or above"),
            ("rms", Some(record.rms), f64::INFINITY, "a number, 0 or above"),
            ("iou", record.iou, 1.0, "a number from 0 to 1"),
            ("joint_error_mm", record.joint_error_mm, f64::INFINITY, "a number, 0 or above"),
            ("seconds", Some(record.seconds), f64::INFINITY, "a number, 0 or above"),
        ] {
            if let Some(value) = value.filter(|value| !(0.0..=most).contains(value)) {
                return Err(self.number(format!("{field}.{name}"), value, expected));
            }
        }
        let iteration = Iteration {
            point: self.pose(model, &format!("{field}.pose"), &record.pose)?,
            stage: record.stage,
            cost: record.cost,
            rms: 0.0,
            trial_cost: record.trial_cost.unwrap_or(f64::INFINITY),
            predicted_decrease: record.foretold.unwrap_or(f64::NAN),
            actual_decrease: record.fell.unwrap_or(f64::NEG_INFINITY),
            damping: record.damping.unwrap_or(f64::INFINITY),
            step_norm: record.step_norm.unwrap_or(f64::INFINITY),
            gradient_max: 0.0,
            accepted: record.accepted,
        };
        let StepRecord { mismatch, rms, iou, joint_error_mm, seconds, .. } = *record;
        Ok(RunStep { iteration, mismatch, rms, iou, joint_error_mm, seconds })
    }
}
