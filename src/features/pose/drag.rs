//! Dragging in a camera's view: joints, limbs, the whole body, and a limb's own size.

use std::sync::Arc;

use backlit_tracking::body::{Model, Pose};
use glam::DVec2;

use crate::app::App;
use crate::context::PaneEvent;
use crate::context::pane::Pane;
use crate::document::edit::Edit;
use crate::document::history::Gesture;
use crate::drawing::{JointId, joint_name};
use crate::features::camera_views::{CameraViews, Drag, TileEvent};
use crate::features::pose as posing;
use crate::features::pose::clipboard::Clipboard;
use crate::features::pose::{Dragged, dragged};
use crate::session::selection::Selection;
use crate::style::format;

/// Nudges that follow each other within so many seconds are one.
const NUDGE_SECONDS: f64 = 2.0;

/// A joint that is nudged by the keyboard.
#[derive(Debug, Clone)]
pub(crate) struct Nudging {
    joint: JointId,
    camera: usize,
    /// The pose in which the first of the nudges began, and how far they go from there.
    base: Pose,
    total_px: DVec2,
    /// The pose that they have led to.
    reached: Pose,
    gesture: Gesture,
    at: f64,
}

/// What the hand holds.
#[derive(Debug, Clone)]
pub(crate) struct Held {
    /// In which camera's view.
    pub(crate) camera: usize,
    /// The pose in which the drag began: dragging back undoes itself.
    base: Pose,
    /// The body in which it began.
    body: Arc<Model>,
    gesture: Gesture,
    /// What is dragged, last.
    pub(crate) drag: Drag,
}

/// What the hand does.
#[derive(Debug, Default)]
pub(crate) struct Posing {
    pub(crate) held: Option<Held>,
    pub(crate) nudging: Option<Nudging>,
    pub(crate) clipboard: Clipboard,
}

impl App {
    /// What the user did in a tile.
    pub(crate) fn tile_event(&mut self, camera: usize, event: TileEvent) {
        match event {
            TileEvent::Activate => self.dock(|docking, window| docking.make_active(window, camera)),
            TileEvent::Hover(_) => {}
            TileEvent::SelectJoint(joint) => self.state.selection.joint = joint,
            TileEvent::SelectLimb(limb) => {
                self.state.selection.joint = Selection::joint_of(&self.document().model, limb);
                self.state.selection.part = Some(limb);
            }
            TileEvent::DragStart(drag) => self.take_hold(camera, drag),
            TileEvent::Drag(drag) => self.drag_on(drag),
            TileEvent::DragEnd => {
                if let Some(held) = self.features.pose.held.take() {
                    let what = posing::words(&held.body, held.drag);
                    self.state.status = Some(format!("{what}: done. Ctrl+Z takes it back."));
                }
            }
            TileEvent::DragCancelled => {
                if let Some(held) = self.features.pose.held.take() {
                    self.state.history.put_back(held.gesture);
                    self.state.status = Some("Put back.".to_owned());
                }
            }
            TileEvent::SetMode(mode) => self.set_tile(camera, |tile| tile.set_mode(mode)),
            TileEvent::CompareWith(mode) => self.set_tile(camera, |tile| tile.compare_with(mode)),
            TileEvent::SetComparison(comparison) => self.set_tile(camera, |tile| match comparison {
                Some(comparison) if tile.comparison != Some(comparison) => tile.toggle(comparison),
                Some(_) => {}
                None => tile.comparison = None,
            }),
            TileEvent::SetSettings(settings) => self.state.preferences.views = settings,
            TileEvent::SetWipe(at) => self.set_tile(camera, |tile| tile.wipe_at = at),
            TileEvent::SetUsed(used) => self.edit(Edit::UseCamera { camera, used }, None),
            TileEvent::SetWeight(weight) => self.edit(Edit::WeighCamera { camera, weight }, None),
            TileEvent::SetLinked(linked) => self.state.preferences.linked_zoom = linked,
            TileEvent::SetFraming(framing) => self.set_tile(camera, |tile| tile.framing = framing),
            TileEvent::ToggleExpanded => self.pane_event(Pane::Camera(camera), PaneEvent::ToggleAlone),
            TileEvent::DragTile => {}
            TileEvent::Switch(Pane::Camera(other)) => {
                self.dock(|docking, window| docking.switch_camera(window, camera, other))
            }
            TileEvent::Switch(pane) => self.pane_event(pane, PaneEvent::Open),
            TileEvent::Close => self.pane_event(Pane::Camera(camera), PaneEvent::Close),
            TileEvent::Segment => self.state.session.forget_measurements(),
        }
    }

