//! First bodies: acquired in one pass by growing templates, beside those that a fit of sizes finds and the average body.
//!
//! Simulated people of several builds before four cameras, exact silhouettes. Nothing is known of them: neither size nor pose nor
//! joints. A fit of sizes is given poses that are 5° and 3 cm off, as in the experiment on sizes. With every body the movement is then
//! tracked from the pose that it was found in.

pub mod footage;

use std::fmt::Write as _;
use std::sync::Arc;
use std::time::Instant;

use backlit_tracking::acquisition::{AcquireOptions, Acquired, FirstPose, acquire, acquire_posed};
use backlit_tracking::body::{Kinematics, Model, Pose, builtin};
use backlit_tracking::body_fit::{
    BodyFitError, BodyFitOptions, BodyFrame, WELL_SEEN, fit_body, fit_body_from,
};
use backlit_tracking::camera::Camera;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{FitOptions, FitView};
use backlit_tracking::render::RendererKind;
use backlit_tracking::search::{WithoutStart, start, without_start};
use backlit_tracking::templates::TemplateOptions;
use backlit_tracking::track::Tracker;
use serde::Serialize;

use super::{ExperimentError, Progress, scene};
use crate::synthetic::people::{PEOPLE, Person};
use crate::synthetic::{capsules, motion, studio};

/// How a body was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Way {
    /// The average body, scaled to the hull; the search's pose.
    Scaled,
    /// Grown in one moment from the pose that templates give.
    Templates,
    /// Grown in one moment from the pose that the search finds.
    Acquired,
    /// Grown in all moments, poses given about.
    AcquiredInAll,
    /// The fit of sizes in all moments, poses given about.
    Fitted,
    /// The same, begun with what was grown.
    FittedFromAcquired,
}

impl Way {
    /// What tables call it.
    #[must_use]
    pub fn label(self) -> &'static str {
        match self {
            Self::Scaled => "average, scaled",
            Self::Templates => "grown from templates",
            Self::Acquired => "grown",
            Self::AcquiredInAll => "grown in all moments",
            Self::Fitted => "fitted",
            Self::FittedFromAcquired => "fitted from grown",
        }
    }
}

/// What to vary.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Options {
    /// How many of the builds.
    pub people: usize,
    /// Moments of the built-in movement; the first is the one of which nothing is known.
    pub moments: Vec<f64>,
    /// Frames that are tracked with every body, from the first moment on; 0 for none.
    pub tracked: usize,
    /// Seed of the poses that are given about.
    pub seed: u64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            people: PEOPLE.len(),
            moments: vec![8.0, 0.0, 16.0, 24.0, 31.0, 41.0, 50.0, 59.0],
            tracked: 30,
            seed: 1,
        }
    }
}

/// What came of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// One entry a build and way.
    pub rows: Vec<Row>,
}

/// One body.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// The build.
    pub person: &'static str,
    /// How it was found.
    pub way: Way,
    /// Why nothing was.
    pub failure: Option<String>,
    /// Wall time, seconds.
    pub seconds: f64,
    /// Mean error of lengths, millimetres.
    pub length_mm: f64,
    /// Mean error of radii, millimetres.
    pub radius_mm: f64,
    /// Overlap of all cameras in the moments that it was found in.
    pub iou: f64,
    /// Mean error of all joints in these moments, millimetres.
    pub joints_mm: f64,
    /// Mean error of all joints, tracked with this body, millimetres.
    pub track_mm: Option<f64>,
}

/// A table of all rows.
#[must_use]
pub fn table(report: &Report) -> String {
    let mut text =
        "| person | way | s | lengths, mm | radii, mm | IoU | joints, mm | tracked, mm |\n".to_owned();
    text += "|---|---|---|---|---|---|---|---|\n";
    for row in &report.rows {
        line(&mut text, row.person, row);
    }
    text
}

/// The means of every way over all people, those who were not found left out.
#[must_use]
pub fn means(report: &Report) -> String {
    let mut text = String::new();
    let mut ways: Vec<Way> = report.rows.iter().map(|row| row.way).collect();
    ways.dedup();
    ways.truncate(6);
    for way in ways {
        let rows: Vec<&Row> =
            report.rows.iter().filter(|row| row.way == way && row.failure.is_none()).collect();
        let mean =
            |of: fn(&Row) -> f64| rows.iter().map(|row| of(row)).sum::<f64>() / rows.len().max(1) as f64;
        let all = Row {
            person: "all",
            way,
            failure: None,
            seconds: mean(|row| row.seconds),
            length_mm: mean(|row| row.length_mm),
            radius_mm: mean(|row| row.radius_mm),
            iou: mean(|row| row.iou),
            joints_mm: mean(|row| row.joints_mm),
            track_mm: Some(mean(|row| row.track_mm.unwrap_or(0.0))),
        };
        line(&mut text, "all", &all);
    }
    text
}

