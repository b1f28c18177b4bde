//! The same of the person of a take with keypoints, of whom nothing is known: keypoints judge, they do not help.
//!
//! A body is acquired in the first frame and tracked through the take, all in one go; a fit of sizes is begun with it or without, on
//! frames of that track. There is no true body: lengths and radii are told beside those that were set by hand.

use std::sync::Arc;
use std::time::Instant;

use anyhow::{Context, Result};
use backlit_formats::Footage;
use backlit_tracking::body::{Kinematics, Limb, Model, Pose};
use backlit_tracking::body_fit::{BodyFitOptions, BodyFrame, frames};
use backlit_tracking::fit::FitOptions;
use backlit_tracking::track::Tracker;
use serde::Serialize;

use super::{BodyMethod, BodyRow, Moments, PosedBody, Report, mean_mm};
use crate::experiment::{Experiment, Run};

/// A take's person.
#[derive(Debug, Serialize)]
pub(super) struct AcquiredTake {
    /// Every how manieth frame is tracked.
    pub(super) every: usize,
    /// Frames that sizes are fitted to, of those that were tracked.
    pub(super) fitted: usize,
    /// The take, opened with the average body.
    #[serde(skip)]
    pub(super) footage: Arc<Footage>,
    /// The person's own body, as far as it is known.
    #[serde(skip)]
    pub(super) by_hand: Arc<Model>,
}

impl Experiment for AcquiredTake {
    const NAME: &'static str = "acquire";
    type Report = Report;

    /// Finds the person by every method that needs nothing known.
    fn run(&mut self, run: &Run) -> Result<Report> {
        let footage = &self.footage;
        let cameras: Vec<usize> = (0..footage.cameras.len()).collect();
        let mut seen = Vec::new();
        for frame in (0..footage.take().frame_count()).step_by(self.every) {
            let views = footage.fit_views(&cameras, frame)?;
            let start = Pose::rest(footage.take().model());
            seen.push(BodyFrame { frame, views, start, joints: Vec::new() });
        }
        let views = &seen.first().context("`frames` is 0; expected 1 or more")?.views;
        let average = Arc::clone(footage.take().model());
        let mut rows: Vec<BodyRow> = Vec::new();
        // Frames with the poses of the track with the body that was grown.
        let mut followed: Option<(Arc<Model>, Vec<BodyFrame>)> = None;
        for (done, method) in BodyMethod::ALL.into_iter().enumerate() {
            run.progress(done, BodyMethod::ALL.len())?;
            let needs_all =
                !matches!(method, BodyMethod::Scaled | BodyMethod::Templates | BodyMethod::Acquired);
            if needs_all && followed.is_none() {
                continue;
            }
            let moments = followed.as_ref().map(|(body, frames)| Moments {
                frames,
                body: Arc::clone(body),
                fit: BodyFitOptions::for_people(&average, false),
            });
            let began = Instant::now();
            let mut found = method.find(&average, views, moments.as_ref(), &run.cancel);
            if let (Ok(body), true) = (&mut found, needs_all) {
                body.poses.truncate(1);
            }
            let seconds = began.elapsed().as_secs_f64();
            let tracked = match &found {
                Ok(body) => self.track(body, &seen, run)?,
                Err(_) => Tracked::default(),
            };
            if method == BodyMethod::Acquired
                && let Ok(body) = &found
            {
                let numbers: Vec<usize> = (0..tracked.poses.len()).collect();
                let chosen = frames::spread(&numbers, self.fitted).into_iter();
                let frame = |at: usize| BodyFrame { start: tracked.poses[at].clone(), ..seen[at].clone() };
                followed = Some((Arc::clone(&body.model), chosen.map(frame).collect()));
            }
            rows.push(self.row(method, found, seconds, &tracked));
            run.check()?;
        }
        Ok(Report { rows })
    }

    fn table(&self, report: &Report) -> String {
        super::table(report)
    }
}

/// What a track gave.
#[derive(Default)]
struct Tracked {
    poses: Vec<Pose>,
    error_mm: Option<f64>,
    iou: f64,
}

impl AcquiredTake {
    /// Tracks all frames that were seen, from the body's own pose in the first.
    fn track(&self, body: &PosedBody, seen: &[BodyFrame], run: &Run) -> Result<Tracked> {
        let Some((_, start)) = body.poses.first() else { return Ok(Tracked::default()) };
        let mut tracker = Tracker::new(Arc::clone(&body.model), FitOptions::default(), start.clone())?;
        let mut tracked = Tracked::default();
        let mut errors = Vec::new();
        for frame in seen {
            let estimate = tracker.track_frame(frame.frame, frame.views.clone(), &run.cancel)?;
            run.check()?;
            tracked.iou += estimate.iou().unwrap_or(0.0) / seen.len() as f64;
            let kinematics = Kinematics::new(&body.model, &estimate.pose);
            let reference = self.footage.take().reference();
            for (limb, at) in reference.map(|all| all.joints(frame.frame)).unwrap_or_default() {
                let place = limb.map_or(estimate.pose.root, |limb| kinematics.ends()[limb]);
                errors.push(place.distance(at));
            }
            tracked.poses.push(estimate.pose);
        }
        tracked.error_mm = (!errors.is_empty()).then(|| mean_mm(&errors)).filter(|mean| mean.is_finite());
        Ok(tracked)
    }

    fn row(&self, method: BodyMethod, found: Result<PosedBody>, seconds: f64, tracked: &Tracked) -> BodyRow {
        let beside = |of: fn(&Limb) -> f64| {
            let Ok(body) = &found else { return f64::INFINITY };
            let off = |limb: &Limb| {
                let other = &self.by_hand.limbs()[self.by_hand.limb_index(&limb.name)?];
                Some((of(limb) - of(other)).abs())
            };
            mean_mm(&body.model.limbs().iter().filter_map(off).collect::<Vec<_>>())
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
            failure: found.err().map(|error| error.to_string()),
        }
    }
}
