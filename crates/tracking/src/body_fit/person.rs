//! A person in one go: where they stand, how large they are, and a pose to begin with.

use std::collections::BTreeMap;
use std::sync::Arc;

use thiserror::Error;

use super::frames::PosedFrame;
use super::own_sizes::{OwnSizes, OwnSizesError, OwnSizesOptions, OwnSizesProgress, own_sizes};
use crate::body::{Model, Pose};
use crate::cancel::CancelToken;
use crate::fit::{FitError, FitOptions, FitView};
use crate::metrics::ReferenceJoints;
use crate::search::{WithoutStartError, WithoutStartOptions, WithoutStartResult, without_start};
use crate::track::{Motion, MotionError, Tracker, WhenToSearch};

/// What is looked for, and how hard.
#[derive(Debug, Clone, PartialEq)]
pub struct PersonOptions {
    /// The fit of a frame.
    pub fit: FitOptions,
    /// Whether sizes are looked for; without it only a pose is.
    pub sizes: bool,
    /// Frames a second of the recording.
    pub frame_rate: f64,
    /// Frames a second that are near enough to one another to be followed.
    pub followed_rate: f64,
    /// Frames that are followed to find sizes, at most.
    pub most_followed: usize,
    /// Joints that are known by frame, as of another tool's keypoints; empty where none are.
    pub joints: BTreeMap<usize, ReferenceJoints>,
}

impl PersonOptions {
    /// For a recording of this many frames a second.
    pub fn new(fit: FitOptions, sizes: bool, frame_rate: f64) -> Self {
        Self { fit, sizes, frame_rate, followed_rate: 20.0, most_followed: 60, joints: BTreeMap::new() }
    }

    /// Which frames are followed to find sizes.
    pub fn followed(&self, frames: &[usize]) -> Vec<usize> {
        let step = ((self.frame_rate / self.followed_rate).round() as usize).max(1);
        frames.iter().copied().step_by(step).take(self.most_followed).collect()
    }
}

/// Who was found.
#[derive(Debug)]
pub struct Person {
    /// The body: the given one, scaled as a whole, or with its own sizes and as wide as the silhouettes show it.
    pub model: Arc<Model>,
    /// A pose to begin the first frame with.
    pub start: Pose,
    /// What the search found, where no start was given.
    pub search: Option<WithoutStartResult>,
    /// What came of the sizes, where they were asked for.
    pub sizes: Option<Result<OwnSizes, OwnSizesError>>,
}

/// How far it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PersonProgress {
    /// A start is searched for.
    Searching,
    /// How many frames are tracked, and how many there are.
    Following(usize, usize),
    /// Sizes are found.
    Sizes(OwnSizesProgress),
}

/// Why nobody was found.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum PersonError {
    #[error(transparent)]
    Start(#[from] WithoutStartError),
    #[error("frame {frame}: {error}")]
    Frame { frame: usize, error: FitError },
    #[error(transparent)]
    Options(FitError),
    #[error(transparent)]
    Motion(MotionError),
    #[error("there is no frame to begin with")]
    NoFrame,
    #[error("the search for a person was stopped")]
    Cancelled,
}

/// Finds a person in the first of `frames`, unless a start is given, follows a body of about the right size over some of them,
/// and fits its own sizes. That no sizes can be found is an answer, not an error: the body is then only scaled as a whole.
///
/// # Errors
/// What `views` returns; nobody is seen, options out of range, or `cancel`.
pub fn find_person<E: From<PersonError>>(
    model: &Arc<Model>,
    start: Option<Pose>,
    frames: &[usize],
    options: &PersonOptions,
    cancel: &CancelToken,
    mut views: impl FnMut(usize) -> Result<Vec<FitView>, E>,
    mut progress: impl FnMut(PersonProgress),
) -> Result<Person, E> {
    let &first = frames.first().ok_or(PersonError::NoFrame)?;
    let (model, start, search) = match start {
        Some(start) => (Arc::clone(model), start, None),
        None => {
            progress(PersonProgress::Searching);
            let choices = WithoutStartOptions {
                scale_body: options.sizes,
                fit: options.fit.clone(),
                ..WithoutStartOptions::default()
            };
            let found = without_start(model, &views(first)?, &choices, cancel).map_err(PersonError::from)?;
            (Arc::clone(&found.model), found.pose().clone(), Some(found))
        }
    };
    if !options.sizes {
        return Ok(Person { model, start, search, sizes: None });
    }
    // Sizes are believed or not, by thresholds: on all processors alike.
    let fit = FitOptions { exact: true, ..options.fit.clone() };
    let options = &PersonOptions { fit: fit.clone(), ..options.clone() };
    let posed = follow(&model, start.clone(), frames, options, cancel, &mut views, &mut progress)?;
    let choices = OwnSizesOptions { pose: fit, ..OwnSizesOptions::default() };
    let found = own_sizes(
        &model,
        &posed,
        &choices,
        cancel,
        |frame| views(frame).map_err(OrViews::Views),
        |frame| options.joints.get(&frame).cloned().unwrap_or_default(),
        |at| progress(PersonProgress::Sizes(at)),
    );
    if cancel.is_cancelled() {
        return Err(PersonError::Cancelled.into());
    }
    let sizes = match found {
        Ok(sizes) => Ok(sizes),
        Err(OrViews::Own(error)) => Err(error),
        Err(OrViews::Views(error)) => return Err(error),
    };
    let model = sizes.as_ref().map_or(model, |sizes| Arc::new(sizes.as_seen()));
    Ok(Person { model, start, search, sizes: Some(sizes) })
}

/// Why something was not found: for a reason of its own, or because a picture cannot be had.
pub(super) enum OrViews<T, E> {
    Own(T),
    Views(E),
}

impl<T, E> From<T> for OrViews<T, E> {
    fn from(error: T) -> Self {
        Self::Own(error)
    }
}

/// Poses of frames that are near enough to one another.
pub(super) fn follow<E: From<PersonError>>(
    model: &Arc<Model>,
    start: Pose,
    frames: &[usize],
    options: &PersonOptions,
    cancel: &CancelToken,
    views: &mut impl FnMut(usize) -> Result<Vec<FitView>, E>,
    progress: &mut impl FnMut(PersonProgress),
) -> Result<Vec<PosedFrame>, E> {
    let followed = options.followed(frames);
    let tracker =
        Tracker::new(Arc::clone(model), options.fit.clone(), start).map_err(PersonError::Options)?;
    let tracker = tracker.with_motion(Motion::Velocity, options.frame_rate).map_err(PersonError::Motion)?;
    let mut tracker = tracker.with_search(WhenToSearch::WhenPoor);
    let mut posed = Vec::with_capacity(followed.len());
    for (done, &frame) in followed.iter().enumerate() {
        progress(PersonProgress::Following(done, followed.len()));
        let estimate = tracker
            .track_frame(frame, views(frame)?, cancel)
            .map_err(|error| PersonError::Frame { frame, error })?;
        if cancel.is_cancelled() {
            return Err(PersonError::Cancelled.into());
        }
        posed.push(PosedFrame::from(&estimate));
    }
    Ok(posed)
}
