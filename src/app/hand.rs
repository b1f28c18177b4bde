//! Dragging in a camera's view: joints, limbs, the whole body.

use backlit_tracking::body::{Kinematics, Model, Pose};
use backlit_tracking::camera::Camera;
use backlit_tracking::track::posing;
use glam::{DQuat, DVec2, DVec3};

use super::App;
use crate::document::Document;
use crate::edit::Edit;
use crate::history::Gesture;
use crate::pane::Pane;
use crate::panels::camera_tile::{Drag, TileEvent, Wipe};
use crate::picture::{JointId, joint_name};
use crate::selection::Selection;
use crate::showing::PaneEvent;

/// What the hand holds.
#[derive(Debug, Clone)]
pub(super) struct Held {
    /// In which camera's view.
    pub(super) camera: usize,
    /// The pose in which the drag began: dragging back undoes itself.
    base: Pose,
    gesture: Gesture,
    /// What is dragged, last.
    pub(super) drag: Drag,
}

impl App {
    /// What the user did in a tile.
    pub(super) fn tile_event(&mut self, camera: usize, event: TileEvent) {
        match event {
            TileEvent::Activate => self.make_active(camera),
            TileEvent::Hover(_) => {}
            TileEvent::SelectJoint(joint) => self.selection.joint = joint,
            TileEvent::SelectLimb(limb) => {
                self.selection.joint = Selection::joint_of(&self.document().model, limb);
            }
            TileEvent::DragStart(drag) => {
                self.interrupt_fit();
                let base = self.session.shown_pose(self.document(), &self.selection).clone();
                self.held = Some(Held { camera, base, gesture: self.new_gesture(), drag });
                self.drag_on(drag);
            }
            TileEvent::Drag(drag) => self.drag_on(drag),
            TileEvent::DragEnd => self.held = None,
            TileEvent::DragCancelled => {
                if let Some(held) = self.held.take() {
                    self.history.put_back(held.gesture);
                }
            }
            TileEvent::SetMode(mode) => self.set_tile(camera, |tile| tile.mode = mode),
            TileEvent::SetWipe(at) => self.set_tile(camera, |tile| {
                tile.wipe = tile.wipe.map(|wipe| Wipe { at, ..wipe });
            }),
            TileEvent::SetUsed(used) => self.edit(Edit::UseCamera { camera, used }, None),
            TileEvent::SetWeight(weight) => {
                let gesture = Gesture(u64::MAX / 2 + camera as u64);
                self.edit(Edit::WeighCamera { camera, weight }, Some(gesture));
            }
            TileEvent::SetLinked(linked) => self.look.linked_zoom = linked,
            TileEvent::SetFraming(framing) => {
                let linked = self.look.linked_zoom;
                for (index, tile) in self.tiles_mut().iter_mut().enumerate() {
                    if linked || index == camera {
                        tile.framing = framing;
                    }
                }
            }
            TileEvent::ToggleExpanded => self.pane_event(Pane::Camera(camera), PaneEvent::ToggleAlone),
            TileEvent::DragTile => {}
            TileEvent::Switch(other) => self.switch_camera(camera, other),
            TileEvent::Close => self.pane_event(Pane::Camera(camera), PaneEvent::Close),
            TileEvent::Segment => self.session.forget_measurements(),
        }
    }

    fn set_tile(&mut self, camera: usize, change: impl FnOnce(&mut crate::panels::tiles::TileLook)) {
        if let Some(tile) = self.tiles_mut().get_mut(camera) {
            change(tile);
        }
    }

    fn drag_on(&mut self, drag: Drag) {
        let Some(held) = &mut self.held else { return };
        held.drag = drag;
        let held = held.clone();
        let Some(take) = &self.session.take else { return };
        let Some(camera) = take.cameras.get(held.camera) else { return };
        let document = self.document();
        let Some(pose) = dragged(document, &held.base, camera, drag) else { return };
        let what = words(&document.model, drag);
        self.doing = Some(format!("{what}, parallel to camera {}. Esc puts it back.", held.camera + 1));
        let edit = Edit::SetPose { frame: self.selection.frame, pose, what };
        self.edit(edit, Some(held.gesture));
    }
}

/// The joint whose sight ray is drawn in the other views.
pub(super) fn dragged_joint(drag: Drag) -> Option<JointId> {
    match drag {
        Drag::Joint { joint, .. } | Drag::Depth { joint, .. } => Some(joint),
        Drag::Twist { .. } | Drag::Turn { .. } | Drag::Body { .. } => None,
    }
}

fn words(model: &Model, drag: Drag) -> String {
    let limb_name = |limb: usize| model.limbs().get(limb).map_or("limb", |limb| limb.name.as_str());
    match drag {
        Drag::Joint { joint, .. } => format!("Move {}", joint_name(model, joint)),
        Drag::Depth { joint, .. } => format!("Move {} in depth", joint_name(model, joint)),
        Drag::Twist { limb, .. } => format!("Twist {}", limb_name(limb)),
        Drag::Turn { limb, .. } => format!("Turn {}", limb_name(limb)),
        Drag::Body { .. } => "Move body".to_owned(),
    }
}

