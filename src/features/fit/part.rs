//! The part of the body that a refit moves.

use backlit_tracking::body::Model;

use crate::context::command::BodyPart;

/// Rotations that a refit may move; `None` for all of them and the root.
pub(super) fn free_rotations(model: &Model, limb: usize, part: BodyPart) -> Option<Vec<bool>> {
    let rotation = model.limbs()[limb].rotation;
    let mut free = vec![false; model.rotation_count()];
    match part {
        BodyPart::Body => return None,
        BodyPart::Limb => free[rotation] = true,
        BodyPart::Chain => {
            // Up to the trunk: a rotation with more than one child belongs to several chains.
            let children = |parent: usize| {
                model.rotation_parents().iter().filter(|other| **other == Some(parent)).count()
            };
            let mut next = Some(rotation);
            while let Some(at) = next {
                free[at] = true;
                next = model.rotation_parents()[at].filter(|parent| children(*parent) == 1);
            }
            for (index, slot) in free.iter_mut().enumerate() {
                *slot |= model.rotation_follows(index, rotation);
            }
        }
    }
    Some(free)
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin;

    use super::*;

    #[test]
    fn a_chain_goes_from_the_trunk_to_the_hand() {
        let model = builtin::full_body();
        let arm = model.limb_index("right upper arm").unwrap();
        let free = free_rotations(&model, arm, BodyPart::Chain).unwrap();
        let names: Vec<&str> = model
            .rotation_owners()
            .iter()
            .zip(&free)
            .filter(|(_, free)| **free)
            .map(|(owner, _)| model.limbs()[*owner].name.as_str())
            .collect();
        assert_eq!(names, ["right clavicle", "right upper arm", "right forearm"]);
        assert_eq!(free_rotations(&model, arm, BodyPart::Limb).unwrap().iter().filter(|f| **f).count(), 1);
        assert_eq!(free_rotations(&model, arm, BodyPart::Body), None);
    }
}
