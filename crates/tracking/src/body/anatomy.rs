//! What anatomy calls the joints at the ends of limbs.

use super::Model;

/// Parts of limbs' names, without their side, and the joint at the end.
const JOINTS: [(&str, &str); 13] = [
    ("spine", "waist"),
    ("chest", "neck"),
    ("torso", "neck"),
    ("neck", "head"),
    ("head", "head"),
    ("clavicle", "shoulder"),
    ("shoulder", "shoulder"),
    ("upper arm", "elbow"),
    ("forearm", "wrist"),
    ("hip", "hip"),
    ("thigh", "knee"),
    ("calf", "ankle"),
    ("foot", "toes"),
];

/// A limb's name in two: "right " or "left " or nothing, and the part of the body.
#[must_use]
pub fn split_side(limb: &str) -> (&str, &str) {
    let after = ["right ", "left "].into_iter().find(|side| limb.starts_with(side)).map_or(0, str::len);
    limb.split_at(after)
}

/// What anatomy calls the second joint of a limb of this name: of `right lower thigh` the `right knee`. `None` for other names.
#[must_use]
pub fn joint_at_end(limb: &str) -> Option<String> {
    let (side, part) = split_side(limb);
    let part = part.strip_prefix("lower ").unwrap_or(part);
    JOINTS.iter().find(|(name, _)| *name == part).map(|(_, joint)| format!("{side}{joint}"))
}

/// The joint at the end of each limb of a body: anatomy's name, or the limb's. Of a limb in two parts the lower one ends there.
#[must_use]
pub fn joint_names(model: &Model) -> Vec<String> {
    let name = |limb: &str| {
        let (side, part) = split_side(limb);
        let joint = joint_at_end(limb).filter(|_| model.limb_index(&format!("{side}lower {part}")).is_none());
        joint.unwrap_or_else(|| limb.to_owned())
    };
    model.limbs().iter().map(|limb| name(&limb.name)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::builtin;

    #[test]
    fn joints_have_one_name_each() {
        for model in [builtin::full_body(), builtin::upper_body()] {
            let mut names = joint_names(&model);
            assert!(names.iter().any(|name| name == "left elbow"), "{names:?}");
            let count = names.len();
            names.sort();
            names.dedup();
            assert_eq!(names.len(), count, "{names:?}");
        }
        let full = builtin::full_body();
        let knee = joint_names(&full).iter().position(|name| name == "right knee");
        assert_eq!(knee, full.limb_index("right lower thigh"));
    }
}
