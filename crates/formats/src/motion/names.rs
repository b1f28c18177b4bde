//! Joints and bones as other programs call them.
//!
//! A bone has the name of the limb that turns, and lies where the limb begins. A joint has the name of the limb that
//! ends there, as everywhere in this program.

use std::collections::BTreeSet;

use backlit_tracking::body::Model;

use super::Names;

/// One limb of the full body in other programs' words; `None` keeps ours.
struct BoneNames {
    /// Of the right side, or of the middle.
    limb: &'static str,
    opensim_bone: Option<&'static str>,
    opensim_joint: Option<&'static str>,
    mixamo_bone: Option<&'static str>,
    mixamo_joint: Option<&'static str>,
    /// Coordinates of the limb's rotation: about z, x, y, and the sense of each on the right side.
    coordinates: Option<[(&'static str, f64); 3]>,
}

const fn row(
    limb: &'static str,
    [opensim_bone, opensim_joint]: [Option<&'static str>; 2],
    [mixamo_bone, mixamo_joint]: [Option<&'static str>; 2],
    coordinates: Option<[(&'static str, f64); 3]>,
) -> BoneNames {
    BoneNames { limb, opensim_bone, opensim_joint, mixamo_bone, mixamo_joint, coordinates }
}

const ROOT: &str = "root";

/// The right side; the left is made from it.
const FULL_BODY: [BoneNames; 15] = [
    row(ROOT, [None, Some("midHip")], [None, Some("Hips")], None),
    row(
        "spine",
        [Some("pelvis"), Some("Spine")],
        [Some("Hips"), Some("Spine")],
        Some([("pelvis_tilt", 1.0), ("pelvis_list", 1.0), ("pelvis_rotation", 1.0)]),
    ),
    row(
        "chest",
        [Some("torso"), Some("Neck")],
        [Some("Spine"), Some("Neck")],
        Some([("lumbar_extension", 1.0), ("lumbar_bending", 1.0), ("lumbar_rotation", 1.0)]),
    ),
    row("neck", [Some("head"), Some("Head")], [Some("Neck"), Some("Head")], None),
    row("skull", [None, Some("HeadTop")], [None, Some("HeadTop_End")], None),
    row("right hip", [None, Some("RHip")], [None, Some("RightUpLeg")], None),
    row(
        "right clavicle",
        [Some("scapula_r"), Some("RShoulder")],
        [Some("RightShoulder"), Some("RightArm")],
        None,
    ),
    row(
        "right upper arm",
        [Some("humerus_r"), Some("RElbow")],
        [Some("RightArm"), Some("RightForeArm")],
        Some([("arm_flex_r", 1.0), ("arm_add_r", 1.0), ("arm_rot_r", 1.0)]),
    ),
    row(
        "right forearm",
        [Some("ulna_r"), Some("RWrist")],
        [Some("RightForeArm"), Some("RightHand")],
        Some([("elbow_flex_r", 1.0), ("elbow_add_r", 1.0), ("pro_sup_r", 1.0)]),
    ),
    row("right hand", [None, Some("RHand")], [None, Some("RightHand_End")], None),
    row(
        "right thigh",
        [Some("femur_r"), None],
        [Some("RightUpLeg"), None],
        Some([("hip_flexion_r", 1.0), ("hip_adduction_r", 1.0), ("hip_rotation_r", 1.0)]),
    ),
    row("right lower thigh", [None, Some("RKnee")], [None, Some("RightLeg")], None),
    row(
        "right calf",
        [Some("tibia_r"), None],
        [Some("RightLeg"), None],
        // The knee bends about −z.
        Some([("knee_angle_r", -1.0), ("knee_adduction_r", 1.0), ("knee_rotation_r", 1.0)]),
    ),
    row("right lower calf", [None, Some("RAnkle")], [None, Some("RightFoot")], None),
    row(
        "right foot",
        [Some("calcn_r"), Some("RBigToe")],
        [Some("RightFoot"), Some("RightToe_End")],
        Some([("ankle_angle_r", 1.0), ("subtalar_angle_r", 1.0), ("ankle_rotation_r", 1.0)]),
    ),
];

/// A limb's row, and whether it is on the left.
fn find(model: &Model, limb: &str) -> Option<(&'static BoneNames, bool)> {
    if model.limb_index("spine").is_none() || model.limb_index("right lower calf").is_none() {
        return None; // another body
    }
    let (right, is_left) = match limb.strip_prefix("left ") {
        Some(rest) => (format!("right {rest}"), true),
        None => (limb.to_owned(), false),
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

fn other(model: &Model, names: Names, limb: &str, is_bone: bool) -> Option<String> {
    let (row, is_left) = find(model, limb)?;
    let name = match (names, is_bone) {
        (Names::Ours, _) => None,
        (Names::OpenSim, true) => row.opensim_bone,
        (Names::OpenSim, false) => row.opensim_joint,
        (Names::Mixamo, true) => row.mixamo_bone,
        (Names::Mixamo, false) => row.mixamo_joint,
    }?;
    let name = if is_left { on_the_left(name) } else { name.to_owned() };
    Some(if names == Names::Mixamo { format!("mixamorig:{name}") } else { name })
}

/// The names of all joints: the root's, then of each limb's second joint. `plain` makes words of ours.
pub(super) fn joints(model: &Model, names: Names, plain: bool) -> Vec<String> {
    let limbs = model.limbs().iter().map(|limb| limb.name.as_str());
    let found = std::iter::once(ROOT).chain(limbs).map(|limb| {
        other(model, names, limb, false).unwrap_or_else(|| if plain { word(limb) } else { limb.to_owned() })
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
        && let Some(coordinates) = row.coordinates
    {
        // On the left, turns out of the plane of walking count the other way, as if seen in a mirror.
        let mut index = 0;
        return coordinates.map(|(name, sense)| {
            let mirrored = is_left && index > 0;
            index += 1;
            let name = if is_left { on_the_left(name) } else { name.to_owned() };
            (name, if mirrored { -sense } else { sense })
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
        for names in [Names::Ours, Names::OpenSim, Names::Mixamo] {
            let joints = joints(&body, names, true);
            assert_eq!(joints.iter().collect::<BTreeSet<_>>().len(), 31, "{joints:?}");
        }
        let joints = joints(&body, Names::OpenSim, true);
        assert!(joints.contains(&"RKnee".to_owned()) && joints.contains(&"LKnee".to_owned()), "{joints:?}");
        assert_eq!(bone(&body, Names::Mixamo, "left thigh"), "mixamorig:LeftUpLeg");
        let [flexion, adduction, _] = coordinates(&body, Names::OpenSim, "left thigh");
        assert_eq!(flexion, ("hip_flexion_l".to_owned(), 1.0));
        assert_eq!(adduction, ("hip_adduction_l".to_owned(), -1.0));
        assert_eq!(bone(&builtin::upper_body(), Names::Mixamo, "a b"), "a_b");
        let same = ["a", "a", "a_2"].map(str::to_owned).into_iter();
        assert_eq!(different(same), ["a", "a_2", "a_2_2"]);
    }
}
