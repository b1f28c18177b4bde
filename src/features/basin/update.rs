//! The basin of the frame on the screen: begun, stopped, its starts taken, its results written.

use std::path::Path;
use std::time::Instant;

use backlit_document::edit::Edit;
use backlit_formats::Footage;
use backlit_jobs::{Job, Outbox, TaskEvent, Turn};
use backlit_runs::basin::{self, BasinError, BasinOptions, BasinResult, Subject, Trial};
use backlit_tracking::search::start;
use backlit_ui::style::format;
use egui::Ui;

use super::panel::progress_text;
use super::{Basin, BasinProgress, BasinResults, BasinSettings, FileKind, Reference};
use crate::context::command::{BasinCommand, BasinView, Command};
use crate::context::feature::Feature;
use crate::context::file_dialog::DialogKind;
use crate::context::pane::Pane;
use crate::context::unavailable::{Why, because, no_fit};
use crate::context::{Context, PaneEvent, Requests, SessionRequest, ShellRequest};

/// All trials of a subject, one a step. The first step finds where fits are to end.
fn trials(subject: Subject, options: BasinOptions) -> impl Job<Result<Trial, BasinError>> {
    let (mut begin, mut basin, mut next) = (Some((subject, options)), None, 0);
    // Makes the next trial; whether there is one more.
    let mut go_on = move |out: &Outbox<Result<Trial, BasinError>>| -> Result<bool, BasinError> {
        if let Some((subject, options)) = begin.take() {
            basin = Some(basin::Basin::new(subject, &options, out.cancel())?);
        }
        let Some(basin) = &basin else { return Ok(false) };
        out.send(Ok(basin.run(next, out.cancel())?));
        next += 1;
        Ok(next < basin.trials())
    };
    move |out: &Outbox<Result<Trial, BasinError>>| {
        if out.cancel().is_cancelled() {
            return Turn::Done;
        }
        match go_on(out) {
            Ok(true) => Turn::Again,
            Ok(false) | Err(BasinError::Cancelled) => Turn::Done,
            Err(error) => {
                out.send(Err(error));
                Turn::Done
            }
        }
    }
}

impl Feature for Basin {
    fn update(&mut self, context: &Context<'_>, requests: &mut Requests) {
        for event in self.task.poll() {
            match event {
                TaskEvent::Output(Ok(trial)) => self.add(trial),
                TaskEvent::Output(Err(error)) => requests.complain(format!("The basin cannot run: {error}.")),
                TaskEvent::Ended => self.ended(requests),
                TaskEvent::Failed(failure) => {
                    requests.failed("The basin", &failure);
                    self.ended(requests);
                }
            }
        }
        for (kind, path) in self.dialogs.answers() {
            self.write(kind, &path, context, requests);
        }
    }

    fn run(&mut self, command: Command, context: &Context<'_>, requests: &mut Requests) -> bool {
        let Command::Basin(command) = command else { return false };
        match command {
            BasinCommand::Run(view) => self.begin(view, context, requests),
            BasinCommand::Cancel => self.cancel(),
        }
        true
    }

    fn unavailable(&self, command: Command, context: &Context<'_>) -> Why {
        let Command::Basin(command) = command else { return None };
        match command {
            BasinCommand::Run(_) => no_fit(context).or(because(context.busy.basin, "A basin is running")),
            BasinCommand::Cancel => because(!context.busy.basin, "No basin is running"),
        }
    }

    fn fills(&self) -> Option<Pane> {
        Some(Pane::Basin)
    }

    fn pane(&mut self, ui: &mut Ui, context: &Context<'_>, siblings: &[Pane], requests: &mut Requests) {
        self.show(ui, context, siblings, requests);
    }

    fn sections(&mut self, ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
        self.section(ui, context, requests);
    }

    fn sentence(&self, _: &Context<'_>) -> Option<String> {
        let progress = progress_text(self.results.running?);
        Some(format!("Running the basin: {progress}. Esc stops it; what is done stays."))
    }

    fn reset(&mut self, _: &Footage) {
        *self = Self { preferences: std::mem::take(&mut self.preferences), ..Self::default() };
    }

    fn freeze_times(&mut self) {
        if let Some(running) = &mut self.results.running {
            running.seconds_left = None;
        }
    }

    fn at_rest(&self) -> Self {
        let results = BasinResults { running: None, ..self.results.clone() };
        Self {
            preferences: self.preferences.clone(),
            results,
            problem: self.problem.clone(),
            ..Self::default()
        }
    }
}

impl Basin {
    /// Other settings.
    pub fn set(&mut self, settings: BasinSettings) {
        self.preferences.settings = settings;
        self.problem = None;
    }

    /// Stops the fits; what is done stays.
    pub(crate) fn cancel(&self) {
        self.task.stop();
    }

    /// Runs what a view shows, about the pose on the screen, and shows it.
    fn begin(&mut self, view: BasinView, context: &Context<'_>, requests: &mut Requests) {
        self.preferences.view = view;
        requests.request(ShellRequest::Pane(Pane::Basin, PaneEvent::Open));
        self.problem = self.try_to_begin(view, context).err();
    }

