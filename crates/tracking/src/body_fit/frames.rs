//! What a frame contributes, and which frames to look at.

use crate::body::Pose;
use crate::fit::FitView;
use crate::metrics::ReferenceJoints;

/// What one frame contributes.
#[derive(Debug, Clone)]
pub struct BodyFrame {
    /// Its number, for the report.
    pub frame: usize,
    /// Its cameras.
    pub views: Vec<FitView>,
    /// A pose near its own.
    pub start: Pose,
    /// Joints that are known from elsewhere, a few centimetres accurate (keypoints); none is fine.
    pub joints: ReferenceJoints,
}

/// `count` of these frames, evenly spread with the first and the last among them; all, if there are no more.
#[must_use]
pub fn spread(frames: &[usize], count: usize) -> Vec<usize> {
    let last = frames.len().saturating_sub(1);
    if count > last {
        return frames.to_vec();
    }
    let between = count.saturating_sub(1).max(1);
    (0..count).map(|k| frames[(k * last + between / 2) / between]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_and_the_last_are_among_them() {
        let frames: Vec<usize> = (10..70).collect();
        assert_eq!(spread(&frames, 4), [10, 30, 49, 69]);
        assert_eq!(spread(&frames, 1), [10]);
        assert_eq!(spread(&frames[..3], 8), [10, 11, 12]);
        assert!(spread(&[], 3).is_empty());
    }
}