/// The pose that a drag makes of the one it began with; `None` where a pixel has no ray.
fn dragged(document: &Document, base: &Pose, camera: &Camera, drag: Drag) -> Option<Pose> {
    let model = &*document.model;
    let position = |joint: JointId| match joint {
        JointId::Root => base.root,
        JointId::End(limb) => Kinematics::new(model, base).ends()[limb],
    };
    let pose = match drag {
        Drag::Joint { joint, target_px } => {
            let target = point_at(camera, target_px, camera.depth(position(joint)))?;
            moved(document, base, joint, target)
        }
        Drag::Depth { joint, ratio } => {
            let from_camera = position(joint) - camera.centre();
            moved(document, base, joint, camera.centre() + from_camera * ratio)
        }
        Drag::Twist { limb, angle_rad } => posing::twist_limb(model, base, limb, angle_rad),
        Drag::Turn { limb, pivot_px, angle_rad } => {
            let axis = camera.ray_in_world(pivot_px)?;
            posing::turn_limb(model, base, limb, DQuat::from_axis_angle(axis, angle_rad))
        }
        Drag::Body { from_px, to_px, depth_m } => {
            let shift = point_at(camera, to_px, depth_m)? - point_at(camera, from_px, depth_m)?;
            Pose { root: base.root + shift, ..base.clone() }
        }
    };
    pose.check(model).is_ok().then_some(pose)
}

/// The pose with a joint elsewhere: the chain follows, pins stay; the root takes the whole body along.
pub(crate) fn moved(document: &Document, base: &Pose, joint: JointId, target: DVec3) -> Pose {
    match joint {
        JointId::Root => Pose { root: target, ..base.clone() },
        JointId::End(limb) => {
            let pins: Vec<usize> = document.pins.iter().copied().collect();
            posing::drag_limb_end(&document.model, base, limb, target, &pins)
        }
    }
}

/// The world point that a pixel shows at a depth along the optical axis.
fn point_at(camera: &Camera, px: DVec2, depth_m: f64) -> Option<DVec3> {
    let per_depth = 1.0 / camera.ray_in_camera(px)?.z;
    Some(camera.centre() + camera.ray_in_world(px)? * (depth_m * per_depth))
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin;
    use backlit_tracking::camera::{CameraFromWorld, Distortion, Intrinsics};

    use super::*;

    fn camera() -> Camera {
        let place = CameraFromWorld::looking_at(DVec3::new(3.0, -1.0, 1.0), DVec3::ZERO, DVec3::Z);
        let intrinsics = Intrinsics { fx: 420.0, fy: 420.0, cx: 134.0, cy: 238.0 };
        Camera::new("c", [272, 480], intrinsics, Distortion::None, place).unwrap()
    }

    #[test]
    fn a_dragged_wrist_is_seen_where_the_pointer_is_and_at_its_depth() {
        let document = Document::new(builtin::full_body());
        let (camera, base) = (camera(), Pose::rest(&document.model));
        let wrist = document.model.limb_index("right forearm").unwrap();
        let before = Kinematics::new(&document.model, &base).ends()[wrist];
        let target_px = camera.project(before).unwrap() + DVec2::new(9.0, -14.0);
        let drag = Drag::Joint { joint: JointId::End(wrist), target_px };
        let pose = dragged(&document, &base, &camera, drag).unwrap();
        let after = Kinematics::new(&document.model, &pose).ends()[wrist];
        assert!(camera.project(after).unwrap().distance(target_px) < 2.0);
        assert!((camera.depth(after) - camera.depth(before)).abs() < 0.01);
    }

    #[test]
    fn the_whole_body_moves_with_the_point_that_is_held() {
        let document = Document::new(builtin::full_body());
        let (camera, base) = (camera(), Pose::rest(&document.model));
        let from_px = camera.project(DVec3::ZERO).unwrap();
        let to_px = from_px + DVec2::new(30.0, 10.0);
        let drag = Drag::Body { from_px, to_px, depth_m: camera.depth(DVec3::ZERO) };
        let pose = dragged(&document, &base, &camera, drag).unwrap();
        assert!(camera.project(pose.root).unwrap().distance(to_px) < 1e-6);
        assert_eq!(pose.rotations, base.rotations);
    }

    #[test]
    fn depth_keeps_the_pixel() {
        let document = Document::new(builtin::full_body());
        let (camera, base) = (camera(), Pose::rest(&document.model));
        let drag = Drag::Depth { joint: JointId::Root, ratio: 1.2 };
        let pose = dragged(&document, &base, &camera, drag).unwrap();
        let (before, after) = (camera.project(base.root).unwrap(), camera.project(pose.root).unwrap());
        assert!(before.distance(after) < 1e-6 && camera.depth(pose.root) > camera.depth(base.root));
    }
}
