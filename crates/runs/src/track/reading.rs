//! Frames of a take, read ahead of the one that is being fitted.

use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use backlit_formats::{Footage, FootageError};
use backlit_tracking::body::Pose;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::cues::{Cue, FrameCues};
use backlit_tracking::fit::FitView;
use rayon::Yield;

/// Frames that are read ahead.
const AHEAD: usize = 3;

/// Reads the frames of a take for a fit. Threads share it.
pub trait FrameReader: Send + Sync + 'static {
    /// What is read of a frame.
    type Data: std::fmt::Debug + Send + Sync + 'static;

    /// Reads and segments a frame.
    fn read(&self, frame: usize) -> Result<Self::Data, FootageError>;

    /// The cameras that a fit uses, with their evidence.
    fn views(&self, frame: &Self::Data) -> Vec<FitView>;

    /// What the frame has beside the silhouettes, in the order of its views.
    fn cues(&self, frame: &Self::Data) -> Result<FrameCues, FootageError>;

    /// Root mean square residual of a pose, grey levels, where it is measured in another way than the tracker does.
    fn rms(&self, frame: &Self::Data, pose: &Pose, tracked: Option<f64>) -> Option<f64> {
        let _ = (frame, pose);
        tracked
    }
}

/// Reads the cameras of a take as its files say, all with the same weight.
#[derive(Debug)]
pub struct TakeReader {
    /// The take.
    pub footage: Arc<Footage>,
    /// Indices of the cameras.
    pub cameras: Vec<usize>,
    /// What is read beside the silhouettes.
    pub cues: Vec<Cue>,
}

impl TakeReader {
    /// Reads silhouettes alone.
    pub fn of_silhouettes(footage: Arc<Footage>, cameras: Vec<usize>) -> Self {
        Self { footage, cameras, cues: Vec::new() }
    }
}

impl FrameReader for TakeReader {
    type Data = (Vec<FitView>, FrameCues);

    fn read(&self, frame: usize) -> Result<Self::Data, FootageError> {
        let views = self.footage.fit_views(&self.cameras, frame)?;
        let pictures = self.cues.iter().any(|cue| *cue != Cue::Keypoints);
        let cues = match self.cues[..] {
            [] => FrameCues::default(),
            _ => self.footage.cues(&self.cameras, frame, pictures)?,
        };
        Ok((views, cues))
    }

    fn views(&self, frame: &Self::Data) -> Vec<FitView> {
        frame.0.clone()
    }

    fn cues(&self, frame: &Self::Data) -> Result<FrameCues, FootageError> {
        Ok(frame.1.clone())
    }
}

/// A frame that is being read ahead, and where it arrives.
type Coming<D> = (usize, Receiver<Result<D, FootageError>>);

/// Frames in a given order, read by the machine's idle cores.
#[derive(Debug)]
pub struct ReadAhead<R: FrameReader> {
    reader: Arc<R>,
    frames: VecDeque<usize>,
    coming: VecDeque<Coming<R::Data>>,
    cancel: CancelToken,
}

impl<R: FrameReader> ReadAhead<R> {
    /// The frames in this order, until `cancel`.
    pub fn new(reader: Arc<R>, frames: VecDeque<usize>, cancel: CancelToken) -> Self {
        Self { reader, frames, coming: VecDeque::new(), cancel }
    }

    /// A frame; the next ones are begun. It is read here if it is out of order, or if reading it ahead panicked.
    pub fn get(&mut self, frame: usize) -> Result<Arc<R::Data>, FootageError> {
        if self.coming.is_empty() {
            // Nothing else is read while the caller waits for this frame.
            self.frames.pop_front_if(|next| *next == frame);
        }
        let ahead = self.coming.pop_front_if(|(next, _)| *next == frame);
        let read = ahead.and_then(|(_, coming)| wait_for(&coming));
        let read = read.unwrap_or_else(|| self.reader.read(frame))?;
        while self.coming.len() < AHEAD
            && let Some(next) = self.frames.pop_front()
        {
            self.begin(next);
        }
        Ok(Arc::new(read))
    }

    fn begin(&mut self, frame: usize) {
        let (sender, receiver) = channel();
        let (reader, cancel) = (self.reader.clone(), self.cancel.clone());
        rayon::spawn(move || {
            if cancel.is_cancelled() {
                return;
            }
            // After a panic the frame is read again by the thread that wants it, which then reports the panic.
            if let Ok(read) = catch_unwind(AssertUnwindSafe(|| reader.read(frame))) {
                // There is no receiver once the run has ended.
                let _ = sender.send(read);
            }
        });
        self.coming.push_back((frame, receiver));
    }
}

/// What arrives, or `None` if nothing will. A thread of a pool works for the pool meanwhile: a pool of one thread would never
/// read what it waits for.
fn wait_for<T>(coming: &Receiver<T>) -> Option<T> {
    loop {
        match coming.try_recv() {
            Ok(read) => return Some(read),
            Err(TryRecvError::Disconnected) => return None,
            Err(TryRecvError::Empty) => {}
        }
        if rayon::yield_now() == Some(Yield::Executed) {
            continue;
        }
        // Another thread reads it.
        return coming.recv().ok();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every frame is empty; reading frame 5 ahead, on another thread than the test's, panics.
    struct Empty(std::thread::ThreadId);

    impl FrameReader for Empty {
        type Data = usize;

        fn read(&self, frame: usize) -> Result<usize, FootageError> {
            assert!(frame != 5 || std::thread::current().id() == self.0, "read ahead");
            Ok(frame)
        }

        fn views(&self, _frame: &usize) -> Vec<FitView> {
            Vec::new()
        }

        fn cues(&self, _frame: &usize) -> Result<FrameCues, FootageError> {
            Ok(FrameCues::default())
        }
    }

    #[test]
    fn frames_come_in_the_order_in_which_they_are_asked_for() {
        let reader = Arc::new(Empty(std::thread::current().id()));
        let cancel = CancelToken::new();
        let mut ahead = ReadAhead::new(reader, [3, 2, 1, 0, 5, 4].into(), cancel.clone());
        // The fourth is skipped: those that were read ahead do not fit any more.
        for frame in [3, 2, 1, 5, 4] {
            if frame == 4 {
                cancel.cancel();
            }
            assert_eq!(*ahead.get(frame).unwrap(), frame);
        }
    }

    #[test]
    fn a_pool_of_one_thread_reads_ahead_for_itself() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        let frames = pool.install(|| {
            let reader = Arc::new(Empty(std::thread::current().id()));
            let mut ahead = ReadAhead::new(reader, (0..20).collect(), CancelToken::new());
            (0..20).map(|frame| *ahead.get(frame).unwrap()).collect::<Vec<_>>()
        });
        assert!(frames.into_iter().eq(0..20));
    }
}
