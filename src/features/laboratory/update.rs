//! The laboratory: it begins anew when what it compares changes, steps its fits, and asks for what its pictures
//! lack. Nothing of it goes into the document.

use std::path::Path;
use std::sync::Arc;

use backlit_tracking::body::Pose;

use crate::app::App;
use crate::app::state::DialogKind;
use crate::context::Request;
use crate::context::command::{Command, FitCommand, LaboratoryCommand, TimelineCommand, ViewCommand};
use crate::context::preferences::Layout;
use crate::features::laboratory::comparison::{Checked, PushKey};
use crate::features::laboratory::job::{
    FitCheck, LaboratoryCheckJob, LaboratoryEvent, LaboratoryJob, LaboratoryLookJob, LaboratoryPlotJob,
    LiveLaboratory,
};
use crate::features::laboratory::start::StartParts;
use crate::features::laboratory::{
    Basis, ColumnCheck, Comparison, Contestant, Laboratory, LaboratoryRequest, StartChoice, table,
};
use crate::session::selection::Selection;
use crate::take::demonstration::Demonstration;
use crate::take::footage::Footage;
use crate::take::source::TakeSource;
use crate::worker::Lane;

/// Steps of the keys for ten frames.
const MANY_STEPS: usize = 10;

impl App {
    /// Forgets the comparison: another take was opened.
    pub(crate) fn reset_laboratory(&mut self, footage: &Footage) {
        for lane in [Lane::Laboratory, Lane::LaboratoryLook, Lane::LaboratoryCheck] {
            self.worker.drop_lane(lane);
        }
        let start = StartChoice::of(demonstration_of(footage));
        self.features.laboratory = Laboratory {
            is_log: self.features.laboratory.is_log,
            comparisons: self.features.laboratory.comparisons,
            start,
            ..Laboratory::default()
        };
    }

    /// What is compared as things are now; `None` as long as the frame is not there.
    fn basis(&self) -> Option<Basis> {
        let scene = self.scene()?;
        scene.frame.as_ref()?;
        let document = self.document();
        let take = self.state.session.take.as_ref()?;
        let frame = self.state.selection.frame;
        let parts = StartParts {
            model: &document.model,
            shown: self.shown_pose(),
            take: &document.start,
            demonstration: demonstration_of(take).map(|which| (which, frame)),
        };
        Some(Basis {
            start: self.features.laboratory.start.pose(&parts).normalized(),
            entrants: self.features.laboratory.lineup.entrants(&document.fit, &document.model),
            scene,
        })
    }

    /// Keeps the laboratory going while its layout is on the screen.
    pub(crate) fn go_on_with_laboratory(&mut self) {
        self.features.laboratory.is_running = self.worker.is_busy(Lane::Laboratory);
        self.features.laboratory.is_checking = self.worker.is_busy(Lane::LaboratoryCheck);
        if self.state.preferences.layout != Layout::Demonstrate {
            // What nobody sees need not be checked.
            self.worker.drop_lane(Lane::LaboratoryCheck);
            return;
        }
        let Some(basis) = self.basis() else {
            self.features.laboratory.is_waiting =
                self.state.session.take.is_some() && !self.refresh.has_failed_to_read();
            return;
        };
        let is_same = self.features.laboratory.comparison.as_ref().is_some_and(|old| old.basis.is(&basis));
        if !is_same {
            self.begin_comparison(basis);
        }
        let camera_count = self.state.session.camera_count();
        self.features.laboratory.camera = self.features.laboratory.camera.min(camera_count.saturating_sub(1));
        let has_begun = self.features.laboratory.comparison.as_ref().is_some_and(Comparison::has_begun);
        if has_begun && self.features.laboratory.wants_run && !self.features.laboratory.is_running {
            self.features.laboratory.wants_run = false;
            self.step_laboratory(None);
        }
        self.features.laboratory.is_waiting =
            !has_begun || self.features.laboratory.wants_run || self.look_in_laboratory();
    }

