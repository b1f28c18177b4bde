//! The joints of a person among the names that skeletons and sets of markers give them.

use std::collections::BTreeMap;

use backlit_tracking::body::joint_at_end;

/// A joint and its names without their side, small letters only, the likeliest first: those of the CMU database's conversions, of
/// Mixamo, `OpenPose`, COCO, `OpenSim`, and of the files that Backlit writes.
const NAMES: [(&str, &[&str]); 9] = [
    ("waist", &["spine", "chest", "torso", "abdomen"]),
    ("neck", &["neck", "lowerneck", "head"]),
    ("hip", &["upleg", "hip", "thigh", "femur"]),
    ("knee", &["knee", "leg", "calf", "lowleg", "tibia"]),
    ("ankle", &["ankle", "foot", "calcn"]),
    ("toes", &["toebase", "toe", "toes", "toeend", "footend", "ankleend"]),
    ("shoulder", &["arm", "shoulder", "upperarm", "humerus"]),
    ("elbow", &["elbow", "forearm", "lowerarm", "ulna"]),
    ("wrist", &["wrist", "hand", "forearmend", "elbowend"]),
];

/// The joints that all tools mean alike. Heads, necks and toes are each tool's own.
pub(crate) const COMMON: [&str; 6] = ["shoulder", "elbow", "wrist", "hip", "knee", "ankle"];

/// What a joint may be called.
pub(crate) fn words(joint: &str) -> &'static [&'static str] {
    NAMES.iter().find(|(name, _)| *name == joint).map_or(&[], |(_, words)| words)
}

/// Small letters and digits and nothing else, without what stands before a colon.
pub(crate) fn plain(name: &str) -> String {
    let name = name.rsplit(':').next().unwrap_or(name);
    name.chars().filter(char::is_ascii_alphanumeric).map(|letter| letter.to_ascii_lowercase()).collect()
}

/// The column of a joint on a side (`left`, `right`, or none) among [`plain`] names, of those that `may` be one.
pub(crate) fn column(
    names: &[String],
    joint: &str,
    side: &str,
    may: impl Fn(usize) -> bool,
) -> Option<usize> {
    let is_named =
        |name: &str, word: &str| if side.is_empty() { name == word } else { is_sided(name, word, side) };
    words(joint).iter().find_map(|word| {
        names.iter().enumerate().position(|(index, name)| may(index) && is_named(name, word))
    })
}

/// Whether a name is a word with a side before it or behind it: `rightarm`, `humerusr`.
fn is_sided(name: &str, word: &str, side: &str) -> bool {
    let letter = &side[..1];
    name.strip_prefix(side).is_some_and(|rest| rest == word)
        || name.strip_suffix(word).is_some_and(|rest| rest == letter)
        || name.strip_prefix(word).is_some_and(|rest| rest == letter)
}

/// The columns of the [`COMMON`] joints by their anatomical names (`left knee`), as far as there are any.
pub(crate) fn common_joints(names: &[String]) -> BTreeMap<String, usize> {
    // A limb of ours is named where it ends, a bone of others where it begins: `left foot` is the toes here, an ankle there.
    let is_ours = names.iter().any(|name| matches!(name.as_str(), "left clavicle" | "left forearm"));
    let plain: Vec<String> = names.iter().map(|name| plain(name)).collect();
    let mut columns = BTreeMap::new();
    for side in ["left", "right"] {
        for joint in COMMON {
            let anatomical = format!("{side} {joint}");
            let column = if is_ours {
                // Of a limb in two parts the lower one, which comes later, ends at the joint.
                names.iter().rposition(|name| joint_at_end(name).as_ref() == Some(&anatomical))
            } else {
                column(&plain, joint, side, |_| true)
            };
            columns.extend(column.map(|column| (anatomical, column)));
        }
    }
    columns
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_are_told_before_and_behind() {
        assert!(is_sided(&plain("mixamorig:RightUpLeg"), "upleg", "right"));
        assert!(is_sided(&plain("humerus_r"), "humerus", "right"));
        assert!(is_sided(&plain("left forearm"), "forearm", "left"));
        assert!(!is_sided(&plain("LeftForeArm"), "arm", "left"));
        assert!(!is_sided(&plain("LHipJoint"), "hip", "left"));
        assert!(!is_sided(&plain("RightUpLeg"), "leg", "right"));
    }

    #[test]
    fn joints_of_several_tools_are_the_same_joints() {
        let of = |names: &str| -> Vec<(String, String)> {
            let names: Vec<String> = names.split(", ").map(str::to_owned).collect();
            common_joints(&names).into_iter().map(|(joint, column)| (joint, names[column].clone())).collect()
        };
        let told =
            |names: &str, joint: &str| of(names).into_iter().find(|(name, _)| name == joint).map(|(_, n)| n);
        assert_eq!(told("Hips, LHipJoint, LeftUpLeg, LeftLeg, LeftFoot", "left ankle").unwrap(), "LeftFoot");
        assert_eq!(told("LeftShoulder, LeftArm, LeftForeArm", "left shoulder").unwrap(), "LeftArm");
        assert_eq!(told("LeftCollar, LeftShoulder, LeftElbow", "left shoulder").unwrap(), "LeftShoulder");
        assert_eq!(told("RWrist, RHand", "right wrist").unwrap(), "RWrist");
        assert_eq!(
            told("left clavicle, left thigh, left lower thigh, left foot", "left knee").unwrap(),
            "left lower thigh"
        );
        assert_eq!(told("left clavicle, left thigh, left lower thigh, left foot", "left ankle"), None);
        assert_eq!(of("nose, r_knee_study, STER"), []);
    }
}
