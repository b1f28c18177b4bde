//! Joints and bones as other programs call them.
//!
//! A bone has the name of the limb that turns, and lies where the limb begins. A joint lies where a limb ends.

use std::collections::BTreeSet;

use backlit_tracking::body::{Model, joint_at_end, split_side};

use super::Names;

/// One limb of the full body in other programs' words.
struct BoneNames {
    /// Of the right side, or of the middle.
    limb: &'static str,
    /// `OpenSim`'s bone and joint, Mixamo's bone and joint; empty where ours is kept.
    names: [&'static str; 4],
    /// `OpenSim`'s coordinates of the limb's rotation about z, x and y on the right side, a minus before one that counts the
    /// other way; empty where there are none.
    coordinates: &'static str,
}

const fn row(limb: &'static str, names: [&'static str; 4], coordinates: &'static str) -> BoneNames {
    BoneNames { limb, names, coordinates }
}

const ROOT: &str = "root";

/// The right side; the left is made from it.
const FULL_BODY: [BoneNames; 15] = [
    row(ROOT, ["", "midHip", "", "Hips"], ""),
    row("spine", ["pelvis", "Spine", "Hips", "Spine"], "pelvis_tilt pelvis_list pelvis_rotation"),
    row("chest", ["torso", "Neck", "Spine", "Neck"], "lumbar_extension lumbar_bending lumbar_rotation"),
    row("neck", ["head", "Head", "Neck", "Head"], ""),
    row("skull", ["", "HeadTop", "", "HeadTop_End"], ""),
    row("right hip", ["", "RHip", "", "RightUpLeg"], ""),
    row("right clavicle", ["scapula_r", "RShoulder", "RightShoulder", "RightArm"], ""),
    row(
        "right upper arm",
        ["humerus_r", "RElbow", "RightArm", "RightForeArm"],
        "arm_flex_r arm_add_r arm_rot_r",
    ),
    row(
        "right forearm",
        ["ulna_r", "RWrist", "RightForeArm", "RightHand"],
        "elbow_flex_r elbow_add_r pro_sup_r",
    ),
    row("right hand", ["", "RHand", "", "RightHand_End"], ""),
    row("right thigh", ["femur_r", "", "RightUpLeg", ""], "hip_flexion_r hip_adduction_r hip_rotation_r"),
    row("right lower thigh", ["", "RKnee", "", "RightLeg"], ""),
    // The knee bends about −z.
    row("right calf", ["tibia_r", "", "RightLeg", ""], "-knee_angle_r knee_adduction_r knee_rotation_r"),
    row("right lower calf", ["", "RAnkle", "", "RightFoot"], ""),
    row(
        "right foot",
        ["calcn_r", "RBigToe", "RightFoot", "RightToe_End"],
        "ankle_angle_r subtalar_angle_r ankle_rotation_r",
    ),
];

/// A limb's row, and whether it is on the left.
fn find(model: &Model, limb: &str) -> Option<(&'static BoneNames, bool)> {
    if model.limb_index("spine").is_none() || model.limb_index("right lower calf").is_none() {
        return None; // another body
    }
    let (right, is_left) = match split_side(limb) {
        ("left ", part) => (format!("right {part}"), true),
        _ => (limb.to_owned(), false),
    };
    FULL_BODY.iter().find(|row| row.limb == right).map(|row| (row, is_left))
}

/// The same name on the other side.
fn on_the_left(name: &str) -> String {
    match (name.strip_suffix("_r"), name.strip_prefix("Right"), name.strip_prefix('R')) {
        (Some(stem), _, _) => format!("{stem}_l"),
        (_, Some(rest), _) => format!("Left{rest}"),
        (_, _, Some(rest)) => format!("L{rest}"),
        _ => name.to_owned(),
    }
}

/// What anatomy calls the joint at the end of a limb. A thigh or a calf of two limbs has its joint at the end of the lower one.
fn anatomical(model: &Model, limb: &str) -> String {
    let (side, part) = split_side(limb);
    if model.limb_index(&format!("{side}lower {part}")).is_some() {
        return format!("{side}mid {part}");
    }
    let end = || if limb == ROOT { limb.to_owned() } else { format!("{limb} end") };
    joint_at_end(limb).unwrap_or_else(end)
}

