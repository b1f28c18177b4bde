//! A two-second movement with known joints: step forward, reach round, crouch, rise with raised arms.
//!
//! Key poses give the pelvis, the trunk and the arms as joint angles, and the feet as places on the floor;
//! the legs follow by the law of cosines. Between keys every number goes by a monotone cubic (F. N. Fritsch
//! and R. E. Carlson, 1980), so that nothing overshoots its keys and a planted foot stays where it is.

use backlit_tracking::body::{JointAngles, Model, Pose};
use glam::{DMat3, DQuat, DVec3};

/// Frames of the movement.
pub const FRAMES: usize = 60;
/// Frames a second.
pub const FRAME_RATE: f64 = 30.0;
/// The ankle's height above the floor when the foot stands flat, metres.
pub(super) const ANKLE_HEIGHT: f64 = 0.098;

/// One key pose, degrees and metres.
struct Key {
    frame: f64,
    /// Root: right, forward, height. Pelvis: turn to the left, lean forward, lean to the right. Chest on the pelvis, and head
    /// on the chest: flexion, lean to the left, turn to the left.
    trunk: [[f64; 3]; 4],
    /// Right and left arm, both sides alike. Clavicle: up, back. Upper arm: raised forward, raised outward, turned inward.
    /// Elbow. Turn of the forearm.
    arms: [[f64; 7]; 2],
    /// Right and left foot: right, forward and height of the ankle, how far it is turned outward and pitched up.
    feet: [[f64; 5]; 2],
}

const NUMBERS: usize = 36;

const KEYS: [Key; 7] = [
    Key {
        frame: 0.0,
        trunk: [[0.0, -0.12, 0.915], [4.0, 2.0, 0.0], [4.0, 0.0, 3.0], [2.0, 0.0, 4.0]],
        arms: [[0.0, 0.0, 8.0, 36.0, 5.0, 18.0, 5.0], [0.0, 0.0, 2.0, 40.0, 0.0, 22.0, 0.0]],
        feet: [[0.13, -0.14, 0.0, 8.0, 0.0], [-0.13, -0.12, 0.0, 8.0, 0.0]],
    },
    Key {
        frame: 9.0,
        trunk: [[0.03, 0.0, 0.905], [-6.0, 5.0, 3.0], [6.0, 3.0, -8.0], [3.0, 0.0, 8.0]],
        arms: [[2.0, -4.0, 34.0, 34.0, 5.0, 34.0, 10.0], [0.0, 4.0, -8.0, 52.0, 0.0, 26.0, 0.0]],
        feet: [[0.13, -0.14, 0.0, 8.0, 0.0], [-0.12, 0.08, 0.12, 4.0, 4.0]],
    },
    Key {
        frame: 18.0,
        trunk: [[-0.01, 0.06, 0.86], [10.0, 7.0, 0.0], [8.0, -3.0, 16.0], [-4.0, 2.0, -4.0]],
        arms: [[8.0, -12.0, 74.0, 26.0, 10.0, 44.0, 20.0], [4.0, 8.0, -6.0, 66.0, -10.0, 34.0, -10.0]],
        feet: [[0.13, -0.14, 0.0, 8.0, 0.0], [-0.13, 0.27, 0.0, 10.0, 0.0]],
    },
    Key {
        frame: 28.0,
        trunk: [[-0.04, 0.1, 0.80], [24.0, 9.0, 2.0], [9.0, -4.0, 38.0], [-10.0, 4.0, -20.0]],
        arms: [[16.0, -18.0, 106.0, 18.0, 10.0, 16.0, 20.0], [10.0, 12.0, -14.0, 84.0, -20.0, 44.0, -15.0]],
        feet: [[0.135, -0.103, 0.06, 10.0, -24.0], [-0.13, 0.27, 0.0, 10.0, 0.0]],
    },
    Key {
        frame: 41.0,
        trunk: [[0.0, 0.05, 0.71], [8.0, 20.0, 0.0], [22.0, 0.0, 6.0], [-24.0, 0.0, 0.0]],
        arms: [[8.0, -8.0, 70.0, 54.0, 4.0, 28.0, 12.0], [6.0, -2.0, 24.0, 79.0, -2.0, 35.0, 3.0]],
        feet: [[0.135, -0.103, 0.06, 10.0, -24.0], [-0.13, 0.27, 0.0, 10.0, 0.0]],
    },
    Key {
        frame: 51.0,
        trunk: [[0.01, 0.1, 0.84], [0.0, 8.0, 0.0], [8.0, 0.0, 0.0], [-12.0, 0.0, 0.0]],
        arms: [[16.0, 0.0, 66.0, 96.0, 0.0, 40.0, 5.0], [16.0, 2.0, 58.0, 100.0, 0.0, 34.0, 0.0]],
        feet: [[0.145, 0.02, 0.075, 12.0, -10.0], [-0.13, 0.27, 0.0, 10.0, 0.0]],
    },
    Key {
        frame: 59.0,
        trunk: [[0.01, 0.16, 0.9], [-3.0, 1.0, 0.0], [-6.0, 0.0, -3.0], [-12.0, 0.0, 2.0]],
        arms: [[26.0, 2.0, 60.0, 128.0, 0.0, 16.0, 0.0], [26.0, 2.0, 54.0, 122.0, 0.0, 12.0, 0.0]],
        feet: [[0.15, 0.1, 0.0, 12.0, 0.0], [-0.13, 0.27, 0.0, 10.0, 0.0]],
    },
];

