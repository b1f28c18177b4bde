//! The same of the person of a take with keypoints, of whom nothing is known: keypoints judge, they do not help.
//!
//! A body is acquired in the first frame and tracked through the take, all in one go; a fit of sizes is begun with it or without, on
//! frames of that track. There is no true body: lengths and radii are told beside those that were set by hand.

use std::sync::Arc;
use std::time::Instant;

use backlit_formats::Footage;
use backlit_tracking::body::{Kinematics, Limb, Model, Pose};
use backlit_tracking::body_fit::{BodyFitOptions, BodyFrame, frames};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::FitOptions;
use backlit_tracking::track::Tracker;
use serde::Serialize;

use super::{BodyMethod, BodyRow, Moments, PosedBody, Report};
use crate::experiment::{ExperimentError, Progress};

/// Which frames.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Options {
    /// Every how manieth frame is tracked.
    pub every: usize,
    /// Frames that sizes are fitted to, of those that were tracked.
    pub fitted: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self { every: 3, fitted: 8 }
    }
}

/// Finds the person by every method that needs nothing known. The take is opened with the
/// average body; lengths and radii are told beside those of `by_hand`, the person's own as far as they are known.
///
/// # Errors
/// Returns an error if pictures cannot be read, if nobody is seen in the first frame, or if it is cancelled.
pub fn run(
    footage: &Footage,
    by_hand: &Model,
    options: &Options,
    cancel: &CancelToken,
    mut on_progress: impl FnMut(Progress),
) -> Result<Report, ExperimentError> {
    let cameras: Vec<usize> = (0..footage.cameras.len()).collect();
    let wanted = (0..footage.take().frame_count()).step_by(options.every.max(1));
    let mut seen = Vec::new();
    for frame in wanted {
        seen.push(BodyFrame {
            frame,
            views: footage.fit_views(&cameras, frame)?,
            start: Pose::rest(footage.take().model()),
            joints: Vec::new(),
        });
    }
    let Some(first) = seen.first() else {
        return Err(ExperimentError::Option { option: "frames", value: 0.0, expected: "1 or more" });
    };
    let average = Arc::clone(footage.take().model());
    let views = &first.views;
    let mut rows: Vec<BodyRow> = Vec::new();
    // Frames with the poses of the track with the body that was grown.
    let mut followed: Option<(Arc<Model>, Vec<BodyFrame>)> = None;
    let total = BodyMethod::ALL.len();
    for (done, method) in BodyMethod::ALL.into_iter().enumerate() {
        on_progress(Progress { done, total });
        let needs_all = !matches!(method, BodyMethod::Scaled | BodyMethod::Templates | BodyMethod::Acquired);
        if needs_all && followed.is_none() {
            continue;
        }
        let moments = followed.as_ref().map(|(body, frames)| Moments {
            frames,
            body: Arc::clone(body),
            fit: BodyFitOptions::for_people(&average, false),
        });
        let began = Instant::now();
        let mut found = method.find(&average, views, moments.as_ref(), cancel);
        if let (Ok(body), true) = (&mut found, needs_all) {
            body.poses.truncate(1);
        }
        let seconds = began.elapsed().as_secs_f64();
        let tracked = match &found {
            Ok(body) => track(footage, body, &seen, cancel)?,
            Err(_) => Tracked::default(),
        };
        if method == BodyMethod::Acquired
            && let Ok(body) = &found
        {
            let numbers: Vec<usize> = (0..tracked.poses.len()).collect();
            let chosen = frames::spread(&numbers, options.fitted).into_iter();
            let frame = |at: usize| BodyFrame { start: tracked.poses[at].clone(), ..seen[at].clone() };
            followed = Some((Arc::clone(&body.model), chosen.map(frame).collect()));
        }
        rows.push(row(method, by_hand, found, seconds, &tracked));
        if cancel.is_cancelled() {
            return Err(ExperimentError::Cancelled);
        }
    }
    on_progress(Progress { done: total, total });
    Ok(Report { rows })
}

/// What a track gave.
#[derive(Default)]
struct Tracked {
    poses: Vec<Pose>,
    error_mm: Option<f64>,
    iou: f64,
}

/// Tracks all frames that were seen, from the body's own pose in the first.
fn track(
    footage: &Footage,
    body: &PosedBody,
    seen: &[BodyFrame],
    cancel: &CancelToken,
) -> Result<Tracked, ExperimentError> {
    let Some((_, start)) = body.poses.first() else { return Ok(Tracked::default()) };
    let mut tracker = Tracker::new(Arc::clone(&body.model), FitOptions::default(), start.clone())?;
    let mut tracked = Tracked::default();
    let mut errors = Vec::new();
    for frame in seen {
        let estimate = tracker.track_frame(frame.frame, frame.views.clone(), cancel)?;
        tracked.iou += estimate.iou().unwrap_or(0.0) / seen.len() as f64;
        let kinematics = Kinematics::new(&body.model, &estimate.pose);
        for (limb, at) in footage.take().reference().map(|all| all.joints(frame.frame)).unwrap_or_default() {
            let place = limb.map_or(estimate.pose.root, |limb| kinematics.ends()[limb]);
            errors.push(place.distance(at));
        }
        tracked.poses.push(estimate.pose);
    }
    let mean = 1e3 * errors.iter().sum::<f64>() / errors.len() as f64;
    tracked.error_mm = Some(mean).filter(|mean| mean.is_finite());
    Ok(tracked)
}

fn row(
    method: BodyMethod,
    by_hand: &Model,
    found: Result<PosedBody, String>,
    seconds: f64,
    tracked: &Tracked,
) -> BodyRow {
    let mean = |errors: Vec<f64>| 1e3 * errors.iter().sum::<f64>() / errors.len().max(1) as f64;
    let beside = |of: fn(&Limb) -> f64| match &found {
        Ok(body) => {
            let limbs = body.model.limbs().iter();
            let off = |limb: &Limb| {
                let other = by_hand.limb_index(&limb.name).map(|index| &by_hand.limbs()[index])?;
                Some((of(limb) - of(other)).abs())
            };
            mean(limbs.filter_map(off).collect())
        }
        Err(_) => f64::INFINITY,
    };
    BodyRow {
        person: "the take's person",
        method,
        seconds,
        length_mm: beside(|limb| limb.length),
        radius_mm: beside(|limb| limb.radius),
        iou: tracked.iou,
        joints_mm: tracked.error_mm.unwrap_or(f64::INFINITY),
        track_mm: tracked.error_mm,
        failure: found.err(),
    }
}
