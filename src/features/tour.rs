//! The tour: seven steps on the built-in take. Each waits until the state of the inspector says that it was done.

mod card;

use backlit_document::Origin;
use backlit_take::source::TakeSource;
use backlit_tracking::body::Kinematics;
use backlit_ui::drawing::{JointId, ViewMode, draggable_joints, joint_name};
use backlit_ui::widgets::accessible::Names;
use egui::accesskit::Role;
use egui::{Rect, Ui};
use glam::DVec3;

use card::{CardAnswer, STEPS};

use crate::context::command::Command;
use crate::context::feature::Feature;
use crate::context::preferences::Layout;
use crate::context::{Context, DesktopRequest, FeatureRequest, Requests, SessionRequest, ShellRequest};

/// The joint that is dragged.
const JOINT: &str = "right wrist";
/// It was dragged when it is this far from where it was, metres.
const DRAGGED_M: f64 = 0.02;

#[derive(Debug, Default)]
pub(crate) struct Tour {
    /// Whether it was offered, kept from start to start.
    pub(crate) was_offered: bool,
    stage: TourStage,
    /// The last step that was reached: up to there one may go on without doing it again.
    furthest: usize,
    /// The camera in whose view the joint was dragged last.
    dragged_in: Option<usize>,
    /// The camera of the first drag.
    first_camera: usize,
    begun: Begun,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
enum TourStage {
    /// It is over, or was not begun.
    #[default]
    Over,
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

impl Feature for Tour {
    fn update(&mut self, context: &Context<'_>, requests: &mut Requests) {
        let is_open = shows_built_in(context);
        match self.stage {
            TourStage::Over | TourStage::Offered => {}
            TourStage::Opening if is_open && context.selection.frame != 0 => {
                requests.request(SessionRequest::Visit(0));
                context.egui.request_repaint();
            }
            TourStage::Opening if is_open => {
                if context.session.frames.get(0).is_some() {
                    for layout in [Layout::Pose, Layout::Debug] {
                        requests.request(FeatureRequest::ShowMode(layout, ViewMode::Tinted));
                    }
                    self.enter(0, context, requests);
                }
            }
            // Where it could not be opened that was said.
            TourStage::Opening if context.busy.opening => {}
            TourStage::Opening => self.stage = TourStage::Over,
            TourStage::At(_) if !is_open => self.stage = TourStage::Over,
            TourStage::At(step) => self.follow(step, context, requests),
        }
    }

    fn run(&mut self, command: Command, context: &Context<'_>, requests: &mut Requests) -> bool {
        let is_own = command == Command::Tour;
        if is_own {
            self.begin(context, requests);
            requests.request(ShellRequest::CloseCard);
        }
        is_own
    }
}

impl Tour {
    /// Offers it, once.
    pub(crate) fn offer(&mut self) {
        if !self.was_offered {
            self.stage = TourStage::Offered;
        }
    }

    /// Begins it; the built-in take is opened if it is not open.
    pub(crate) fn begin(&mut self, context: &Context<'_>, requests: &mut Requests) {
        *self = Self { was_offered: true, stage: TourStage::Opening, ..Self::default() };
        if !shows_built_in(context) {
            requests.request(DesktopRequest::Open(TakeSource::BuiltIn));
        }
    }

    /// The step on the screen, counted from one; zero while the tour is offered.
    pub(crate) fn step(&self, context: &Context<'_>) -> Option<usize> {
        match self.stage {
            TourStage::Offered => can_offer(context).then_some(0),
            TourStage::Over | TourStage::Opening => None,
            TourStage::At(step) => Some(step + 1),
        }
    }

    fn follow(&mut self, step: usize, context: &Context<'_>, requests: &mut Requests) {
        Names::keep(context.egui);
        self.dragged_in = context.drag.camera.or(self.dragged_in);
        let renderer = context.document().fit.renderer.name();
        if !self.begun.renderers.contains(&renderer) {
            self.begun.renderers.push(renderer);
        }
        if !self.has_done(step, context) {
            return;
        }
        if step + 1 == STEPS.len() {
            requests.inform("That was the tour. Help › Tour shows it again.", None);
            self.stage = TourStage::Over;
        } else {
            self.enter(step + 1, context, requests);
        }
    }

    /// Goes to a step and arranges the window so that what it is about can be seen.
    fn enter(&mut self, step: usize, context: &Context<'_>, requests: &mut Requests) {
        Names::keep(context.egui);
        if step == 2 {
            self.first_camera = self.dragged_in.unwrap_or(0);
        }
        let layout = if matches!(step, 4 | 5) { Layout::Debug } else { Layout::Pose };
        requests.request(ShellRequest::Layout(layout));
        requests.request(ShellRequest::ShowAllTiles);
        if step == 5 {
            // The step that was looked at is left: the renderers are compared on the pose of the frame.
            requests.request(SessionRequest::LeaveStep);
        }
        self.stage = TourStage::At(step);
        self.furthest = self.furthest.max(step);
        self.dragged_in = None;
        self.begun = Begun {
            joint: toured_joint(context),
            steps: steps_done(context),
            tracked: frames_tracked(context),
            renderers: vec![context.document().fit.renderer.name()],
        };
        context.egui.request_repaint();
    }

