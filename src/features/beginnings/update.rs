//! Begun, one method a step of the pool, stopped, played step by step, taken.

use std::sync::Arc;
use std::time::Duration;

use backlit_document::edit::Edit;
use backlit_formats::Footage;
use backlit_jobs::{Job, Outbox, TaskEvent, Turn};
use backlit_runs::initialisation::{InitialisationMessage, InitialisationOutcome, InitialisationRun};
use backlit_tracking::initialisation::{InitialisationMethod as Method, InitialisationOptions};
use egui::Ui;

use super::record::{Recorder, ShownAttempt};
use super::{AttemptIndex, Beginnings, COMPARED, InitialisedFrame, MethodWords};
use crate::context::command::{BeginningCommand, Command};
use crate::context::command_button::next_gesture;
use crate::context::feature::Feature;
use crate::context::pane::Pane;
use crate::context::unavailable::{Why, because, no_fit, no_take};
use crate::context::{Context, PaneEvent, Published, Requests, ShellRequest};
use crate::session::prediction::{FitInputs, Predicted};

/// Seconds between two steps that are played.
const SECONDS: f64 = 0.35;

#[derive(Debug)]
pub(super) enum BeginningMessage {
    /// A method begins.
    Begun(Method),
    /// It has come by a pose, or leads nowhere; why.
    Ended(Method, Result<Arc<Outcome>, String>),
}

/// What a method led to.
#[derive(Debug, Clone)]
pub(super) struct Outcome {
    /// All that it did; never empty.
    pub(super) steps: Vec<ShownAttempt>,
    /// Mismatch of the pose, as the window measures every pose.
    pub(super) cost: f64,
    pub(super) iou: Option<f64>,
    /// Evaluations of Λ, where they are counted.
    pub(super) evaluations: Option<usize>,
    pub(super) seconds: f64,
    /// Mean distance of the joints from the take's reference.
    pub(super) error_mm: Option<f64>,
}

/// Tries methods, one a step.
fn try_all(mut run: InitialisationRun, inputs: FitInputs) -> impl Job<BeginningMessage> {
    move |out: &Outbox<BeginningMessage>| {
        let (model, mut recorder) = (Arc::clone(&run.model), None);
        let goes_on = run.step(out.cancel(), &mut |message| match message {
            InitialisationMessage::Begun(method) => {
                recorder = Some(Recorder::new(method, &model));
                out.send(BeginningMessage::Begun(method));
            }
            InitialisationMessage::Attempt(attempt) => {
                if let Some(recorder) = &mut recorder {
                    recorder.record(attempt);
                }
            }
            InitialisationMessage::Ended(method, outcome) => {
                if let Some(recorder) = recorder.take() {
                    let outcome = measured(&inputs, outcome, recorder);
                    out.send(BeginningMessage::Ended(method, Ok(Arc::new(outcome))));
                }
            }
            InitialisationMessage::Failed(method, why) => {
                out.send(BeginningMessage::Ended(method, Err(why)));
            }
        });
        if goes_on { Turn::Again } else { Turn::Done }
    }
}

/// The figures of where a method ended, as the window measures every pose.
fn measured(inputs: &FitInputs, outcome: InitialisationOutcome, mut recorder: Recorder) -> Outcome {
    let InitialisationOutcome { result, pose, seconds, error_mm } = outcome;
    recorder.end(&pose);
    let inputs = FitInputs { model: result.model, ..inputs.clone() };
    let predicted = Predicted::new(&inputs, &pose, None);
    let (cost, iou) = (predicted.mismatch, predicted.iou());
    Outcome { steps: recorder.steps, cost, iou, evaluations: result.evaluations, seconds, error_mm }
}

impl Feature for Beginnings {
    fn update(&mut self, context: &Context<'_>, requests: &mut Requests) {
        if self.about.as_ref().is_some_and(|about| !is_about(about, context)) {
            self.forget();
        }
        for event in self.task.poll() {
            match event {
                TaskEvent::Output(BeginningMessage::Begun(method)) => self.running = Some(method),
                TaskEvent::Output(BeginningMessage::Ended(method, outcome)) => {
                    let is_first = outcome.is_ok() && self.at.is_none();
                    self.ended.insert(method, outcome);
                    if is_first {
                        self.look_at(AttemptIndex { method, step: 0 });
                    }
                }
                TaskEvent::Ended => self.running = None,
                TaskEvent::Failed(failure) => {
                    self.running = None;
                    requests.failed("A way to begin", &failure);
                }
            }
        }
        // The screen is another's.
        let busy = &context.busy;
        let is_elsewhere = busy.fitting || busy.tracking || context.playback.is_playing();
        let is_open = context.preferences.is_open(Pane::Beginnings, context.session.camera_count());
        if is_elsewhere || context.selection.step.is_some() || !is_open {
            self.leave();
        }
        if self.waits && is_read(context) {
            self.waits = false;
            requests.run(Command::Beginning(BeginningCommand::RunAll));
        }
        self.play(context);
        self.draw();
    }

