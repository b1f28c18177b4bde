//! The fit, begun and gone on with, its steps taken in, stopped.

use backlit_formats::Footage;
use std::sync::Arc;

use backlit_document::edit::Edit;
use backlit_document::run::{Run, RunChoices, RunEnding, RunStep};
use backlit_document::runs::{RunChange, StepRef};
use backlit_document::tracking_choices::TrackingChoices;
use backlit_document::{Estimate, Origin, fit_words as words};
use backlit_jobs::TaskEvent;
use backlit_tracking::fit::{FitOptions, Preset};

use super::job::{FitJob, FitMessage, FitStart};
use super::refit::Refitted;
use super::variants::{VariantRun, free_rotations};
use super::{Fit, LiveRun};
use crate::context::command::{BodyPart, Command, FitCommand};
use crate::context::command_button::next_gesture;
use crate::context::feature::Feature;
use crate::context::unavailable::{Why, because, no_body_fit, no_fit};
use crate::context::{Context, FeatureRequest, Requests, SessionRequest};
use crate::session::playback::PlaybackChange;
use crate::session::prediction::Predicted;

#[derive(Debug, Default)]
struct NewRun {
    /// The part of the body that may move, by name; otherwise all of it.
    part: Option<(String, Vec<bool>)>,
    /// How many steps; otherwise to the end.
    steps: Option<usize>,
    /// From another start and with other choices than the document's, to be compared.
    again: Option<VariantRun>,
}

impl Feature for Fit {
    fn update(&mut self, context: &Context<'_>, requests: &mut Requests) {
        // A run that was removed does not go on, even if it comes back.
        self.live.take_if(|live| context.runs().get(live.number).is_none());
        for event in self.task.poll() {
            match event {
                TaskEvent::Output(FitMessage::Step(step, predicted)) => {
                    self.take_in(*step, predicted, context, requests);
                }
                TaskEvent::Output(FitMessage::Refused(error)) => {
                    requests.complain(format!("The fit cannot begin: {error}"));
                    self.end(Some(RunEnding::Solver(error.to_string())), requests);
                }
                TaskEvent::Output(FitMessage::Paused(ending, paused)) => {
                    self.paused = paused;
                    self.end(ending, requests);
                }
                TaskEvent::Ended if self.pending_steps > 0 => {
                    let steps = std::mem::take(&mut self.pending_steps);
                    self.gesture = Some(next_gesture(context.egui));
                    self.go_on(Some(steps), context);
                }
                TaskEvent::Ended => {
                    let was_comparison = self.live.as_ref().is_some_and(|live| live.is_comparison);
                    if was_comparison && !self.begin_next(context, requests) {
                        // The views show the body again.
                        self.live = None;
                    }
                }
                TaskEvent::Failed(failure) => {
                    requests.failed("The fit", &failure);
                    // Nothing else begins by itself after it.
                    requests.request(FeatureRequest::InterruptFit);
                    self.pending_steps = 0;
                    self.end(Some(RunEnding::Solver("a step broke down".to_owned())), requests);
                    self.live = None;
                }
            }
        }
    }

    fn run(&mut self, command: Command, context: &Context<'_>, requests: &mut Requests) -> bool {
        let Command::Fit(command) = command else { return false };
        if matches!(
            command,
            FitCommand::Step
                | FitCommand::Run
                | FitCommand::RunAgain(_)
                | FitCommand::RunAgainWithCameras
                | FitCommand::Refit(_)
        ) {
            requests.request(SessionRequest::Playback(PlaybackChange::Pause));
        }
        match command {
            FitCommand::Step => self.step(Some(1), context, requests),
            FitCommand::Run => self.step(None, context, requests),
            FitCommand::Stop => {
                self.stop();
                // The tracker stops too.
                return false;
            }
            FitCommand::StepBack | FitCommand::EarlierStep => look_at_neighbour(false, context, requests),
            FitCommand::LaterStep => look_at_neighbour(true, context, requests),
            FitCommand::Branch => branch(context, requests),
            FitCommand::Refit(part) => self.refit(part, context, requests),
            FitCommand::RunAgain(over) => self.run_again(VariantRun::all(over, context), context, requests),
            FitCommand::RunAgainWithCameras => {
                self.run_again(VariantRun::over_cameras(context), context, requests);
            }
            FitCommand::SearchPoses | FitCommand::FitBody | FitCommand::MakeSpheres => return false,
            FitCommand::Renderer(renderer) => {
                let options = FitOptions { renderer, ..(*context.document().fit).clone() };
                let what = format!("Switch to {}", renderer.label().to_lowercase());
                requests.edit(Edit::SetFit { options: Box::new(options), what });
            }
            FitCommand::Preset(preset) => set_preset(preset, context, requests),
        }
        true
    }

