//! Copies of training motions: mirrored, slower and faster, by another person, and as a tracker would have found them.

use glam::{DMat3, DQuat, DVec3};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

use crate::joints::{Joint, JointMotion, Joints};

/// The motion of a mirrored person.
#[must_use]
pub fn mirrored(motion: &JointMotion) -> JointMotion {
    let flip = DVec3::new(-1.0, 1.0, 1.0);
    motion.map(|joints| std::array::from_fn(|index| flip * joints[Joint::ALL[index].mirrored() as usize]))
}

/// The motion this many times as fast.
#[must_use]
pub fn faster(motion: &JointMotion, times: f64) -> JointMotion {
    let thinned = motion.resampled(motion.frame_rate / times);
    JointMotion::new(motion.frame_rate, motion.first_frame, thinned.frames)
        .unwrap_or_else(|_too_short| motion.clone())
}

/// How far people differ in how they hold their limbs and in how long these are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PersonVariation {
    /// Deviation of a limb's turn about each axis, radians.
    pub turn_rad: f64,
    /// Deviation of a limb's length, as a part of it.
    pub length: f64,
}

impl Default for PersonVariation {
    fn default() -> Self {
        Self { turn_rad: 0.3, length: 0.1 }
    }
}

/// Parts of [`PersonVariation::turn_rad`]: of the trunk, of the head, of both arms alike, and of each arm by itself.
const TURN_PARTS: [f64; 4] = [0.5, 1.0, 0.7, 0.5];
/// A limb is at least this part of its length.
const LEAST_LENGTH: f64 = 0.5;

/// The motion as another person would do it. Trunk, head and arms are turned by angles that stay the same in the body's frame; trunk, arms and
/// legs have other lengths. The same seed gives the same.
#[must_use]
pub fn by_another_person(motion: &JointMotion, variation: PersonVariation, seed: u64) -> JointMotion {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut turn = |part: f64| DQuat::from_scaled_axis(part * variation.turn_rad * gaussian(&mut random));
    let [trunk, head] = [turn(TURN_PARTS[0]), turn(TURN_PARTS[1])];
    let both_arms = [turn(TURN_PARTS[2]), turn(TURN_PARTS[2])];
    let left_arm = both_arms.map(|both| both * turn(TURN_PARTS[3]));
    let right_arm = both_arms.map(|both| mirrored_turn(both * turn(TURN_PARTS[3])));
    let mut length = || (1.0 + variation.length * gaussian(&mut random).x).max(LEAST_LENGTH);
    let [trunk_length, leg_length] = [length(), length()];
    let arm_lengths = [length(), length()];
    motion.map(|p| {
        let world_from_body = world_from_body(p);
        let in_world = |turn: DQuat| world_from_body * turn * world_from_body.inverse();
        let trunk = in_world(trunk);
        let mut out = p.map(|place| place * DVec3::new(1.0, leg_length, 1.0));
        let hips = |p: &Joints| p[Joint::LeftHip as usize].midpoint(p[Joint::RightHip as usize]);
        let (hips_before, hips) = (hips(p), hips(&out));
        let on_trunk = |joint: usize| hips + trunk * (p[joint] - hips_before) * trunk_length;
        let [neck, top] = [Joint::Neck, Joint::Head].map(|joint| joint as usize);
        out[neck] = on_trunk(neck);
        out[top] = out[neck] + in_world(head) * (trunk * (p[top] - p[neck]));
        for (shoulder, turns) in [(Joint::LeftShoulder, left_arm), (Joint::RightShoulder, right_arm)] {
            let shoulder = shoulder as usize;
            out[shoulder] = on_trunk(shoulder);
            let mut arm = DQuat::IDENTITY;
            for (limb, turn) in turns.into_iter().enumerate() {
                arm = in_world(turn) * arm;
                let from = shoulder + limb;
                out[from + 1] = out[from] + arm * (p[from + 1] - p[from]) * arm_lengths[limb];
            }
        }
        out
    })
}

/// Turns directions of the body (x to the left, y up, z forward) into the world's.
fn world_from_body(p: &Joints) -> DQuat {
    let across = |left: Joint, right: Joint| p[left as usize] - p[right as usize];
    let left =
        across(Joint::LeftHip, Joint::RightHip) + 0.5 * across(Joint::LeftShoulder, Joint::RightShoulder);
    let left = (left * DVec3::new(1.0, 0.0, 1.0)).try_normalize().unwrap_or(DVec3::X);
    DQuat::from_mat3(&DMat3::from_cols(left, DVec3::Y, left.cross(DVec3::Y)))
}

/// The turn of the other side's limb.
fn mirrored_turn(turn: DQuat) -> DQuat {
    DQuat::from_xyzw(turn.x, -turn.y, -turn.z, turn.w)
}

/// What a tracker adds to joints.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrackerNoise {
    /// Deviation along each axis, in the motion's unit.
    pub deviation: f64,
    /// The part of the variance that is smooth in time, 0 to 1; the rest is new in every frame.
    pub smooth: f64,
    /// Seconds over which the smooth part forgets itself.
    pub memory_s: f64,
}

