//! Dragging in a camera's view: joints, limbs, the whole body, and a limb's own size; and nudges by the keyboard.

use std::sync::Arc;
use std::time::Duration;

use backlit_document::edit::Edit;
use backlit_document::history::Gesture;
use backlit_tracking::body::{Model, Pose};
use backlit_tracking::camera::Camera;
use backlit_tracking::posing::Held;
use backlit_ui::drawing::{Drag, DragEvent, JointId, joint_name};
use backlit_ui::style::format;
use glam::{DVec2, DVec3};

use super::Posing;
use super::dragged::{Dragged, dragged, joint_position, limit_sentence, moved, words};
use super::placement::on_ray;
use crate::context::command_button::next_gesture;
use crate::context::marks::{DragMarks, Placement};
use crate::context::{Context, Requests, SessionRequest};

/// A joint is still where it was put in a view if it has moved by less there.
const STILL_PX: f64 = 1.0;

/// Nudges that follow each other within this many seconds are one.
pub(super) const NUDGE_SECONDS: f64 = 2.0;

/// A joint that is nudged by the keyboard.
#[derive(Debug, Clone)]
pub(super) struct Nudging {
    joint: JointId,
    camera: usize,
    /// The pose in which the first of the nudges began, and how far they go from there.
    pub(super) base: Arc<Pose>,
    /// Where the joint was put before, if it was there.
    before: Option<Placement>,
    total_px: DVec2,
    /// The pose that they have led to.
    reached: Pose,
    gesture: Gesture,
    pub(super) at: f64,
}

/// A drag that goes on.
#[derive(Debug, Clone)]
pub(super) struct Dragging {
    /// In which camera's view.
    camera: usize,
    /// The pose in which it began: dragging back undoes itself.
    base: Arc<Pose>,
    /// The body in which it began.
    body: Arc<Model>,
    gesture: Gesture,
    /// What was dragged last, and how far.
    drag: Drag,
    /// Where the joint was put before, in whichever view, if it is still there.
    before: Option<Placement>,
    /// The pose that the drag has led to.
    reached: Option<Pose>,
}

impl Dragging {
    /// What others must know of it.
    pub(super) fn marks(&self) -> DragMarks {
        let (joint, twisted) = match self.drag {
            Drag::Joint { joint, .. } | Drag::Depth { joint, .. } => (Some(joint), None),
            Drag::Twist { limb, .. } => (None, Some(limb)),
            Drag::Turn { limb, .. } => (Some(JointId::End(limb)), None),
            Drag::Body { .. } => (Some(JointId::Root), None),
            Drag::Length { .. } | Drag::Radius { .. } => (None, None),
        };
        let (camera, from) = (Some(self.camera), Some(self.base.clone()));
        DragMarks { camera, joint, twisted, from, placement: self.before.clone() }
    }

    fn placing<'a>(&'a self, context: &'a Context<'a>) -> Option<Placing<'a>> {
        let (body, joint) = (&*self.body, placed_by(self.drag)?);
        Some(Placing { context, body, joint, camera: self.camera, before: self.before.as_ref() })
    }

    /// Asks for what the drag has led to.
    fn request(&mut self, context: &Context<'_>, requests: &mut Requests) {
        let document = context.document();
        let camera = context.session.take.as_ref().and_then(|take| take.cameras.get(self.camera));
        let Some(camera) = camera else { return };
        let what = words(&self.body, self.drag);
        let pins: Vec<usize> = document.pins.iter().copied().collect();
        let held = Held { pins: &pins, trunk: context.views.hold_trunk };
        let (found, on_ray_of) = match (self.placing(context), self.drag) {
            (Some(placing), Drag::Joint { target_px, .. }) => placing.dragged(held, &self.base, target_px),
            (_, drag) => (dragged(&self.body, held, &self.base, camera, drag), None),
        };
        let edit = match found {
            Some(Dragged::Pose(pose)) => {
                let reached = limit_sentence(&self.body, &self.base, &pose);
                let ray = on_ray_of
                    .map_or_else(String::new, |first| format!(", on the ray of camera {}", first + 1));
                let how = format!("{what}, seen from camera {}{ray}. Esc puts it back.", self.camera + 1);
                requests.status(reached.unwrap_or(how));
                self.reached = Some(pose.clone());
                Edit::SetPose { frame: context.selection.frame, pose, what }
            }
            Some(Dragged::Size { limb, length, radius }) => {
                let (long, thick) = (format::metres(length), format::metres(radius));
                requests.status(format!("{what}: {long} long, radius {thick}. Esc puts it back."));
                Edit::SetSize { limb, length, radius, both_sides: context.views.both_sides }
            }
            None => return,
        };
        requests.drag(edit, self.gesture);
    }
}

