//! The tour: seven steps on the built-in take. Each waits until the state of the inspector says that it was done.

pub(crate) mod panel;

use backlit_tracking::body::Kinematics;
use egui::Rect;
use egui::accesskit::Role;
use glam::DVec3;

use crate::app::{App, Opening};
use crate::context::Request;
use crate::context::preferences::Layout;
use crate::document::Origin;
use crate::drawing::{JointId, ViewMode, draggable_joints, joint_name};
use crate::features::tour::panel as tour;
use crate::features::tour::panel::{STEPS, TourCard, TourEvent};
use crate::take::source::TakeSource;
use crate::widgets::accessible::Names;

/// The joint that is dragged.
const JOINT: &str = "right wrist";
/// It was dragged when it is this far from where it was, metres.
const DRAGGED_M: f64 = 0.02;

/// Where the tour is.
#[derive(Debug)]
pub(crate) struct Tour {
    stage: Stage,
    /// The last step that was reached: up to there one may go on without doing it again.
    furthest: usize,
    /// The camera in whose view the joint was dragged last.
    dragged_in: Option<usize>,
    /// The camera of the first drag.
    first_camera: usize,
    begun: Begun,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stage {
    /// It is offered.
    Offered,
    /// The built-in take is being opened.
    Opening,
    /// A step, counted from zero.
    At(usize),
}

/// What was the case when the step began.
#[derive(Debug, Default)]
struct Begun {
    joint: Option<DVec3>,
    steps: usize,
    tracked: usize,
    /// Renderers that were seen since.
    renderers: Vec<&'static str>,
}

impl App {
    /// Offers the tour, once.
    pub(crate) fn offer_tour(&mut self) {
        if !self.state.preferences.tour_offered {
            self.features.tour = Some(Tour::new(Stage::Offered));
        }
    }

    /// Begins the tour; the built-in take is opened if it is not open.
    pub(crate) fn begin_tour(&mut self) {
        self.state.preferences.tour_offered = true;
        self.features.tour = Some(Tour::new(Stage::Opening));
        if !self.shows_built_in() {
            self.open(Opening::Take(TakeSource::BuiltIn));
        }
    }

    /// The step on the screen, counted from one; zero while the tour is offered.
    pub(crate) fn tour_step(&self) -> Option<usize> {
        match self.features.tour.as_ref()?.stage {
            Stage::Offered => self.can_offer().then_some(0),
            Stage::Opening => None,
            Stage::At(step) => Some(step + 1),
        }
    }

    fn shows_built_in(&self) -> bool {
        let take = self.state.session.take.as_ref();
        take.is_some_and(|take| take.source == Some(TakeSource::BuiltIn))
    }

    /// Who has opened something else, or has lost work to look at first, is left in peace.
    fn can_offer(&self) -> bool {
        let is_nowhere = self.state.session.take.is_none()
            && self.worker.is_idle()
            && !self.features.recovery.is_offered();
        self.shell.overlay.is_none() && (self.shows_built_in() || is_nowhere)
    }

    /// Looks whether the step on the screen was done.
    pub(crate) fn follow_tour(&mut self) {
        let Some(mut tour) = self.features.tour.take() else { return };
        let is_open = self.shows_built_in();
        match tour.stage {
            Stage::Offered => {}
            Stage::Opening => {
                if is_open && self.state.session.frames.get(self.state.selection.frame).is_some() {
                    self.go_to_frame(0);
                    for layout in [Layout::Pose, Layout::Debug] {
                        self.request(Request::ShowMode(layout, ViewMode::Tinted));
                    }
                    self.enter(&mut tour, 0);
                } else if !is_open && self.worker.is_idle() {
                    // It could not be opened; that was said.
                    return;
                }
            }
            Stage::At(_) if !is_open => return,
            Stage::At(step) => {
                Names::keep(&self.state.egui);
                tour.dragged_in = self.context().drag.camera.or(tour.dragged_in);
                let renderer = self.document().fit.renderer.name();
                if !tour.begun.renderers.contains(&renderer) {
                    tour.begun.renderers.push(renderer);
                }
                if self.has_done(&tour, step) {
                    if step + 1 == STEPS.len() {
                        let text = "That was the tour. Help › Tour shows it again.";
                        self.state.notices.info(self.state.now, text, None);
                        return;
                    }
                    self.enter(&mut tour, step + 1);
                }
            }
        }
        self.features.tour = Some(tour);
    }

    /// Goes to a step and arranges the window so that what it is about can be seen.
    fn enter(&mut self, tour: &mut Tour, step: usize) {
        Names::keep(&self.state.egui);
        if step == 2 {
            tour.first_camera = tour.dragged_in.unwrap_or(0);
        }
        self.state.preferences.layout = if matches!(step, 4 | 5) { Layout::Debug } else { Layout::Pose };
        self.shell.docking.alone = None;
        if step == 5 {
            // The step that was looked at is left: the renderers are compared on the pose of the frame.
            self.state.selection.step = None;
        }
        tour.stage = Stage::At(step);
        tour.furthest = tour.furthest.max(step);
        tour.dragged_in = None;
        tour.begun = Begun {
            joint: self.toured_joint(),
            steps: self.steps_done(),
            tracked: self.frames_tracked(),
            renderers: vec![self.document().fit.renderer.name()],
        };
        self.state.egui.request_repaint();
    }

