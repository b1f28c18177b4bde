//! What anatomy calls the joints at the ends of limbs.

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

/// What anatomy calls the second joint of a limb of this name: of `right lower thigh` the `right knee`. `None` for other names.
#[must_use]
pub fn joint_at_end(limb: &str) -> Option<String> {
    let (side, part) = ["right ", "left "]
        .into_iter()
        .find_map(|side| limb.strip_prefix(side).map(|part| (side, part)))
        .unwrap_or(("", limb));
    let part = part.strip_prefix("lower ").unwrap_or(part);
    JOINTS.iter().find(|(name, _)| *name == part).map(|(_, joint)| format!("{side}{joint}"))
}
