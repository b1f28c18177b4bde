//! Names of motions: walking, running, boxing, from nothing but joints over time. Whoever has found the joints, from silhouettes or otherwise,
//! this crate knows nothing of it (section 6.6 of P. Kaimakis, "Markerless Motion Capture", 2004).
//!
//! A motion goes through these rooms:
//!
//! | file | holds |
//! |---|---|
//! | [`joints`] | [`JointMotion`]: the sixteen joints that all sources have, frame by frame |
//! | [`features`] | what is measured apart from place, heading and size |
//! | [`observed`] | a motion as windows of a second, and as short windows that follow each other |
//! | [`principal`] | principal components: the plane that motions are drawn on |
//! | [`discriminant`] | axes that tell classes apart and not people |
//! | [`hmm`] | a Gaussian hidden Markov model a class; Viterbi segmentation of long takes |
//! | [`svm`] | support vector machines of windows of a second |
//! | [`nearest`] | nearest neighbours, the baseline |
//! | [`novelty`] | what is nothing known |
//! | [`recognizer`] | all of these as one [`Recognizer`] |
//! | [`learn`], [`augment`] | learning from named motions and changed copies of them |
//! | [`recognition`] | a take's frames and stretches by name |
//! | [`evaluation`], [`confusion_picture`] | how often names are right |
//! | [`model_file`] | a recognizer as a small JSON |
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

    use crate::NamedMotion;
    use crate::joints::{JOINT_COUNT, JointMotion, Joints};

    /// Two people who stand, and walk.
    pub(crate) fn standing_and_walking() -> Vec<NamedMotion> {
        let named = |speed: f64, class: &str, subject: &str| NamedMotion {
            name: format!("{class} {subject}"),
            class: class.to_owned(),
            subject: subject.to_owned(),
            motion: walker(1.5, speed),
        };
        vec![
            named(0.0, "stand", "a"),
            named(0.1, "stand", "b"),
            named(1.0, "walk", "a"),
            named(1.3, "walk", "b"),
        ]
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