    fn has_done(&self, tour: &Tour, step: usize) -> bool {
        let moved = || {
            let joints = tour.begun.joint.zip(self.toured_joint());
            !self.context().drag.is_dragging()
                && joints.is_some_and(|(before, now)| before.distance(now) > DRAGGED_M)
        };
        let busy = self.context().busy;
        match step {
            1 => moved() && tour.dragged_in.is_some(),
            2 => moved() && tour.dragged_in.is_some_and(|camera| camera != tour.first_camera),
            3 => self.steps_done() > tour.begun.steps,
            4 => self.run_has_ended() && self.state.selection.step.is_some(),
            5 => tour.begun.renderers.len() > 2,
            6 => self.frames_tracked() > tour.begun.tracked && !busy.tracking,
            // The first is for looking: nobody can tell when that is done.
            _ => false,
        }
    }

    /// Where the joint is that is dragged.
    fn toured_joint(&self) -> Option<DVec3> {
        let model = &self.document().model;
        let joint = draggable_joints(model).into_iter().find(|joint| joint_name(model, *joint) == JOINT)?;
        let pose = self.document().pose_at(self.state.selection.frame);
        match joint {
            JointId::Root => Some(pose.root),
            JointId::End(limb) => Kinematics::new(model, pose).ends().get(limb).copied(),
        }
    }

    fn steps_done(&self) -> usize {
        self.state.session.runs.iter().map(|run| run.steps.len().saturating_sub(1)).sum()
    }

    fn frames_tracked(&self) -> usize {
        self.document().estimates.values().filter(|found| found.origin == Origin::Track).count()
    }

    fn run_has_ended(&self) -> bool {
        let run =
            self.state.session.run_of(&self.state.selection).and_then(|run| self.state.session.runs.get(run));
        run.is_some_and(|run| run.ending.is_some())
    }

    /// Shows the card, and does what is asked on it.
    pub(crate) fn show_tour(&mut self, ui: &egui::Ui, bottom: f32) {
        let Some(tour) = &self.features.tour else { return };
        let event = match tour.stage {
            Stage::Opening => None,
            Stage::Offered if self.can_offer() => tour::offer(ui, bottom),
            Stage::Offered => None,
            Stage::At(_) if self.shell.overlay.is_some() => None,
            Stage::At(step) => {
                let (target, camera) = self.target(tour, step);
                let can_go_on = step == 0 || step < tour.furthest;
                tour::card(ui, &TourCard { step, target, camera, can_go_on })
            }
        };
        match event {
            Some(TourEvent::Begin) => self.begin_tour(),
            Some(TourEvent::Skip) => {
                self.features.tour = None;
                self.state.preferences.tour_offered = true;
            }
            Some(TourEvent::Back) => self.go_in_tour(-1),
            Some(TourEvent::Next) => self.go_in_tour(1),
            None => {}
        }
    }

    fn go_in_tour(&mut self, by: isize) {
        if let Some(mut tour) = self.features.tour.take() {
            if let Stage::At(step) = tour.stage {
                self.enter(&mut tour, step.saturating_add_signed(by).min(STEPS.len() - 1));
            }
            self.features.tour = Some(tour);
        }
    }

    /// What a step points at, and the camera that it is about, counted from one.
    fn target(&self, tour: &Tour, step: usize) -> (Option<Rect>, usize) {
        let named = |name: &str| Names::find(&self.state.egui, |named| named.name == name);
        let button = |name: &str| {
            Names::find(&self.state.egui, |named| named.name == name && named.role == Role::Button)
        };
        let joint = |camera: usize| named(&format!("{JOINT}, Camera {camera}"));
        let count = self.state.session.camera_count();
        match step {
            0 => {
                let bar = || Names::find(&self.state.egui, |named| named.name.starts_with("Missing"));
                (bar().or_else(|| named("Camera 1 header")), 1)
            }
            1 => {
                let camera = (1..=count).find(|camera| joint(*camera).is_some()).unwrap_or(1);
                (joint(camera), camera)
            }
            2 => {
                // Rather one that looks from the side than the neighbour of the first.
                let mut others: Vec<usize> =
                    (1..=count).filter(|camera| *camera != tour.first_camera + 1).collect();
                others.sort_by_key(|camera| *camera != 3);
                let camera = others.iter().find(|camera| joint(**camera).is_some()).or(others.first());
                let camera = camera.copied().unwrap_or(2);
                (joint(camera), camera)
            }
            3 => (button("Step"), 1),
            4 if self.run_has_ended() => {
                (Names::find(&self.state.egui, |named| named.name == "Step" && named.role == Role::Slider), 1)
            }
            4 => (button("Run"), 1),
            5 => (named("Renderer").or_else(|| button("Renderer")), 1),
            _ => (button("Track forward").or_else(|| button("Stop")), 1),
        }
    }
}

impl Tour {
    fn new(stage: Stage) -> Self {
        Self { stage, furthest: 0, dragged_in: None, first_camera: 0, begun: Begun::default() }
    }
}
