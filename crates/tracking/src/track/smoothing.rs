//! A track smoothed by what later frames say of earlier ones.

use std::collections::VecDeque;

use nalgebra::DVector;
use thiserror::Error;

use super::estimate::{FrameEstimate, Track};
use crate::body::{Parameters, Pose};
use crate::filter::{Belief, FilterError, smoother};

/// Why a track cannot be smoothed.
#[derive(Debug, Error, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum SmoothingError {
    #[error(
        "frame {forward} was tracked forwards and frame {backward} backwards; expected frames of one direction"
    )]
    BothDirections { forward: usize, backward: usize },
    #[error("frame {frame}: {error}")]
    Filter { frame: usize, error: FilterError },
}

/// The track smoothed by what later frames say of earlier ones (Rauch, Tung, Striebel): by all of them, or, with a
/// `lag`, by so many frames after each, as a live track could show that many frames late.
///
/// Frames are taken in the order in which they were tracked; a frame without a belief, or with which nothing
/// was foretold, begins anew. Costs and overlaps stay those of the filtered poses; overlaps can be measured anew
/// ([`FrameEstimate::measure_overlap`]).
///
/// # Errors
/// Frames of both directions: they are two tracks, to be smoothed each by itself. A covariance that is certain of a
/// direction.
pub fn smoothed(track: &Track, lag: Option<usize>) -> Result<Track, SmoothingError> {
    let mut order: Vec<&FrameEstimate> = track.frames.values().collect();
    if runs_back(&order)? {
        order.reverse();
    }
    let mut smoother = FixedLagSmoother::new(lag.unwrap_or(order.len()));
    let mut smoothed = Track::default();
    let mut keep = |estimate: FrameEstimate| smoothed.frames.insert(estimate.frame, estimate);
    if lag.is_some() {
        for estimate in order {
            smoother.push(estimate.clone())?.map(&mut keep);
        }
    } else {
        smoother.waiting.extend(order.into_iter().cloned());
    }
    smoother.finish()?.into_iter().for_each(|estimate| {
        keep(estimate);
    });
    Ok(smoothed)
}

/// Whether frames were tracked backwards.
fn runs_back(frames: &[&FrameEstimate]) -> Result<bool, SmoothingError> {
    let seconds = |estimate: &FrameEstimate| Some(estimate.belief.as_ref()?.predicted.as_ref()?.seconds);
    let one = |runs: fn(f64) -> bool| {
        frames.iter().find(|estimate| seconds(estimate).is_some_and(runs)).map(|estimate| estimate.frame)
    };
    match (one(|seconds| seconds > 0.0), one(|seconds| seconds < 0.0)) {
        (Some(forward), Some(backward)) => Err(SmoothingError::BothDirections { forward, backward }),
        (_, backward) => Ok(backward.is_some()),
    }
}

/// Smooths frame after frame, each by so many after it. It keeps no more frames than that.
#[derive(Debug, Clone)]
pub struct FixedLagSmoother {
    lag: usize,
    /// In the order in which they were tracked.
    waiting: VecDeque<FrameEstimate>,
}

impl FixedLagSmoother {
    /// Smooths by `lag` later frames.
    #[must_use]
    pub fn new(lag: usize) -> Self {
        Self { lag, waiting: VecDeque::new() }
    }

    /// Takes the next frame in the order of tracking; gives the one that `lag` frames have followed by now, smoothed.
    ///
    /// # Errors
    /// A covariance that is certain of a direction.
    pub fn push(&mut self, estimate: FrameEstimate) -> Result<Option<FrameEstimate>, SmoothingError> {
        self.waiting.push_back(estimate);
        if self.waiting.len() <= self.lag {
            return Ok(None);
        }
        let mut later = None;
        for index in (0..self.waiting.len()).rev() {
            later = smoothed_by(&self.waiting[index], self.waiting.get(index + 1), later)?;
        }
        Ok(self.waiting.pop_front().map(|estimate| replaced(estimate, later)))
    }

