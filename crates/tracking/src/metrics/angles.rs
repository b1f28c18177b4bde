//! Angles of joints as clinicians name them, from the places of joints alone.
//!
//! With p the places of joints, r the unit vector from the left hip (shoulder) to the right one, u the direction from the middle of
//! the hips to the middle of the shoulders without its part along r, and f = u × r, which points forwards:
//!
//! - knee and elbow: π − the angle between both limbs, 0 when straight;
//! - hip and shoulder: atan2(d·f, −d·u), where d points along the thigh (upper arm); 0 when it hangs beside the trunk, positive
//!   forwards. It is flexion in the sagittal plane of the trunk, in the sense of the recommendations of the ISB (Wu et al.,
//!   Journal of Biomechanics 35, 2002 and 38, 2005), without the axes that they take from markers on bones.

use glam::DVec3;

/// A limb this near to the axis from left to right, as the length of its part across, has no flexion that could be measured: 15°.
const LEAST_ACROSS: f64 = 0.26;

/// An angle of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[expect(missing_docs, reason = "the names say what each is")]
pub enum JointAngle {
    LeftHip,
    RightHip,
    LeftKnee,
    RightKnee,
    LeftShoulder,
    RightShoulder,
    LeftElbow,
    RightElbow,
}

impl JointAngle {
    /// All of them, in the order in which they are shown.
    pub const ALL: [Self; 8] = [
        Self::LeftHip,
        Self::RightHip,
        Self::LeftKnee,
        Self::RightKnee,
        Self::LeftShoulder,
        Self::RightShoulder,
        Self::LeftElbow,
        Self::RightElbow,
    ];

    /// What it is called: `left knee flexion`.
    #[must_use]
    pub fn label(self) -> &'static str {
        match self {
            Self::LeftHip => "left hip flexion",
            Self::RightHip => "right hip flexion",
            Self::LeftKnee => "left knee flexion",
            Self::RightKnee => "right knee flexion",
            Self::LeftShoulder => "left shoulder flexion",
            Self::RightShoulder => "right shoulder flexion",
            Self::LeftElbow => "left elbow flexion",
            Self::RightElbow => "right elbow flexion",
        }
    }

    /// The coordinate of `OpenSim`'s models with the same meaning, as most models spell it and as others do.
    #[must_use]
    pub fn opensim(self) -> [&'static str; 2] {
        match self {
            Self::LeftHip => ["hip_flexion_l", "l_hip_flexion"],
            Self::RightHip => ["hip_flexion_r", "r_hip_flexion"],
            Self::LeftKnee => ["knee_angle_l", "knee_flexion_l"],
            Self::RightKnee => ["knee_angle_r", "knee_flexion_r"],
            Self::LeftShoulder => ["arm_flex_l", "shoulder_flexion_l"],
            Self::RightShoulder => ["arm_flex_r", "shoulder_flexion_r"],
            Self::LeftElbow => ["elbow_flex_l", "elbow_flexion_l"],
            Self::RightElbow => ["elbow_flex_r", "elbow_flexion_r"],
        }
    }

    /// The angle, radians, of joints whose places `at` tells by their anatomical names (`left hip`, `right elbow` …), metres or any
    /// other unit. `None` where a joint is not known, two lie at the same place, or the limb points to the side.
    pub fn measure(self, at: impl Fn(&str) -> Option<DVec3>) -> Option<f64> {
        let on = |side: &str, joint: &str| at(&format!("{side} {joint}"));
        match self {
            Self::LeftHip => flexion(&at, "hip", on("left", "hip")?, on("left", "knee")?),
            Self::RightHip => flexion(&at, "hip", on("right", "hip")?, on("right", "knee")?),
            Self::LeftShoulder => flexion(&at, "shoulder", on("left", "shoulder")?, on("left", "elbow")?),
            Self::RightShoulder => flexion(&at, "shoulder", on("right", "shoulder")?, on("right", "elbow")?),
            Self::LeftKnee => bend(["hip", "knee", "ankle"].map(|joint| on("left", joint))),
            Self::RightKnee => bend(["hip", "knee", "ankle"].map(|joint| on("right", joint))),
            Self::LeftElbow => bend(["shoulder", "elbow", "wrist"].map(|joint| on("left", joint))),
            Self::RightElbow => bend(["shoulder", "elbow", "wrist"].map(|joint| on("right", joint))),
        }
    }
}

