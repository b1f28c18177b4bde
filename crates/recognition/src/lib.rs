//! Names of motions: walking, running, boxing, from nothing but joints over time. Whoever has found the joints, from silhouettes or otherwise,
//! this crate knows nothing of it (section 6.6 of P. Kaimakis, "Markerless Motion Capture", 2004).
//!
//! Everything is deterministic: the same motions give the same bits.

pub mod augment;
pub mod confusion_picture;
pub mod discriminant;
pub mod evaluation;
pub mod features;
pub mod hmm;
pub mod joints;
pub mod learn;
pub mod model_file;
pub mod nearest;
pub mod novelty;
pub mod observed;
pub mod principal;
pub mod radial;
pub mod recognition;
pub mod recognizer;
pub mod svm;

pub use evaluation::{Confusion, Evaluation, LeftOut, Score, evaluate, leave_out};
pub use joints::{Joint, JointMotion, MotionError};
pub use learn::{LearnError, LearnOptions, NamedMotion};
pub use recognition::{FrameName, Recognition, Stretch};
pub use recognizer::{Method, Recognizer};

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use crate::joints::{JOINT_COUNT, JointMotion, Joints};
    use crate::{LearnOptions, NamedMotion, Recognizer};

    /// Somebody's [`walker`].
    pub(crate) fn named(name: &str, class: &str, subject: &str, seconds: f64, speed: f64) -> NamedMotion {
        let [name, class, subject] = [name, class, subject].map(str::to_owned);
        NamedMotion { name, class, subject, motion: walker(seconds, speed) }
    }

    /// Two people who stand, and walk.
    pub(crate) fn standing_and_walking() -> Vec<NamedMotion> {
        let all = [("stand", "a", 0.0), ("stand", "b", 0.1), ("walk", "a", 1.0), ("walk", "b", 1.3)];
        let one = |(class, subject, speed)| named(&format!("{class} {subject}"), class, subject, 1.5, speed);
        all.map(one).into()
    }

    /// What is learnt from them.
    pub(crate) fn learnt() -> Recognizer {
        let options = LearnOptions { copies: 1, ..LearnOptions::default() };
        Recognizer::learn(&standing_and_walking(), &options).unwrap()
    }

    /// A stick figure that walks forward (z) at 30 frames a second, this many metres a second, stepping twice a second.
    pub(crate) fn walker(seconds: f64, speed: f64) -> JointMotion {
        let frames = (0..(seconds * 30.0).round() as usize).map(|frame| {
            let t = frame as f64 / 30.0;
            let swing = 0.25 * speed * (std::f64::consts::TAU * t).sin();
            let root = DVec3::new(0.0, 0.0, speed * t);
            let mut joints: Joints = [DVec3::ZERO; JOINT_COUNT];
            let mut put = |index: usize, x: f64, y: f64, z: f64| joints[index] = root + DVec3::new(x, y, z);
            put(0, 0.0, 1.45, 0.0);
            put(1, 0.0, 1.65, 0.03);
            for (first, side) in [(2, 1.0), (5, -1.0)] {
                put(first, 0.18 * side, 1.42, 0.0);
                put(first + 1, 0.2 * side, 1.15, -0.5 * swing * side);
                put(first + 2, 0.21 * side, 0.9, -swing * side + 0.05);
            }
            for (first, side) in [(8, 1.0), (12, -1.0)] {
                let lift = 0.12 * speed * (swing * side).max(0.0);
                put(first, 0.1 * side, 0.95, 0.0);
                put(first + 1, 0.1 * side, 0.52 + lift, 0.5 * swing * side + 0.03);
                put(first + 2, 0.1 * side, 0.1 + lift, swing * side);
                put(first + 3, 0.1 * side, 0.03 + lift, swing * side + 0.15);
            }
            joints
        });
        JointMotion::new(30.0, 0, frames.collect()).unwrap()
    }
}