    fn publish(&self, published: &mut Published) {
        published.ghosts =
            self.drawn.as_ref().filter(|_| self.is_shown).map(|(_, ghosts)| Arc::clone(ghosts));
    }

    fn run(&mut self, command: Command, context: &Context<'_>, requests: &mut Requests) -> bool {
        let Command::Beginning(command) = command else { return false };
        match command {
            BeginningCommand::RunAll if is_read(context) => self.begin(&COMPARED, context, requests),
            BeginningCommand::RunAll => self.waits = true,
            BeginningCommand::AcquireBody => self.begin(&[Method::Body], context, requests),
            BeginningCommand::Stop => self.stop(),
        }
        true
    }

    fn unavailable(&self, command: Command, context: &Context<'_>) -> Why {
        let Command::Beginning(command) = command else { return None };
        match command {
            // It begins when the frame is read.
            BeginningCommand::RunAll if !is_read(context) => no_take(context),
            BeginningCommand::RunAll | BeginningCommand::AcquireBody => no_fit(context)
                .or(because(self.is_running(), "A way to begin is being tried: wait, or stop it with Esc")),
            BeginningCommand::Stop => because(!self.is_running(), "No way to begin is being tried"),
        }
    }

    fn fills(&self) -> Option<Pane> {
        Some(Pane::Beginnings)
    }

    fn pane(&mut self, ui: &mut Ui, context: &Context<'_>, siblings: &[Pane], requests: &mut Requests) {
        self.show(ui, context, siblings, requests);
    }

    fn sentence(&self, _: &Context<'_>) -> Option<String> {
        if let Some(method) = self.running.filter(|_| self.is_running()) {
            return Some(format!(
                "Trying {}. Esc stops it; what is done stays.",
                MethodWords::of(method).lower_case
            ));
        }
        let &(AttemptIndex { method, step }, _) = self.drawn.as_ref().filter(|_| self.is_shown)?;
        Some(format!(
            "Step {} of {}. Esc shows the pose again.",
            step + 1,
            MethodWords::of(method).lower_case
        ))
    }

    fn reset(&mut self, _: &Footage) {
        *self = Self { no_start: self.no_start, ..Self::default() };
    }

    fn freeze_times(&mut self) {
        for outcome in self.ended.values_mut().flatten() {
            Arc::make_mut(outcome).seconds = f64::NAN;
        }
    }

    fn at_rest(&self) -> Self {
        let (about, ended, drawn) = (self.about.clone(), self.ended.clone(), self.drawn.clone());
        let Self { no_start, at, is_shown, .. } = *self;
        Self { about, ended, drawn, no_start, at, is_shown, ..Self::default() }
    }
}

impl Beginnings {
    /// Stops what is being tried; what is done stays.
    pub(crate) fn stop(&self) {
        self.task.stop();
    }

    /// Shows the pose again in the place of a step. Whether a step was shown.
    pub(crate) fn leave(&mut self) -> bool {
        self.plays = None;
        std::mem::take(&mut self.is_shown)
    }

    /// Tries ways, and shows the pane. A single one begins where the others did; all of them begin again.
    pub(super) fn begin(&mut self, methods: &[Method], context: &Context<'_>, requests: &mut Requests) {
        requests.request(ShellRequest::Pane(Pane::Beginnings, PaneEvent::Open));
        let Some((footage, inputs)) = context.session.take.clone().zip(context.fit_inputs()) else { return };
        let has_start = |about: &InitialisedFrame| about.start.is_none() == self.no_start;
        let fits = self.about.as_ref().is_some_and(|about| methods == [Method::Body] || has_start(about));
        if methods.len() > 1 || !fits {
            self.forget();
            let start = (!self.no_start).then(|| context.shown_pose().clone());
            self.about = Some(InitialisedFrame { frame: context.selection.frame, inputs, start });
        }
        let Some(about) = self.about.clone() else { return };
        for method in methods {
            self.ended.remove(method);
        }
        self.at = None;
        self.drawn = None;
        self.running = methods.first().copied();
        let reference = footage.take().reference();
        let run = InitialisationRun {
            model: Arc::clone(&about.inputs.model),
            views: about.inputs.views(),
            start: about.start,
            reference: reference.map(|reference| reference.joints(about.frame)),
            options: InitialisationOptions::default(),
            methods: methods.iter().copied().collect(),
        };
        self.task.begin(context.pool, (), |()| try_all(run, about.inputs));
    }

