//! A short sequence of different motions: a walk, two squats, signals with the arms, boxing. Names of motions are tried on it.

use std::f64::consts::TAU;
use std::sync::Arc;

use backlit_tracking::body::{Model, Pose};
use backlit_tracking::camera::{Camera, CameraError};
use glam::{DQuat, DVec3};

use super::motion::{ANKLE_HEIGHT, place_leg, set, set_angles};
use super::studio::pinhole;

/// Frames a second.
pub const FRAME_RATE: f64 = 20.0;
/// When each part begins, seconds, and when the last one ends.
const BEGINS: [f64; 4] = [0.0, 3.0, 6.6, 9.4];
/// Length of the whole sequence, seconds.
pub const SECONDS: f64 = 12.4;
/// One part becomes the next in this many seconds.
const BLEND: f64 = 0.5;

/// Metres a second of the walk, and seconds of two of its steps.
const SPEED: f64 = 1.15;
const STRIDE_S: f64 = 1.05;
/// Part of it in which a foot stands.
const STANCE: f64 = 0.56;
/// Where the walk ends.
const STOP: f64 = 0.3;
/// Seconds of a squat, of a signal and of two blows.
const SQUAT_S: f64 = 1.8;
const SIGNAL_S: f64 = 1.4;
const BLOWS_S: f64 = 0.9;

/// Where the cameras stand: degrees from straight ahead to the subject's right, metres from where the walk ends, height.
const PLACES: [(f64, f64, f64); 3] = [(35.0, 4.3, 1.5), (-62.0, 4.1, 1.9), (160.0, 6.2, 1.6)];
/// What they look at.
const TARGET: DVec3 = DVec3::new(0.0, -0.55, 0.9);
/// Focal length, in picture heights.
const FOCAL: f64 = 1.15;

/// Most cameras of [`cameras`].
pub const MOST_CAMERAS: usize = PLACES.len();

/// The first `count` cameras that see all of it, three at most.
///
/// # Errors
/// A size that no camera can have.
pub fn cameras(count: usize, size_px: [u64; 2]) -> Result<Vec<Arc<Camera>>, CameraError> {
    let focal = FOCAL * size_px[1] as f64;
    let place = |(index, (degrees, distance, height)): (usize, &(f64, f64, f64))| {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let centre = DVec3::new(sine * distance, STOP - 0.8 + cosine * distance, *height);
        pinhole(&format!("cam{}", index + 1), size_px, focal, [centre, TARGET], DVec3::Z)
    };
    PLACES.iter().take(count).enumerate().map(place).collect()
}

/// The true pose at a time in seconds; the ends hold beyond.
///
/// `model` is to be the built-in full body or one of other sizes with its limb names.
#[must_use]
pub fn pose(model: &Model, seconds: f64) -> Pose {
    let seconds = seconds.clamp(0.0, SECONDS);
    let part = BEGINS.iter().rposition(|begin| seconds >= *begin).unwrap_or(0);
    let of = |part: usize| {
        let since = seconds - BEGINS[part];
        match part {
            0 => walk(model, seconds),
            1 => squat(model, since),
            2 => signal(model, since),
            _ => blows(model, since),
        }
    };
    let share = ((seconds - BEGINS[part]) / BLEND).min(1.0);
    if part == 0 || share >= 1.0 {
        return of(part);
    }
    let share = share * share * (3.0 - 2.0 * share);
    let (mut pose, after) = (of(part - 1), of(part));
    pose.root = pose.root.lerp(after.root, share);
    for (rotation, after) in pose.rotations.iter_mut().zip(&after.rotations) {
        *rotation = rotation.slerp(*after, share);
    }
    pose
}

/// One arm's angles, degrees, both sides alike.
#[derive(Debug, Clone, Copy)]
pub(super) struct Arm {
    pub(super) raised: f64,
    pub(super) out: f64,
    pub(super) turned: f64,
    pub(super) elbow: f64,
}

