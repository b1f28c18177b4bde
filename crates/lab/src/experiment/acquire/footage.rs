//! The same of the person of a take with keypoints, of whom nothing is known: keypoints judge, they do not help.
//!
//! A body is acquired in the first frame and tracked through the take, all in one go; a fit of sizes is begun with it or without, on
//! frames of that track. There is no true body: lengths and radii are told beside those that were set by hand.

use std::sync::Arc;
use std::time::Instant;

use backlit_formats::Footage;
use backlit_tracking::acquisition::{AcquireOptions, FirstPose, acquire, acquire_posed};
use backlit_tracking::body::{Kinematics, Model, Pose};
use backlit_tracking::body_fit::{BodyFitOptions, BodyFrame, fit_body, fit_body_from, frames};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::FitOptions;
use backlit_tracking::search::{WithoutStart, without_start};
use backlit_tracking::templates::TemplateOptions;
use backlit_tracking::track::Tracker;
use serde::Serialize;

use super::{Body, Report, Row, Way, number, words};
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

/// Finds the person in every way that needs nothing known. The take is opened with the
/// average body; lengths and radii are told beside those of `by_hand`, the person's own as far as they are known.
///
/// # Errors
/// Pictures that cannot be read, a take in whose first frame nobody is seen, or `cancel`.
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
    let scale_body = WithoutStart { scale_body: true, ..WithoutStart::default() };
    let by = |pose: FirstPose| AcquireOptions { pose, ..AcquireOptions::default() };
    let ways = [
        Way::Scaled,
        Way::Templates,
        Way::Acquired,
        Way::AcquiredInAll,
        Way::Fitted,
        Way::FittedFromAcquired,
    ];
    let mut rows: Vec<Row> = Vec::new();
    // Frames with the poses of the track with the body that was grown.
    let mut followed: Option<(Arc<Model>, Vec<BodyFrame>)> = None;
    for (done, way) in ways.into_iter().enumerate() {
        on_progress(Progress { done, total: ways.len() });
        let began = Instant::now();
        let found: Result<Body, String> = match way {
            Way::Scaled => without_start(&average, views, &scale_body, cancel)
                .map(|found| Body {
                    model: Arc::clone(&found.model),
                    poses: number(vec![found.pose().clone()]),
                })
                .map_err(words),
            Way::Templates | Way::Acquired => {
                let pose = match way {
                    Way::Templates => FirstPose::Templates(TemplateOptions::default()),
                    _ => FirstPose::Search(scale_body.clone()),
                };
                acquire(&average, views, &by(pose), cancel)
                    .map(|found| Body { model: found.model, poses: number(found.poses) })
                    .map_err(words)
            }
            Way::AcquiredInAll | Way::Fitted | Way::FittedFromAcquired => {
                let Some((grown, frames)) = &followed else { continue };
                in_all(way, &average, grown, frames, cancel)
            }
        };
        let seconds = began.elapsed().as_secs_f64();
        let tracked = match &found {
            Ok(body) => track(footage, body, &seen, cancel)?,
            Err(_) => Tracked::default(),
        };
        if way == Way::Acquired
            && let Ok(body) = &found
        {
            let numbers: Vec<usize> = (0..tracked.poses.len()).collect();
            let chosen = frames::spread(&numbers, options.fitted).into_iter();
            let frame = |at: usize| BodyFrame { start: tracked.poses[at].clone(), ..seen[at].clone() };
            followed = Some((Arc::clone(&body.model), chosen.map(frame).collect()));
        }
        rows.push(row(way, by_hand, found, seconds, &tracked));
        if cancel.is_cancelled() {
            return Err(ExperimentError::Cancelled);
        }
    }
    on_progress(Progress { done: ways.len(), total: ways.len() });
    Ok(Report { rows })
}

fn in_all(
    way: Way,
    average: &Arc<Model>,
    grown: &Arc<Model>,
    frames: &[BodyFrame],
    cancel: &CancelToken,
) -> Result<Body, String> {
    let options = BodyFitOptions::for_people(average, false);
    let first = |poses: Vec<Pose>| number(poses.into_iter().take(1).collect());
    let fitted = match way {
        Way::AcquiredInAll => {
            let posed: Vec<_> =
                frames.iter().map(|frame| (frame.views.clone(), frame.start.clone())).collect();
            let found = acquire_posed(grown, &posed, &AcquireOptions::default(), cancel).map_err(words)?;
            return Ok(Body { model: found.model, poses: first(found.poses) });
        }
        Way::Fitted => fit_body(Arc::clone(average), frames.to_vec(), None, &options, cancel, |_| {}),
        _ => fit_body_from(Arc::clone(average), frames.to_vec(), grown, &options, cancel, |_| {}),
    };
    let fitted = fitted.map_err(words)?;
    Ok(Body { model: Arc::new(fitted.model), poses: first(fitted.poses) })
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
    body: &Body,
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

fn row(way: Way, by_hand: &Model, found: Result<Body, String>, seconds: f64, tracked: &Tracked) -> Row {
    let mean = |errors: Vec<f64>| 1e3 * errors.iter().sum::<f64>() / errors.len().max(1) as f64;
    let beside = |of: fn(&backlit_tracking::body::Limb) -> f64| match &found {
        Ok(body) => {
            let limbs = body.model.limbs().iter();
            let off = |limb: &backlit_tracking::body::Limb| {
                let other = by_hand.limb_index(&limb.name).map(|index| &by_hand.limbs()[index])?;
                Some((of(limb) - of(other)).abs())
            };
            mean(limbs.filter_map(off).collect())
        }
        Err(_) => f64::INFINITY,
    };
    Row {
        person: "the take's person",
        way,
        seconds,
        length_mm: beside(|limb| limb.length),
        radius_mm: beside(|limb| limb.radius),
        iou: tracked.iou,
        joints_mm: tracked.error_mm.unwrap_or(f64::INFINITY),
        track_mm: tracked.error_mm,
        failure: found.err(),
    }
}
