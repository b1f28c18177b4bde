//! From the start of one frame to the poses of several: the body is scaled as a whole to the first frame, then tracked.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::fit::{BodyFitError, FirstSizes, fit_body};
use super::frames::BodyFrame;
use super::options::BodyFitOptions;
use super::scale;
use crate::body::{Model, Pose, SizeChoice};
use crate::cancel::CancelToken;
use crate::fit::{FitOptions, FitView};
use crate::metrics::ReferenceJoints;
use crate::track::Tracker;

/// How many of a fit's stages the first frame's goes through: as far as a body of other proportions can be near.
const FIRST_STAGES: usize = 3;

/// What to approach, and from where.
#[derive(Debug, Clone, PartialEq)]
pub struct Approach {
    /// A pose near the first frame's.
    pub start: Pose,
    /// The body's size as a logarithm of the model's, where it is known; else silhouettes say.
    pub size: Option<f64>,
    /// Frames wanted, in any order; the start is that of the smallest.
    pub frames: Vec<usize>,
    /// On the way, every n frames are looked at.
    pub step: usize,
}

/// Follows the body to every wanted frame. Returns the size, as a logarithm of the model's, and the frames; those in
/// which the body was lost are left out.
///
/// `views(frame)` gives what the cameras see, `joints(frame)` the joints that are known; `progress(done, all)` counts the
/// frames on the way.
///
/// # Errors
/// What `views` returns, or as [`fit_body`].
pub fn approach<E: From<BodyFitError>>(
    model: &Arc<Model>,
    approach: &Approach,
    options: &BodyFitOptions,
    cancel: &CancelToken,
    mut views: impl FnMut(usize) -> Result<Vec<FitView>, E>,
    joints: impl Fn(usize) -> ReferenceJoints,
    mut progress: impl FnMut(usize, usize),
) -> Result<(f64, Vec<BodyFrame>), E> {
    let wanted: BTreeSet<usize> = approach.frames.iter().copied().collect();
    let (Some(&first), Some(&last)) = (wanted.first(), wanted.last()) else {
        return Err(BodyFitError::NoFrames.into());
    };
    let path: Vec<usize> = (first..=last)
        .filter(|frame| (frame - first) % approach.step.max(1) == 0 || wanted.contains(frame))
        .collect();
    let at_frame = |frame| move |error| E::from(BodyFitError::Frame { frame, error });
    let seen = views(first)?;
    let mut start = BodyFrame {
        frame: first,
        views: seen.clone(),
        start: approach.start.normalized(),
        joints: joints(first),
    };
    let size = approach.size.unwrap_or_else(|| {
        let (rough, poses) = scale::from_silhouettes(model, std::slice::from_ref(&start), 0.0);
        start.start = poses.into_iter().next().unwrap_or_else(|| start.start.clone());
        rough
    });
    // One frame says little of proportions.
    let choice = SizeChoice { lengths: false, radii: false, ..options.choice };
    let mut whole = BodyFitOptions { choice, ..options.clone() };
    whole.stages.truncate(FIRST_STAGES);
    let scaled = fit_body(model.clone(), vec![start], FirstSizes::Scaled(size), &whole, cancel, |_| {})?;
    let pose = scaled.poses[0].clone();
    // Where this ends decides whether a widening is believed: on all processors alike.
    let exact = FitOptions { exact: true, ..FitOptions::default() };
    let mut tracker =
        Tracker::new(Arc::new(scaled.model), exact, pose).map_err(at_frame(first))?.continuing_from(first);
    let mut found = Vec::with_capacity(wanted.len());
    for (done, &frame) in path.iter().enumerate() {
        if cancel.is_cancelled() {
            return Err(BodyFitError::Cancelled.into());
        }
        let views = if frame == first { seen.clone() } else { views(frame)? };
        let estimate = tracker.track_frame(frame, views.clone(), cancel).map_err(at_frame(frame))?;
        if !estimate.is_lost() && wanted.contains(&frame) {
            found.push(BodyFrame { frame, views, start: estimate.pose, joints: joints(frame) });
        }
        progress(done + 1, path.len());
    }
    if found.is_empty() {
        return Err(BodyFitError::Lost { frame: first }.into());
    }
    Ok((scaled.size.ln(), found))
}
