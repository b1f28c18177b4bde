//! A take whose cameras were started by hand: its silhouettes over time, and what they say of the cameras' clocks.
//!
//! Silhouettes are made at the take's working size (`reduction`), of every nth frame where the take is long; what is kept
//! of them is small. [`shift_offsets`] writes what was found into the take file.

use backlit_tracking::cancel::CancelToken;
use backlit_tracking::synchronise::{
    self as clocks, CameraOffset, Recording, Synchronisation, SynchroniseError, SynchroniseOptions,
};
use thiserror::Error;

use crate::video::Video;
use crate::{Footage, FootageError, Take};

pub use crate::take::{OffsetShift, shift_offsets};

/// Frames that are looked at unless asked for otherwise.
pub const USUAL_FRAMES: usize = 600;

/// What a take's silhouettes say of its cameras' clocks.
#[derive(Debug, Clone, PartialEq)]
pub struct TakeClocks {
    /// Beside the offsets that the take has now.
    pub found: Synchronisation,
    /// By how much each camera is to be shifted, in the take's order; `None` where it cannot be told.
    pub shifts: Vec<Option<OffsetShift>>,
    /// Every `every`th frame was used.
    pub every: usize,
}

/// Why a take's clocks cannot be compared.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the messages say what each variant is")]
pub enum TakeClocksError {
    #[error(transparent)]
    Footage(#[from] FootageError),
    #[error(transparent)]
    Synchronise(#[from] SynchroniseError),
    #[error("the search for the cameras' offsets was stopped")]
    Cancelled,
}

/// When a camera's frame was taken by its own clock, seconds from the frame that belongs to the take's frame 0.
fn seconds(take: &Take, camera: usize, frame: usize) -> f64 {
    let by_rate = frame as f64 / take.frame_rate();
    let Some(footage) = take.footage().get(camera) else { return by_rate };
    let times = footage.video().map(Video::seconds).unwrap_or_default();
    let at = |frame: usize| times.get(usize::try_from(footage.number(frame)).ok()?);
    at(frame).zip(at(0)).map_or(by_rate, |(time, zero)| time - zero)
}

/// The silhouettes of every `every`th frame of all cameras. `on_frame` hears how many frames are done, of how many.
pub fn record(
    footage: &Footage,
    every: usize,
    cancel: &CancelToken,
    mut on_frame: impl FnMut(usize, usize),
) -> Result<Vec<Recording>, TakeClocksError> {
    let cameras: Vec<usize> = (0..footage.cameras.len()).collect();
    let mut recordings: Vec<Recording> =
        footage.cameras.iter().map(|camera| Recording::new((**camera).clone())).collect();
    let frames: Vec<usize> = (0..footage.take().frame_count()).step_by(every.max(1)).collect();
    for (done, &frame) in frames.iter().enumerate() {
        if cancel.is_cancelled() {
            return Err(TakeClocksError::Cancelled);
        }
        on_frame(done, frames.len());
        let masks = footage.single_masks(&cameras, frame)?;
        for (camera, (mask, recording)) in masks.iter().zip(&mut recordings).enumerate() {
            recording.push(seconds(footage.take(), camera, frame), mask);
        }
    }
    on_frame(frames.len(), frames.len());
    Ok(recordings)
}

/// Gives recordings of every `every`th frame of all cameras the joints that the take's keypoints show, if it has any.
pub fn add_keypoints(
    footage: &Footage,
    every: usize,
    recordings: &mut [Recording],
) -> Result<(), FootageError> {
    let take = footage.take();
    for (camera, recording) in recordings.iter_mut().enumerate() {
        for at in 0..recording.frame_count() {
            let pixels = take.joint_pixels(camera, at * every.max(1), &footage.cameras[camera])?;
            recording.set_keypoints(at, &pixels);
        }
    }
    Ok(())
}

/// Finds by how much each camera is to be shifted, from at most `most_frames` frames.
pub fn find(
    footage: &Footage,
    most_frames: usize,
    options: &SynchroniseOptions,
    cancel: &CancelToken,
    on_frame: impl FnMut(usize, usize),
) -> Result<TakeClocks, TakeClocksError> {
    let take = footage.take();
    let count = footage.cameras.len();
    if count < 2 {
        return Err(SynchroniseError::Count { count }.into());
    }
    let every = take.frame_count().div_ceil(most_frames.max(1));
    let recordings = record(footage, every, cancel, on_frame)?;
    let found = clocks::synchronise(&recordings, options)?;
    let shift = |(camera, offset): (usize, &CameraOffset)| {
        let seconds = match offset {
            CameraOffset::Reference => 0.0,
            CameraOffset::Found(offset) => offset.seconds,
            CameraOffset::Undecided(_) => return None,
        };
        let own = take.footage()[camera].video().and_then(Video::frame_rate);
        let frames = (seconds * own.unwrap_or(take.frame_rate())).round() as i64;
        Some(OffsetShift { camera: footage.cameras[camera].name().to_owned(), frames, seconds })
    };
    let shifts = found.cameras.iter().enumerate().map(shift).collect();
    Ok(TakeClocks { found, shifts, every })
}