/// The joint that a drag puts somewhere.
const fn placed_by(drag: Drag) -> Option<JointId> {
    match drag {
        Drag::Joint { joint, .. } | Drag::Depth { joint, .. } => Some(joint),
        _ => None,
    }
}

/// A joint that is dragged to a pixel, and where it was put before.
struct Placing<'a> {
    context: &'a Context<'a>,
    body: &'a Model,
    joint: JointId,
    /// In whose view it is dragged.
    camera: usize,
    before: Option<&'a Placement>,
}

impl Placing<'_> {
    /// Where the ray of the latest place in another view is nearest to the pixel's, and whose ray that is.
    fn on_ray(&self, px: DVec2) -> Option<(DVec3, usize)> {
        let (before, cameras) = (self.before?, &self.context.session.take.as_ref()?.cameras);
        let (dragged_in, mut others) = (cameras.get(self.camera)?, before.cameras_but(self.camera));
        let first = others.next()?;
        let others: Vec<&Camera> = others.filter_map(|other| Some(&**cameras.get(other)?)).collect();
        Some((on_ray(cameras.get(first)?, &others, before.at, dragged_in, px)?, first))
    }

    /// What it makes of a pose, and on whose ray it stays.
    fn dragged(&self, held: Held<'_>, base: &Pose, px: DVec2) -> (Option<Dragged>, Option<usize>) {
        if let Some((at, first)) = self.on_ray(px) {
            let pose = moved(self.body, held, base, self.joint, at);
            return (pose.check(self.body).is_ok().then_some(Dragged::Pose(pose)), Some(first));
        }
        let camera = self.context.session.take.as_ref().and_then(|take| take.cameras.get(self.camera));
        let drag = Drag::Joint { joint: self.joint, target_px: px };
        (camera.and_then(|camera| dragged(self.body, held, base, camera, drag)), None)
    }

    /// Where it is now. A place in another view stays where the joint is still seen there.
    fn placement(&self, reached: &Pose) -> Option<Placement> {
        let at = joint_position(self.body, reached, self.joint);
        let cameras = &self.context.session.take.as_ref()?.cameras;
        let is_still_there = |other: usize, before: DVec3| {
            let [then, now] = [before, at].map(|point| cameras.get(other)?.project(point));
            then.zip(now).is_some_and(|(then, now)| then.distance(now) < STILL_PX)
        };
        let before =
            self.before.iter().flat_map(|before| before.cameras.iter().map(|&other| (other, before.at)));
        let stays = before.filter(|&(other, at)| other != self.camera && is_still_there(other, at));
        let cameras = stays.map(|(other, _)| other).chain([self.camera]).collect();
        Some(Placement { frame: self.context.selection.frame, joint: self.joint, at, cameras })
    }
}

impl Posing {
    /// Where the joint was put before, if nothing else has moved it since.
    fn placed(&self, context: &Context<'_>, joint: JointId, pose: &Pose) -> Option<Placement> {
        let at = joint_position(&context.document().model, pose, joint);
        self.placement.clone().filter(|placement| placement.holds(context.selection.frame, joint, at))
    }