    fn has_done(&self, step: usize, context: &Context<'_>) -> bool {
        let moved = || {
            let joints = self.begun.joint.zip(toured_joint(context));
            !context.drag.is_dragging()
                && joints.is_some_and(|(before, now)| before.distance(now) > DRAGGED_M)
        };
        match step {
            1 => moved() && self.dragged_in.is_some(),
            2 => moved() && self.dragged_in.is_some_and(|camera| camera != self.first_camera),
            3 => steps_done(context) > self.begun.steps,
            4 => run_has_ended(context) && context.selection.step.is_some(),
            5 => self.begun.renderers.len() > 2,
            6 => frames_tracked(context) > self.begun.tracked && !context.busy.tracking,
            // The first is for looking: nobody can tell when that is done.
            _ => false,
        }
    }

    /// Shows the card, and does what is asked on it. The offer lies above `bottom`.
    pub(crate) fn ui(&mut self, ui: &Ui, context: &Context<'_>, bottom: f32, requests: &mut Requests) {
        let answer = match self.stage {
            TourStage::Offered if can_offer(context) => card::offer(ui, bottom),
            TourStage::At(step) if !context.is_covered => {
                let can_go_on = step == 0 || step < self.furthest;
                card::card(ui, step, self.target(step, context), can_go_on)
            }
            TourStage::Over | TourStage::Offered | TourStage::Opening | TourStage::At(_) => None,
        };
        match answer {
            Some(CardAnswer::Begin) => self.begin(context, requests),
            Some(CardAnswer::Skip) => *self = Self { was_offered: true, ..Self::default() },
            Some(CardAnswer::Back) => self.go(-1, context, requests),
            Some(CardAnswer::Next) => self.go(1, context, requests),
            None => {}
        }
    }

    fn go(&mut self, by: isize, context: &Context<'_>, requests: &mut Requests) {
        if let TourStage::At(step) = self.stage {
            self.enter(step.saturating_add_signed(by).min(STEPS.len() - 1), context, requests);
        }
    }

    /// What a step points at, and the camera that it is about, counted from one.
    fn target(&self, step: usize, context: &Context<'_>) -> (Option<Rect>, usize) {
        let named = |name: &str| Names::find(context.egui, |named| named.name == name);
        let button =
            |name: &str| Names::find(context.egui, |named| named.name == name && named.role == Role::Button);
        let joint = |camera: usize| named(&format!("{JOINT}, Camera {camera}"));
        let count = context.session.camera_count();
        match step {
            0 => {
                let bar = || Names::find(context.egui, |named| named.name.starts_with("Missing"));
                (bar().or_else(|| named("Camera 1 header")), 1)
            }
            1 => {
                let camera = (1..=count).find(|camera| joint(*camera).is_some()).unwrap_or(1);
                (joint(camera), camera)
            }
            2 => {
                // Rather one that looks from the side than the neighbour of the first.
                let mut others: Vec<usize> =
                    (1..=count).filter(|camera| *camera != self.first_camera + 1).collect();
                others.sort_by_key(|camera| *camera != 3);
                let camera = others.iter().find(|camera| joint(**camera).is_some()).or(others.first());
                let camera = camera.copied().unwrap_or(2);
                (joint(camera), camera)
            }
            3 => (button("Step"), 1),
            4 if run_has_ended(context) => {
                (Names::find(context.egui, |named| named.name == "Step" && named.role == Role::Slider), 1)
            }
            4 => (button("Run"), 1),
            5 => (named("Renderer").or_else(|| button("Renderer")), 1),
            _ => (button("Track forward").or_else(|| button("Stop")), 1),
        }
    }
}

fn shows_built_in(context: &Context<'_>) -> bool {
    context.session.source == Some(TakeSource::BuiltIn)
}

/// Who has opened something else, or has lost work to look at first, is left in peace.
fn can_offer(context: &Context<'_>) -> bool {
    let is_nowhere = context.session.take.is_none() && !context.busy.opening && !context.offers_unsaved_work;
    !context.is_covered && (shows_built_in(context) || is_nowhere)
}

/// Where the joint is that is dragged.
fn toured_joint(context: &Context<'_>) -> Option<DVec3> {
    let model = &context.document().model;
    let joint = draggable_joints(model).into_iter().find(|joint| joint_name(model, *joint) == JOINT)?;
    let pose = context.document().pose_at(context.selection.frame);
    match joint {
        JointId::Root => Some(pose.root),
        JointId::End(limb) => Kinematics::new(model, pose).ends().get(limb).copied(),
    }
}

fn steps_done(context: &Context<'_>) -> usize {
    context.runs().all().iter().map(|run| run.steps.len().saturating_sub(1)).sum()
}

fn frames_tracked(context: &Context<'_>) -> usize {
    context.document().estimates.values().filter(|found| found.origin == Origin::Track).count()
}

fn run_has_ended(context: &Context<'_>) -> bool {
    context.run().is_some_and(|run| run.ending.is_some())
}