fn line(text: &mut String, person: &str, row: &Row) {
    let track = row.track_mm.map_or_else(|| "–".to_owned(), |mm| format!("{mm:.1}"));
    let failure = row.failure.as_deref().map_or_else(String::new, |why| format!(" ({why})"));
    // Writing to a string cannot fail.
    let _ = writeln!(
        text,
        "| {person} | {}{failure} | {:.2} | {:.1} | {:.1} | {:.3} | {:.1} | {track} |",
        row.way.label(),
        row.seconds,
        row.length_mm,
        row.radius_mm,
        row.iou,
        row.joints_mm,
    );
}

/// A body with poses of some moments.
struct Body {
    model: Arc<Model>,
    poses: Vec<(usize, Pose)>,
}

/// Finds every person in every way.
///
/// # Errors
/// Options that make no sense, or `cancel`.
pub fn run(
    options: &Options,
    cancel: &CancelToken,
    mut on_progress: impl FnMut(Progress),
) -> Result<Report, ExperimentError> {
    if options.moments.is_empty() {
        return Err(ExperimentError::Option { option: "moments", value: 0.0, expected: "1 or more" });
    }
    let people = &PEOPLE[..options.people.min(PEOPLE.len())];
    let mut rows = Vec::new();
    for (done, person) in people.iter().enumerate() {
        on_progress(Progress { done, total: people.len() });
        rows.extend(Someone::new(person, options)?.rows(options, cancel)?);
    }
    on_progress(Progress { done: people.len(), total: people.len() });
    Ok(Report { rows })
}

/// One person as the cameras see them.
struct Someone {
    person: &'static Person,
    adult: Arc<Model>,
    body: Model,
    cameras: Vec<Arc<Camera>>,
    truths: Vec<Pose>,
    frames: Vec<BodyFrame>,
}

impl Someone {
    fn new(person: &'static Person, options: &Options) -> Result<Self, ExperimentError> {
        let adult = Arc::new(builtin::full_body());
        let body = person.of(&adult)?;
        let rig = studio::cameras();
        let cameras: Vec<Arc<Camera>> =
            rig.cameras().iter().map(|camera| Arc::new(camera.without_distortion())).collect();
        let truths: Vec<Pose> =
            options.moments.iter().map(|&at| person.standing(motion::pose(&body, at))).collect();
        let frame = |(index, truth): (usize, &Pose)| {
            let seed = options.seed.wrapping_add(index as u64);
            Ok(BodyFrame {
                frame: index,
                views: see(&body, truth, &cameras)?,
                start: start::perturb(&adult, truth, 5.0_f64.to_radians(), 0.03, seed),
                joints: Vec::new(),
            })
        };
        let frames: Result<Vec<BodyFrame>, ExperimentError> = truths.iter().enumerate().map(frame).collect();
        Ok(Self { frames: frames?, person, adult, body, cameras, truths })
    }

    fn rows(&self, options: &Options, cancel: &CancelToken) -> Result<Vec<Row>, ExperimentError> {
        let seen = &self.frames[0].views;
        let scale_body = WithoutStart { scale_body: true, ..WithoutStart::default() };
        let one = |found: Acquired| Body { model: found.model, poses: number(found.poses) };
        let by = |pose: FirstPose| AcquireOptions { pose, ..AcquireOptions::default() };
        let posed: Vec<(Vec<FitView>, Pose)> =
            self.frames.iter().map(|frame| (frame.views.clone(), frame.start.clone())).collect();
        let fit = BodyFitOptions::default().with_proportions(WELL_SEEN);
        let mut rows = vec![
            self.row(Way::Scaled, options, cancel, || {
                let found = without_start(&self.adult, seen, &scale_body, cancel).map_err(words)?;
                Ok(Body { model: Arc::clone(&found.model), poses: number(vec![found.pose().clone()]) })
            })?,
            self.row(Way::Templates, options, cancel, || {
                let choices = by(FirstPose::Templates(TemplateOptions::default()));
                acquire(&self.adult, seen, &choices, cancel).map(one).map_err(words)
            })?,
            self.row(Way::Acquired, options, cancel, || {
                let choices = by(FirstPose::Search(scale_body.clone()));
                acquire(&self.adult, seen, &choices, cancel).map(one).map_err(words)
            })?,
        ];
        let mut grown = None;
        rows.push(self.row(Way::AcquiredInAll, options, cancel, || {
            let scaled = Arc::new(self.adult.scaled(self.person.stature).map_err(words)?);
            let found = acquire_posed(&scaled, &posed, &AcquireOptions::default(), cancel).map_err(words)?;
            grown = Some(Arc::clone(&found.model));
            Ok(one(found))
        })?);
        let fitted = |from: Option<&Model>| {
            let (adult, frames) = (Arc::clone(&self.adult), self.frames.clone());
            let found = match from {
                Some(grown) => fit_body_from(adult, frames, grown, &fit, cancel, |_| {}),
                None => fit_body(adult, frames, None, &fit, cancel, |_| {}),
            };
            let found = found.map_err(|error: BodyFitError| error.to_string())?;
            let poses = found.frames.iter().copied().zip(found.poses).collect();
            Ok(Body { model: Arc::new(found.model), poses })
        };
        rows.push(self.row(Way::Fitted, options, cancel, || fitted(None))?);
        if let Some(grown) = &grown {
            rows.push(self.row(Way::FittedFromAcquired, options, cancel, || fitted(Some(grown)))?);
        }
        Ok(rows)
    }

