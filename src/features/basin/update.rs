//! The basin of the frame on the screen: begun, stopped, its starts taken, its results written.

use backlit_formats::Footage;
use egui::Ui;
use std::path::Path;
use std::time::Instant;

use backlit_document::edit::Edit;
use backlit_jobs::News;
use backlit_lab::experiment::frame_basin::{Frame, Report};
use backlit_results::basin::{About, AnglesResult, MapResult, direction_name};
use backlit_tracking::search::start;
use backlit_ui::style::format;

use super::BasinResults;
use super::job::{BasinJob, BasinWork, Fitted};
use super::panel::progress_text;
use super::settings::BasinProblem;
use super::{Basin, BasinSettings, FileKind, Reference, Running, ShownMap};
use crate::context::command::Command;
use crate::context::command::{BasinCommand, BasinView};
use crate::context::feature::Feature;
use crate::context::file_dialog::DialogKind;
use crate::context::pane::Pane;
use crate::context::unavailable::{Why, because, no_fit};
use crate::context::{Context, PaneEvent, Requests, SessionRequest, ShellRequest};

impl Feature for Basin {
    fn update(&mut self, context: &Context<'_>, requests: &mut Requests) {
        for news in self.task.poll() {
            match news {
                News::Output(Fitted::Trial(trial)) => self.results.add_trial(trial),
                News::Output(Fitted::Cell(cell)) => self.results.add_cell(cell),
                News::Output(Fitted::Refused(error)) => {
                    requests.complain(format!("The basin cannot run: {error}."));
                }
                News::Ended => self.ended(requests),
                News::Failed(failure) => {
                    requests.failed("The basin", &failure);
                    self.ended(requests);
                }
            }
            self.estimate_time();
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
        self.section(ui, context, requests, false);
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

    fn try_to_begin(&mut self, view: BasinView, context: &Context<'_>) -> Result<(), BasinProblem> {
        let frame = self.frame(context)?;
        let document = context.document();
        let held = document.model.limbs()[context.selection.limb(&document.model)].rotation;
        let settings = &self.preferences.settings;
        let (work, total) = match view {
            BasinView::Angles => {
                let options = settings.options(&document.fit, held)?;
                let about = self.about(context, options.rotation);
                let report = Report::of(&options, &[]);
                let work = (BasinWork::Angles(Box::new(options.clone())), options.trials());
                self.results.angles = Some(AnglesResult { about, options, trials: Vec::new(), report });
                work
            }
            BasinView::Map => {
                let options = settings.map_options(&document.fit, &document.model, held);
                let about = self.about(context, None);
                let directions = options.directions.map(|one| direction_name(&frame.model, one));
                let work = (BasinWork::Map(Box::new(options.clone())), options.trials());
                self.results.map =
                    Some(ShownMap::new(MapResult::new(about, options, frame.clone(), directions)));
                work
            }
        };
        self.results.running = Some(Running { view, done: 0, total, seconds_left: None });
        self.began = Some(Instant::now());
        self.task.begin(context.pool, (), |()| BasinJob::new(frame, work));
        Ok(())
    }

    /// What the cameras see of the frame on the screen, and the pose that its basin is about.
    fn frame(&self, context: &Context<'_>) -> Result<Frame, BasinProblem> {
        let Some(inputs) = context.fit_inputs() else { return Err(BasinProblem::NoTake) };
        let views = inputs.views();
        if views.is_empty() {
            return Err(BasinProblem::NoSilhouettes);
        }
        let reference = match self.preferences.settings.reference {
            Reference::Pose => context.shown_pose().clone(),
            Reference::Truth => {
                let take = context.session.take.as_ref();
                let joints =
                    take.and_then(|take| take.take().reference()).map(|r| r.joints(context.selection.frame));
                let pose = joints.and_then(|joints| start::from_joints(&inputs.model, &joints));
                pose.ok_or(BasinProblem::NoTruth)?
            }
        };
        Ok(Frame { model: inputs.model, views, reference })
    }

    fn about(&self, context: &Context<'_>, rotation: Option<usize>) -> About {
        let (document, frame) = (context.document(), context.selection.frame);
        let model = &document.model;
        let cameras: Vec<String> = document.used_cameras().map(|index| (index + 1).to_string()).collect();
        let turned = rotation.map(|rotation| &model.limbs()[model.rotation_owners()[rotation]].name);
        let mut conditions = format!("frame {frame}");
        conditions += &format!(", camera{} {}", if cameras.len() == 1 { "" } else { "s" }, cameras.join(" "));
        if let Some(limb) = turned {
            conditions += &format!(", {limb} alone");
        }
        if self.preferences.settings.reference == Reference::Truth {
            conditions += ", about the truth";
        }
        About { frame, conditions }
    }

    fn estimate_time(&mut self) {
        if let (Some(running), Some(began)) = (&mut self.results.running, self.began)
            && running.done > 0
        {
            let each = began.elapsed().as_secs_f64() / running.done as f64;
            running.seconds_left = Some(each * running.total.saturating_sub(running.done) as f64);
        }
    }

    /// The experiment is over: all of it, or as far as it was wanted.
    fn ended(&mut self, requests: &mut Requests) {
        let Some(running) = self.results.running.take() else { return };
        let (done, total) = (format::count(running.done as i64), format::count(running.total as i64));
        let text = if running.done == running.total {
            format!("The basin is done: {total} fits.")
        } else if running.done == 0 {
            self.results.forget(running.view);
            "The basin ended before its first fit.".to_owned()
        } else {
            format!("The basin was stopped after {done} of {total} fits. Their results stay, marked partial.")
        };
        requests.inform(text, None);
    }

    /// Gives the frame of the map the start of a cell, so that it can be stepped.
    pub(super) fn take_start(&mut self, place: [usize; 2], requests: &mut Requests) {
        let Some(map) = &mut self.results.map else { return };
        map.taken = Some(place);
        let (frame, pose) = (map.about.frame, map.options.start(&map.frame, place));
        let [across, up] = place.map(|place| format::number(map.options.offset_degrees(place), 0));
        let what = format!("Start from the map at {across}°, {up}°");
        requests.request(SessionRequest::Frame(frame));
        requests.status(format!("{what}. Space steps from here; undo brings the pose back."));
        requests.edit(Edit::SetPose { frame, pose, what });
    }

    /// Asks where what the pane shows is to be written.
    pub(super) fn ask_for_file(&self, kind: FileKind, context: &Context<'_>, requests: &mut Requests) {
        let name = format!("{} basin.{}", context.take_name(), kind.extension());
        let wanted = DialogKind::NewFile(name, kind.endings());
        if let Err(why) = self.dialogs.ask(context.egui, kind, "Export basin", wanted) {
            requests.complain(why.to_string());
        }
    }

    /// Writes what the pane shows to a file.
    pub fn write(&self, kind: FileKind, path: &Path, context: &Context<'_>, requests: &mut Requests) {
        let theme = context.preferences.theme;
        match (self.preferences.view, self.results.angles.clone(), self.results.map.clone()) {
            (BasinView::Angles, Some(angles), _) => requests.write(path, move || match kind {
                FileKind::Csv => angles.csv(),
                FileKind::Png => Ok(angles.figure().png(theme)?),
                FileKind::Json => angles.json(),
            }),
            (BasinView::Map, _, Some(map)) => requests.write(path, move || match kind {
                FileKind::Csv => map.csv(),
                FileKind::Png => Ok(backlit_plot::png(map.picture(theme))?),
                FileKind::Json => map.json(),
            }),
            _ => requests.complain("There is no basin to write yet."),
        }
    }
}

impl FileKind {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Csv, Self::Png, Self::Json];

    /// The ending of its files.
    pub const fn extension(self) -> &'static str {
        self.endings()[0]
    }

    const fn endings(self) -> &'static [&'static str] {
        match self {
            Self::Csv => &["csv"],
            Self::Png => &["png"],
            Self::Json => &["json"],
        }
    }

    /// What is in it, on the menu.
    pub(crate) const fn text(self) -> &'static str {
        match self {
            Self::Csv => "Table as CSV…",
            Self::Png => "Picture as PNG…",
            Self::Json => "Numbers as JSON…",
        }
    }
}
