//! A run of the fit as a project's file has it.

use std::sync::Arc;

use backlit_tracking::body::Model;
use backlit_tracking::fit::{FitOptions, Stage};
use backlit_tracking::optimize::Iteration;
use serde::{Deserialize, Serialize};

use super::ProjectProblem;
use super::record::{PoseRecord, check_numbers, checked_cameras, read_fit};
use crate::run::{Run, RunChoices, RunEnding, RunStep};
use crate::runs::StepRef;
use crate::{CameraUse, likely_poses};

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
    #[serde(default, skip_serializing_if = "Option::is_none")]
    likely_poses: Option<f64>,
    cameras: Vec<CameraUse>,
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
    stages: Vec<String>,
    /// The solver's words; left out where the user stopped it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    ending: Option<String>,
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

impl RunRecord {
    /// A run whose poses are the body's; one of another body cannot be shown.
    pub(super) fn of(model: &Model, run: &Run) -> Option<Self> {
        run.steps.iter().all(|step| step.iteration.point.check(model).is_ok()).then(|| Self {
            number: run.number,
            frame: run.frame,
            name: run.is_named.then(|| run.name.clone()),
            detail: run.detail.clone(),
            fit: (*run.choices.fit).clone(),
            likely_poses: likely_poses::weight(&run.choices.fit),
            cameras: (*run.choices.cameras).clone(),
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
            steps: run.steps.iter().map(|step| StepRecord::of(model, step)).collect(),
        })
    }
}

impl StepRecord {
    fn of(model: &Model, step: &RunStep) -> Self {
        let finite = |value: f64| Some(value).filter(|value| value.is_finite());
        let iteration = &step.iteration;
        Self {
            pose: PoseRecord::of(model, &iteration.point),
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

    fn read(&self, model: &Model, field: &str) -> Result<RunStep, ProjectProblem> {
        let numbers = [
            ("mismatch", Some(self.mismatch), f64::INFINITY),
            ("rms", Some(self.rms), f64::INFINITY),
            ("iou", self.iou, 1.0),
            ("joint_error_mm", self.joint_error_mm, f64::INFINITY),
            ("seconds", Some(self.seconds), f64::INFINITY),
        ];
        check_numbers(field, &numbers)?;
        let iteration = Iteration {
            stage: self.stage,
            trial_cost: self.trial_cost.unwrap_or(f64::INFINITY),
            predicted_decrease: self.foretold.unwrap_or(f64::NAN),
            actual_decrease: self.fell.unwrap_or(f64::NEG_INFINITY),
            damping: self.damping.unwrap_or(f64::INFINITY),
            step_norm: self.step_norm.unwrap_or(f64::INFINITY),
            accepted: self.accepted,
            ..Iteration::start(self.pose.pose(model, &format!("{field}.pose"))?, self.cost)
        };
        let Self { mismatch, rms, iou, joint_error_mm, seconds, .. } = *self;
        Ok(RunStep { iteration, mismatch, rms, iou, joint_error_mm, seconds })
    }
}

/// The runs, by number.
pub(super) fn read_runs(model: &Model, records: Vec<RunRecord>) -> Result<Vec<Run>, ProjectProblem> {
    let mut runs: Vec<Run> = Vec::with_capacity(records.len());
    for (index, record) in records.into_iter().enumerate() {
        let field = format!("runs[{index}]");
        if runs.last().is_some_and(|last| record.number <= last.number) || record.number == 0 {
            let expected = "a number above those of the runs before it";
            let (field, value) = (format!("{field}.number"), record.number as f64);
            return Err(ProjectProblem::Number { field, value, expected });
        }
        runs.push(record.read(model, &field)?);
    }
    Ok(runs)
}

impl RunRecord {
    fn read(self, model: &Model, field: &str) -> Result<Run, ProjectProblem> {
        let fit = read_fit(self.fit, self.likely_poses, &format!("{field}.fit"))?;
        let mut steps = Vec::with_capacity(self.steps.len());
        for (index, step) in self.steps.iter().enumerate() {
            let field = format!("{field}.steps[{index}]");
            if step.stage >= self.stages.len().max(1) {
                let (field, value) = (format!("{field}.stage"), step.stage as f64);
                let expected = "the index of a stage of the run";
                return Err(ProjectProblem::Number { field, value, expected });
            }
            steps.push(step.read(model, &field)?);
        }
        Ok(Run {
            number: self.number,
            is_named: self.name.is_some(),
            name: self.name.unwrap_or_default(),
            choices: RunChoices {
                fit: Arc::new(fit),
                cameras: Arc::new(checked_cameras(self.cameras)?),
                part: self.part,
                branched_from: self.branched_from.map(|[run, step]| StepRef { run, step }),
            },
            detail: self.detail,
            frame: self.frame,
            measured_by: self.measured_by,
            colour: self.colour,
            steps,
            stages: self.stages,
            ending: Some(self.ending.map_or(RunEnding::Stopped, RunEnding::Solver)),
            is_shown: self.shown,
        })
    }
}
