//! A run of the fit with all its steps, rejected ones too.

use std::sync::Arc;

use backlit_formats::export::ending_text;
use backlit_tracking::body::Pose;
use backlit_tracking::fit::{FitOptions, Stage};
use backlit_tracking::optimize::{Iteration, Termination};
use backlit_words::format;

use crate::CameraUse;
use crate::runs::StepRef;

/// One step of a run. The first is the start.
#[derive(Debug, Clone, PartialEq)]
pub struct RunStep {
    /// What the solver did, by the measure of its own stage; at the start where it begins, with a step norm of zero. A
    /// project's file does not keep its root mean square and its gradient.
    pub iteration: Iteration<Pose>,
    /// Mismatch by the run's [measure](Run::measure), one for all steps and all runs of a frame, squared grey levels: the
    /// plot's height.
    pub mismatch: f64,
    /// Root of its mean over the pixels that count, grey levels; zero where none does.
    pub rms: f64,
    /// IoU of body and silhouettes, all cameras together.
    pub iou: Option<f64>,
    /// Mean distance of the joints from the take's reference, millimetres, where there is one.
    pub joint_error_mm: Option<f64>,
    /// Time of the solver's step, in seconds.
    pub seconds: f64,
}

impl RunStep {
    /// The cost before the step, by the measure of its stage.
    pub fn cost_before(&self) -> f64 {
        let Iteration { accepted, cost, actual_decrease, .. } = self.iteration;
        if accepted { cost + actual_decrease } else { cost }
    }

    /// By which fraction of the cost before it the step lowered the cost; a rejected one would have.
    pub fn actual_share(&self) -> Option<f64> {
        let Iteration { accepted, cost, trial_cost, actual_decrease, .. } = self.iteration;
        self.share(if accepted { actual_decrease } else { cost - trial_cost })
    }

    /// By which fraction of the cost before it the linear model predicted that the cost would fall.
    pub fn predicted_share(&self) -> Option<f64> {
        self.share(self.iteration.predicted_decrease)
    }

    fn share(&self, value: f64) -> Option<f64> {
        let before = self.cost_before();
        (before > 0.0).then(|| value / before)
    }
}

/// How a run ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum RunEnding {
    /// The solver's own words.
    Solver(String),
    /// The user stopped it; it may go on.
    Stopped,
}

impl RunEnding {
    /// The end of a fit whose solver has ended; an annealed one has several stages.
    pub fn of(termination: Termination, is_annealed: bool) -> Self {
        match termination {
            Termination::StepLimit { steps } if is_annealed => {
                Self::Solver(format!("the {steps} steps of the last stage are done"))
            }
            Termination::Cancelled => Self::Stopped,
            other => Self::Solver(ending_text(other)),
        }
    }

    /// A sentence without its full stop.
    pub fn text(&self) -> String {
        match self {
            Self::Solver(words) => format!("Stopped: {words}"),
            Self::Stopped => "Stopped by you".to_owned(),
        }
    }
}

/// What a run depends on besides its frame and its start: what its name may be made of.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RunChoices {
    /// How it was fitted.
    pub fit: Arc<FitOptions>,
    /// Which cameras counted, and how much.
    pub cameras: Arc<Vec<CameraUse>>,
    /// The part of the body that moved: "right forearm"; `None` for all of it.
    pub part: Option<String>,
    /// The step of an earlier run that it began at.
    pub branched_from: Option<StepRef>,
}

/// Where a run begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunOrigin {
    /// Steps before it.
    pub steps: usize,
    /// What they left of the first start's cost, as a fraction.
    pub fraction: f64,
}

/// A run of the fit on one frame.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Run {
    /// Counts the runs of the session from 1; it stays whatever is removed.
    pub number: usize,
    /// What distinguishes it from the other runs, or what it was called by hand.
    pub name: String,
    /// Whether the name was given, so that it stays whatever other runs there are.
    pub is_named: bool,
    /// What it depends on.
    pub choices: RunChoices,
    /// Renderer, ramp and the other choices, in one line.
    pub detail: String,
    /// The frame that was fitted.
    pub frame: usize,
    /// Whose ramp and data its steps are measured by, where that is not the last stage of its own fit.
    pub measured_by: Option<Stage>,
    /// Index of its colour and dash.
    pub colour: usize,
    /// The start, then every step.
    pub steps: Vec<RunStep>,
    /// Words for the stages of the annealing.
    pub stages: Vec<String>,
    /// How it ended, once it has.
    pub ending: Option<RunEnding>,
    /// Whether its curve is drawn.
    pub is_shown: bool,
}

impl Run {
    /// Whose ramp and data its steps are measured by.
    pub fn measure(&self) -> Option<Stage> {
        self.measured_by.or_else(|| self.choices.fit.stages.last().copied())
    }

    /// Number of accepted steps among the first `step` ones.
    pub fn accepted_until(&self, step: usize) -> usize {
        self.steps.iter().take(step + 1).skip(1).filter(|step| step.iteration.accepted).count()
    }

    /// What is left of the start's cost after a step, as a fraction. Each step takes away its share of the cost by the measure
    /// of its own stage, so that what it says of itself is what the curve shows: where the ramp changes the curve goes on at
    /// the height it had.
    pub fn fraction(&self, step: usize) -> Option<f64> {
        self.fractions().nth(step)
    }