    fn unavailable(&self, command: Command, context: &Context<'_>) -> Why {
        let Command::Fit(command) = command else { return None };
        let busy = context.busy;
        match command {
            FitCommand::Step | FitCommand::SearchPoses => no_fit(context),
            FitCommand::Run
            | FitCommand::RunAgain(_)
            | FitCommand::RunAgainWithCameras
            | FitCommand::Refit(_) => no_fit(context).or(because(busy.fitting, "The fit is running")),
            FitCommand::FitBody | FitCommand::MakeSpheres => {
                no_body_fit(context).or(because(busy.fitting, "The fit is running"))
            }
            FitCommand::Stop => {
                let is_behind = busy.exporting.is_some() || context.busy.basin;
                because(!(busy.fitting || busy.tracking || is_behind), "Nothing is running")
            }
            FitCommand::StepBack | FitCommand::EarlierStep => match (context.run(), context.shown_step()) {
                (None, _) => Some("This frame has no run yet: press Space to step"),
                (Some(_), Some(StepRef { step: 0, .. })) => Some("This is the start of the run"),
                (Some(run), _) => because(run.steps.len() < 2, "The run has no step yet"),
            },
            FitCommand::LaterStep => {
                let is_last = |at: StepRef| context.run().is_none_or(|run| run.last_step() == at.step);
                because(context.shown_step().is_none_or(is_last), "This is the newest step of the run")
            }
            FitCommand::Branch => because(
                context.selection.step.is_none(),
                "The frame’s pose is on the screen: go to a step of a run first",
            ),
            FitCommand::Renderer(_) | FitCommand::Preset(_) => None,
        }
    }

    fn answer(&mut self, request: &FeatureRequest, _: &Context<'_>, requests: &mut Requests) {
        if matches!(request, FeatureRequest::InterruptFit) {
            self.interrupt(requests);
        }
    }

    fn sentence(&self, _: &Context<'_>) -> Option<String> {
        self.is_running().then(|| "The fit is running. Esc stops it; all steps stay.".to_owned())
    }

    fn reset(&mut self, _: &Footage) {
        *self = Self::default();
    }

    fn freeze_times(&mut self) {
        self.step_seconds = None;
    }

    fn at_rest(&self) -> Self {
        Self { refits: self.refits.clone(), step_seconds: self.step_seconds, ..Self::default() }
    }
}

impl Fit {
    /// Stops it after its step; what is done stays, and may go on.
    pub(crate) fn stop(&mut self) {
        self.again.clear();
        self.pending_steps = 0;
        self.task.stop();
    }

    /// Ends it at once, because its pose is about to change: what it has done stays as a run.
    pub(crate) fn interrupt(&mut self, requests: &mut Requests) {
        self.again.clear();
        if self.task.is_busy() {
            self.task.forget();
            self.pending_steps = 0;
            self.end(Some(RunEnding::Stopped), requests);
            self.live = None;
        }
    }

    /// One step, or all of them: of the run that is live, if the pose on the screen is its last one and
    /// nothing that it depends on has changed; else of a new run.
    fn step(&mut self, steps: Option<usize>, context: &Context<'_>, requests: &mut Requests) {
        if self.task.is_busy() {
            self.pending_steps += steps.unwrap_or(0);
            return;
        }
        self.gesture = Some(next_gesture(context.egui));
        match self.live.as_ref().filter(|live| live.can_go_on(context)) {
            Some(live) if live.is_over => {
                requests
                    .status("This run has ended. Move the body or choose otherwise, and a new one begins.");
            }
            Some(live) => {
                requests.request(SessionRequest::LeaveStep);
                requests.request(SessionRequest::Runs(RunChange::End(live.number, None)));
                self.go_on(steps, context);
            }
            None => self.begin(NewRun { steps, ..NewRun::default() }, context, requests),
        }
    }

