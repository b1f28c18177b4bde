//! First bodies: acquired in one pass by growing templates, beside those that a fit of sizes finds and the average body.
//!
//! Simulated people of several builds before four cameras, exact silhouettes. Nothing is known of them: neither size nor pose nor
//! joints. A fit of sizes is given poses that are 5° and 3 cm off. With every body the movement is then tracked from the pose that
//! it was found in. Or the person of a take ([`of_take`]).

mod of_take;

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use anyhow::{Context, Result};
use backlit_formats::Take;
use backlit_lab::experiment::scene;
use backlit_lab::synthetic::people::{PEOPLE, Person};
use backlit_lab::synthetic::{capsules, motion, studio};
use backlit_tracking::acquisition::{AcquireOptions, Acquired, FirstPose, acquire, acquire_posed};
use backlit_tracking::body::{Kinematics, Model, Pose, builtin};
use backlit_tracking::body_fit::{BodyFitOptions, BodyFrame, FirstSizes, WELL_SEEN, fit_body};
use backlit_tracking::camera::Camera;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{FitOptions, FitView};
use backlit_tracking::render::RendererKind;
use backlit_tracking::search::{WithoutStartOptions, start, without_start};
use backlit_tracking::templates::TemplateOptions;
use backlit_tracking::track::Tracker;
use clap::Args;
use serde::Serialize;

use self::of_take::AcquiredTake;
use super::arguments::OutputArguments;
use super::{Experiment, Run, check_least};
use crate::numbers::within;
use crate::output::number;
use crate::table::Table;
use crate::take_options;

/// First bodies of people of several builds, grown with nothing known, beside fitted ones; or of a take's person
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    simulated: AcquiredPeople,
    /// Take whose person is acquired and tracked instead of simulated ones; sizes are compared with those of its own body
    #[arg(long, value_name = "TAKE", conflicts_with_all = ["people", "moments", "tracked", "seed"])]
    take: Option<PathBuf>,
    #[command(flatten)]
    output: OutputArguments,
}

impl Arguments {
    pub(crate) fn run(mut self) -> Result<()> {
        let Some(take) = &self.take else { return self.simulated.perform(&self.output) };
        let by_hand = Arc::clone(Take::open(take)?.model());
        let footage = take_options::open_with_model(take, Some("full_body"))?;
        AcquiredTake { every: 3, fitted: 8, footage, by_hand }.perform(&self.output)
    }
}

/// Simulated people.
#[derive(Debug, Args, Serialize)]
struct AcquiredPeople {
    /// How many of the six builds [1 to 6]
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = within(1..=6_u32))]
    people: u32,
    /// Moments of the built-in movement (its frames, 0 to 59); in the first, nothing is known of the person [0 to 59]
    #[arg(long, value_name = "K,…", value_delimiter = ',', value_parser = within(0.0..=59.0_f64))]
    moments: Option<Vec<f64>>,
    /// Frames that are tracked with every body [0 to 10000]
    #[arg(long, value_name = "N", default_value_t = 30, value_parser = within(0..=10_000_u32))]
    tracked: u32,
    /// Seed of the poses that fits of sizes begin with [0 to 4294967295]
    #[arg(long, value_name = "S", default_value_t = 1, value_parser = within(0..=4_294_967_295_u64))]
    seed: u64,
}

/// The moments if none are given.
const MOMENTS: [f64; 8] = [8.0, 0.0, 16.0, 24.0, 31.0, 41.0, 50.0, 59.0];

/// How a body was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
enum BodyMethod {
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

impl BodyMethod {
    const ALL: [Self; 6] = [
        Self::Scaled,
        Self::Templates,
        Self::Acquired,
        Self::AcquiredInAll,
        Self::Fitted,
        Self::FittedFromAcquired,
    ];

    fn label(self) -> &'static str {
        match self {
            Self::Scaled => "average, scaled",
            Self::Templates => "grown from templates",
            Self::Acquired => "grown",
            Self::AcquiredInAll => "grown in all moments",
            Self::Fitted => "fitted",
            Self::FittedFromAcquired => "fitted from grown",
        }
    }

