//! Visual hulls of the frames that were looked at last.

use std::collections::VecDeque;
use std::sync::Arc;

use backlit_tracking::camera::Camera;
use backlit_tracking::visual_hull::VisualHull;

use crate::session::FrameData;

/// Hulls that are kept.
const CAPACITY: usize = 32;

/// What a hull is carved from: the same where cameras and frame are the very same.
#[derive(Debug, Clone)]
pub(super) struct HullInputs {
    /// The cameras without distortion.
    pub(super) cameras: Arc<Vec<Arc<Camera>>>,
    /// The frame, with the silhouettes of all of them.
    pub(super) frame: Arc<FrameData>,
}

impl PartialEq for HullInputs {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.cameras, &other.cameras) && Arc::ptr_eq(&self.frame, &other.frame)
    }
}

/// Hulls by the frame that they were carved from.
#[derive(Debug, Clone, Default)]
pub struct HullCache {
    hulls: VecDeque<(Arc<FrameData>, Option<Arc<VisualHull>>)>,
}

impl HullCache {
    /// A frame's hull: `None` while it is not carved, `Some(None)` if its silhouettes leave none.
    pub fn get(&self, frame: &Arc<FrameData>) -> Option<Option<&Arc<VisualHull>>> {
        let found = self.hulls.iter().find(|(other, _)| Arc::ptr_eq(other, frame));
        found.map(|(_, hull)| hull.as_ref())
    }

    /// Keeps a hull, and drops the oldest if there are too many.
    pub(crate) fn insert(&mut self, frame: Arc<FrameData>, hull: Option<Arc<VisualHull>>) {
        self.hulls.retain(|(other, _)| other.frame != frame.frame);
        if self.hulls.len() == CAPACITY {
            self.hulls.pop_front();
        }
        self.hulls.push_back((frame, hull));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hull_is_of_the_very_frame() {
        let frame = |frame| Arc::new(FrameData { frame, cameras: Vec::new(), made_with: Default::default() });
        let mut cache = HullCache::default();
        let (first, again) = (frame(3), frame(3));
        cache.insert(first.clone(), None);
        assert_eq!(cache.get(&first), Some(None));
        assert_eq!(cache.get(&again), None, "segmented again, it is another one");
        cache.insert(again.clone(), None);
        assert_eq!(cache.get(&first), None);
        for other in 10..10 + CAPACITY {
            cache.insert(frame(other), None);
        }
        assert_eq!(cache.get(&again), None, "the oldest goes");
    }
}
