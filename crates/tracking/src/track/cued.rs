//! The cues of the frame that is being tracked.

use std::sync::Arc;

use crate::body::Pose;
use crate::cues::{CueMemory, CueSet, CueWatch, FrameCues, LimbHold, WatchedCamera};
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

    /// What is remembered after a frame.
    pub(super) fn memory(&self) -> CueMemory {
        self.watch.memory()
    }

    /// Goes on from there.
    pub(super) fn remember(&mut self, memory: CueMemory) {
        self.watch.remember(&memory);
    }

    /// Shows it the pictures of the frame before.
    pub(super) fn see_before(&mut self, views: &[FitView], cues: FrameCues) {
        self.take_in(views, cues);
        self.watch.see_before(&self.cameras, &self.cues);
    }

    /// Begins a frame whose fit starts at a pose.
    pub(super) fn begin(&mut self, views: &[FitView], cues: FrameCues, start: &Pose) {
        self.take_in(views, cues);
        self.set = Arc::new(self.watch.look(&self.cameras, &self.cues, start));
    }

    /// The cameras that see somebody, with their cues.
    fn take_in(&mut self, views: &[FitView], mut cues: FrameCues) {
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
