//! First bodies: acquired in one pass by growing templates, beside those that a fit of sizes finds and the average body.
//!
//! Simulated people of several builds before four cameras, exact silhouettes. Nothing is known of them: neither size nor pose nor
//! joints. A fit of sizes is given poses that are 5° and 3 cm off, as in the experiment on sizes. With every body the movement is then
//! tracked from the pose that it was found in.

pub mod footage;

use std::sync::Arc;
use std::time::Instant;

use backlit_tracking::acquisition::{AcquireOptions, Acquired, FirstPose, acquire, acquire_posed};
use backlit_tracking::body::{Kinematics, Model, Pose, builtin};
use backlit_tracking::body_fit::{BodyFitOptions, BodyFrame, WELL_SEEN, fit_body, fit_body_from};
use backlit_tracking::camera::Camera;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{FitOptions, FitView};
use backlit_tracking::render::RendererKind;
use backlit_tracking::search::{WithoutStartOptions, start, without_start};
use backlit_tracking::templates::TemplateOptions;
use backlit_tracking::track::Tracker;
use serde::Serialize;

use super::{ExperimentError, Progress, scene};
use crate::synthetic::people::{PEOPLE, Person};
use crate::synthetic::{capsules, motion, studio};

/// How a body was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum BodyMethod {
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

    /// Finds a body: from the first moment's views alone, or from several moments whose poses are about right.
    fn find(
        self,
        average: &Arc<Model>,
        views: &[FitView],
        moments: Option<&Moments<'_>>,
        cancel: &CancelToken,
    ) -> Result<PosedBody, String> {
        let grown = |found: Acquired| PosedBody {
            model: found.model,
            poses: found.poses.into_iter().enumerate().collect(),
        };
        let scale_body = WithoutStartOptions { scale_body: true, ..WithoutStartOptions::default() };
        let by = |pose: FirstPose| {
            let options = AcquireOptions { pose, ..AcquireOptions::default() };
            acquire(average, views, &options, cancel).map(grown).map_err(words)
        };
        let moments = || moments.ok_or_else(|| "no body was grown before".to_owned());
        let fitted = |moments: &Moments<'_>, from: Option<&Model>| {
            let (average, frames) = (Arc::clone(average), moments.frames.to_vec());
            let fitted = match from {
                Some(grown) => fit_body_from(average, frames, grown, &moments.fit, cancel, |_| {}),
                None => fit_body(average, frames, None, &moments.fit, cancel, |_| {}),
            };
            let fitted = fitted.map_err(words)?;
            let poses = fitted.frames.iter().copied().zip(fitted.poses).collect();
            Ok(PosedBody { model: Arc::new(fitted.model), poses })
        };
        match self {
            Self::Scaled => {
                let found = without_start(average, views, &scale_body, cancel).map_err(words)?;
                let poses = vec![(0, found.pose().clone())];
                Ok(PosedBody { model: found.model, poses })
            }
            Self::Templates => by(FirstPose::Templates(TemplateOptions::default())),
            Self::Acquired => by(FirstPose::Search(scale_body)),
            Self::AcquiredInAll => {
                let moments = moments()?;
                let posed = moments.frames.iter().map(|frame| (frame.views.clone(), frame.start.clone()));
                let (posed, options): (Vec<_>, _) = (posed.collect(), AcquireOptions::default());
                acquire_posed(&moments.body, &posed, &options, cancel).map(grown).map_err(words)
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

/// What to vary.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Options {
    /// How many of the builds.
    pub people: usize,
    /// Moments of the built-in movement; nothing is known of the first one.
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
    /// One entry a build and method.
    pub rows: Vec<BodyRow>,
}

/// One body.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BodyRow {
    /// The build.
    pub person: &'static str,
    /// How it was found.
    #[serde(rename = "way")]
    pub method: BodyMethod,
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

/// Finds every person in every way.
///
/// # Errors
/// Returns an error if an option is out of range, or if it is cancelled.
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

    fn rows(&self, options: &Options, cancel: &CancelToken) -> Result<Vec<BodyRow>, ExperimentError> {
        let fit = BodyFitOptions::default().with_proportions(WELL_SEEN);
        let body = Arc::new(self.adult.scaled(self.person.stature)?);
        let mut moments = Moments { frames: &self.frames, body, fit };
        let mut rows = Vec::with_capacity(BodyMethod::ALL.len());
        for method in BodyMethod::ALL {
            let began = Instant::now();
            let found = method.find(&self.adult, &self.frames[0].views, Some(&moments), cancel);
            let seconds = began.elapsed().as_secs_f64();
            if cancel.is_cancelled() {
                return Err(ExperimentError::Cancelled);
            }
            let grown = found.as_ref().ok().map(|found| Arc::clone(&found.model));
            rows.push(self.row(method, options, cancel, found, seconds)?);
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
    fn row(
        &self,
        method: BodyMethod,
        options: &Options,
        cancel: &CancelToken,
        found: Result<PosedBody, String>,
        seconds: f64,
    ) -> Result<BodyRow, ExperimentError> {
        let person = self.person.name;
        let body = match found {
            Ok(body) => body,
            Err(failure) => {
                let nothing = f64::INFINITY;
                return Ok(BodyRow {
                    person,
                    method,
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
        Ok(BodyRow {
            person,
            method,
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
        body: &PosedBody,
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

fn see(body: &Model, pose: &Pose, cameras: &[Arc<Camera>]) -> Result<Vec<FitView>, ExperimentError> {
    let view = |camera: &Arc<Camera>| {
        let mask = capsules::hard_mask(body, pose, camera)?;
        let evidence = backlit_tracking::fit::Evidence::Mask(Arc::new(mask));
        Ok(FitView { camera: Arc::clone(camera), evidence, weight: 1.0 })
    };
    cameras.iter().map(view).collect()
}