    /// The same after every step; none where the start has no cost.
    fn fractions(&self) -> impl Iterator<Item = f64> {
        let is_of_something = self.steps.first().is_some_and(|start| start.iteration.cost > 0.0);
        let steps = self.steps.iter().enumerate().filter(move |_| is_of_something);
        steps.scan(1.0, |left, (index, step)| {
            if index > 0 && step.iteration.accepted {
                *left *= 1.0 - step.actual_share().unwrap_or(0.0);
            }
            Some(*left)
        })
    }

    /// Where the run begins among all of them: steps that led there and what they left of the first start's cost, those of the
    /// runs that it branched from.
    pub fn origin(&self, all: &[Self]) -> RunOrigin {
        // Earlier runs alone are branched from.
        let parent = self.choices.branched_from.and_then(|from| {
            let parent = all.iter().find(|run| run.number == from.run && run.number < self.number)?;
            Some((parent, from.step))
        });
        parent.map_or(RunOrigin { steps: 0, fraction: 1.0 }, |(parent, step)| {
            let RunOrigin { steps, fraction } = parent.origin(all);
            RunOrigin { steps: steps + step, fraction: fraction * parent.fraction(step).unwrap_or(1.0) }
        })
    }

    /// What is left of the first start's cost after a step: of the run that this one, or the run before, branched from.
    pub fn fraction_among(&self, all: &[Self], step: usize) -> Option<f64> {
        Some(self.origin(all).fraction * self.fraction(step)?)
    }

    /// The same after every step, in one go.
    pub fn fractions_among(&self, all: &[Self]) -> Vec<f64> {
        let before = self.origin(all).fraction;
        self.fractions().map(|left| before * left).collect()
    }

    /// The index of the last step, 0 of a run that has not begun.
    pub fn last_step(&self) -> usize {
        self.steps.len().saturating_sub(1)
    }

    /// How it ended, in a sentence without its full stop.
    pub fn ending_text(&self) -> String {
        let so_far = || format!("{} so far", format::counted(self.last_step(), "step"));
        self.ending.as_ref().map_or_else(so_far, RunEnding::text)
    }

    /// The figures it has reached: steps, what is left of the start's cost, and the RMS.
    pub fn reached_text(&self, all: &[Self]) -> String {
        let mut text = format::counted(self.last_step(), "step");
        if let Some(share) = self.fraction_among(all, self.last_step()) {
            text += &format!(", {} of the start", format::percent(share));
        }
        if let Some(last) = self.steps.last() {
            text += &format!(", RMS {}", format::number(last.rms, 1));
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    fn step(mismatch: f64, accepted: bool) -> RunStep {
        let pose = Pose { root: DVec3::ZERO, rotations: Vec::new() };
        let iteration = Iteration { accepted, ..Iteration::start(pose, mismatch) };
        RunStep { iteration, mismatch, rms: mismatch, iou: None, joint_error_mm: None, seconds: 0.0 }
    }

    fn tried(cost: f64, trial_cost: f64, actual_decrease: f64, accepted: bool) -> RunStep {
        let step = step(10.0, accepted);
        let predicted_decrease = 5.0;
        let iteration = Iteration { cost, trial_cost, predicted_decrease, actual_decrease, ..step.iteration };
        RunStep { iteration, ..step }
    }

    /// Half, then half again in a stage whose cost is counted anew: a quarter is left, whatever the costs; a branch goes on there.
    #[test]
    fn what_is_left_is_by_the_stages_and_goes_on_in_a_branch() {
        let halved = |cost: f64| tried(cost, cost, cost, true);
        let steps = vec![step(8.0, true), halved(4.0), tried(4.0, 6.0, 0.0, false), halved(50.0)];
        let run = Run { number: 1, steps, ..Run::default() };
        assert_eq!(
            [0, 1, 2, 3, 4].map(|step| run.fraction(step)),
            [Some(1.0), Some(0.5), Some(0.5), Some(0.25), None]
        );
        assert_eq!((0..4).map(|step| run.accepted_until(step)).collect::<Vec<_>>(), [0, 1, 1, 2]);
        let mut branch = Run { number: 2, ..run.clone() };
        branch.choices.branched_from = Some(StepRef { run: 1, step: 2 });
        let all = [run, branch];
        assert_eq!(all[1].origin(&all), RunOrigin { steps: 2, fraction: 0.5 });
        assert_eq!(all[1].fraction_among(&all, 3), Some(0.125));
        assert_eq!(all[1].fractions_among(&all), [0.5, 0.25, 0.25, 0.125]);
        assert_eq!(all[0].reached_text(&all), "3 steps, 25.0 % of the start, RMS 10.0");
        assert_eq!(all[0].ending_text(), "3 steps so far");
    }

    #[test]
    fn a_rejected_step_says_what_it_would_have_done() {
        let rejected = tried(10.0, 12.0, 0.0, false);
        assert_eq!((rejected.actual_share(), rejected.predicted_share()), (Some(-0.2), Some(0.5)));
        let accepted = tried(6.0, 6.0, 4.0, true);
        assert_eq!((accepted.actual_share(), accepted.predicted_share()), (Some(0.4), Some(0.5)));
        assert_eq!(tried(0.0, 0.0, 0.0, true).actual_share(), None);
    }
}