/// A motion as a tracker would have found it. The same seed gives the same.
#[must_use]
pub fn noisy(motion: &JointMotion, noise: TrackerNoise, seed: u64) -> JointMotion {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let keep = (-1.0 / (noise.memory_s * motion.frame_rate)).exp();
    let mut slow: Joints = std::array::from_fn(|_| gaussian(&mut random));
    let (white, smooth) = ((1.0 - noise.smooth).sqrt(), noise.smooth.sqrt());
    motion.map(|joints| {
        std::array::from_fn(|joint| {
            slow[joint] = keep * slow[joint] + (1.0 - keep * keep).sqrt() * gaussian(&mut random);
            joints[joint] + noise.deviation * (white * gaussian(&mut random) + smooth * slow[joint])
        })
    })
}

/// Three numbers of the normal distribution (Box and Muller).
fn gaussian(random: &mut Pcg64Mcg) -> DVec3 {
    let one = |random: &mut Pcg64Mcg| {
        let radius = (-2.0 * (1.0 - unit(random)).ln()).sqrt();
        radius * (std::f64::consts::TAU * unit(random)).cos()
    };
    DVec3::new(one(random), one(random), one(random))
}

/// A number from 0 up to 1.
pub(crate) fn unit(random: &mut Pcg64Mcg) -> f64 {
    (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::walker;

    #[test]
    fn noise_has_its_deviation_and_its_memory() {
        let motion = walker(60.0, 0.0);
        for (smooth, correlation) in [(0.0, 0.0), (1.0, (-1.0_f64 / 9.0).exp())] {
            let noise = TrackerNoise { deviation: 0.03, smooth, memory_s: 0.3 };
            let found = noisy(&motion, noise, 5);
            assert_eq!(found, noisy(&motion, noise, 5));
            let added: Vec<f64> =
                found.frames.iter().zip(&motion.frames).map(|(a, b)| a[3].x - b[3].x).collect();
            let mean = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / added.len() as f64;
            let variance = mean(&mut added.iter().map(|x| x * x));
            assert!((variance.sqrt() - 0.03).abs() < 0.004, "{}", variance.sqrt());
            let lagged = mean(&mut added.windows(2).map(|pair| pair[0] * pair[1]));
            assert!((lagged / variance - correlation).abs() < 0.08, "{}", lagged / variance);
        }
    }

    #[test]
    fn another_person_has_other_limbs_that_turn_with_the_body() {
        let motion = walker(1.0, 1.0);
        let variation = PersonVariation::default();
        let greatest_distance = |a: &JointMotion, b: &JointMotion| {
            let pairs = a.frames.iter().flatten().zip(b.frames.iter().flatten());
            pairs.map(|(a, b)| a.distance(*b)).fold(0.0, f64::max)
        };
        let same = by_another_person(&motion, PersonVariation { turn_rad: 0.0, length: 0.0 }, 4);
        assert!(greatest_distance(&same, &motion) < 1e-12);
        let another = by_another_person(&motion, variation, 4);
        assert_eq!(another, by_another_person(&motion, variation, 4));
        let distance = greatest_distance(&another, &motion);
        assert!(distance > 0.1 && distance < 1.0, "{distance}");

        let arms = [(2, 3), (3, 4), (5, 6), (6, 7)];
        let length =
            |motion: &JointMotion, (a, b): (usize, usize)| motion.frames[9][a].distance(motion.frames[9][b]);
        let ratios = |of: &JointMotion| arms.map(|limb| length(of, limb) / length(&motion, limb));
        let turned = by_another_person(&motion, PersonVariation { length: 0.0, ..variation }, 4);
        assert!(ratios(&turned).into_iter().all(|ratio| (ratio - 1.0).abs() < 1e-9), "{:?}", ratios(&turned));
        let [left_upper, left_fore, right_upper, right_fore] = ratios(&another);
        assert!((left_upper - right_upper).abs() < 1e-9 && (left_fore - right_fore).abs() < 1e-9);
        assert!((left_upper - 1.0).abs() > 1e-3 && (left_fore - left_upper).abs() > 1e-3);

        let turned_round =
            |motion: &JointMotion| motion.map(|p| p.map(|place| DQuat::from_rotation_y(1.2) * place));
        let (a, b) = (turned_round(&another), by_another_person(&turned_round(&motion), variation, 4));
        assert!(greatest_distance(&a, &b) < 1e-9);

        let (turn, flip) = (DQuat::from_scaled_axis(DVec3::new(0.3, -0.5, 0.9)), DVec3::new(-1.0, 1.0, 1.0));
        let limb = DVec3::new(0.2, 0.4, -0.1);
        assert!((mirrored_turn(turn) * (flip * limb)).distance(flip * (turn * limb)) < 1e-12);
    }

    #[test]
    fn a_faster_motion_is_shorter() {
        let motion = walker(3.0, 1.0);
        let quick = faster(&motion, 1.5);
        assert_eq!((quick.frames.len(), quick.frame_rate), (60, 30.0));
        assert_eq!(mirrored(&mirrored(&motion)), motion);
    }
}