    /// The frames that still wait, smoothed by all that there are.
    ///
    /// # Errors
    /// A covariance that is certain of a direction.
    pub fn finish(&mut self) -> Result<Vec<FrameEstimate>, SmoothingError> {
        let waiting: Vec<FrameEstimate> = std::mem::take(&mut self.waiting).into();
        let mut found = Vec::with_capacity(waiting.len());
        let mut later = None;
        for index in (0..waiting.len()).rev() {
            later = smoothed_by(&waiting[index], waiting.get(index + 1), later)?;
            found.push(later.clone());
        }
        Ok(waiting.into_iter().zip(found.into_iter().rev()).map(|(frame, by)| replaced(frame, by)).collect())
    }
}

fn replaced(mut estimate: FrameEstimate, by: Option<(Pose, Belief)>) -> FrameEstimate {
    if let Some((pose, belief)) = by
        && let Some(frame_belief) = &mut estimate.belief
    {
        estimate.pose = pose;
        frame_belief.belief = belief;
    }
    estimate
}

/// A frame's pose and belief given the next frame's; its own where nothing is known of a next one.
fn smoothed_by(
    here: &FrameEstimate,
    next: Option<&FrameEstimate>,
    later: Option<(Pose, Belief)>,
) -> Result<Option<(Pose, Belief)>, SmoothingError> {
    let Some(filtered) = here.belief.as_ref().map(|belief| &belief.belief) else { return Ok(None) };
    let predicted = next.and_then(|next| next.belief.as_ref()?.predicted.as_ref());
    let Some((predicted, (pose, belief))) = predicted.zip(later) else {
        return Ok(Some((here.pose.clone(), filtered.clone())));
    };
    let difference = DVector::from_vec(pose.local(&predicted.mean));
    let model = predicted.noise.model(filtered.columns());
    let found =
        smoother::smooth(&model, filtered, &predicted.belief, &belief, &difference, predicted.seconds)
            .map_err(|error| SmoothingError::Filter { frame: here.frame, error })?;
    Ok(Some((here.pose.retract(Parameters::Tangent, found.step.as_slice()), found.belief)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::builtin;
    use crate::track::motion::{KalmanOptions, MotionFilter};
    use nalgebra::DMatrix;

    /// A limb that the filter follows through these frames of a movement.
    fn followed(frames: &[usize]) -> Vec<FrameEstimate> {
        let model = builtin::single_limb();
        let mut filter = MotionFilter::new(&model, KalmanOptions::default());
        let mut last = None;
        let mut found = Vec::new();
        for &frame in frames {
            let seconds = frame as f64 / 30.0;
            let step = [0.1 * seconds, 0.0, 0.0, 0.4 * (5.0 * seconds).sin(), 0.2, 0.3 * seconds];
            let pose = Pose::rest(&model).retract(Parameters::Tangent, &step);
            let predicted = last
                .and_then(|before: usize| filter.predict(seconds - before as f64 / 30.0))
                .ok_or(crate::track::Begins::First);
            let products = DMatrix::from_diagonal_element(6, 6, 4e6);
            let belief = Some(filter.learn(&pose, Some((products, DVector::zeros(6))), predicted));
            last = Some(frame);
            found.push(FrameEstimate { belief, ..FrameEstimate::of_pose(frame, pose) });
        }
        found
    }

    fn track(frames: Vec<FrameEstimate>) -> Track {
        Track { frames: frames.into_iter().map(|estimate| (estimate.frame, estimate)).collect() }
    }

    #[test]
    fn frames_of_both_directions_are_no_track() {
        let mut both = followed(&[4, 5, 6, 9]);
        both.extend(followed(&[3, 2, 0]));
        for lag in [None, Some(2)] {
            let error = smoothed(&track(both.clone()), lag).unwrap_err();
            assert_eq!(error, SmoothingError::BothDirections { forward: 5, backward: 0 });
        }
        assert!(smoothed(&track(followed(&[9, 8, 3, 2])), None).is_ok());
    }

    /// A lag of all frames is the whole smoother, forwards and backwards, with uneven gaps.
    #[test]
    fn a_lag_as_long_as_the_track_is_no_lag() {
        for frames in [[0, 1, 2, 7, 8, 20], [20, 8, 7, 2, 1, 0]] {
            let track = track(followed(&frames));
            let whole = smoothed(&track, None).unwrap();
            assert_eq!(smoothed(&track, Some(6)).unwrap(), whole);
            assert_eq!(smoothed(&track, Some(0)).unwrap(), track);
            assert_ne!(whole, track);
        }
    }
}