    fn go_on(&mut self, steps: Option<usize>, context: &Context<'_>) {
        let job = FitJob { start: None, fit: self.paused.take(), left: steps };
        self.task.begin(context.pool, (), |()| job);
    }

    /// Fits a part of the body from the pose on the screen, to the end.
    fn refit(&mut self, part: BodyPart, context: &Context<'_>, requests: &mut Requests) {
        let model = &context.document().model;
        let limb = context.selection.limb(model);
        let name = match part {
            BodyPart::Limb => Some(model.limbs()[limb].name.clone()),
            BodyPart::Chain => Some(format!("chain of {}", model.limbs()[limb].name)),
            BodyPart::Body => None,
        };
        self.gesture = Some(next_gesture(context.egui));
        let what = format!("Refit {}", name.as_deref().unwrap_or("body"));
        let part = name.zip(free_rotations(model, limb, part));
        self.begin(NewRun { part, ..NewRun::default() }, context, requests);
        self.refitting = Some(what);
    }

    /// Begins the next run of a comparison; says whether there was one.
    fn begin_next(&mut self, context: &Context<'_>, requests: &mut Requests) -> bool {
        let Some(again) = self.again.pop_front() else { return false };
        self.gesture = None;
        self.begin(NewRun { again: Some(again), ..NewRun::default() }, context, requests);
        true
    }

    /// Runs from the start of the run on the screen with each of some choices, one after the other.
    fn run_again(&mut self, runs: Vec<VariantRun>, context: &Context<'_>, requests: &mut Requests) {
        if self.task.is_busy() {
            return;
        }
        self.again = runs.into();
        self.begin_next(context, requests);
    }

    fn begin(&mut self, new: NewRun, context: &Context<'_>, requests: &mut Requests) {
        self.refitting = None;
        let Some(mut inputs) = context.fit_inputs() else { return };
        let (mut pose, frame, runs) = (context.shown_pose().clone(), context.selection.frame, context.runs());
        let is_comparison = new.again.is_some();
        if let Some(again) = new.again {
            (inputs.fit, pose, inputs.uses) = (Arc::new(again.options), again.start, again.cameras);
        }
        let (part, free) = new.part.unzip();
        let fit = inputs.fit.clone();
        // Stages to the scale of what is seen: these are the ones that the fit's steps will name.
        let options = (*fit).clone().at_scale(&inputs.model, &inputs.views(), &pose);
        let number = runs.next_number();
        let branched_from = runs.step_with_pose(frame, &pose);
        let measured_by = runs.measure_beside(frame, &fit);
        let run = Run {
            number,
            detail: words::fit_detail(&fit),
            frame,
            measured_by,
            colour: runs.free_colour(),
            stages: options.stages.iter().map(|stage| words::short_ramp(stage.ramp)).collect(),
            choices: RunChoices { fit, cameras: inputs.uses.clone(), part, branched_from },
            is_shown: true,
            ..Run::default()
        };
        requests.request(SessionRequest::Runs(RunChange::Begin(Box::new(run))));
        requests.request(SessionRequest::LeaveStep);
        self.live = Some(LiveRun {
            number,
            frame,
            inputs: inputs.clone(),
            before: 0.0,
            steps: 0,
            last: None,
            is_over: false,
            is_comparison,
        });
        let views = context.session.viewed.clone();
        let start = Some(FitStart { inputs, pose, options, free, measured_by, views });
        self.task.begin(context.pool, (), |()| FitJob { start, fit: None, left: new.steps });
    }

    fn take_in(
        &mut self,
        mut step: RunStep,
        predicted: Arc<Predicted>,
        context: &Context<'_>,
        requests: &mut Requests,
    ) {
        self.step_seconds = Some(step.seconds);
        step.joint_error_mm = context.joint_error_mm(&step.iteration.point);
        if context.selection.step.is_none() {
            requests.predicted = Some(predicted.clone());
        }
        let Some(live) = &mut self.live else { return };
        if live.last.is_some() {
            live.steps += 1;
        } else {
            live.before = step.mismatch;
        }
        live.last = Some((step.clone(), predicted));
        requests.request(SessionRequest::Runs(RunChange::Step(live.number, Box::new(step))));
    }