    fn try_to_begin(&mut self, view: BasinView, context: &Context<'_>) -> Result<(), String> {
        let subject = self.subject(context)?;
        let document = context.document();
        let held = document.model.limbs()[context.selection.limb(&document.model)].rotation;
        let options = self.preferences.settings.options(view, &document.fit, &document.model, held)?;
        let (frame, conditions) = (context.selection.frame, self.conditions(&options, context));
        let result = BasinResult::new(frame, conditions, options.clone(), subject.clone());
        let total = result.fits().total;
        *self.results.of_mut(view) = Some(result);
        if view == BasinView::Map {
            (self.results.shown_choice, self.results.taken) = (None, None);
        }
        self.results.running = Some(BasinProgress { view, done: 0, total, seconds_left: None });
        self.began = Some(Instant::now());
        self.task.begin(context.pool, (), |()| trials(subject, options));
        Ok(())
    }

    /// What the cameras see of the frame on the screen, and the pose that its basin is about.
    fn subject(&self, context: &Context<'_>) -> Result<Subject, &'static str> {
        let Some(inputs) = context.fit_inputs() else { return Err("Open a take first") };
        let views = inputs.views();
        if views.is_empty() {
            return Err("No camera that counts has a silhouette of this frame");
        }
        let reference = match self.preferences.settings.reference {
            Reference::Pose => context.shown_pose().clone(),
            Reference::Truth => {
                let take = context.session.take.as_ref();
                let joints =
                    take.and_then(|take| take.take().reference()).map(|r| r.joints(context.selection.frame));
                let pose = joints.and_then(|joints| start::from_joints(&inputs.model, &joints));
                pose.ok_or("The take has no true pose of this frame")?
            }
        };
        Ok(Subject { model: inputs.model, views, reference })
    }

    /// Frame, cameras and what is turned, in one line.
    fn conditions(&self, options: &BasinOptions, context: &Context<'_>) -> String {
        let (document, frame) = (context.document(), context.selection.frame);
        let model = &document.model;
        let cameras: Vec<String> = document.used_cameras().map(|index| (index + 1).to_string()).collect();
        let s = if cameras.len() == 1 { "" } else { "s" };
        let mut conditions = format!("frame {frame}, camera{s} {}", cameras.join(" "));
        if let basin::Starts::Random(basin::RandomStarts { rotation: Some(rotation), .. }) = options.starts {
            conditions += &format!(", {} alone", model.limbs()[model.rotation_owners()[rotation]].name);
        }
        if self.preferences.settings.reference == Reference::Truth {
            conditions += ", about the truth";
        }
        conditions
    }

    fn add(&mut self, trial: Trial) {
        let (Some(running), Some(began)) = (&mut self.results.running, self.began) else { return };
        running.done += 1;
        let each = began.elapsed().as_secs_f64() / running.done as f64;
        running.seconds_left = Some(each * running.total.saturating_sub(running.done) as f64);
        let view = running.view;
        if let Some(result) = self.results.of_mut(view) {
            result.add(trial);
        }
    }

    /// The experiment is over: all of it, or as far as it was wanted.
    fn ended(&mut self, requests: &mut Requests) {
        let Some(running) = self.results.running.take() else { return };
        let (done, total) = (format::count(running.done as i64), format::count(running.total as i64));
        let text = if running.done == running.total {
            format!("The basin is done: {total} fits.")
        } else if running.done == 0 {
            *self.results.of_mut(running.view) = None;
            "The basin ended before its first fit.".to_owned()
        } else {
            format!("The basin was stopped after {done} of {total} fits. Their results stay, marked partial.")
        };
        requests.inform(text, None);
    }

    /// Gives the frame of the map the start of a cell, so that it can be stepped.
    pub(super) fn take_start(&mut self, place: [usize; 2], requests: &mut Requests) {
        let Some((map, grid)) = self.results.map_and_grid() else { return };
        let (frame, pose) = (map.frame, grid.pose(&map.subject, place));
        let [across, up] = place.map(|index| format::number(grid.offset_degrees(index), 0));
        self.results.taken = Some(place);
        let what = format!("Start from the map at {across}°, {up}°");
        requests.request(SessionRequest::Frame(frame));
        requests.status(format!("{what}. Space steps from here; undo brings the pose back."));
        requests.edit(Edit::SetPose { frame, pose, what });
    }

    /// Asks where what the pane shows is to be written.
    pub(super) fn ask_for_file(&self, kind: FileKind, context: &Context<'_>, requests: &mut Requests) {
        let name = format!("{} basin.{}", context.take_name(), kind.extension());
        let dialog = ("Export basin", DialogKind::NewFile(name, kind.words().0));
        self.dialogs.ask(context.egui, kind, dialog, |why| requests.complain(why));
    }

    /// Writes what the pane shows to a file.
    pub fn write(&self, kind: FileKind, path: &Path, context: &Context<'_>, requests: &mut Requests) {
        let theme = context.preferences.theme;
        let Some(result) = self.results.of(self.preferences.view).cloned() else {
            return requests.complain("There is no basin to write yet.");
        };
        requests.write(path, move || match kind {
            FileKind::Csv => result.csv(),
            FileKind::Png => result.png(theme),
            FileKind::Json => result.json(),
        });
    }
}