    fn begin_comparison(&mut self, basis: Basis) {
        self.worker.drop_lane(Lane::LaboratoryLook);
        self.worker.drop_lane(Lane::LaboratoryCheck);
        self.features.laboratory.pending_steps = 0;
        self.features.laboratory.marked = None;
        self.features.laboratory.comparisons += 1;
        self.live_laboratory = LiveLaboratory::default();
        let starts = basis.entrants.iter().map(|entrant| (basis.scene_of(entrant), basis.start.clone()));
        let job = LaboratoryJob::begin(starts.collect(), self.live_laboratory.clone());
        self.worker.request(Lane::Laboratory, job);
        self.features.laboratory.comparison =
            Some(Comparison::new(basis, self.features.laboratory.comparisons));
        self.features.laboratory.is_running = true;
    }

    /// Asks for pictures and checks that the screen lacks. Whether any is still to come.
    fn look_in_laboratory(&mut self) -> bool {
        let key = self.push_key();
        let Some(comparison) = &self.features.laboratory.comparison else { return false };
        let has_pushes = comparison
            .contestants
            .iter()
            .all(|fit| fit.pushed.as_ref().is_some_and(|(of, _)| *of == key) || fit.steps.is_empty());
        let looks: Vec<_> = comparison
            .stale()
            .map(|(index, fit, pose)| (index, fit.scene.clone(), pose.clone(), fit.shown.clone()))
            .collect();
        let lacks = (!looks.is_empty() || !has_pushes) && self.may_ask(Lane::LaboratoryLook);
        if lacks && !self.worker.is_busy(Lane::LaboratoryLook) {
            let starts = || {
                let one = |fit: &Contestant| (fit.scene.clone(), comparison.basis.start.clone());
                comparison.contestants.iter().map(one).collect()
            };
            let push = (!has_pushes).then(|| (key, starts()));
            self.worker.request(Lane::LaboratoryLook, LaboratoryLookJob { looks, push });
        }
        // Fits first: while they run, the pose to check changes with every step.
        lacks || (!self.features.laboratory.is_running && self.check_in_laboratory())
    }

    /// Asks for the check of the gradients at the step that is looked at, in all cameras, the one that is shown first.
    /// Whether one is still to come.
    fn check_in_laboratory(&mut self) -> bool {
        let Some(comparison) = &self.features.laboratory.comparison else { return false };
        let (wanted, cameras) = (unchecked(comparison), comparison.basis.scene.cameras.len());
        if wanted.is_empty() || cameras == 0 || !self.may_ask(Lane::LaboratoryCheck) {
            return false;
        }
        let is_asked = self.worker.is_busy(Lane::LaboratoryCheck)
            && (self.features.laboratory.check_wanted.as_ref())
                .is_some_and(|asked| wanted.iter().all(|one| asked.contains(one)));
        if !is_asked {
            let shown = self.features.laboratory.camera;
            let order: Vec<usize> =
                std::iter::once(shown).chain((0..cameras).filter(|camera| *camera != shown)).collect();
            let checks =
                wanted.iter().map(|(index, pose)| check_of(comparison, *index, pose, &order)).collect();
            self.features.laboratory.check_wanted = Some(wanted);
            self.features.laboratory.check_broke = false;
            self.worker.request(Lane::LaboratoryCheck, LaboratoryCheckJob::new(checks));
        }
        true
    }

    /// A job of the laboratory broke down.
    pub(crate) fn laboratory_broke(&mut self, lane: Lane) {
        match lane {
            Lane::Laboratory => {
                self.features.laboratory.pending_steps = 0;
                self.features.laboratory.wants_run = false;
                self.live_laboratory = LiveLaboratory::default();
                if let Some(comparison) = &mut self.features.laboratory.comparison {
                    comparison.break_down("the work on the fits broke down; Restart begins again");
                }
            }
            Lane::LaboratoryCheck => self.features.laboratory.check_broke = true,
            _ => {}
        }
    }

    /// Which pushes are shown.
    fn push_key(&self) -> PushKey {
        let model = &self.document().model;
        (
            self.features.laboratory.camera,
            self.features.laboratory.axis_for(model),
            self.state.selection.limb(model),
        )
    }