    /// Finds a body and judges it.
    fn row(
        &self,
        way: Way,
        options: &Options,
        cancel: &CancelToken,
        find: impl FnOnce() -> Result<Body, String>,
    ) -> Result<Row, ExperimentError> {
        let began = Instant::now();
        let found = find();
        let seconds = began.elapsed().as_secs_f64();
        if cancel.is_cancelled() {
            return Err(ExperimentError::Cancelled);
        }
        let person = self.person.name;
        let body = match found {
            Ok(body) => body,
            Err(failure) => {
                let nothing = f64::INFINITY;
                return Ok(Row {
                    person,
                    way,
                    failure: Some(failure),
                    seconds,
                    length_mm: nothing,
                    radius_mm: nothing,
                    iou: 0.0,
                    joints_mm: nothing,
                    track_mm: None,
                });
            }
        };
        let limbs = || body.model.limbs().iter().zip(self.body.limbs());
        let mean = |errors: Vec<f64>| 1e3 * errors.iter().sum::<f64>() / errors.len().max(1) as f64;
        let joints = |(index, pose): &(usize, Pose)| self.joints(&body.model, pose, &self.truths[*index]);
        let overlaps = body.poses.iter().map(|(index, pose)| {
            scene::overlap(&body.model, pose, &self.frames[*index].views, RendererKind::Capsule)
        });
        let overlap = overlaps.reduce(|all, one| all.merge(one)).unwrap_or_default();
        Ok(Row {
            person,
            way,
            failure: None,
            seconds,
            length_mm: mean(limbs().map(|(found, truth)| (found.length - truth.length).abs()).collect()),
            radius_mm: mean(limbs().map(|(found, truth)| (found.radius - truth.radius).abs()).collect()),
            iou: overlap.iou().unwrap_or(0.0),
            joints_mm: mean(body.poses.iter().flat_map(joints).collect()),
            track_mm: self.tracked(&body, options, cancel)?,
        })
    }

    /// Distances of all joints, metres.
    fn joints(&self, model: &Model, pose: &Pose, truth: &Pose) -> Vec<f64> {
        let (found, truth) = (Kinematics::new(model, pose), Kinematics::new(&self.body, truth));
        found.ends().iter().zip(truth.ends()).map(|(found, truth)| found.distance(*truth)).collect()
    }

    /// Mean joint error of a track with the body, from the first moment on, millimetres.
    fn tracked(
        &self,
        body: &Body,
        options: &Options,
        cancel: &CancelToken,
    ) -> Result<Option<f64>, ExperimentError> {
        let Some((_, begin)) = body.poses.iter().find(|(index, _)| *index == 0) else { return Ok(None) };
        if options.tracked == 0 {
            return Ok(None);
        }
        let mut tracker = Tracker::new(Arc::clone(&body.model), FitOptions::default(), begin.clone())?;
        let mut errors = Vec::new();
        for frame in 0..options.tracked {
            let truth =
                self.person.standing(motion::pose(&self.body, (options.moments[0] + frame as f64) % 60.0));
            let views = see(&self.body, &truth, &self.cameras)?;
            let pose = tracker.track_frame(frame, views, cancel)?.pose;
            errors.extend(self.joints(&body.model, &pose, &truth));
        }
        Ok(Some(1e3 * errors.iter().sum::<f64>() / errors.len() as f64))
    }
}

fn words(error: impl ToString) -> String {
    error.to_string()
}

fn number(poses: Vec<Pose>) -> Vec<(usize, Pose)> {
    poses.into_iter().enumerate().collect()
}

fn see(body: &Model, pose: &Pose, cameras: &[Arc<Camera>]) -> Result<Vec<FitView>, ExperimentError> {
    let view = |camera: &Arc<Camera>| {
        let mask = capsules::hard_mask(body, pose, camera)?;
        let evidence = backlit_tracking::fit::Evidence::Mask(Arc::new(mask));
        Ok(FitView { camera: Arc::clone(camera), evidence, weight: 1.0 })
    };
    cameras.iter().map(view).collect()
}
