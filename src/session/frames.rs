//! Decoded, rectified and segmented frames, the newest few.

use std::collections::VecDeque;
use std::sync::Arc;

use backlit_formats::footage::{CameraFrame, FrameData};

/// Megabytes that are kept unless something else is chosen.
const LIMIT_MB: usize = 128;
/// This many frames are kept however large they are: what is shown, and what was read ahead.
const FEWEST: usize = 4;
/// Bytes of a pixel: its colours, its label, whether it is shadow. Distances are of the frame on the screen alone.
const BYTES_PER_PIXEL: usize = 3 + 1 + 1;

/// Memory that a frame's pictures and silhouettes take, about.
fn bytes(frame: &FrameData) -> usize {
    let pixels = |camera: &CameraFrame| camera.mask.as_ref().map_or(0, |mask| mask.labels().len());
    BYTES_PER_PIXEL * frame.cameras.iter().map(pixels).sum::<usize>()
}

/// The frames that were loaded last, within a limit.
#[derive(Debug, Clone)]
pub struct SegmentedFrames {
    frames: VecDeque<Arc<FrameData>>,
    bytes: usize,
    limit: usize,
}

impl Default for SegmentedFrames {
    fn default() -> Self {
        Self { frames: VecDeque::new(), bytes: 0, limit: LIMIT_MB * 1_000_000 }
    }
}

impl SegmentedFrames {
    /// A frame, if it is there.
    pub fn get(&self, frame: usize) -> Option<&Arc<FrameData>> {
        self.frames.iter().find(|data| data.frame == frame)
    }

    /// Keeps a frame, and drops those that were loaded first where there are too many.
    pub(crate) fn insert(&mut self, data: Arc<FrameData>) {
        self.retain(|other| other.frame != data.frame);
        self.bytes += bytes(&data);
        self.frames.push_back(data);
        self.shrink();
    }

    /// Changes how many megabytes of 10⁶ bytes are kept.
    pub(crate) fn set_limit_mb(&mut self, megabytes: usize) {
        self.limit = megabytes.saturating_mul(1_000_000);
        self.shrink();
    }

    /// Lets go of the distances of all frames but one.
    pub(crate) fn keep_distances_of(&self, frame: usize) {
        let others = self.frames.iter().filter(|other| other.frame != frame);
        others.flat_map(|other| &other.cameras).for_each(CameraFrame::forget_distance);
    }

    fn shrink(&mut self) {
        while self.bytes > self.limit && self.frames.len() > FEWEST {
            let dropped = self.frames.pop_front();
            self.bytes -= dropped.map_or(0, |frame| bytes(&frame));
        }
    }

    /// Forgets the frames of which `is` says no.
    pub(crate) fn retain(&mut self, is: impl Fn(&FrameData) -> bool) {
        self.frames.retain(|frame| is(frame));
        self.bytes = self.frames.iter().map(|frame| bytes(frame)).sum();
    }

    pub(crate) fn clear(&mut self) {
        self.retain(|_| false);
    }
}

#[cfg(test)]
mod tests {
    use backlit_formats::footage::MadeWith;
    use backlit_tracking::silhouette::{Label, Mask};

    use super::*;

    fn data(frame: usize, side: usize) -> Arc<FrameData> {
        let mask = Mask::new(side, side, vec![Label::Background; side * side]).unwrap();
        let mut camera = CameraFrame::default();
        camera.mask = Some(Arc::new(mask));
        Arc::new(FrameData { frame, cameras: vec![camera], made_with: MadeWith::default() })
    }

    #[test]
    fn the_newest_frames_are_kept_within_the_limit() {
        let mut cache = SegmentedFrames::default();
        cache.set_limit_mb(1);
        // Five bytes a pixel: twenty frames of 50 kB.
        for frame in 0..23 {
            cache.insert(data(frame, 100));
        }
        assert!(cache.get(2).is_none() && cache.get(3).is_some() && cache.get(22).is_some());
        cache.insert(data(5, 100));
        assert!(cache.get(3).is_some(), "a frame that is loaded again replaces itself");
        cache.set_limit_mb(0);
        let kept = (0..23).filter(|&frame| cache.get(frame).is_some()).count();
        assert_eq!(kept, FEWEST, "what is shown and read ahead stays");
    }

    #[test]
    fn only_the_frame_on_the_screen_keeps_its_distance() {
        let mut cache = SegmentedFrames::default();
        (0..2).for_each(|frame| cache.insert(data(frame, 10)));
        let distance = |frame: usize| cache.get(frame).unwrap().cameras[0].distance().unwrap();
        let before = [0, 1].map(distance);
        cache.keep_distances_of(1);
        let after = [0, 1].map(distance);
        assert!(Arc::ptr_eq(&before[1], &after[1]) && !Arc::ptr_eq(&before[0], &after[0]));
        assert_eq!(before, after, "it is measured again");
    }
}