    /// What the laboratory's jobs said.
    pub(crate) fn hear_laboratory(&mut self, event: LaboratoryEvent) {
        if let LaboratoryEvent::Written(path) = &event {
            let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
            return self.state.notices.info(self.state.now, format!("Saved the plot to {name}."), None);
        }
        let Some(comparison) = &mut self.features.laboratory.comparison else { return };
        match event {
            LaboratoryEvent::Step(index, step, predicted) => {
                comparison.add_step(index, *step, predicted);
                self.features.laboratory.measure_steps();
            }
            LaboratoryEvent::Extents(extents) => comparison.add_extents(&extents),
            LaboratoryEvent::Ended(index, ending) => comparison.end(index, ending),
            LaboratoryEvent::Looked(index, predicted) => {
                if let Some(fit) = comparison.contestants.get_mut(index) {
                    fit.shown = Some(predicted);
                }
            }
            LaboratoryEvent::Pushed(key, pushed) => {
                for (fit, pushed) in comparison.contestants.iter_mut().zip(pushed) {
                    fit.pushed = Some((key, Arc::new(pushed)));
                }
            }
            LaboratoryEvent::Checked { index, pose, progress } => {
                if let Some(fit) = comparison.contestants.get_mut(index) {
                    fit.checked = Some(Checked { pose, progress });
                }
            }
            LaboratoryEvent::Written(_) => {}
        }
    }

    /// The steps that were asked for are done.
    pub(crate) fn laboratory_ended(&mut self) {
        let steps = std::mem::take(&mut self.features.laboratory.pending_steps);
        if steps > 0 {
            self.run_fits(Some(steps));
        }
    }

    fn run_fits(&mut self, steps: Option<usize>) {
        let job = LaboratoryJob::go_on(self.live_laboratory.clone(), steps);
        self.worker.request(Lane::Laboratory, job);
        self.features.laboratory.is_running = true;
    }

    /// A step of all fits, or all of their steps. Steps that are there already are only looked at.
    fn step_laboratory(&mut self, steps: Option<usize>) {
        let is_busy = self.worker.is_busy(Lane::Laboratory);
        let Some(comparison) = &mut self.features.laboratory.comparison else { return };
        if steps.is_some() && comparison.cursor < comparison.last() {
            comparison.go_to(comparison.cursor + 1);
            return;
        }
        comparison.go_to(comparison.last());
        comparison.follows = true;
        if is_busy {
            self.features.laboratory.pending_steps += steps.unwrap_or(0);
        } else if !comparison.is_over() {
            self.run_fits(steps);
        }
    }

    /// Does what a command of another feature means in the laboratory's layout. `false` for those that mean there
    /// what they mean everywhere.
    pub(crate) fn laboratory_takes(&mut self, command: Command) -> bool {
        if self.state.preferences.layout != Layout::Demonstrate {
            return false;
        }
        if let Command::View(ViewCommand::CameraAlone(camera)) = command {
            self.features.laboratory.camera = camera;
            return true;
        }
        let Some(comparison) = &mut self.features.laboratory.comparison else { return false };
        let here = comparison.cursor;
        match command {
            Command::Fit(FitCommand::Step | FitCommand::LaterStep)
            | Command::Timeline(TimelineCommand::NextFrame) => self.step_laboratory(Some(1)),
            Command::Fit(FitCommand::Run) => self.step_laboratory(None),
            Command::Fit(FitCommand::StepBack | FitCommand::EarlierStep)
            | Command::Timeline(TimelineCommand::PreviousFrame) => {
                comparison.go_to(here.saturating_sub(1));
            }
            Command::Timeline(TimelineCommand::TenFramesBack) => {
                comparison.go_to(here.saturating_sub(MANY_STEPS));
            }
            Command::Timeline(TimelineCommand::TenFramesOn) => comparison.go_to(here + MANY_STEPS),
            Command::Timeline(TimelineCommand::FirstFrame) => comparison.go_to(0),
            Command::Timeline(TimelineCommand::LastFrame) => comparison.go_to(usize::MAX),
            Command::Fit(FitCommand::Stop) if self.features.laboratory.is_running => {
                self.features.laboratory.pending_steps = 0;
                self.worker.cancel(Lane::Laboratory);
            }
            _ => return false,
        }
        true
    }

