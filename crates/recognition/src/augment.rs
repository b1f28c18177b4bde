//! Training motions seen otherwise: mirrored, slower and faster, and as a tracker would have found them.

use glam::DVec3;
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
    fn a_faster_motion_is_shorter() {
        let motion = walker(3.0, 1.0);
        let quick = faster(&motion, 1.5);
        assert_eq!((quick.frames.len(), quick.frame_rate), (60, 30.0));
        assert_eq!(mirrored(&mirrored(&motion)), motion);
    }
}
