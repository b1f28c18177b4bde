//! Places of joints, or angles, over time: of a track of ours or of anybody's recording.

use std::collections::BTreeMap;

use glam::DVec3;

use super::angles::JointAngle;
use crate::body::{Kinematics, Model, Pose, joint_names};

/// Places of named joints over time, in any axes and unit.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Trajectories {
    /// The joints by their anatomical names (`left knee`), or by a limb's that ends where anatomy names no joint.
    pub joints: Vec<String>,
    /// Seconds of the frames, ascending.
    pub times: Vec<f64>,
    /// By frame and joint; `None` where it was not seen.
    pub points: Vec<Vec<Option<DVec3>>>,
    /// Angles by frame, radians, of recordings that have them instead of joints.
    pub angles: BTreeMap<JointAngle, Vec<Option<f64>>>,
}

/// A moment between two frames.
#[derive(Debug, Clone, Copy)]
pub struct Between {
    before: usize,
    after: usize,
    share: f64,
}

impl Trajectories {
    /// The joints of a body's poses, metres; frame k is at k / `frame_rate` seconds.
    #[must_use]
    pub fn of_poses(model: &Model, frame_rate: f64, poses: &BTreeMap<usize, Pose>) -> Self {
        let points = poses.values().map(|pose| {
            let kinematics = Kinematics::new(model, pose);
            kinematics.ends().iter().map(|end| Some(*end)).collect()
        });
        Self {
            joints: joint_names(model),
            times: poses.keys().map(|frame| *frame as f64 / frame_rate).collect(),
            points: points.collect(),
            angles: BTreeMap::new(),
        }
    }

    /// The column of a joint.
    #[must_use]
    pub fn column(&self, joint: &str) -> Option<usize> {
        self.joints.iter().position(|name| name == joint)
    }

    /// Half of the frames are nearer to the next than this, seconds; 0 of fewer than two.
    #[must_use]
    pub fn period(&self) -> f64 {
        let mut steps: Vec<f64> = self.times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        crate::statistics::upper_median(&mut steps).unwrap_or(0.0)
    }

    /// An angle in a frame, radians: as it was recorded, or measured from the joints.
    #[must_use]
    pub fn angle(&self, frame: usize, angle: JointAngle) -> Option<f64> {
        match self.angles.get(&angle) {
            Some(recorded) => recorded[frame],
            None => angle.measure(|joint| self.points.get(frame)?[self.column(joint)?]),
        }
    }

    /// An angle over all frames.
    #[must_use]
    pub fn angle_curve(&self, angle: JointAngle) -> Vec<Option<f64>> {
        (0..self.times.len()).map(|frame| self.angle(frame, angle)).collect()
    }

    /// The recording at any time.
    #[must_use]
    pub fn moments(&self) -> Moments<'_> {
        Moments { recording: self, period: self.period() }
    }
}

/// A recording between its frames: straight from one to the next, and nothing in gaps longer than 2.5 frames.
#[derive(Debug, Clone, Copy)]
pub struct Moments<'a> {
    recording: &'a Trajectories,
    period: f64,
}

impl Moments<'_> {
    /// The frames about a time; `None` before the first, after the last, and in gaps.
    #[must_use]
    pub fn between(&self, time: f64) -> Option<Between> {
        let times = &self.recording.times;
        // Times of files are rounded: what lies a hair outside is the frame.
        let hair = 1e-3 * self.period;
        let after = times.partition_point(|other| *other < time - hair);
        let end = *times.get(after)?;
        if end <= time + hair {
            return Some(Between { before: after, after, share: 0.0 });
        }
        let before = after.checked_sub(1)?;
        let length = end - times[before];
        let share = (time - times[before]) / length;
        (length <= 2.5 * self.period).then_some(Between { before, after, share })
    }

    /// The joints at a time.
    #[must_use]
    pub fn points_at(&self, time: f64) -> Vec<Option<DVec3>> {
        let Some(Between { before, after, share }) = self.between(time) else {
            return vec![None; self.recording.joints.len()];
        };
        let (a, b) = (&self.recording.points[before], &self.recording.points[after]);
        a.iter().zip(b).map(|(a, b)| Some((*a)?.lerp((*b)?, share))).collect()
    }
}

impl Between {
    /// The value there of a curve that has one a frame.
    #[must_use]
    pub fn value(&self, curve: &[Option<f64>]) -> Option<f64> {
        let (a, b) = (curve[self.before]?, curve[self.after]?);
        Some(a + self.share * (b - a))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_lie_between_their_frames_and_not_in_gaps() {
        let at = |x: f64| vec![Some(DVec3::X * x), None];
        let joints = vec!["a".to_owned(), "b".to_owned()];
        let times = vec![0.0, 0.1, 0.2, 0.9];
        let points = [0.0, 1.0, 3.0, 5.0].map(at).to_vec();
        let track = Trajectories { joints, times, points, angles: BTreeMap::new() };
        let moments = track.moments();
        assert!(moments.points_at(0.15)[0].unwrap().distance(2.0 * DVec3::X) < 1e-12);
        assert_eq!(moments.points_at(0.15)[1], None);
        assert_eq!(moments.points_at(0.200_000_01)[0], Some(3.0 * DVec3::X));
        assert_eq!([0.5, -0.1, 1.0].map(|time| moments.points_at(time)[0]), [None; 3]);
        let curve = [Some(1.0), Some(2.0), None, Some(0.0)];
        let value_at = |time: f64| moments.between(time).and_then(|between| between.value(&curve));
        assert_eq!(value_at(0.05), Some(1.5));
        assert_eq!(value_at(0.15), None);
    }
}