    pub(crate) fn laboratory_command(&mut self, command: LaboratoryCommand) {
        match command {
            LaboratoryCommand::Restart => self.features.laboratory.comparison = None,
        }
    }

    pub(crate) fn laboratory_request(&mut self, request: LaboratoryRequest) {
        match request {
            LaboratoryRequest::Lineup(lineup) => self.features.laboratory.lineup = lineup,
            LaboratoryRequest::Start(start) => self.features.laboratory.start = start,
            LaboratoryRequest::Camera(camera) => self.features.laboratory.camera = camera,
            LaboratoryRequest::Axis(axis) => self.features.laboratory.axis = Some(axis),
            LaboratoryRequest::Limb(limb) => {
                let joint = Selection::joint_of(&self.document().model, limb);
                self.request(Request::Joint(joint));
            }
            LaboratoryRequest::Log(is_log) => self.features.laboratory.is_log = is_log,
            LaboratoryRequest::Mark(fit) => self.mark_worst(fit),
            LaboratoryRequest::Step(step) => {
                if let Some(comparison) = &mut self.features.laboratory.comparison {
                    comparison.go_to(step);
                }
            }
            LaboratoryRequest::CopyTable => {
                if let Some(comparison) = &self.features.laboratory.comparison {
                    self.state.egui.copy_text(table::csv(comparison));
                    self.state.status = Some("Copied the curves as comma-separated values.".to_owned());
                }
            }
            LaboratoryRequest::SavePlot => self.ask_for_file(DialogKind::LaboratoryPlot),
        }
    }

    /// Marks the worst pixel of a fit, and shows the camera that it is in.
    fn mark_worst(&mut self, fit: Option<usize>) {
        self.features.laboratory.marked = fit;
        let comparison = self.features.laboratory.comparison.as_ref();
        let marked = fit.and_then(|fit| comparison?.contestants.get(fit)?.checked.as_ref());
        if let Some(worst) = marked.and_then(|checked| checked.progress.worst.as_ref()) {
            self.features.laboratory.camera = worst.camera;
        }
    }

    /// Writes the laboratory's plot as a PNG.
    pub fn save_laboratory_plot(&mut self, path: &Path) {
        let Some(comparison) = &self.features.laboratory.comparison else { return };
        let title = self.features.laboratory.lineup.title();
        let take = self.state.session.take.as_ref().map_or("", |take| take.name.as_str());
        let subtitle = format!("{take}. {}", self.features.laboratory.lineup.sentence());
        let figure = table::figure(comparison, title, &subtitle, self.features.laboratory.is_log);
        let path = if path.extension().is_none() { path.with_extension("png") } else { path.to_owned() };
        self.worker.request(
            Lane::LaboratoryPlot,
            LaboratoryPlotJob { figure, theme: self.state.preferences.theme, path },
        );
    }
}

/// Fits whose gradient was not wholly checked at the step that is looked at, with their poses.
fn unchecked(comparison: &Comparison) -> Vec<(usize, Pose)> {
    let pose = |(index, fit): (usize, &Contestant)| {
        let pose = fit.pose(comparison.cursor)?;
        let known = fit.checked.as_ref().filter(|old| old.pose == *pose);
        (!known.is_some_and(|known| known.progress.is_whole())).then(|| (index, pose.clone()))
    };
    comparison.contestants.iter().enumerate().filter_map(pose).collect()
}

/// The check of a fit in these cameras.
fn check_of(comparison: &Comparison, index: usize, pose: &Pose, order: &[usize]) -> FitCheck {
    let scene = &comparison.contestants[index].scene;
    let check = |camera: &usize| {
        let check = ColumnCheck {
            model: scene.model.clone(),
            pose: pose.clone(),
            camera: scene.cameras.get(*camera)?.clone(),
            renderer: scene.fit.renderer,
            ramp: scene.fit.final_ramp(),
            parameters: scene.fit.parameters,
        };
        Some((*camera, check))
    };
    FitCheck::new(index, order.iter().filter_map(check).collect())
}

/// The demonstration that a take is.
fn demonstration_of(take: &Footage) -> Option<Demonstration> {
    match take.source {
        Some(TakeSource::Demonstration(which)) => Some(which),
        _ => None,
    }
}
