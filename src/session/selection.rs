//! What the user looks at and holds: frame, camera, limb, step of a run.

use backlit_document::runs::StepRef;
use backlit_tracking::body::Model;
use backlit_ui::drawing::{JointId, draggable_joints};

/// What is selected. Nothing here is saved or undone.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Selection {
    /// The frame on the screen.
    pub frame: usize,
    /// The camera whose tile is active.
    pub camera: usize,
    /// The joint that is held.
    pub joint: JointId,
    /// Of the limbs that turn with the held joint, the one whose size is looked at; another one stands for the limb
    /// that owns the rotation.
    pub(crate) part: Option<usize>,
    /// The step on the screen, while the user looks back into a run; otherwise the document's pose is shown.
    pub step: Option<StepRef>,
}

impl Selection {
    /// The limb that turns when the held joint is moved: the one that owns its rotation.
    pub(crate) fn limb(&self, model: &Model) -> usize {
        let rotation = match self.joint {
            JointId::Root => 0,
            JointId::End(limb) => model.limbs().get(limb).map_or(0, |limb| limb.rotation),
        };
        model.rotation_owners()[rotation]
    }

    /// The limb whose size is looked at.
    pub(crate) fn sized_limb(&self, model: &Model) -> usize {
        let owner = self.limb(model);
        let rotation = model.limbs()[owner].rotation;
        let part =
            self.part.filter(|part| model.limbs().get(*part).is_some_and(|limb| limb.rotation == rotation));
        part.unwrap_or(owner)
    }

    /// The joint by which a limb is held: the outermost one that turns with it.
    pub(crate) fn joint_of(model: &Model, limb: usize) -> JointId {
        let rotation = model.limbs().get(limb).map_or(0, |limb| limb.rotation);
        let turns_with =
            |joint: &JointId| matches!(joint, JointId::End(end) if model.limbs()[*end].rotation == rotation);
        let first_owner = model.rotation_owners()[0];
        if limb == first_owner && model.rotation_count() > 1 {
            return JointId::Root;
        }
        draggable_joints(model).into_iter().rfind(turns_with).unwrap_or(JointId::End(limb))
    }

    /// Goes to a frame and leaves the run that was looked into.
    pub(crate) fn go_to_frame(&mut self, frame: usize, frame_count: usize) {
        self.frame = frame.min(frame_count.saturating_sub(1));
        self.step = None;
    }
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin;

    use super::*;

    #[test]
    fn limbs_and_joints_name_each_other() {
        let model = builtin::full_body();
        for &owner in model.rotation_owners() {
            let joint = Selection::joint_of(&model, owner);
            let selection = Selection { joint, ..Selection::default() };
            assert_eq!(selection.limb(&model), owner, "{}", model.limbs()[owner].name);
        }
    }

    #[test]
    fn another_frame_is_not_a_step() {
        let mut selection = Selection { step: Some(StepRef { run: 0, step: 2 }), ..Selection::default() };
        selection.go_to_frame(9, 4);
        assert_eq!((selection.frame, selection.step), (3, None));
    }
}
