//! The basin of the frame on the screen: begun, stopped, its starts taken, its results written.

use std::path::Path;
use std::time::Instant;

use backlit_lab::experiment::basin_map::Cell;
use backlit_lab::experiment::frame_basin::{Frame, Report, Trial};
use backlit_tracking::search::start;

use crate::app::App;
use crate::app::state::DialogKind;
use crate::context::PaneEvent;
use crate::context::pane::Pane;
use crate::document::edit::Edit;
use crate::features::basin::job::{BasinJob, BasinWork};
use crate::features::basin::settings::direction_name;
use crate::features::basin::{
    About, AnglesResult, BasinRequest, BasinSettings, BasinState, BasinView, FileKind, MapResult, Reference,
    Running,
};
use crate::style::format;
use crate::worker::Lane;

impl App {
    pub(crate) fn basin_request(&mut self, request: BasinRequest) {
        match request {
            BasinRequest::Settings(settings) => self.set_basin(*settings),
            BasinRequest::View(view) => self.state.preferences.basin.view = view,
            BasinRequest::Colour(colour) => self.state.preferences.basin.colour = colour,
            BasinRequest::ShowChoice(choice) => {
                if let Some(map) = &mut self.features.basin.map {
                    map.shown = choice;
                }
            }
            BasinRequest::TakeStart(place) => self.take_start(place),
            BasinRequest::Export(kind) => self.ask_for_file(DialogKind::Basin(kind)),
        }
    }

    /// Other settings of the basin.
    pub fn set_basin(&mut self, settings: BasinSettings) {
        self.state.preferences.basin.settings = settings;
        self.features.basin.problem = None;
    }

    /// Runs what a view shows, about the pose on the screen, and shows it.
    pub(crate) fn run_basin(&mut self, view: BasinView) {
        self.state.preferences.basin.view = view;
        self.features.basin.problem = None;
        self.pane_event(Pane::Basin, PaneEvent::Open);
        let begun = self.basin_frame().and_then(|frame| self.begin_basin(view, frame));
        if let Err(problem) = begun {
            self.features.basin.problem = Some(problem);
        }
    }

    fn begin_basin(&mut self, view: BasinView, frame: Frame) -> Result<(), String> {
        let document = self.document();
        let held = document.model.limbs()[self.state.selection.limb(&document.model)].rotation;
        let settings = &self.state.preferences.basin.settings;
        let work = match view {
            BasinView::Angles => {
                let options = settings.options(&document.fit, held)?;
                let about = self.about_basin(options.rotation);
                let report = Report::of(&options, &[]);
                let work = BasinWork::Angles(Box::new(options.clone()));
                self.features.basin.angles =
                    Some(AnglesResult { about, options, trials: Vec::new(), report });
                work
            }
            BasinView::Map => {
                let options = settings.map_options(&document.fit, &document.model, held);
                let about = self.about_basin(None);
                let directions = options.directions.map(|one| direction_name(&frame.model, one));
                let work = BasinWork::Map(Box::new(options.clone()));
                self.features.basin.map = Some(MapResult::new(about, options, frame.clone(), directions));
                work
            }
        };
        let total = match &work {
            BasinWork::Angles(options) => options.trials(),
            BasinWork::Map(options) => options.trials(),
        };
        self.features.basin.running = Some(Running { view, done: 0, total, seconds_left: None });
        self.background.basin_began = Some(Instant::now());
        self.background.worker.request(Lane::Basin, BasinJob::new(frame, work));
        Ok(())
    }

    /// What the cameras see of the frame on the screen, and the pose that its basin is about.
    fn basin_frame(&self) -> Result<Frame, String> {
        let Some(scene) = self.scene() else { return Err("Open a take first".to_owned()) };
        let views = scene.views();
        if views.is_empty() {
            return Err("No camera that is used has a silhouette of this frame".to_owned());
        }
        let reference = match self.state.preferences.basin.settings.reference {
            Reference::Pose => self.shown_pose().clone(),
            Reference::Truth => {
                let take = self.state.session.take.as_ref();
                let joints = take
                    .and_then(|take| take.take().reference())
                    .map(|r| r.joints(self.state.selection.frame));
                let pose = joints.and_then(|joints| start::from_joints(&scene.model, &joints));
                pose.ok_or("The take does not say where the joints are in this frame")?
            }
        };
        Ok(Frame { model: scene.model.clone(), views, reference })
    }