/// What other programs, or anatomy, call a bone, or the joint at a limb's end; `None` where our name stays.
fn other(model: &Model, names: Names, limb: &str, is_bone: bool) -> Option<String> {
    let first = match names {
        Names::Limbs => return None,
        Names::Anatomical => return (!is_bone).then(|| anatomical(model, limb)),
        Names::OpenSim => 0,
        Names::Mixamo => 2,
    };
    let (row, is_left) = find(model, limb)?;
    let name = row.names[first + usize::from(!is_bone)];
    if name.is_empty() {
        return None;
    }
    let name = if is_left { on_the_left(name) } else { name.to_owned() };
    Some(if names == Names::Mixamo { format!("mixamorig:{name}") } else { name })
}

/// The names of all joints: the root's, then of each limb's second joint. `plain` makes words of ours.
pub(super) fn joints(model: &Model, names: Names, plain: bool) -> Vec<String> {
    let limbs = model.limbs().iter().map(|limb| limb.name.as_str());
    let found = std::iter::once(ROOT).chain(limbs).map(|limb| {
        let name = other(model, names, limb, false).unwrap_or_else(|| limb.to_owned());
        if plain { word(&name) } else { name }
    });
    if plain { different(found) } else { found.collect() }
}

/// The name of the bone that a limb is.
pub(super) fn bone(model: &Model, names: Names, limb: &str) -> String {
    other(model, names, limb, true).unwrap_or_else(|| word(limb))
}

/// The coordinates of a limb's rotation about z, x and y, and their senses.
pub(super) fn coordinates(model: &Model, names: Names, limb: &str) -> [(String, f64); 3] {
    if names == Names::OpenSim
        && let Some((row, is_left)) = find(model, limb)
        && !row.coordinates.is_empty()
    {
        let mut words = row.coordinates.split(' ');
        return [0, 1, 2].map(|index| {
            let word = words.next().unwrap_or_default();
            let (name, sense) = word.strip_prefix('-').map_or((word, 1.0), |name| (name, -1.0));
            // On the left, turns out of the plane of walking count the other way, as if seen in a mirror.
            let is_mirrored = is_left && index > 0;
            let name = if is_left { on_the_left(name) } else { name.to_owned() };
            (name, if is_mirrored { -sense } else { sense })
        });
    }
    let bone = bone(model, names, limb);
    ["z", "x", "y"].map(|axis| (format!("{bone}_{axis}"), 1.0))
}

/// Letters, digits and little else: what every program takes as one word.
pub(super) fn word(name: &str) -> String {
    name.chars().map(|c| if c.is_alphanumeric() || "-_.:".contains(c) { c } else { '_' }).collect()
}

/// Names that became the same are numbered.
pub(super) fn different(names: impl Iterator<Item = String>) -> Vec<String> {
    let mut taken = BTreeSet::new();
    names
        .map(|name| {
            let mut free = name.clone();
            let mut number = 2;
            while !taken.insert(free.clone()) {
                free = format!("{name}_{number}");
                number += 1;
            }
            free
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin;

    use super::*;

    #[test]
    fn both_sides_have_names_and_no_two_are_the_same() {
        let body = builtin::full_body();
        for names in [Names::Anatomical, Names::Limbs, Names::OpenSim, Names::Mixamo] {
            let joints = joints(&body, names, true);
            assert_eq!(joints.iter().collect::<BTreeSet<_>>().len(), 31, "{joints:?}");
        }
        let joints = joints(&body, Names::OpenSim, true);
        assert!(joints.contains(&"RKnee".to_owned()) && joints.contains(&"LKnee".to_owned()), "{joints:?}");
        let ours = super::joints(&body, Names::Anatomical, true);
        for name in
            ["right_elbow", "left_knee", "right_mid_thigh", "left_ankle", "left_wrist", "skull_end", "root"]
        {
            assert!(ours.contains(&name.to_owned()), "{name} of {ours:?}");
        }
        assert_eq!(bone(&body, Names::Anatomical, "left thigh"), "left_thigh");
        assert_eq!(bone(&body, Names::Mixamo, "left thigh"), "mixamorig:LeftUpLeg");
        let [flexion, adduction, _] = coordinates(&body, Names::OpenSim, "left thigh");
        assert_eq!(flexion, ("hip_flexion_l".to_owned(), 1.0));
        assert_eq!(adduction, ("hip_adduction_l".to_owned(), -1.0));
        assert_eq!(bone(&builtin::upper_body(), Names::Mixamo, "a b"), "a_b");
        let same = ["a", "a", "a_2"].map(str::to_owned).into_iter();
        assert_eq!(different(same), ["a", "a_2", "a_2_2"]);
    }
}