impl Key {
    fn numbers(&self) -> [f64; NUMBERS] {
        let parts = [self.trunk.as_flattened(), self.arms.as_flattened(), self.feet.as_flattened()];
        let mut numbers = [0.0; NUMBERS];
        numbers.iter_mut().zip(parts.concat()).for_each(|(number, part)| *number = part);
        numbers
    }
}

/// The movement's true pose at a frame (0 to [`FRAMES`] − 1; fractions allowed, the ends hold beyond).
///
/// `model` is to be the built-in full body or one of other sizes with the same limb names; limbs that it
/// lacks stay out. Guaranteed: within the joint limits for the built-in body, and the same for the same frame.
#[must_use]
pub fn pose(model: &Model, frame: f64) -> Pose {
    let numbers = interpolate(frame);
    let mut pose = Pose::rest(model);
    pose.root = DVec3::from_slice(&numbers[0..3]);
    let [turn, lean, aside] = [3, 4, 5].map(|at: usize| numbers[at].to_radians());
    let pelvis = DQuat::from_rotation_z(turn) * DQuat::from_rotation_x(-lean) * DQuat::from_rotation_y(aside);
    set(model, &mut pose, "spine", pelvis);
    for (name, at) in [("chest", 6), ("neck", 9)] {
        set_angles(model, &mut pose, name, [numbers[at], numbers[at + 1], numbers[at + 2]]);
    }
    for (side, sign, at) in [("right", 1.0, 12), ("left", -1.0, 19)] {
        let angle = &numbers[at..at + 7];
        // Angles are mirrored: outward swing and inward turn change sign on the left.
        let mut joint = |limb: &str, angles| set_angles(model, &mut pose, &format!("{side} {limb}"), angles);
        joint("clavicle", [angle[0], sign * angle[1], 0.0]);
        joint("upper arm", [angle[2], sign * angle[3], -sign * angle[4]]);
        joint("forearm", [angle[5], 0.0, -sign * angle[6]]);
    }
    for (side, sign, at) in [("right", 1.0, 26), ("left", -1.0, 31)] {
        let foot = &numbers[at..at + 5];
        let ankle = DVec3::new(foot[0], foot[1], ANKLE_HEIGHT + foot[2]);
        let flat = DQuat::from_rotation_z(-sign * foot[3].to_radians())
            * DQuat::from_rotation_x(foot[4].to_radians());
        place_leg(model, &mut pose, side, ankle, flat);
    }
    pose
}