impl Arm {
    /// This share of the way to another place.
    pub(super) fn towards(self, other: Self, share: f64) -> Self {
        let blend = |a: f64, b: f64| a + (b - a) * share;
        Self {
            raised: blend(self.raised, other.raised),
            out: blend(self.out, other.out),
            turned: blend(self.turned, other.turned),
            elbow: blend(self.elbow, other.elbow),
        }
    }

    fn pose(self, model: &Model, pose: &mut Pose, side: &str) {
        let sign = if side == "right" { 1.0 } else { -1.0 };
        let angles = [self.raised, sign * self.out, -sign * self.turned];
        set_angles(model, pose, &format!("{side} upper arm"), angles);
        set_angles(model, pose, &format!("{side} forearm"), [self.elbow, 0.0, 0.0]);
    }
}

/// Who stands, sways a little, and holds the arms so.
pub(super) fn standing(model: &Model, seconds: f64, right: Arm, left: Arm) -> Pose {
    let sway = (1.3 * seconds).sin();
    let mut pose = Pose::rest(model);
    pose.root = DVec3::new(0.012 * sway, 0.0, 0.912);
    set(model, &mut pose, "spine", DQuat::from_rotation_z(0.05 * sway) * DQuat::from_rotation_x(-0.04));
    set_angles(model, &mut pose, "chest", [3.0, 1.5 * sway, 2.0 * sway]);
    right.pose(model, &mut pose, "right");
    left.pose(model, &mut pose, "left");
    plant(model, &mut pose, 0.0);
    pose
}

/// A walk that ends at [`STOP`]; feet that stand do not slide.
fn walk(model: &Model, seconds: f64) -> Pose {
    let way = STOP + SPEED * (seconds - BEGINS[1]).min(0.0);
    let cycle = (seconds.min(BEGINS[1])) / STRIDE_S;
    let swing = (TAU * cycle).sin();
    let arm = |sign: f64| Arm {
        raised: 4.0 + sign * 24.0 * swing,
        out: 10.0,
        turned: 0.0,
        elbow: 24.0 + sign * 10.0 * swing,
    };
    let mut pose = standing(model, 0.0, arm(-1.0), arm(1.0));
    pose.root = DVec3::new(0.015 * (TAU * cycle).cos(), way, 0.855 + 0.015 * (2.0 * TAU * cycle).cos());
    let lean = DQuat::from_rotation_z(0.07 * swing) * DQuat::from_rotation_x(-0.07);
    set(model, &mut pose, "spine", lean);
    let stride = SPEED * STRIDE_S;
    for (side, sign, offset) in [("right", 1.0, 0.0), ("left", -1.0, 0.5)] {
        let at = cycle + offset;
        let (step, part) = (at.floor(), at.fract());
        // Where the body is in the middle of the stance.
        let stands = |step: f64| STOP + SPEED * ((step + 0.5 * STANCE - offset) * STRIDE_S - BEGINS[1]);
        let ahead = ((part - STANCE) / (1.0 - STANCE)).max(0.0);
        let smooth = ahead * ahead * (3.0 - 2.0 * ahead);
        let lift = 0.11 * (std::f64::consts::PI * ahead).sin();
        let ankle = DVec3::new(sign * 0.1, stands(step) + stride * smooth, ANKLE_HEIGHT + lift);
        let toes = -0.5 * (TAU * ahead).sin() * f64::from(u8::from(ahead < 0.5));
        place_leg(model, &mut pose, side, ankle, DQuat::from_rotation_x(toes));
    }
    pose
}

fn stand_at_stop(model: &Model, seconds: f64, right: Arm, left: Arm) -> Pose {
    let mut pose = standing(model, seconds, right, left);
    pose.root.y += STOP;
    pose
}