    /// Goes along with a drag in a camera's view. A modifier pressed on the way begins again from the pose that is
    /// reached: still one gesture.
    pub(crate) fn drag(
        &mut self,
        camera: usize,
        event: DragEvent,
        context: &Context<'_>,
        requests: &mut Requests,
    ) {
        match event {
            DragEvent::Begin(drag) => {
                let before = self.dragging.take();
                let gesture = before.map_or_else(|| next_gesture(context.egui), |before| before.gesture);
                let (base, body) = (Arc::new(context.shown_pose().clone()), context.document().model.clone());
                let placed = placed_by(drag).and_then(|joint| self.placed(context, joint, &base));
                let mut dragging =
                    Dragging { camera, base, body, gesture, drag, before: placed, reached: None };
                dragging.request(context, requests);
                self.dragging = Some(dragging);
            }
            DragEvent::Move(drag) => {
                if let Some(dragging) = &mut self.dragging {
                    dragging.drag = drag;
                    dragging.request(context, requests);
                }
            }
            DragEvent::End => {
                if let Some(dragging) = self.dragging.take() {
                    let placing = dragging.placing(context).zip(dragging.reached.as_ref());
                    let placed = placing.and_then(|(placing, reached)| placing.placement(reached));
                    let has_others = placed.is_some() && context.session.camera_count() > 1;
                    let stays =
                        if has_others { "; dragged in another view it stays on this ray" } else { "" };
                    self.placement = placed.or(self.placement.take());
                    let what = words(&dragging.body, dragging.drag);
                    requests.status(format!("{what}: done{stays}. Ctrl+Z takes it back."));
                }
            }
            DragEvent::Cancel => {
                if let Some(dragging) = self.dragging.take() {
                    requests.request(SessionRequest::CancelGesture(dragging.gesture));
                    requests.status("Put back.");
                }
            }
        }
    }

    /// Moves the selected joint by pixels of the active view. Keys that follow each other quickly are undone as one.
    pub(super) fn nudge(&mut self, by_px: DVec2, context: &Context<'_>, requests: &mut Requests) {
        let (joint, camera) = (context.selection.joint, context.selection.camera);
        let Some(view) = context.session.take.as_ref().and_then(|take| take.cameras.get(camera)) else {
            return;
        };
        let pose = context.shown_pose();
        let goes_on = self.nudging.take().filter(|nudging| {
            (nudging.joint, nudging.camera) == (joint, camera)
                && nudging.reached == *pose
                && context.now - nudging.at < NUDGE_SECONDS
        });
        let mut nudging = goes_on.unwrap_or_else(|| Nudging {
            joint,
            camera,
            base: Arc::new(pose.clone()),
            before: self.placed(context, joint, pose),
            total_px: DVec2::ZERO,
            reached: pose.clone(),
            gesture: next_gesture(context.egui),
            at: 0.0,
        });
        nudging.total_px += by_px;
        nudging.at = context.now;
        let document = context.document();
        let (model, base) = (&document.model, &nudging.base);
        let Some(from_px) = view.project(joint_position(model, base, joint)) else { return };
        let pins: Vec<usize> = document.pins.iter().copied().collect();
        let held = Held { pins: &pins, trunk: context.views.hold_trunk };
        let placing = Placing { context, body: model, joint, camera, before: nudging.before.as_ref() };
        let target_px = from_px + nudging.total_px;
        let (Some(Dragged::Pose(pose)), _) = placing.dragged(held, base, target_px) else { return };
        self.placement = placing.placement(&pose);
        let name = joint_name(model, joint);
        let DVec2 { x, y } = nudging.total_px;
        let moved = format!("Nudged {name} by {x:.0}, {y:.0} pixels in camera {}.", camera + 1);
        requests.status(limit_sentence(model, base, &pose).unwrap_or(moved));
        // As the document has it.
        nudging.reached = pose.normalized();
        let edit = Edit::SetPose { frame: context.selection.frame, pose, what: format!("Nudge {name}") };
        requests.drag(edit, nudging.gesture);
        // What is shown of the limits goes by itself.
        context.egui.request_repaint_after(Duration::from_secs_f64(NUDGE_SECONDS));
        self.nudging = Some(nudging);
    }
}
