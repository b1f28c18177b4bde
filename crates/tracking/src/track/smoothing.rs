//! A track smoothed by what later frames say of earlier ones.

use std::collections::VecDeque;

use nalgebra::DVector;
use thiserror::Error;

use super::estimate::{FrameEstimate, Track};
use super::memory::{WaitingFrame, waiting_again};
use super::motion::MotionModel;
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
/// `lag`, by this many frames after each, as a live track could show that many frames late.
///
/// Frames are taken in the order in which they were tracked; a frame without a belief, or with which nothing
/// was predicted, begins again. Costs and overlaps stay those of the filtered poses; overlaps can be measured again
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
    let mut smoother = Smoother { wait: Wait::Exactly(lag.unwrap_or(order.len())), waiting: VecDeque::new() };
    let mut smoothed = Track::default();
    let mut keep = |known: Vec<FrameEstimate>| {
        smoothed.frames.extend(known.into_iter().map(|estimate| (estimate.frame, estimate)));
    };
    for estimate in order {
        keep(smoother.take(estimate.clone())?);
    }
    keep(smoother.take_rest()?);
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

/// Frames after each that a [`Smoother`] waits for where all that come later count. With the default noise a velocity is
/// forgotten within 0.3 s: what is this many frames later moves a joint that is seen by less than 10⁻⁶ rad. A joint that nobody
/// sees for longer than this is not moved by what is seen of it afterwards.
pub const WHOLE_LAG: usize = 64;

/// How many frames after it a frame waits for.
#[derive(Debug, Clone, Copy)]
enum Wait {
    /// This many: the smoother runs back over all of them for every frame.
    Exactly(usize),
    /// At least this many, up to twice as many: the smoother runs back once for this many frames.
    AtLeast(usize),
}

/// Smooths frame after frame in bounded memory, each by frames that come after it. What it gives is without what only
/// smoothing needs ([`FrameEstimate::settled`]).
#[derive(Debug, Clone)]
pub struct Smoother {
    wait: Wait,
    /// In the order in which they were tracked.
    waiting: VecDeque<FrameEstimate>,
}

impl Smoother {
    /// Smooths by `lag` later frames, as a live track could show that many frames late; by all that could count
    /// ([`WHOLE_LAG`] or more) where there is no lag.
    #[must_use]
    pub fn new(lag: Option<usize>) -> Self {
        Self { wait: lag.map_or(Wait::AtLeast(WHOLE_LAG), Wait::Exactly), waiting: VecDeque::new() }
    }

    /// The frames that wait now, in the order of tracking.
    #[must_use]
    pub fn waiting(&self) -> Vec<WaitingFrame> {
        let one = |estimate: &FrameEstimate| {
            let belief = estimate.belief.as_ref();
            WaitingFrame {
                frame: estimate.frame,
                pose: estimate.pose.clone(),
                belief: belief.map(|found| found.belief.clone()),
                goes_on: belief.is_some_and(|found| found.predicted.is_some()),
            }
        };
        self.waiting.iter().map(one).collect()
    }

    /// The smoother again that these frames waited in, with a filter of this motion at this frame rate. `known` is what else is
    /// known of them, in the same order.
    #[must_use]
    pub fn with_waiting(
        mut self,
        known: Vec<FrameEstimate>,
        waiting: Vec<WaitingFrame>,
        motion: &MotionModel,
        frame_rate: f64,
    ) -> Self {
        self.waiting = waiting_again(known, waiting, motion, 1.0 / frame_rate).into();
        self
    }

    /// Takes the next frame in the order of tracking; gives those that enough frames have followed by now, smoothed.
    ///
    /// # Errors
    /// A covariance that is certain of a direction.
    pub fn push(&mut self, estimate: FrameEstimate) -> Result<Vec<FrameEstimate>, SmoothingError> {
        Ok(self.take(estimate)?.into_iter().map(FrameEstimate::settled).collect())
    }

    /// The frames that still wait, smoothed by all that there are.
    ///
    /// # Errors
    /// A covariance that is certain of a direction.
    pub fn finish(&mut self) -> Result<Vec<FrameEstimate>, SmoothingError> {
        Ok(self.take_rest()?.into_iter().map(FrameEstimate::settled).collect())
    }

    fn take(&mut self, estimate: FrameEstimate) -> Result<Vec<FrameEstimate>, SmoothingError> {
        self.waiting.push_back(estimate);
        let known = match self.wait {
            Wait::Exactly(lag) => self.waiting.len().saturating_sub(lag),
            Wait::AtLeast(lag) => self.waiting.len() / (2 * lag) * lag,
        };
        self.give(known)
    }

    fn take_rest(&mut self) -> Result<Vec<FrameEstimate>, SmoothingError> {
        self.give(self.waiting.len())
    }

