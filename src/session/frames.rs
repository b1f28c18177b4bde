//! Decoded, rectified and segmented frames, the newest few.

use std::collections::VecDeque;
use std::sync::Arc;

use backlit_tracking::segment::SegmentOptions;
use rayon::prelude::*;

use crate::take::footage::Footage;

use crate::take::footage::{CameraFrame, MadeWith};

/// Frames that are kept.
const CAPACITY: usize = 48;

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
    /// Whether at least one camera has a silhouette.
    pub(crate) fn has_mask(&self) -> bool {
        self.cameras.iter().any(|camera| camera.mask.is_some())
    }
}

/// The frames that were loaded last.
#[derive(Debug, Clone, Default)]
pub struct FrameCache {
    frames: VecDeque<Arc<FrameData>>,
}

impl FrameCache {
    /// A frame, if it is there.
    pub fn get(&self, frame: usize) -> Option<&Arc<FrameData>> {
        self.frames.iter().find(|data| data.frame == frame)
    }

    /// Keeps a frame and, if there are too many, drops the one that was loaded first.
    pub(crate) fn insert(&mut self, data: Arc<FrameData>) {
        self.frames.retain(|other| other.frame != data.frame);
        if self.frames.len() == CAPACITY {
            self.frames.pop_front();
        }
        self.frames.push_back(data);
    }

    /// Forgets the frames of which `is` says no.
    pub(crate) fn retain(&mut self, is: impl Fn(&FrameData) -> bool) {
        self.frames.retain(|frame| is(frame));
    }

    /// Forgets all frames.
    pub(crate) fn clear(&mut self) {
        self.frames.clear();
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
    use super::*;

    #[test]
    fn the_newest_frames_are_kept() {
        let mut cache = FrameCache::default();
        for frame in 0..CAPACITY + 2 {
            cache.insert(Arc::new(FrameData { frame, cameras: Vec::new(), made_with: MadeWith::default() }));
        }
        assert!(cache.get(1).is_none() && cache.get(2).is_some() && cache.get(CAPACITY + 1).is_some());
        cache.insert(Arc::new(FrameData { frame: 5, cameras: Vec::new(), made_with: MadeWith::default() }));
        assert!(cache.get(2).is_some(), "a frame that is loaded again replaces itself");
    }
}
