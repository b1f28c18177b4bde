//! Frames read and segmented on a thread of their own, ahead of the one that is being fitted.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, sync_channel};

use backlit_tracking::segment::SegmentOptions;

use crate::session::FrameData;
use crate::session::load_frame;
use crate::take::footage::Footage;

/// Frames that wait to be fitted.
const WAITING: usize = 2;

/// Frames in a given order. The reading ends when this is dropped.
#[derive(Debug)]
pub(crate) struct ReadAhead {
    frames: Receiver<Arc<FrameData>>,
}

impl ReadAhead {
    /// Begins to read.
    ///
    /// # Errors
    /// The system gives no thread.
    pub(crate) fn start(
        footage: Arc<Footage>,
        measurement: Arc<Vec<SegmentOptions>>,
        frames: Vec<usize>,
    ) -> std::io::Result<Self> {
        let (sender, receiver) = sync_channel(WAITING);
        std::thread::Builder::new().name("backlit reader".to_owned()).spawn(move || {
            for frame in frames {
                // Nobody listens any more when the tracker has ended.
                if sender.send(Arc::new(load_frame(&footage, &measurement, frame))).is_err() {
                    return;
                }
            }
        })?;
        Ok(Self { frames: receiver })
    }

    /// The next frame; `None` after the last, or if reading it broke down.
    pub(crate) fn next(&self) -> Option<Arc<FrameData>> {
        self.frames.recv().ok()
    }
}
