//! Dragging in a camera's view: joints, limbs, the whole body, and a limb's own size; and nudges by the keyboard.

use std::sync::Arc;
use std::time::Duration;

use backlit_document::edit::Edit;
use backlit_document::history::Gesture;
use backlit_tracking::body::{Model, Pose};
use backlit_tracking::posing::Held;
use backlit_ui::drawing::{Drag, DragEvent, JointId, joint_name};
use backlit_ui::style::format;
use glam::DVec2;

use super::Posing;
use super::dragged::{Dragged, dragged, joint_position, limit_sentence, words};
use crate::context::command_button::next_gesture;
use crate::context::marks::DragMarks;
use crate::context::{Context, Requests, SessionRequest};

/// Nudges that follow each other within this many seconds are one.
pub(super) const NUDGE_SECONDS: f64 = 2.0;

/// A joint that is nudged by the keyboard.
#[derive(Debug, Clone)]
pub(super) struct Nudging {
    joint: JointId,
    camera: usize,
    /// The pose in which the first of the nudges began, and how far they go from there.
    pub(super) base: Arc<Pose>,
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
        DragMarks { camera: Some(self.camera), joint, twisted, from: Some(self.base.clone()) }
    }

    /// Asks for what the drag has led to.
    fn request(&self, context: &Context<'_>, requests: &mut Requests) {
        let document = context.document();
        let camera = context.session.take.as_ref().and_then(|take| take.cameras.get(self.camera));
        let Some(camera) = camera else { return };
        let what = words(&self.body, self.drag);
        let pins: Vec<usize> = document.pins.iter().copied().collect();
        let held = Held { pins: &pins, trunk: context.views.hold_trunk };
        let edit = match dragged(&self.body, held, &self.base, camera, self.drag) {
            Some(Dragged::Pose(pose)) => {
                let reached = limit_sentence(&self.body, &self.base, &pose);
                let how = format!("{what}, seen from camera {}. Esc puts it back.", self.camera + 1);
                requests.status(reached.unwrap_or(how));
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

impl Posing {
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
                let dragging = Dragging { camera, base, body, gesture, drag };
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
                    let what = words(&dragging.body, dragging.drag);
                    requests.status(format!("{what}: done. Ctrl+Z takes it back."));
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
        let drag = Drag::Joint { joint, target_px: from_px + nudging.total_px };
        let pins: Vec<usize> = document.pins.iter().copied().collect();
        let held = Held { pins: &pins, trunk: context.views.hold_trunk };
        let Some(Dragged::Pose(pose)) = dragged(model, held, base, view, drag) else { return };
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