pub(super) fn set(model: &Model, pose: &mut Pose, limb: &str, rotation: DQuat) {
    if let Some(index) = model.limb_index(limb) {
        pose.rotations[model.limbs()[index].rotation] = rotation;
    }
}

pub(super) fn set_angles(model: &Model, pose: &mut Pose, name: &str, degrees: [f64; 3]) {
    if let Some(index) = model.limb_index(name) {
        let limb = &model.limbs()[index];
        let [flexion, sideways, twist] = degrees.map(f64::to_radians);
        pose.rotations[limb.rotation] = limb.rotation_from_angles(JointAngles { flexion, sideways, twist });
    }
}

/// Bends hip and knee so that the ankle comes to a place, or as near as the leg reaches, and sets the foot.
pub(super) fn place_leg(model: &Model, pose: &mut Pose, side: &str, ankle: DVec3, foot_in_world: DQuat) {
    let length = |limb: &str| {
        model.limb_index(&format!("{side} {limb}")).map_or(0.0, |index| model.limbs()[index].length)
    };
    let (thigh, calf) = (length("thigh") + length("lower thigh"), length("calf") + length("lower calf"));
    let Some(hip_limb) = model.limb_index(&format!("{side} hip")) else { return };
    let pelvis = pose.rotations[model.limbs()[hip_limb].rotation];
    let hip = pose.root + pelvis * (model.limbs()[hip_limb].direction * model.limbs()[hip_limb].length);
    let reach = (ankle - hip).length().clamp((thigh - calf).abs() + 1e-3, (thigh + calf) * 0.9999);
    let down = (ankle - hip).normalize_or(DVec3::NEG_Z);
    // The knee points between where the pelvis and where the foot point.
    let forward = (pelvis * DVec3::Y + foot_in_world * DVec3::Y).reject_from(down).normalize_or(DVec3::Y);
    let cosine =
        |a: f64, b: f64, opposite: f64| ((a * a + b * b - opposite * opposite) / (2.0 * a * b)).acos();
    let at_hip = cosine(thigh, reach, calf);
    let knee = std::f64::consts::PI - cosine(thigh, calf, reach);
    let bone = down * at_hip.cos() + forward * at_hip.sin();
    let right = forward.cross(-down).normalize();
    let thigh_in_world =
        DQuat::from_mat3(&DMat3::from_cols(right, (-bone).cross(right).normalize(), -bone)).normalize();
    let calf_rotation = DQuat::from_rotation_x(-knee);
    set(model, pose, &format!("{side} thigh"), pelvis.inverse() * thigh_in_world);
    set(model, pose, &format!("{side} calf"), calf_rotation);
    let foot = (thigh_in_world * calf_rotation).inverse() * foot_in_world;
    set(model, pose, &format!("{side} foot"), foot.normalize());
}

fn interpolate(frame: f64) -> [f64; NUMBERS] {
    let last = KEYS.len() - 1;
    let frame = frame.clamp(KEYS[0].frame, KEYS[last].frame);
    let segment = KEYS[1..last].iter().take_while(|key| key.frame <= frame).count();
    let numbers: Vec<[f64; NUMBERS]> = KEYS.iter().map(Key::numbers).collect();
    let width = KEYS[segment + 1].frame - KEYS[segment].frame;
    let t = (frame - KEYS[segment].frame) / width;
    let (t2, t3) = (t * t, t * t * t);
    std::array::from_fn(|which| {
        let slope = |key: usize| monotone_slope(&numbers, key, which) * width;
        (2.0 * t3 - 3.0 * t2 + 1.0) * numbers[segment][which]
            + (t3 - 2.0 * t2 + t) * slope(segment)
            + (3.0 * t2 - 2.0 * t3) * numbers[segment + 1][which]
            + (t3 - t2) * slope(segment + 1)
    })
}

