//! Decoded, rectified and segmented frames, the newest few.

use std::collections::VecDeque;
use std::sync::Arc;

use backlit_take::footage::Footage;
use backlit_take::footage::{CameraFrame, MadeWith};
use backlit_tracking::segment::SegmentOptions;
use rayon::prelude::*;

/// Megabytes that are kept unless something else is chosen.
const LIMIT_MB: usize = 512;
/// So many frames are kept however large they are: what is shown, and what was read ahead.
const FEWEST: usize = 4;
/// Bytes of a pixel: its colours, its label, whether it is shadow, its distance.
const BYTES_PER_PIXEL: usize = 3 + 1 + 1 + 4;

/// All cameras' pictures of one frame.
#[derive(Debug, Clone)]
pub struct FrameData {
    pub(crate) frame: usize,
    /// By camera.
    pub cameras: Vec<CameraFrame>,
    /// What it depends on, besides the take.
    pub(crate) made_with: MadeWith,
}

impl FrameData {
    /// Memory that its pictures and silhouettes take, about.
    fn bytes(&self) -> usize {
        let pixels = |camera: &CameraFrame| camera.mask.as_ref().map_or(0, |mask| mask.labels().len());
        BYTES_PER_PIXEL * self.cameras.iter().map(pixels).sum::<usize>()
    }

    /// Whether at least one camera has a silhouette.
    pub(crate) fn has_mask(&self) -> bool {
        self.cameras.iter().any(|camera| camera.mask.is_some())
    }
}

/// The frames that were loaded last, within a limit.
#[derive(Debug, Clone)]
pub struct FrameCache {
    frames: VecDeque<Arc<FrameData>>,
    bytes: usize,
    limit: usize,
}

impl Default for FrameCache {
    fn default() -> Self {
        Self { frames: VecDeque::new(), bytes: 0, limit: LIMIT_MB * 1_000_000 }
    }
}

impl FrameCache {
    /// A frame, if it is there.
    pub fn get(&self, frame: usize) -> Option<&Arc<FrameData>> {
        self.frames.iter().find(|data| data.frame == frame)
    }

    /// Keeps a frame, and drops those that were loaded first where there are too many.
    pub(crate) fn insert(&mut self, data: Arc<FrameData>) {
        self.retain(|other| other.frame != data.frame);
        self.bytes += data.bytes();
        self.frames.push_back(data);
        self.shrink();
    }

    /// Changes how many megabytes of 10⁶ bytes are kept.
    pub(crate) fn set_limit_mb(&mut self, megabytes: usize) {
        self.limit = megabytes.saturating_mul(1_000_000);
        self.shrink();
    }

    fn shrink(&mut self) {
        while self.bytes > self.limit && self.frames.len() > FEWEST {
            let dropped = self.frames.pop_front();
            self.bytes -= dropped.map_or(0, |frame| frame.bytes());
        }
    }

    /// Forgets the frames of which `is` says no.
    pub(crate) fn retain(&mut self, is: impl Fn(&FrameData) -> bool) {
        self.frames.retain(|frame| is(frame));
        self.bytes = self.frames.iter().map(|frame| frame.bytes()).sum();
    }

    /// Forgets all frames.
    pub(crate) fn clear(&mut self) {
        self.retain(|_| false);
    }
}

/// A frame. The result does not depend on how the cameras are shared out.
pub(crate) fn load_frame(
    footage: &Footage,
    measurement: &Arc<Vec<SegmentOptions>>,
    frame: usize,
) -> FrameData {
    let load = |camera: usize| {
        let options = measurement.get(camera).cloned().unwrap_or_default();
        footage.load(camera, frame, &options)
    };
    let cameras = (0..footage.cameras.len()).into_par_iter().map(load).collect();
    FrameData { frame, cameras, made_with: footage.made_with(measurement, frame) }
}

#[cfg(test)]
mod tests {
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
        let mut cache = FrameCache::default();
        cache.set_limit_mb(1);
        // Nine bytes a pixel: ten frames of 90 kB and one more that does not fit.
        for frame in 0..13 {
            cache.insert(data(frame, 100));
        }
        assert!(cache.get(1).is_none() && cache.get(2).is_some() && cache.get(12).is_some());
        cache.insert(data(5, 100));
        assert!(cache.get(2).is_some(), "a frame that is loaded again replaces itself");
        cache.set_limit_mb(0);
        let kept = (0..13).filter(|&frame| cache.get(frame).is_some()).count();
        assert_eq!(kept, FEWEST, "what is shown and read ahead stays");
    }
}
