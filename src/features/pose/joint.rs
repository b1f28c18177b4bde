//! The section of the selected joint: its angles with their limits, where it is, and what can be done with it.

use backlit_document::edit::Edit;
use backlit_tracking::body::{Limb, Pose};
use backlit_tracking::posing::{Held, LimitedAngle};
use backlit_ui::drawing::limits::WARN_WITHIN;
use backlit_ui::drawing::{JointId, joint_name};
use backlit_ui::style::theme::space;
use backlit_ui::style::{format, theme};
use backlit_ui::widgets::{SliderRow, hint, named_section, number_field, paint_text, row_name};
use egui::{Align2, TextStyle, Ui, vec2};

use super::dragged::{joint_position, moved};
use crate::context::command::{Command, PoseCommand};
use crate::context::command_button::{gesture, named_button};
use crate::context::{Context, Requests};

/// Degrees by which a slider reaches beyond a joint's limits.
const BEYOND_LIMITS: f64 = 20.0;

/// A narrower field has no room for the letter of its axis.
const AXIS_FROM: f32 = 78.0;
/// From a field's edge to the letter of its axis.
const AXIS_AWAY: f32 = 5.0;

/// The section of the selected joint; the angle under the pointer, or held by it.
pub(super) fn ui(
    ui: &mut Ui,
    context: &Context<'_>,
    requests: &mut Requests,
    open: bool,
) -> Option<LimitedAngle> {
    let mut looked_at = None;
    let model = &context.document().model;
    let index = context.selection.limb(model);
    let limb = &model.limbs()[index];
    let turns_at = limb.parent.map_or(JointId::Root, JointId::End);
    let summary = format!("turns at the {}", joint_name(model, turns_at));
    named_section(ui, "joint", &format::capitalised(&limb.name), &summary, open, |ui| {
        let pose = context.shown_pose();
        looked_at = angles(ui, context, requests, limb, pose);
        position(ui, context, requests, pose);
        ui.add_space(space::ROW);
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 6.0;
            named_button(ui, context, requests, Command::Pose(PoseCommand::Mirror), "Mirror");
            let pinned = matches!(context.selection.joint, JointId::End(end) if context.document().pins.contains(&end));
            named_button(ui, context, requests, Command::Pose(PoseCommand::PinJoint), if pinned { "Free" } else { "Pin" });
            named_button(ui, context, requests, Command::Pose(PoseCommand::ResetLimb), "Reset");
            named_button(ui, context, requests, Command::Pose(PoseCommand::Copy), "Copy");
            named_button(ui, context, requests, Command::Pose(PoseCommand::Paste), "Paste");
        });
    });
    looked_at
}

fn angles(
    ui: &mut Ui,
    context: &Context<'_>,
    requests: &mut Requests,
    limb: &Limb,
    pose: &Pose,
) -> Option<LimitedAngle> {
    let mut looked_at = None;
    let now = limb.angles(pose.rotations[limb.rotation]);
    let limits = limb.limits;
    let rows = [
        ("Flexion", now.flexion, limits.map(|l| l.flexion), "Bends the joint about its main axis"),
        ("Sideways", now.sideways, limits.map(|l| l.sideways), "Swings the limb to the side"),
        (
            "Twist",
            now.twist,
            limits.map(|l| l.twist),
            "Turns the limb about itself; silhouettes hardly see it",
        ),
    ];
    for (index, (name, angle, range, tooltip)) in rows.into_iter().enumerate() {
        let mut degrees = angle.to_degrees();
        let limits = range.map(|range| (range.0.to_degrees(), range.1.to_degrees(), WARN_WITHIN));
        let ends = limits.map_or(-180.0..=180.0, |(low, high, _)| {
            (low - BEYOND_LIMITS).max(-180.0)..=(high + BEYOND_LIMITS).min(180.0)
        });
        let row = SliderRow::new(name, "°", 1, ends, tooltip);
        let row = SliderRow { limits, origin: 0.0, is_held: true, ..row };
        let response = row.show(ui, &mut degrees);
        if response.hovered() || response.dragged() || response.has_focus() {
            let angles = [LimitedAngle::Flexion, LimitedAngle::Sideways, LimitedAngle::Twist];
            looked_at = Some(angles[index]);
        }
        if response.changed() && degrees.is_finite() {
            let mut angles = now;
            *[&mut angles.flexion, &mut angles.sideways, &mut angles.twist][index] = degrees.to_radians();
            let mut pose = pose.clone();
            pose.rotations[limb.rotation] = limb.rotation_from_angles(angles);
            let what = format!("Turn {}", limb.name);
            let edit = Edit::SetPose { frame: context.selection.frame, pose, what };
            requests.edits.push((edit, gesture(ui, ("angle", index), &response)));
        } else {
            gesture(ui, ("angle", index), &response);
        }
    }
    looked_at
}

fn position(ui: &mut Ui, context: &Context<'_>, requests: &mut Requests, pose: &Pose) {
    let document = context.document();
    let model = &document.model;
    let joint = context.selection.joint;
    let point = joint_position(model, pose, joint);
    let name = joint_name(model, joint);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = space::ROW;
        row_name(ui, "At", 24.0);
        let width = (ui.available_width() - 2.0 * space::ROW) / 3.0;
        for axis in 0..3 {
            let mut value = point[axis];
            let label = format!("{} {}", format::capitalised(&name), ["x", "y", "z"][axis]);
            let response = number_field(ui, &label, &mut value, 3, " m", 0.005, width);
            let drag = gesture(ui, ("position", axis), &response);
            if response.changed() && value.is_finite() {
                let mut target = point;
                target[axis] = value;
                let pins: Vec<usize> = document.pins.iter().copied().collect();
                let held = Held { pins: &pins, trunk: context.views.hold_trunk };
                let pose = moved(model, held, pose, joint, target);
                let edit =
                    Edit::SetPose { frame: context.selection.frame, pose, what: format!("Move {name}") };
                requests.edits.push((edit, drag));
            }
            let letter = ["x", "y", "z"][axis];
            let at = response.rect.left_center() + vec2(AXIS_AWAY, 0.0);
            if response.rect.width() >= AXIS_FROM && !response.has_focus() {
                let colour = theme::palette(ui).text3;
                paint_text(ui, at, Align2::LEFT_CENTER, letter, TextStyle::Small, colour);
            }
            response.on_hover_text(format!(
                "{letter} of the {name} in the world, metres; the chain follows. Drag, or click and type"
            ));
        }
    });
    if let JointId::End(limb) = joint
        && document.pins.contains(&limb)
    {
        hint(ui, "Pinned: other drags leave it here");
    }
}