/// The slope at a key: zero at turning points and at the ends, else the weighted harmonic mean beside it.
fn monotone_slope(numbers: &[[f64; NUMBERS]], key: usize, which: usize) -> f64 {
    if key == 0 || key + 1 == numbers.len() {
        return 0.0;
    }
    let (before, after) = (KEYS[key].frame - KEYS[key - 1].frame, KEYS[key + 1].frame - KEYS[key].frame);
    let rise = (numbers[key][which] - numbers[key - 1][which]) / before;
    let next = (numbers[key + 1][which] - numbers[key][which]) / after;
    if rise * next <= 0.0 {
        return 0.0;
    }
    let (a, b) = (2.0 * after + before, after + 2.0 * before);
    (a + b) / (a / rise + b / next)
}

#[cfg(test)]
pub(super) mod tests {
    use std::sync::Arc;

    use backlit_tracking::body::{Kinematics, builtin};
    use backlit_tracking::camera::Camera;

    use super::*;

    /// What a movement must keep to: joint limits, but for some radians; a distance from the edges of the cameras' pictures,
    /// pixels; the greatest speed of a joint, m/s.
    pub(in super::super) fn check_movement(
        pose: impl Fn(&Model, f64) -> Pose,
        [frames, rate]: [f64; 2],
        beyond_limits: f64,
        cameras: &[Arc<Camera>],
        margin_px: f64,
        fastest: f64,
    ) {
        let model = builtin::full_body();
        let (mut failures, mut before) = (Vec::new(), None::<Kinematics>);
        for frame in 0..frames as usize {
            let pose = pose(&model, frame as f64);
            pose.check(&model).unwrap();
            for (rotation, &owner) in model.rotation_owners().iter().enumerate() {
                let limb = &model.limbs()[owner];
                let Some(limits) = limb.limits else { continue };
                let angles = limb.angles(pose.rotations[rotation]);
                let excess = limits.flexion.excess(angles.flexion).abs()
                    + limits.sideways.excess(angles.sideways).abs()
                    + limits.twist.excess(angles.twist).abs();
                if excess > beyond_limits {
                    failures.push(format!("frame {frame}: {} {angles:?}", limb.name));
                }
            }
            let joints = Kinematics::new(&model, &pose);
            for (index, (limb, end)) in model.limbs().iter().zip(joints.ends()).enumerate() {
                for camera in cameras {
                    let at = camera.project(*end).unwrap();
                    let inside = |at: f64, side: usize| (margin_px..side as f64 - margin_px).contains(&at);
                    if !(inside(at.x, camera.width()) && inside(at.y, camera.height())) {
                        failures.push(format!("frame {frame}: {} at {at} of {}", limb.name, camera.name()));
                    }
                }
                let moved = before.as_ref().map_or(0.0, |before| before.ends()[index].distance(*end));
                if moved * rate > fastest {
                    failures.push(format!("frame {frame}: {} leaps {moved:.2} m", limb.name));
                }
            }
            before = Some(joints);
        }
        assert!(failures.is_empty(), "{}", failures.join("\n"));
    }

    #[test]
    fn every_joint_stays_within_its_limits_and_none_leaps() {
        check_movement(pose, [FRAMES as f64, FRAME_RATE], 0.0, &[], 0.0, 4.0);
    }

    #[test]
    fn a_planted_foot_does_not_slide() {
        let model = builtin::full_body();
        for (side, frames) in [("right", 0..20), ("left", 19..60)] {
            let ankle = model.limb_index(&format!("{side} lower calf")).unwrap();
            let at = |frame: usize| Kinematics::new(&model, &pose(&model, frame as f64)).ends()[ankle];
            for frame in frames.clone() {
                let moved = at(frame).distance(at(frames.start));
                assert!(moved < 2e-3, "{side} foot slid {moved:.4} m by frame {frame}");
            }
        }
    }
}
