//! The body taken apart into its trunk and its free-hanging chains of rotations: arms, legs, head.
//!
//! A chain is a run of rotations, each the only child of the one before, that ends in one without children.
//! All other rotations are the trunk. A body that is one chain has its first rotation as trunk.

use crate::body::Model;

/// The limbs that each rotation turns directly, and the chains.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Chains {
    /// Per rotation, the limbs that follow it, parents first.
    pub groups: Vec<Vec<usize>>,
    /// Free-hanging chains: the rotations of each from the trunk outwards, in the order of the first ones.
    pub chains: Vec<Vec<usize>>,
    /// The other rotations, parents first.
    pub trunk: Vec<usize>,
}

impl Chains {
    /// Takes a model apart.
    #[must_use]
    pub fn new(model: &Model) -> Self {
        let count = model.rotation_count();
        let mut groups = vec![Vec::new(); count];
        for (index, limb) in model.limbs().iter().enumerate() {
            groups[limb.rotation].push(index);
        }
        let children = |rotation: usize| {
            (0..count).filter(move |&child| model.rotation_parents()[child] == Some(rotation))
        };
        let mut chains: Vec<Vec<usize>> = Vec::new();
        for end in (0..count).filter(|&rotation| children(rotation).next().is_none()) {
            let mut rotations = vec![end];
            let mut next = model.rotation_parents()[end];
            // The root's rotation always belongs to the trunk.
            while let Some(rotation) = next
                && children(rotation).count() == 1
                && model.rotation_parents()[rotation].is_some()
            {
                rotations.push(rotation);
                next = model.rotation_parents()[rotation];
            }
            if model.rotation_parents()[end].is_some() {
                rotations.reverse();
                chains.push(rotations);
            }
        }
        chains.sort_by_key(|chain| chain[0]);
        let in_chain = |rotation: &usize| chains.iter().any(|chain| chain.contains(rotation));
        let trunk = model.rotations_parents_first().iter().copied().filter(|r| !in_chain(r)).collect();
        Self { groups, chains, trunk }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::builtin;

    fn names(model: &Model, rotations: &[usize]) -> Vec<String> {
        rotations.iter().map(|&r| model.limbs()[model.rotation_owners()[r]].name.clone()).collect()
    }

    #[test]
    fn the_upper_body_is_a_torso_two_arms_and_a_head() {
        let model = builtin::upper_body();
        let parts = Chains::new(&model);
        assert_eq!(names(&model, &parts.trunk), ["torso"]);
        let chains: Vec<Vec<String>> = parts.chains.iter().map(|chain| names(&model, chain)).collect();
        assert_eq!(chains[0], ["right shoulder", "right upper arm", "right forearm"]);
        assert_eq!(chains[1], ["left shoulder", "left upper arm", "left forearm"]);
        assert_eq!(chains[2], ["head"]);
    }

    #[test]
    fn every_rotation_is_in_one_part() {
        for model in [builtin::single_limb(), builtin::upper_body(), builtin::full_body()] {
            let parts = Chains::new(&model);
            let mut all = parts.trunk.clone();
            all.extend(parts.chains.concat());
            all.sort_unstable();
            assert_eq!(all, (0..model.rotation_count()).collect::<Vec<_>>(), "{}", model.name());
            assert_eq!(parts.groups.iter().map(Vec::len).sum::<usize>(), model.limbs().len());
        }
    }
}