    /// The first `known` of the waiting frames.
    fn give(&mut self, known: usize) -> Result<Vec<FrameEstimate>, SmoothingError> {
        let mut found = VecDeque::with_capacity(known);
        let mut later = None;
        for index in (0..self.waiting.len()).rev().take_while(|_| known > 0) {
            later = smoothed_by(&self.waiting[index], self.waiting.get(index + 1), later)?;
            if index < known {
                found.push_front(later.clone());
            }
        }
        Ok(self.waiting.drain(..known).zip(found).map(|(estimate, by)| replaced(estimate, by)).collect())
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
    let model = predicted.motion.constant_velocity();
    let (step, belief) =
        smoother::smooth(&model, filtered, &predicted.belief, &belief, &difference, predicted.seconds)
            .map_err(|error| SmoothingError::Filter { frame: here.frame, error })?;
    Ok(Some((here.pose.retract(Parameters::Tangent, step.as_slice()), belief)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::builtin;
    use crate::track::motion::{Begins, FrameBelief, FrameMeasurement, KalmanOptions, Predicted};
    use nalgebra::DMatrix;

    /// A limb that the filter follows through these frames of a movement.
    fn followed(frames: &[usize]) -> Vec<FrameEstimate> {
        let model = builtin::single_limb();
        let motion = MotionModel::new(KalmanOptions::default(), &model, None);
        let mut found: Vec<FrameEstimate> = Vec::new();
        for &frame in frames {
            let seconds = frame as f64 / 30.0;
            let step = [0.1 * seconds, 0.0, 0.0, 0.4 * (5.0 * seconds).sin(), 0.2, 0.3 * seconds];
            let pose = Pose::rest(&model).retract(Parameters::Tangent, &step);
            let prediction = |before: &FrameEstimate| {
                let (belief, since) = (before.belief.as_ref().unwrap(), frame as f64 - before.frame as f64);
                Predicted::after(motion.clone(), &before.pose, &belief.belief, since * (1.0 / 30.0)).into()
            };
            let predicted = found.last().map(prediction).ok_or(Begins::First);
            let products = DMatrix::from_diagonal_element(6, 6, 4e6);
            let measurement = FrameMeasurement { products, pull: DVector::zeros(6), variance: 100.0 * 100.0 };
            let belief = FrameBelief::learnt(&pose, Some(measurement), predicted);
            found.push(FrameEstimate { belief: Some(belief), ..FrameEstimate::of_pose(frame, pose) });
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

    /// A long track in blocks is what the whole smoother makes of it, backwards too, and memory does not grow with it.
    #[test]
    fn a_long_track_is_smoothed_in_bounded_memory() {
        let forwards: Vec<usize> = (0..400).collect();
        let backwards: Vec<usize> = forwards.iter().rev().copied().collect();
        for frames in [forwards, backwards] {
            let all = followed(&frames);
            let whole = smoothed(&track(all.clone()), None).unwrap();
            let mut smoother = Smoother::new(None);
            let mut known = Vec::new();
            for estimate in all {
                known.extend(smoother.push(estimate).unwrap());
                assert!(smoother.waiting.len() < 2 * WHOLE_LAG, "{}", smoother.waiting.len());
            }
            known.extend(smoother.finish().unwrap());
            assert_eq!((known.len(), smoother.waiting.len()), (400, 0));
            let mut farthest = 0.0_f64;
            for estimate in &known {
                let other = &whole.frames[&estimate.frame];
                farthest = estimate.pose.local(&other.pose).iter().fold(farthest, |far, x| far.max(x.abs()));
                let belief = estimate.belief.as_ref().unwrap();
                let is_needed = belief.predicted.is_some() || belief.measurement.is_some();
                assert!(!is_needed, "what only smoothing needs is gone");
            }
            assert!(farthest < 1e-6, "{farthest}");
            // What smoothing does is far more than that.
            let moved =
                whole.frames.values().zip(followed(&frames)).filter(|(a, b)| a.pose != b.pose).count();
            assert!(moved > 300, "{moved}");
        }
    }

    /// What waits is all that is needed to smooth as if nothing had come between: poses and beliefs are the same to the bit.
    #[test]
    fn a_smoother_goes_on_where_another_stopped() {
        let smooth = |found: Vec<FrameEstimate>| -> Vec<(usize, Pose, Belief)> {
            let belief = |estimate: &FrameEstimate| estimate.belief.as_ref().unwrap().belief.clone();
            found.iter().map(|estimate| (estimate.frame, estimate.pose.clone(), belief(estimate))).collect()
        };
        let frames: Vec<usize> = (0..200).filter(|frame| *frame != 150).collect();
        for lag in [None, Some(3), Some(0)] {
            let all = followed(&frames);
            let mut whole = Smoother::new(lag);
            let mut before = Vec::new();
            for estimate in &all[..120] {
                before.extend(whole.push(estimate.clone()).unwrap());
            }
            let waiting = whole.waiting();
            let known = waiting
                .iter()
                .map(|frame| FrameEstimate::of_pose(frame.frame, Pose::rest(&builtin::single_limb())));
            let mut again = Smoother::new(lag).with_waiting(
                known.collect(),
                waiting.clone(),
                &MotionModel::new(KalmanOptions::default(), &builtin::single_limb(), None),
                30.0,
            );
            assert_eq!(again.waiting.len(), 120 - before.len());
            for estimate in &all[120..] {
                let [one, other] =
                    [&mut again, &mut whole].map(|smoother| smooth(smoother.push(estimate.clone()).unwrap()));
                assert!(one == other, "frame {}", estimate.frame);
            }
            let [one, other] = [again, whole].map(|mut smoother| smooth(smoother.finish().unwrap()));
            assert!(one == other, "the rest");
        }
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