fn squat(model: &Model, seconds: f64) -> Pose {
    let depth = 0.5 - 0.5 * (TAU * seconds / SQUAT_S).cos();
    let arm =
        Arm { raised: 4.0 + 74.0 * depth, out: 20.0 - 8.0 * depth, turned: 0.0, elbow: 14.0 - 2.0 * depth };
    let mut pose = stand_at_stop(model, seconds, arm, arm);
    pose.root += DVec3::new(0.0, -0.2 * depth, -0.4 * depth);
    set(model, &mut pose, "spine", DQuat::from_rotation_x(-(3.0 + 36.0 * depth).to_radians()));
    set_angles(model, &mut pose, "chest", [4.0 + 10.0 * depth, 0.0, 0.0]);
    plant(model, &mut pose, STOP);
    pose
}

fn signal(model: &Model, seconds: f64) -> Pose {
    let phase = TAU * seconds / SIGNAL_S;
    let up = |phase: f64| 0.5 - 0.5 * phase.cos();
    let side = |share: f64| Arm {
        raised: 20.0 + 10.0 * share,
        out: 45.0 + 80.0 * share,
        turned: 10.0,
        elbow: 60.0 - 30.0 * share,
    };
    stand_at_stop(model, seconds, side(up(phase)), side(up(0.7 * phase + 1.0)))
}

fn blows(model: &Model, seconds: f64) -> Pose {
    let phase = TAU * seconds / BLOWS_S;
    let blow = |phase: f64| phase.sin().max(0.0).powi(2);
    let arm = |share: f64| Arm {
        raised: 38.0 + 48.0 * share,
        out: 14.0,
        turned: 25.0 * (1.0 - share),
        elbow: 118.0 - 105.0 * share,
    };
    let (right, left) = (blow(phase), blow(phase + std::f64::consts::PI));
    let mut pose = stand_at_stop(model, seconds, arm(right), arm(left));
    pose.root += DVec3::new(0.03 * phase.sin(), 0.03, -0.04 - 0.015 * (2.0 * phase).cos());
    let turn = DQuat::from_rotation_z(0.35 * (right - left)) * DQuat::from_rotation_x(-0.14);
    set(model, &mut pose, "spine", turn);
    plant(model, &mut pose, STOP);
    pose
}

/// Both feet on the floor, this far ahead.
fn plant(model: &Model, pose: &mut Pose, ahead: f64) {
    for (side, sign) in [("right", 1.0), ("left", -1.0)] {
        let ankle = DVec3::new(sign * 0.13, ahead - 0.02, ANKLE_HEIGHT);
        place_leg(model, pose, side, ankle, DQuat::from_rotation_z(-sign * 0.15));
    }
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::{Kinematics, builtin};

    use super::*;
    use crate::synthetic::motion::tests::check_movement;

    #[test]
    fn joints_stay_within_their_limits_and_in_the_pictures_and_do_not_leap() {
        let cameras = cameras(MOST_CAMERAS, [192, 144]).unwrap();
        let frames = SECONDS * FRAME_RATE;
        let pose = |model: &Model, frame| pose(model, frame / FRAME_RATE);
        check_movement(pose, [frames, FRAME_RATE], 0.02, &cameras, 3.0, 6.5);
    }

    #[test]
    fn the_walk_gets_on_and_feet_that_stand_do_not_slide() {
        let model = builtin::full_body();
        let ankle = model.limb_index("right lower calf").unwrap();
        let at = |seconds: f64| Kinematics::new(&model, &pose(&model, seconds)).ends()[ankle];
        for step in 0..2 {
            let begin = f64::from(step) * STRIDE_S;
            for part in [0.1, 0.3, 0.5] {
                let slid = at(begin + part * STRIDE_S).distance(at(begin + 0.05));
                assert!(slid < 0.01, "step {step}, {part}: {slid:.3} m");
            }
        }
        assert!(pose(&model, 2.9).root.y - pose(&model, 0.1).root.y > 3.0);
        assert!(pose(&model, BEGINS[1] + 0.5 * SQUAT_S).root.z < 0.6);
    }
}