    /// The steps asked for are done, or the fit has ended: its pose becomes the frame's.
    fn end(&mut self, ending: Option<RunEnding>, requests: &mut Requests) {
        let Some(live) = &self.live else { return };
        requests.request(SessionRequest::Runs(RunChange::End(live.number, ending.clone())));
        let Some((last, predicted)) = &live.last else {
            // It could not begin.
            self.live = None;
            return;
        };
        if let Some(ending) = &ending
            && let Some(what) = self.refitting.take()
        {
            let (before, after, ending) = (live.before, last.mismatch, ending.text());
            let refitted = Refitted { what, before, after, steps: live.steps, ending };
            let (is_worse, frame) = (refitted.is_worse(), live.frame);
            self.refits.insert(frame, refitted);
            if is_worse {
                // The run stays to be looked at; the body stays as it was.
                self.live = None;
                return;
            }
        }
        if live.steps > 0 && !live.is_comparison {
            let predicted = Some(predicted).filter(|predicted| predicted.pose == last.iteration.point);
            let estimate = Estimate {
                pose: last.iteration.point.clone(),
                origin: Origin::Fit,
                cost: Some(predicted.map_or(last.mismatch, |predicted| predicted.mismatch)),
                rms: predicted.and_then(|predicted| predicted.rms),
                iou: predicted.and_then(|predicted| predicted.iou()),
                steps: live.steps,
                lost: false,
                is_stale: false,
            };
            let edit = Edit::AddEstimate { frame: live.frame, estimate: Arc::new(estimate) };
            requests.edits.push((edit, self.gesture));
        }
        if let Some(live) = self.live.as_mut().filter(|_| ending.is_some()) {
            live.is_over = matches!(ending, Some(RunEnding::Solver(_)));
            self.pending_steps = 0;
        }
    }
}

impl LiveRun {
    /// Whether the pose on the screen is its last one, and nothing else that it depends on has changed.
    fn can_go_on(&self, context: &Context<'_>) -> bool {
        let has_same_inputs = || context.fit_inputs().is_some_and(|inputs| self.inputs.is(&inputs));
        self.frame == context.selection.frame
            && self.last.as_ref().is_some_and(|(last, _)| *context.shown_pose() == last.iteration.point)
            && has_same_inputs()
    }
}

/// Goes to the step before or after the one on the screen.
fn look_at_neighbour(later: bool, context: &Context<'_>, requests: &mut Requests) {
    let Some(run) = context.run().filter(|run| !run.steps.is_empty()) else { return };
    let last = run.last_step();
    let step = match context.shown_step() {
        Some(at) if later => (at.step + 1).min(last),
        Some(at) => at.step.saturating_sub(1),
        // The body was moved since: back to where the run left it.
        None => last,
    };
    // The newest step is the document's pose, as long as nobody has changed that.
    let is_newest = step == last
        && run.steps[last].iteration.point == *context.document().pose_at(context.selection.frame);
    let at = StepRef { run: run.number, step };
    requests.request(if is_newest { SessionRequest::LeaveStep } else { SessionRequest::Step(at) });
}

/// Makes the step on the screen the frame's pose.
fn branch(context: &Context<'_>, requests: &mut Requests) {
    let Some(at) = context.selection.step else { return };
    let Some(step) = context.runs().step(at) else { return };
    let what = format!("Branch at step {}", at.step);
    requests.edit(Edit::SetPose { frame: context.selection.frame, pose: step.iteration.point.clone(), what });
}

/// Switches to a preset, with the tracking that goes with it: one act. The renderer is chosen by itself.
fn set_preset(preset: Preset, context: &Context<'_>, requests: &mut Requests) {
    let document = context.document();
    let gesture = next_gesture(context.egui);
    let mut options = FitOptions { renderer: document.fit.renderer, ..FitOptions::preset(preset) };
    options.prior.clone_from(&document.fit.prior);
    let what = format!("Switch to {}", preset.label());
    requests.drag(Edit::SetFit { options: Box::new(options), what }, gesture);
    let mut choices = TrackingChoices::of_preset(Some(preset));
    let motion = document.tracking.motion;
    // A filter that was chosen stays; but the report has none.
    if preset != Preset::Report
        && motion != TrackingChoices::of_preset(words::preset_like(&document.fit)).motion
    {
        choices.motion = motion;
    }
    // Demonstrations are of silhouettes alone, as the experiments of the same name.
    if context.session.demonstration().is_some() {
        choices.prior = document.tracking.prior;
    }
    requests.drag(Edit::SetTracking(choices), gesture);
}