    /// What the cameras' views show.
    pub(crate) fn camera_views(&self) -> CameraViews<'_> {
        let held = self.features.pose.held.as_ref();
        let nudging =
            self.features.pose.nudging.as_ref().filter(|nudging| self.state.now - nudging.at < NUDGE_SECONDS);
        CameraViews {
            tiles: &self.features.camera_views.tiles
                [usize::from(self.state.preferences.layout == crate::context::preferences::Layout::Debug)],
            alone: match self.shell.docking.alone {
                Some(Pane::Camera(camera)) => Some(camera),
                _ => None,
            },
            is_dragging: held.is_some(),
            picture_alone: self.features.camera_views.picture_alone,
            turned_from: held.map(|held| &held.base).or(nudging.map(|nudging| &nudging.base)),
            twisted: held.and_then(|held| match held.drag {
                Drag::Twist { limb, .. } => Some(limb),
                _ => None,
            }),
            dragged: held.and_then(|held| Some((held.camera, dragged_joint(held.drag)?))),
        }
    }

    /// A drag begins. A modifier pressed on the way begins anew from the pose that is reached: still one gesture.
    fn take_hold(&mut self, camera: usize, drag: Drag) {
        self.interrupt_fit();
        self.pause();
        let base = self.state.session.shown_pose(self.document(), &self.state.selection).clone();
        let gesture = self.features.pose.held.take().map_or_else(|| self.new_gesture(), |held| held.gesture);
        let body = self.document().model.clone();
        self.features.pose.held = Some(Held { camera, base, body, gesture, drag });
        self.drag_on(drag);
    }

    fn set_tile(&mut self, camera: usize, change: impl FnOnce(&mut crate::features::camera_views::TileLook)) {
        if let Some(tile) = self.tiles_mut().get_mut(camera) {
            change(tile);
        }
    }

    fn drag_on(&mut self, drag: Drag) {
        let Some(held) = &mut self.features.pose.held else { return };
        held.drag = drag;
        let held = held.clone();
        let Some(take) = &self.state.session.take else { return };
        let Some(camera) = take.cameras.get(held.camera) else { return };
        let what = posing::words(&held.body, drag);
        let pins = &self.document().pins;
        let Some(dragged) = dragged(&held.body, pins, &held.base, camera, drag) else { return };
        let edit = match dragged {
            Dragged::Pose(pose) => {
                let reached = posing::limit_sentence(&held.body, &held.base, &pose);
                let how = format!("{what}, seen from camera {}. Esc puts it back.", held.camera + 1);
                self.state.status = Some(reached.unwrap_or(how));
                Edit::SetPose { frame: self.state.selection.frame, pose, what }
            }
            Dragged::Size { limb, length, radius } => {
                self.state.status = Some(format!(
                    "{what}: {} long, radius {}. Esc puts it back.",
                    format::metres(length),
                    format::metres(radius)
                ));
                Edit::SetSize { limb, length, radius, both_sides: self.state.preferences.views.both_sides }
            }
        };
        self.edit(edit, Some(held.gesture));
    }

    /// Moves the selected joint by pixels of the active view. Keys that follow each other quickly are undone as one.
    pub(crate) fn nudge(&mut self, by_px: DVec2) {
        let (joint, camera) = (self.state.selection.joint, self.state.selection.camera);
        let Some(view) = self.state.session.take.as_ref().and_then(|take| take.cameras.get(camera)).cloned()
        else {
            return;
        };
        let pose = self.shown_pose().clone();
        let goes_on = self.features.pose.nudging.take().filter(|nudging| {
            (nudging.joint, nudging.camera) == (joint, camera)
                && nudging.reached == pose
                && self.state.now - nudging.at < NUDGE_SECONDS
        });
        let mut nudging = goes_on.unwrap_or_else(|| Nudging {
            joint,
            camera,
            base: pose.clone(),
            total_px: DVec2::ZERO,
            reached: pose,
            gesture: self.new_gesture(),
            at: 0.0,
        });
        self.interrupt_fit();
        nudging.total_px += by_px;
        nudging.at = self.state.now;
        let document = self.document();
        let at = posing::joint_position(&document.model, &nudging.base, joint);
        let Some(from_px) = view.project(at) else { return };
        let drag = Drag::Joint { joint, target_px: from_px + nudging.total_px };
        let Some(Dragged::Pose(pose)) = dragged(&document.model, &document.pins, &nudging.base, &view, drag)
        else {
            return;
        };
        let name = joint_name(&document.model, joint);
        let DVec2 { x, y } = nudging.total_px;
        let reached = posing::limit_sentence(&document.model, &nudging.base, &pose);
        let moved = format!("Nudged {name} by {x:.0}, {y:.0} pixels in camera {}.", camera + 1);
        self.state.status = Some(reached.unwrap_or(moved));
        let edit = Edit::SetPose { frame: self.state.selection.frame, pose, what: format!("Nudge {name}") };
        self.edit(edit, Some(nudging.gesture));
        nudging.reached = self.shown_pose().clone();
        // What is shown of the limits goes by itself.
        self.state.egui.request_repaint_after(std::time::Duration::from_secs_f64(NUDGE_SECONDS));
        self.features.pose.nudging = Some(nudging);
    }
}

/// The joint whose sight ray is drawn in the other views.
fn dragged_joint(drag: Drag) -> Option<JointId> {
    match drag {
        Drag::Joint { joint, .. } | Drag::Depth { joint, .. } => Some(joint),
        Drag::Twist { .. }
        | Drag::Turn { .. }
        | Drag::Body { .. }
        | Drag::Length { .. }
        | Drag::Radius { .. } => None,
    }
}
