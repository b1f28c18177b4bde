//! Which limbs a rotation carries, as branches of the body: what sums over limbs need to be taken from the leaves to
//! the root.

use super::Model;

/// A body all of whose rotations carry whole branches: some limbs that grow from one place, and all that grows from them.
///
/// What the rotation k carries moves about one point, its pivot, and what a rotation before it on the way to the root does
/// to the branch is a turn about another. So sums over a branch's limbs are made once and handed on.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Branches {
    /// By limb, the rotation that it turns with.
    pub(crate) rotations: Vec<usize>,
    /// By rotation, the one that carries it.
    pub(crate) parents: Vec<Option<usize>>,
    /// By rotation, a limb that starts at its pivot.
    pub(crate) roots: Vec<usize>,
    /// All rotations, what they carry before themselves.
    pub(crate) leaves_first: Vec<usize>,
}

impl Branches {
    /// None where a file has a limb rigid with one that grows from another place, or one that is carried but does not turn.
    ///
    /// `carriers` are, by limb, the rotations that move it, each with whether the limb turns with it.
    pub(crate) fn of<I>(model: &Model, carriers: impl Fn(usize) -> I) -> Option<Self>
    where
        I: Iterator<Item = (usize, bool)>,
    {
        let limbs = model.limbs();
        let mut roots: Vec<Option<usize>> = vec![None; model.rotation_count()];
        for (index, limb) in limbs.iter().enumerate() {
            for (rotation, turns) in carriers(index) {
                let is_inside =
                    limb.parent.is_some_and(|parent| carriers(parent).any(|(other, _)| other == rotation));
                let root = *roots[rotation].get_or_insert(index);
                if !turns || (!is_inside && limbs[root].parent != limb.parent) {
                    return None;
                }
            }
        }
        Some(Self {
            rotations: limbs.iter().map(|limb| limb.rotation).collect(),
            parents: model.rotation_parents().to_vec(),
            roots: roots.into_iter().collect::<Option<_>>()?,
            leaves_first: model.rotations_parents_first().iter().rev().copied().collect(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::{Kinematics, ModelSpec, Pose, builtin};

    fn of(model: &Model) -> Option<Branches> {
        Kinematics::new(model, &Pose::rest(model)).branches().cloned()
    }

    #[test]
    fn built_in_bodies_are_of_branches() {
        for model in [builtin::single_limb(), builtin::upper_body(), builtin::full_body()] {
            let branches = of(&model).unwrap();
            for (rotation, &root) in branches.roots.iter().enumerate() {
                assert_eq!(
                    model.limbs()[root].parent,
                    model.limbs()[model.rotation_owners()[rotation]].parent
                );
            }
        }
    }

    #[test]
    fn limbs_that_only_lean_on_others_are_no_branches() {
        let model = |limbs: &str| {
            let text = format!("format = \"backlit-body 1\"\nname = \"body\"\nlimb = [{limbs}]");
            Model::new(&toml::from_str::<ModelSpec>(&text).unwrap()).unwrap()
        };
        let limb = |name: &str, more: &str| {
            format!("{{ name = \"{name}\", direction = [0, 1, 0], length = 0.3, radius = 0.1{more} }},")
        };
        let trunk = limb("trunk", "") + &limb("arm", ", parent = \"trunk\"");
        assert!(of(&model(&trunk)).is_some());
        // A hand that keeps the trunk's rotation while the arm between them turns.
        let hand = limb("hand", ", parent = \"arm\", rigid_with = \"trunk\"");
        assert_eq!(of(&model(&(trunk.clone() + &hand))), None);
        // Two limbs of one rotation at two places.
        let legs = limb("leg", "") + &limb("other", ", parent = \"trunk\", rigid_with = \"leg\"");
        assert_eq!(of(&model(&(trunk + &legs))), None);
    }
}
