//! What menus, buttons, keys and the palette ask of the pose.

use backlit_document::edit::Edit;
use backlit_formats::Footage;
use backlit_tracking::body::{Model, Pose};
use backlit_tracking::posing;
use backlit_ui::drawing::JointId;

use super::Posing;
use super::panel::rotation_tree;
use crate::context::command::{Command, HistoryCommand, PoseCommand};
use crate::context::feature::Feature;
use crate::context::unavailable::Why;
use crate::context::unavailable::no_take;
use crate::context::view_settings::ViewSettings;
use crate::context::{Context, FeatureRequest, Requests, SessionRequest};
use crate::session::selection::Selection;

impl Feature for Posing {
    fn run(&mut self, command: Command, context: &Context<'_>, requests: &mut Requests) -> bool {
        let Command::Pose(command) = command else { return false };
        let (document, frame) = (context.document(), context.selection.frame);
        let (model, pose) = (&document.model, context.shown_pose());
        let limb = &model.limbs()[context.selection.limb(model)];
        let (rotation, name) = (limb.rotation, &limb.name);
        let set = |pose, what| Edit::SetPose { frame, pose, what };
        match command {
            PoseCommand::Copy => self.copy(context, requests),
            PoseCommand::Paste => self.paste(context, requests),
            PoseCommand::Mirror => {
                requests.edit(set(mirrored(model, pose, rotation), format!("Mirror {name}")));
            }
            PoseCommand::MirrorAll => {
                requests.edit(set(posing::mirror(model, pose), "Mirror pose".to_owned()));
            }
            PoseCommand::TurnRound => {
                requests.edit(set(posing::turn_round(model, pose), "Turn round".to_owned()));
            }
            PoseCommand::HoldTrunk => {
                let hold_trunk = !context.views.hold_trunk;
                requests.request(FeatureRequest::Views(ViewSettings { hold_trunk, ..context.views }));
                requests.status(if hold_trunk {
                    "The trunk is held: a dragged joint moves its own arm, leg or neck alone."
                } else {
                    "The trunk follows a dragged joint where its own chain does not reach."
                });
            }
            PoseCommand::PinJoint => {
                if let JointId::End(limb) = context.selection.joint {
                    requests.edit(Edit::Pin { limb, pinned: !document.pins.contains(&limb) });
                }
            }
            PoseCommand::ResetLimb => {
                let mut pose = pose.clone();
                pose.rotations[rotation] = Pose::rest(model).rotations[rotation];
                requests.edit(set(pose, format!("Reset {name}")));
            }
            PoseCommand::ResetBody => {
                let edit = set((*document.start).clone(), "Reset body".to_owned());
                if document.would_change(&edit) {
                    let text = "The body has the start pose of the take again.";
                    requests.inform(text, Some(Command::History(HistoryCommand::Undo)));
                }
                requests.edit(edit);
            }
            PoseCommand::NextJoint | PoseCommand::PreviousJoint => {
                // In the order of the tree in the Pose section.
                let rows = rotation_tree(model);
                let here = rows.iter().position(|(row, _)| *row == rotation).unwrap_or(0);
                let by = if command == PoseCommand::NextJoint { 1 } else { rows.len() - 1 };
                let owner = model.rotation_owners()[rows[(here + by) % rows.len()].0];
                requests.request(SessionRequest::Joint(Selection::joint_of(model, owner)));
            }
            PoseCommand::Nudge(nudge) => self.nudge(nudge.by_px(), context, requests),
        }
        true
    }

    fn unavailable(&self, command: Command, context: &Context<'_>) -> Why {
        let Command::Pose(command) = command else { return None };
        match command {
            PoseCommand::Copy
            | PoseCommand::Paste
            | PoseCommand::Mirror
            | PoseCommand::MirrorAll
            | PoseCommand::TurnRound
            | PoseCommand::HoldTrunk
            | PoseCommand::PinJoint
            | PoseCommand::ResetLimb
            | PoseCommand::ResetBody
            | PoseCommand::Nudge(_) => no_take(context),
            PoseCommand::NextJoint | PoseCommand::PreviousJoint => None,
        }
    }

    fn answer(&mut self, request: &FeatureRequest, context: &Context<'_>, requests: &mut Requests) {
        if let FeatureRequest::Drag(camera, event) = *request {
            self.drag(camera, event, context, requests);
        }
    }

    fn reset(&mut self, _: &Footage) {
        self.dragging = None;
        self.nudging = None;
    }
}

/// The pose with the other side's limb, and all that hangs from it, turned as this side's is.
fn mirrored(model: &Model, pose: &Pose, rotation: usize) -> Pose {
    let all = posing::mirror(model, pose);
    let mut result = pose.clone();
    for (index, &owner) in model.rotation_owners().iter().enumerate() {
        let other = model.limbs()[model.mirrored_limb(owner)].rotation;
        // What follows the selected rotation on this side is copied to the other.
        if model.rotation_follows(other, rotation) && other != index {
            result.rotations[index] = all.rotations[index];
        }
    }
    result
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::{Parameters, builtin};

    use super::*;

    #[test]
    fn mirroring_an_arm_moves_the_other_arm_only() {
        let model = builtin::full_body();
        let step: Vec<f64> = (0..48).map(|i| 0.3 * (f64::from(i) * 1.3).sin()).collect();
        let pose = Pose::rest(&model).retract(Parameters::Tangent, &step);
        let arm = model.limbs()[model.limb_index("right upper arm").unwrap()].rotation;
        let after = mirrored(&model, &pose, arm);
        let changed: Vec<&str> = model
            .rotation_owners()
            .iter()
            .enumerate()
            .filter(|(index, _)| after.rotations[*index] != pose.rotations[*index])
            .map(|(_, owner)| model.limbs()[*owner].name.as_str())
            .collect();
        assert_eq!(changed, ["left upper arm", "left forearm"]);
    }
}