    fn about_basin(&self, rotation: Option<usize>) -> About {
        let document = self.document();
        let model = &document.model;
        let cameras: Vec<String> = document.used_cameras().map(|index| (index + 1).to_string()).collect();
        let turned = rotation.map(|rotation| &model.limbs()[model.rotation_owners()[rotation]].name);
        let mut conditions = format!("frame {}", self.state.selection.frame);
        conditions += &format!(", camera{} {}", if cameras.len() == 1 { "" } else { "s" }, cameras.join(" "));
        if let Some(limb) = turned {
            conditions += &format!(", {limb} alone");
        }
        if self.state.preferences.basin.settings.reference == Reference::Truth {
            conditions += ", about the truth";
        }
        About { frame: self.state.selection.frame, conditions }
    }

    pub(crate) fn cancel_basin(&self) {
        self.background.worker.cancel(Lane::Basin);
    }

    /// Another take: what is about the old one goes.
    pub(crate) fn forget_basin(&mut self) {
        self.background.worker.drop_lane(Lane::Basin);
        self.features.basin = BasinState::default();
    }

    pub(crate) fn basin_trial(&mut self, trial: Trial) {
        self.features.basin.add_trial(trial);
        self.time_basin();
    }

    pub(crate) fn basin_cell(&mut self, cell: Cell) {
        self.features.basin.add_cell(cell);
        self.time_basin();
    }

    fn time_basin(&mut self) {
        if let (Some(running), Some(began)) = (&mut self.features.basin.running, self.background.basin_began)
            && running.done > 0
        {
            let each = began.elapsed().as_secs_f64() / running.done as f64;
            running.seconds_left = Some(each * running.total.saturating_sub(running.done) as f64);
        }
    }

    /// The experiment is over: all of it, or as far as it was wanted.
    pub(crate) fn basin_ended(&mut self) {
        let Some(running) = self.features.basin.running.take() else { return };
        let (done, total) = (format::count(running.done as i64), format::count(running.total as i64));
        let text = if running.done == running.total {
            format!("The basin is done: {total} fits.")
        } else if running.done == 0 {
            self.features.basin.forget(running.view);
            "The basin ended before its first fit.".to_owned()
        } else {
            format!("The basin was stopped after {done} of {total} fits. They stay, as a part.")
        };
        self.state.notices.info(self.state.now, text, None);
    }

    /// Gives the frame of the map the start of a cell, so that it can be stepped.
    fn take_start(&mut self, place: [usize; 2]) {
        let Some(map) = &mut self.features.basin.map else { return };
        map.taken = Some(place);
        let (frame, pose) = (map.about.frame, map.options.start(&map.frame, place));
        let [across, up] = place.map(|place| format::number(map.options.offset_degrees(place), 0));
        let what = format!("Start from the map at {across}°, {up}°");
        self.interrupt_fit();
        self.go_to_frame(frame);
        self.state.status = Some(format!("{what}. Space steps from here; undo brings the pose back."));
        self.edit(Edit::SetPose { frame, pose, what }, None);
    }

    /// Writes what the basin's pane shows to a file.
    pub fn export_basin_to(&mut self, kind: FileKind, path: &Path) {
        let theme = self.state.preferences.theme;
        match (
            self.state.preferences.basin.view,
            self.features.basin.angles.clone(),
            self.features.basin.map.clone(),
        ) {
            (BasinView::Angles, Some(angles), _) => self.write(path, move || match kind {
                FileKind::Csv => angles.csv(),
                FileKind::Png => angles.figure().png(theme),
                FileKind::Json => angles.json(),
            }),
            (BasinView::Map, _, Some(map)) => self.write(path, move || match kind {
                FileKind::Csv => map.csv(),
                FileKind::Png => crate::drawing::plot::png(map.picture(theme)),
                FileKind::Json => map.json(),
            }),
            _ => self.state.notices.error("There is no basin to write yet."),
        }
    }
}