    fn forget(&mut self) {
        let no_start = self.no_start;
        *self = Self { no_start, ..Self::default() };
    }

    /// Looks at a step, in views and scene too.
    pub(super) fn look_at(&mut self, at: AttemptIndex) {
        self.at = Some(at);
        self.is_shown = true;
        self.draw();
    }

    /// Plays on, or begins to play: from the first step where the last is looked at.
    pub(super) fn toggle_play(&mut self, now: f64) {
        let Some((at, last)) = self.at.zip(self.last_step()) else { return };
        self.plays = if self.plays.is_some() { None } else { Some(now + SECONDS) };
        if self.plays.is_some() {
            self.look_at(AttemptIndex { step: if at.step >= last { 0 } else { at.step }, ..at });
        }
    }

    /// Index of the last step of the way that is looked at.
    pub(super) fn last_step(&self) -> Option<usize> {
        self.outcome().map(|outcome| outcome.steps.len().saturating_sub(1))
    }

    fn play(&mut self, context: &Context<'_>) {
        let (Some(due), Some(at), Some(last)) = (self.plays, self.at, self.last_step()) else { return };
        if context.now >= due {
            let step = (at.step + 1).min(last);
            self.plays = (step < last).then_some(context.now + SECONDS);
            self.look_at(AttemptIndex { step, ..at });
        }
        if let Some(due) = self.plays {
            context.egui.request_repaint_after(Duration::from_secs_f64((due - context.now).max(0.0)));
        }
    }

    /// Has the bodies of the step ready that is looked at.
    fn draw(&mut self) {
        let Some(at) = self.at.filter(|at| self.drawn.as_ref().is_none_or(|drawn| drawn.0 != *at)) else {
            return;
        };
        let ghosts = self.outcome().and_then(|outcome| outcome.steps.get(at.step)).map(|step| step.ghosts());
        self.drawn = ghosts.map(|ghosts| (at, Arc::new(ghosts)));
    }

    /// The pose of the step that is looked at becomes the frame's; of a body that was acquired its sizes too, as one act.
    pub(super) fn take(&mut self, context: &Context<'_>, requests: &mut Requests) {
        let (Some(at), Some(about), Some(outcome)) = (self.at, &self.about, self.outcome()) else { return };
        let Some(step) = outcome.steps.get(at.step) else { return };
        let (frame, pose) = (about.frame, step.pose().clone());
        if at.method == Method::Body {
            let gesture = Some(next_gesture(context.egui));
            let name = context.document().model.name();
            let body = Arc::new((*step.model).clone().renamed(name));
            let what = "Take acquired body".to_owned();
            requests.edits.push((Edit::SetBody(body), gesture));
            requests.edits.push((Edit::SetPose { frame, pose, what }, gesture));
            requests
                .status("The body has the sizes and the pose of this step. Undo brings the old ones back.");
        } else {
            let what = format!("Take pose of {}", MethodWords::of(at.method).lower_case);
            requests.edit(Edit::SetPose { frame, pose, what });
            requests.status("The frame has the pose of this step. Space fits on from here; undo brings the old pose back.");
        }
        self.leave();
    }
}

/// Whether the frame on the screen is read.
fn is_read(context: &Context<'_>) -> bool {
    context.session.frames.get(context.selection.frame).is_some()
}

/// Whether what is on the screen is still what the runs are about.
fn is_about(about: &InitialisedFrame, context: &Context<'_>) -> bool {
    let document = context.document();
    let cameras = context.session.take.as_ref().map(|take| &take.cameras);
    about.frame == context.selection.frame
        && Arc::ptr_eq(&about.inputs.model, &document.model)
        && Arc::ptr_eq(&about.inputs.uses, &document.cameras)
        && cameras.is_some_and(|cameras| Arc::ptr_eq(&about.inputs.cameras, cameras))
}