/// How far a hinge is bent.
fn bend([above, hinge, below]: [Option<DVec3>; 3]) -> Option<f64> {
    let (upper, lower) = ((hinge? - above?).try_normalize()?, (below? - hinge?).try_normalize()?);
    // Exact near 0 too, where the arc cosine is not.
    Some(upper.cross(lower).length().atan2(upper.dot(lower)))
}

/// How far a limb from `joint` to `end` is turned forwards from hanging, in the trunk whose axis from left to right goes through
/// both `lateral` joints.
fn flexion(at: &impl Fn(&str) -> Option<DVec3>, lateral: &str, joint: DVec3, end: DVec3) -> Option<f64> {
    let both = |name: &str| Some([at(&format!("left {name}"))?, at(&format!("right {name}"))?]);
    let middle = |[left, right]: [DVec3; 2]| (left + right) / 2.0;
    let [left, right] = both(lateral)?;
    let right = (right - left).try_normalize()?;
    let up = (middle(both("shoulder")?) - middle(both("hip")?)).reject_from_normalized(right);
    let up = up.try_normalize()?;
    let along = (end - joint).try_normalize()?;
    let [forwards, upwards] = [along.dot(up.cross(right)), along.dot(up)];
    (forwards.hypot(upwards) >= LEAST_ACROSS).then(|| forwards.atan2(-upwards))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A person who looks along y, z up: the joint of a name, with one joint elsewhere.
    fn standing(name: &str) -> Option<DVec3> {
        let (side, joint) = name.split_once(' ')?;
        let x = if side == "left" { -0.15 } else { 0.15 };
        let z = match joint {
            "hip" => 0.9,
            "knee" => 0.5,
            "ankle" => 0.1,
            "shoulder" => 1.4,
            "elbow" => 1.1,
            "wrist" => 0.85,
            _ => return None,
        };
        Some(DVec3::new(x, 0.0, z))
    }

    fn with(moved: &'static str, to: DVec3) -> impl Fn(&str) -> Option<DVec3> {
        move |name| if name == moved { Some(to) } else { standing(name) }
    }

    #[test]
    fn who_stands_has_no_flexion() {
        for angle in JointAngle::ALL {
            assert!(angle.measure(standing).unwrap().abs() < 1e-12, "{}", angle.label());
        }
    }

    #[test]
    fn flexion_is_positive_forwards_in_any_axes() {
        let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.4, -1.1, 2.0);
        let measure = |angle: JointAngle, moved, to| {
            let at = with(moved, to);
            angle.measure(|name| Some(turn * at(name)? * 1000.0 + DVec3::X)).unwrap().to_degrees()
        };
        let (y, z) = (DVec3::Y, DVec3::Z);
        let hip = DVec3::new(-0.15, 0.0, 0.9);
        let forty = 40_f64.to_radians();
        let knee = hip + 0.4 * (forty.sin() * y - forty.cos() * z);
        assert!((measure(JointAngle::LeftHip, "left knee", knee) - 40.0).abs() < 1e-9);
        let back = hip + 0.4 * (-forty.sin() * y - forty.cos() * z);
        assert!((measure(JointAngle::LeftHip, "left knee", back) + 40.0).abs() < 1e-9);
        let raised = DVec3::new(0.15, 0.3, 1.4);
        assert!((measure(JointAngle::RightShoulder, "right elbow", raised) - 90.0).abs() < 1e-9);
        let wrist = DVec3::new(0.15, 0.25, 1.1);
        assert!((measure(JointAngle::RightElbow, "right wrist", wrist) - 90.0).abs() < 1e-9);
        let ankle = DVec3::new(-0.15, -0.4, 0.5);
        assert!((measure(JointAngle::LeftKnee, "left ankle", ankle) - 90.0).abs() < 1e-9);
    }

    #[test]
    fn what_cannot_be_measured_is_not() {
        let aside = with("left elbow", DVec3::new(-0.5, 0.0, 1.4));
        assert_eq!(JointAngle::LeftShoulder.measure(aside), None);
        let without = |name: &str| standing(name).filter(|_| name != "right knee");
        assert_eq!(JointAngle::RightHip.measure(without), None);
        assert!(JointAngle::LeftHip.measure(without).is_some());
        assert_eq!(JointAngle::RightKnee.measure(with("right knee", DVec3::new(0.15, 0.0, 0.9))), None);
    }
}
