//! The cues of the frame that is being tracked.

use std::sync::Arc;

use crate::body::Pose;
use crate::cues::{CueSet, CueWatch, FrameCues, LimbHold, WatchedCamera};
use crate::fit::{Evidence, Fit, FitError, FitView};

/// What is remembered from frame to frame, and what pulls in the one at hand.
#[derive(Debug)]
pub(super) struct Cued {
    watch: CueWatch,
    cameras: Vec<WatchedCamera>,
    cues: FrameCues,
    set: Arc<CueSet>,
}

impl Cued {
    pub(super) fn new(watch: CueWatch) -> Self {
        Self { watch, cameras: Vec::new(), cues: FrameCues::default(), set: Arc::default() }
    }

    /// Begins a frame whose fit starts at a pose.
    pub(super) fn begin(&mut self, views: &[FitView], mut cues: FrameCues, start: &Pose) {
        let watched = |view: &FitView| WatchedCamera {
            camera: Arc::clone(&view.camera),
            mask: match &view.evidence {
                Evidence::Mask(mask) => Some(Arc::clone(mask)),
                Evidence::Measurement(_) => None,
            },
        };
        // A camera that sees nobody, or is left out, holds nothing and has no cues.
        let used: Vec<bool> = views.iter().map(FitView::has_data).collect();
        cues.cameras.resize_with(views.len(), Default::default);
        let mut is_used = used.iter();
        cues.cameras.retain(|_| is_used.next().is_some_and(|used| *used));
        self.cameras =
            views.iter().zip(used).filter(|(_, used)| *used).map(|(view, _)| watched(view)).collect();
        self.cues = cues;
        self.set = Arc::new(self.watch.look(&self.cameras, &self.cues, start));
    }

    /// A fit of this frame with its cues.
    pub(super) fn pull(&self, fit: Fit) -> Result<Fit, FitError> {
        fit.with_cues(Arc::clone(&self.set))
    }

    /// Learns from the frame's fitted pose, and says what held it. Nothing is learnt from a frame that is lost.
    pub(super) fn learn(&mut self, pose: &Pose, is_lost: bool) -> Vec<LimbHold> {
        let holds = self.watch.learn(&self.cameras, &self.cues, &self.set, pose, !is_lost);
        self.cues = FrameCues::default();
        holds
    }
}