    /// Finds a body: from the first moment's views alone, or from several moments whose poses are about right.
    fn find(
        self,
        average: &Arc<Model>,
        views: &[FitView],
        moments: Option<&Moments<'_>>,
        cancel: &CancelToken,
    ) -> Result<PosedBody> {
        let grown = |found: Acquired| PosedBody {
            model: found.model,
            poses: found.poses.into_iter().enumerate().collect(),
        };
        let scale_body = WithoutStartOptions { scale_body: true, ..WithoutStartOptions::default() };
        let by = |pose: FirstPose| {
            let options = AcquireOptions { pose, ..AcquireOptions::default() };
            Ok(grown(acquire(average, views, &options, cancel)?))
        };
        let moments = || moments.context("no body was grown before");
        let fitted = |moments: &Moments<'_>, from: Option<&Model>| {
            let (average, frames) = (Arc::clone(average), moments.frames.to_vec());
            let first = from.map_or(FirstSizes::Silhouettes, FirstSizes::Known);
            let fitted = fit_body(average, frames, first, &moments.fit, cancel, |_| {})?;
            let poses = fitted.frames.iter().copied().zip(fitted.poses).collect();
            Ok(PosedBody { model: Arc::new(fitted.model), poses })
        };
        match self {
            Self::Scaled => {
                let found = without_start(average, views, &scale_body, cancel)?;
                let poses = vec![(0, found.pose().clone())];
                Ok(PosedBody { model: found.model, poses })
            }
            Self::Templates => by(FirstPose::Templates(TemplateOptions::default())),
            Self::Acquired => by(FirstPose::Search(scale_body)),
            Self::AcquiredInAll => {
                let moments = moments()?;
                let posed = moments.frames.iter().map(|frame| (frame.views.clone(), frame.start.clone()));
                let (posed, options): (Vec<_>, _) = (posed.collect(), AcquireOptions::default());
                Ok(grown(acquire_posed(&moments.body, &posed, &options, cancel)?))
            }
            Self::Fitted => fitted(moments()?, None),
            Self::FittedFromAcquired => fitted(moments()?, Some(&moments()?.body)),
        }
    }
}

/// Moments whose poses are about right.
struct Moments<'a> {
    frames: &'a [BodyFrame],
    /// A body of about the right size: what is grown in all moments, and what a fit of sizes may begin with.
    body: Arc<Model>,
    fit: BodyFitOptions,
}

/// A body with poses of some moments.
struct PosedBody {
    model: Arc<Model>,
    poses: Vec<(usize, Pose)>,
}

#[derive(Debug, Serialize)]
struct Report {
    /// One entry a build and method.
    rows: Vec<BodyRow>,
}

/// One body. What was not found is infinitely far off.
#[derive(Debug, Serialize)]
struct BodyRow {
    /// The build.
    person: &'static str,
    #[serde(rename = "way")]
    method: BodyMethod,
    /// Why nothing was found.
    failure: Option<String>,
    /// Wall time, seconds.
    seconds: f64,
    /// Mean error of lengths, millimetres.
    length_mm: f64,
    /// Mean error of radii, millimetres.
    radius_mm: f64,
    /// Overlap of all cameras in the moments that it was found in.
    iou: f64,
    /// Mean error of all joints in these moments, millimetres.
    joints_mm: f64,
    /// Mean error of all joints, tracked with this body, millimetres.
    track_mm: Option<f64>,
}

/// The mean of errors in metres, millimetres.
fn mean_mm(errors: &[f64]) -> f64 {
    1e3 * errors.iter().sum::<f64>() / errors.len().max(1) as f64
}

impl Experiment for AcquiredPeople {
    const NAME: &'static str = "acquire";
    type Report = Report;

    /// Finds every person in every way.
    fn run(&mut self, run: &Run) -> Result<Report> {
        let moments = self.moments.get_or_insert_with(|| MOMENTS.to_vec()).clone();
        check_least("moments", moments.len(), 1)?;
        let people = &PEOPLE[..self.people as usize];
        let mut rows = Vec::new();
        for (done, person) in people.iter().enumerate() {
            run.progress(done, people.len())?;
            rows.extend(Someone::new(person, &moments, self)?.rows(run)?);
        }
        Ok(Report { rows })
    }

    fn table(&self, report: &Report) -> String {
        table(report)
    }
}

fn table(report: &Report) -> String {
    let name = |row: &BodyRow| format!("{}: {}", row.person, row.method.label());
    let table = Table::of(
        &report.rows,
        &[
            ("person: way", &|row| name(row)),
            ("s", &|row| number(row.seconds, 2)),
            ("lengths, mm", &|row| number(row.length_mm, 1)),
            ("radii, mm", &|row| number(row.radius_mm, 1)),
            ("IoU", &|row| number(row.iou, 3)),
            ("joints, mm", &|row| number(row.joints_mm, 1)),
            ("tracked, mm", &|row| number(row.track_mm, 1)),
        ],
    );
    let failed = |row: &BodyRow| {
        let failure = row.failure.as_ref()?;
        Some(format!("\n{}, {}: {failure}", row.person, row.method.label()))
    };
    table + &report.rows.iter().filter_map(failed).collect::<String>()
}

/// One person as the cameras see them.
struct Someone<'a> {
    person: &'static Person,
    options: &'a AcquiredPeople,
    first_moment: f64,
    adult: Arc<Model>,
    body: Model,
    cameras: Vec<Arc<Camera>>,
    truths: Vec<Pose>,
    frames: Vec<BodyFrame>,
}

