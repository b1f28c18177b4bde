//! What a drag in a camera's picture makes of a pose or of a limb's size, and the limits it meets.

use std::ops::RangeInclusive;

use backlit_tracking::body::{Kinematics, Model, Pose};
use backlit_tracking::camera::Camera;
use backlit_tracking::posing::{self, Held};
use backlit_ui::drawing::{self, Drag, JointId, joint_name, point_at};
use backlit_ui::style::format;
use glam::{DQuat, DVec2, DVec3};

/// Shortest and longest limb, metres.
pub(super) const LENGTHS_M: RangeInclusive<f64> = 0.02..=0.8;

/// Thinnest and thickest limb, metres.
pub(super) const RADII_M: RangeInclusive<f64> = 0.01..=0.25;

/// Squared sine between a ray and a limb below which the limb is seen end-on and its length cannot be dragged.
const END_ON: f64 = 1e-3;

/// What a drag makes.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Dragged {
    /// Another pose.
    Pose(Pose),
    /// Another size of a limb, metres.
    Size {
        /// The limb.
        limb: usize,
        /// From joint to joint.
        length: f64,
        /// Radius.
        radius: f64,
    },
}

/// Where a joint is in the world; the root's place for one that the body does not have.
pub(super) fn joint_position(model: &Model, pose: &Pose, joint: JointId) -> DVec3 {
    drawing::joint_position(joint, pose.root, &Kinematics::new(model, pose)).unwrap_or(pose.root)
}

/// What a drag makes of the pose and the body that it began with; `None` where a pixel has no ray.
///
/// No angle leaves its limits; one that was outside may only come back.
pub(super) fn dragged(
    model: &Model,
    held: Held<'_>,
    base: &Pose,
    camera: &Camera,
    drag: Drag,
) -> Option<Dragged> {
    let position = |joint| joint_position(model, base, joint);
    let pose = match drag {
        Drag::Joint { joint, target_px } => {
            let target = point_at(camera, target_px, camera.depth(position(joint)))?;
            moved(model, held, base, joint, target)
        }
        Drag::Depth { joint, ratio } => {
            let from_camera = position(joint) - camera.centre();
            moved(model, held, base, joint, camera.centre() + from_camera * ratio)
        }
        Drag::Twist { limb, angle_rad } => {
            posing::within_limits(model, base, &posing::twist_limb(model, base, limb, angle_rad))
        }
        Drag::Turn { limb, pivot_px, angle_rad } => {
            let turn = DQuat::from_axis_angle(camera.ray_in_world(pivot_px)?, angle_rad);
            posing::within_limits(model, base, &posing::turn_limb(model, base, limb, turn))
        }
        Drag::Body { from_px, to_px, depth_m } => {
            let shift = point_at(camera, to_px, depth_m)? - point_at(camera, from_px, depth_m)?;
            Pose { root: base.root + shift, ..base.clone() }
        }
        Drag::Length { limb, from_px, to_px } | Drag::Radius { limb, from_px, to_px } => {
            return resized(model, base, camera, limb, [from_px, to_px], matches!(drag, Drag::Length { .. }));
        }
    };
    pose.check(model).is_ok().then_some(Dragged::Pose(pose))
}

/// The pose with a joint elsewhere: the chain follows, pins stay; the root takes the whole body along.
pub(super) fn moved(model: &Model, held: Held<'_>, base: &Pose, joint: JointId, target: DVec3) -> Pose {
    match joint {
        JointId::Root => Pose { root: target, ..base.clone() },
        JointId::End(limb) => posing::drag_limb_end(model, base, limb, target, held),
    }
}

/// The size of a limb whose end, or whose outline, was dragged from one pixel to another: it grows by as much as the
/// sight ray moves along its axis, or away from it.
fn resized(
    model: &Model,
    pose: &Pose,
    camera: &Camera,
    limb: usize,
    px: [DVec2; 2],
    is_length: bool,
) -> Option<Dragged> {
    let kinematics = Kinematics::new(model, pose);
    let start = *kinematics.starts().get(limb)?;
    let along = (kinematics.ends()[limb] - start).normalize();
    let from_start = camera.centre() - start;
    let [from, to] = px.map(|px| {
        let ray = camera.ray_in_world(px)?;
        let cosine = ray.dot(along);
        let sine2 = 1.0 - cosine * cosine;
        if is_length {
            let at = (along.dot(from_start) - cosine * ray.dot(from_start)) / sine2;
            (sine2 > END_ON).then_some(at)
        } else {
            let across = ray.cross(along).try_normalize()?;
            Some(from_start.dot(across).abs())
        }
    });
    let by = to? - from?;
    let (length, radius) = (model.limbs()[limb].length, model.limbs()[limb].radius);
    let within = |value: f64, range: RangeInclusive<f64>| value.clamp(*range.start(), *range.end());
    Some(if is_length {
        Dragged::Size { limb, length: within(length + by, LENGTHS_M), radius }
    } else {
        Dragged::Size { limb, length, radius: within(radius + by, RADII_M) }
    })
}

/// What a drag does, for the undo menu.
pub(super) fn words(model: &Model, drag: Drag) -> String {
    let limb_name = |limb: usize| model.limbs().get(limb).map_or("limb", |limb| limb.name.as_str());
    match drag {
        Drag::Joint { joint, .. } => format!("Move {}", joint_name(model, joint)),
        Drag::Depth { joint, .. } => format!("Move {} in depth", joint_name(model, joint)),
        Drag::Twist { limb, .. } => format!("Twist {}", limb_name(limb)),
        Drag::Turn { limb, .. } => format!("Turn {}", limb_name(limb)),
        Drag::Body { .. } => "Move body".to_owned(),
        Drag::Length { limb, .. } => format!("Length of {}", limb_name(limb)),
        Drag::Radius { limb, .. } => format!("Radius of {}", limb_name(limb)),
    }
}

/// "Right forearm stops: its flexion is at the limit of 145.0°." Only of limbs that a drag has turned.
pub(super) fn limit_sentence(model: &Model, base: &Pose, pose: &Pose) -> Option<String> {
    let reached = posing::limits_reached(model, pose);
    let mut turned = reached.into_iter().filter(|limit| {
        let before = base.rotations[model.limbs()[limit.limb].rotation];
        let after = pose.rotations[model.limbs()[limit.limb].rotation];
        before.dot(after).abs() < 1.0 - 1e-9
    });
    let limit = turned.next()?;
    let name = format::capitalised(&model.limbs()[limit.limb].name);
    let more = match turned.count() {
        0 => String::new(),
        count => format!(" And {count} more."),
    };
    Some(format!(
        "{name} stops: its {} is at the limit of {}°.{more}",
        limit.angle.name(),
        format::number(limit.limit_rad.to_degrees(), 1)
    ))
}

#[cfg(test)]
mod tests;
