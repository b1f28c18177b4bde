//! Frames read and segmented by the machine's idle cores, ahead of the one that is being fitted.

use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};

use backlit_take::footage::Footage;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::segment::SegmentOptions;

use crate::session::{FrameData, load_frame};

/// Frames that are read ahead.
const AHEAD: usize = 3;

/// Frames in a given order.
#[derive(Debug)]
pub(super) struct ReadAhead {
    footage: Arc<Footage>,
    measurement: Arc<Vec<SegmentOptions>>,
    frames: VecDeque<usize>,
    coming: VecDeque<(usize, Receiver<FrameData>)>,
    cancel: CancelToken,
}

impl ReadAhead {
    /// The frames in this order, until `cancel`.
    pub(super) fn new(
        footage: Arc<Footage>,
        measurement: Arc<Vec<SegmentOptions>>,
        frames: VecDeque<usize>,
        cancel: CancelToken,
    ) -> Self {
        Self { footage, measurement, frames, coming: VecDeque::new(), cancel }
    }

    /// A frame; the next ones are begun. Out of their order, or where reading it ahead broke down, it is read here.
    pub(super) fn get(&mut self, frame: usize) -> Arc<FrameData> {
        if self.coming.is_empty() {
            // Nothing else is read while somebody waits for it.
            self.frames.pop_front_if(|next| *next == frame);
        }
        let ahead = self.coming.pop_front_if(|(next, _)| *next == frame);
        let data = ahead.and_then(|(_, coming)| coming.recv().ok());
        let data = data.unwrap_or_else(|| load_frame(&self.footage, &self.measurement, frame));
        while self.coming.len() < AHEAD
            && let Some(next) = self.frames.pop_front()
        {
            self.begin(next);
        }
        Arc::new(data)
    }

    /// Reads a frame without holding up anybody: no thread waits for it but the tracker's.
    fn begin(&mut self, frame: usize) {
        let (sender, receiver) = channel();
        let (footage, measurement) = (self.footage.clone(), self.measurement.clone());
        let cancel = self.cancel.clone();
        rayon::spawn(move || {
            if cancel.is_cancelled() {
                return;
            }
            // The tracker's thread reads it again where this breaks down, and says so.
            let read = catch_unwind(AssertUnwindSafe(|| load_frame(&footage, &measurement, frame)));
            if let Ok(data) = read {
                // Nobody listens any more when the tracker has ended.
                let _ = sender.send(data);
            }
        });
        self.coming.push_back((frame, receiver));
    }
}