impl<'a> Someone<'a> {
    fn new(person: &'static Person, moments: &[f64], options: &'a AcquiredPeople) -> Result<Self> {
        let adult = Arc::new(builtin::full_body());
        let body = person.of(&adult)?;
        let rig = studio::cameras();
        let cameras: Vec<Arc<Camera>> =
            rig.cameras().iter().map(|camera| Arc::new(camera.without_distortion())).collect();
        let truths: Vec<Pose> = moments.iter().map(|&at| person.standing(motion::pose(&body, at))).collect();
        let frame = |(index, truth): (usize, &Pose)| {
            let seed = options.seed.wrapping_add(index as u64);
            Ok(BodyFrame {
                frame: index,
                views: see(&body, truth, &cameras)?,
                start: start::perturb(&adult, truth, 5.0_f64.to_radians(), 0.03, seed),
                joints: Vec::new(),
            })
        };
        let frames = truths.iter().enumerate().map(frame).collect::<Result<_>>()?;
        Ok(Self { person, options, first_moment: moments[0], adult, body, cameras, truths, frames })
    }

    fn rows(&self, run: &Run) -> Result<Vec<BodyRow>> {
        let fit = BodyFitOptions::default().with_proportions(WELL_SEEN);
        let body = Arc::new(self.adult.scaled(self.person.stature)?);
        let mut moments = Moments { frames: &self.frames, body, fit };
        let mut rows = Vec::with_capacity(BodyMethod::ALL.len());
        for method in BodyMethod::ALL {
            let began = Instant::now();
            let found = method.find(&self.adult, &self.frames[0].views, Some(&moments), &run.cancel);
            let seconds = began.elapsed().as_secs_f64();
            run.check()?;
            let grown = found.as_ref().ok().map(|found| Arc::clone(&found.model));
            rows.push(self.row(method, run, found, seconds)?);
            // What was grown in all moments is what the last fit begins with.
            match (method, grown) {
                (BodyMethod::AcquiredInAll, Some(grown)) => moments.body = grown,
                (BodyMethod::Fitted, _) if rows[3].failure.is_some() => break,
                _ => {}
            }
        }
        Ok(rows)
    }

    /// Judges a body.
    fn row(&self, method: BodyMethod, run: &Run, found: Result<PosedBody>, seconds: f64) -> Result<BodyRow> {
        let mut row = BodyRow {
            person: self.person.name,
            method,
            failure: found.as_ref().err().map(ToString::to_string),
            seconds,
            length_mm: f64::INFINITY,
            radius_mm: f64::INFINITY,
            iou: 0.0,
            joints_mm: f64::INFINITY,
            track_mm: None,
        };
        let Ok(body) = found else { return Ok(row) };
        let limbs = || body.model.limbs().iter().zip(self.body.limbs());
        let lengths: Vec<f64> = limbs().map(|(found, truth)| (found.length - truth.length).abs()).collect();
        let radii: Vec<f64> = limbs().map(|(found, truth)| (found.radius - truth.radius).abs()).collect();
        let joints = |(index, pose): &(usize, Pose)| self.joints(&body.model, pose, &self.truths[*index]);
        let overlaps = body.poses.iter().map(|(index, pose)| {
            scene::overlap(&body.model, pose, &self.frames[*index].views, RendererKind::Capsule)
        });
        let overlap = overlaps.reduce(|all, one| all.merge(one)).unwrap_or_default();
        (row.length_mm, row.radius_mm) = (mean_mm(&lengths), mean_mm(&radii));
        row.iou = overlap.iou().unwrap_or(0.0);
        row.joints_mm = mean_mm(&body.poses.iter().flat_map(joints).collect::<Vec<_>>());
        row.track_mm = self.tracked(&body, run)?;
        Ok(row)
    }

    /// Distances of all joints, metres.
    fn joints(&self, model: &Model, pose: &Pose, truth: &Pose) -> Vec<f64> {
        let (found, truth) = (Kinematics::new(model, pose), Kinematics::new(&self.body, truth));
        found.ends().iter().zip(truth.ends()).map(|(found, truth)| found.distance(*truth)).collect()
    }

    /// Mean joint error of a track with the body, from the first moment on, millimetres.
    fn tracked(&self, body: &PosedBody, run: &Run) -> Result<Option<f64>> {
        let Some((_, begin)) = body.poses.iter().find(|(index, _)| *index == 0) else { return Ok(None) };
        if self.options.tracked == 0 {
            return Ok(None);
        }
        let mut tracker = Tracker::new(Arc::clone(&body.model), FitOptions::default(), begin.clone())?;
        let mut errors = Vec::new();
        for frame in 0..self.options.tracked as usize {
            let moment = (self.first_moment + frame as f64) % 60.0;
            let truth = self.person.standing(motion::pose(&self.body, moment));
            let views = see(&self.body, &truth, &self.cameras)?;
            let pose = tracker.track_frame(frame, views, &run.cancel)?.pose;
            run.check()?;
            errors.extend(self.joints(&body.model, &pose, &truth));
        }
        Ok(Some(mean_mm(&errors)))
    }
}

fn see(body: &Model, pose: &Pose, cameras: &[Arc<Camera>]) -> Result<Vec<FitView>> {
    let view =
        |camera: &Arc<Camera>| Ok(FitView::of_mask(camera.clone(), capsules::hard_mask(body, pose, camera)?));
    cameras.iter().map(view).collect()
}
