//! A person's own sizes found from a track with the average body, silhouettes exact and too wide: what they are worth after.
//!
//! The builds of [`people`](crate::synthetic::people) go through a movement before four cameras around them or before two
//! telephones; the average body is scaled to the first frame and followed; sizes come from that track, as before there was
//! a survey, a widening and frames held out, and as now; then everything is followed again with each body.

use std::sync::Arc;

use backlit_tracking::body::{Kinematics, Model, Pose, builtin};
use backlit_tracking::body_fit::widening::narrowed;
use backlit_tracking::body_fit::{
    Approach, BodyFitError, BodyFitOptions, BodyFrame, CLOTHED, OwnSizesError, OwnSizesOptions, PosedFrame,
    approach, fit_body, frames, own_sizes,
};
use backlit_tracking::camera::Camera;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{Evidence, FitOptions, FitView};
use backlit_tracking::metrics::ReferenceJoints;
use backlit_tracking::residual::Proportions;
use backlit_tracking::search::start;
use backlit_tracking::track::{Motion, Tracker, WhenToSearch};
use glam::DVec3;
use serde::Serialize;

use super::track::widened;
use super::{ExperimentError, Progress};
use crate::synthetic::people::{PEOPLE, Person};
use crate::synthetic::{capsules, motion, squats, studio};

/// The pelvis of the average adult, metres above the floor: people of other statures stand on the same floor.
const PELVIS_HEIGHT: f64 = 0.9;
/// Across the shoulders of the average adult, metres: what a mask's widening is a share of.
const BREADTH: f64 = 0.5;
/// Frames that sizes were fitted to before.
const BEFORE: usize = 8;

/// Who looks on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Setting {
    /// Four cameras all around, the built-in movement.
    Around,
    /// Two telephones 37° apart, squats.
    Phones,
}

impl Setting {
    /// What it is called in tables.
    #[must_use]
    pub fn label(self) -> &'static str {
        match self {
            Self::Around => "four cameras around",
            Self::Phones => "two phones, 37°",
        }
    }
}

/// What to vary.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Options {
    /// Cameras and movement.
    pub settings: Vec<Setting>,
    /// By how much masks are too wide across the shoulders, as shares.
    pub widened: Vec<f64>,
    /// How many of the builds.
    pub people: usize,
    /// Frames that are followed.
    pub frames: usize,
    /// Every how manieth frame of the movement is seen.
    pub every: usize,
    /// How far every rotation of the first frame starts from the truth, radians.
    pub start_angle_rad: f64,
    /// How far its root starts from the truth, metres.
    pub start_distance_m: f64,
    /// Seed of the starts.
    pub seed: u64,
    /// How much the proportions count, before and now.
    pub proportions: [f64; 2],
    /// Standard deviation of the widening, metres.
    pub widening_deviation_m: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            settings: vec![Setting::Around, Setting::Phones],
            widened: vec![0.0, 0.03, 0.06],
            people: PEOPLE.len(),
            frames: 60,
            every: 1,
            start_angle_rad: 5.0_f64.to_radians(),
            start_distance_m: 0.03,
            seed: 1,
            proportions: [20.0, CLOTHED],
            widening_deviation_m: BodyFitOptions::default().widening,
        }
    }
}

/// What came of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// One entry a setting, widening and build.
    pub cases: Vec<Case>,
}

impl Report {
    /// The cases of one setting and widening each, in their order.
    #[must_use]
    pub fn groups(&self) -> Vec<&[Case]> {
        self.cases.chunk_by(|a, b| a.setting == b.setting && a.widened == b.widened).collect()
    }
}

/// One build before one set of cameras with one widening.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Case {
    /// Cameras and movement.
    pub setting: Setting,
    /// By how much masks are too wide across the shoulders, as a share.
    pub widened: f64,
    /// The same, pixels all round.
    pub widened_px: f64,
    /// The build.
    pub name: &'static str,
    /// The average body, scaled as a whole to the first frame.
    pub average: BodyReport,
    /// Sizes as they were fitted before.
    pub before: BodyReport,
    /// Sizes as they are fitted now, whether taken or not.
    pub found: BodyReport,
    /// The body that is gone on with now, as the masks show it.
    pub now: BodyReport,
    /// The person instead, on masks that are narrowed by what was found; `None` where nothing sure was.
    pub now_narrowed: Option<BodyReport>,
    /// The widening that was found, pixels, its deviation, and whether it is believed.
    pub widening: Option<(f64, f64, bool)>,
    /// What spoke against the sizes, in short.
    pub doubts: Vec<String>,
}

/// One body's errors.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BodyReport {
    /// Mean error of lengths, millimetres.
    pub length_mm: f64,
    /// Mean error of radii, millimetres.
    pub radius_mm: f64,
    /// Girth beside the true one: mean logarithm of all radii.
    pub girth: f64,
    /// Mean error of all joints in all frames, followed with this body, millimetres.
    pub track_mm: f64,
}

/// Finds every person's sizes in every case.
///
/// # Errors
/// Options that make no sense, or `cancel`.
pub fn run(
    options: &Options,
    cancel: &CancelToken,
    mut on_progress: impl FnMut(Progress),
) -> Result<Report, ExperimentError> {
    let people = &PEOPLE[..options.people.min(PEOPLE.len())];
    let total = options.settings.len() * options.widened.len() * people.len();
    let mut cases = Vec::new();
    for &setting in &options.settings {
        for &share in &options.widened {
            for person in people {
                on_progress(Progress { done: cases.len(), total });
                cases.push(Scene::new(options, setting, share, person)?.case(options, cancel)?);
            }
        }
    }
    on_progress(Progress { done: total, total });
    Ok(Report { cases })
}

/// What is seen of one person.
struct Scene {
    setting: Setting,
    every: usize,
    share: f64,
    widened_px: f64,
    person: &'static Person,
    body: Model,
    truths: Vec<Pose>,
    views: Vec<Vec<FitView>>,
}

impl Scene {
    fn new(
        options: &Options,
        setting: Setting,
        share: f64,
        person: &'static Person,
    ) -> Result<Self, ExperimentError> {
        let body = person.of(&builtin::full_body())?;
        let truth = |index: usize| {
            let frame = index * options.every;
            let mut pose = match setting {
                Setting::Around => motion::pose(&body, frame as f64 % 60.0),
                Setting::Phones => squats::pose(&body, frame as f64 / squats::FRAME_RATE),
            };
            pose.root -= DVec3::Z * (PELVIS_HEIGHT * (1.0 - person.stature));
            pose
        };
        let truths: Vec<Pose> = (0..options.frames).map(truth).collect();
        let cameras: Vec<Arc<Camera>> = match setting {
            Setting::Around => studio::cameras()
                .cameras()
                .iter()
                .map(|camera| Arc::new(camera.without_distortion()))
                .collect(),
            Setting::Phones => squats::cameras([180, 320])?,
        };
        let widening = |camera: &Camera, pose: &Pose| {
            let depth = camera.camera_from_world().transform(pose.root).z;
            0.5 * share * BREADTH * person.stature * camera.intrinsics().fx / depth
        };
        let see = |pose: &Pose| -> Result<Vec<FitView>, ExperimentError> {
            let of = |camera: &Arc<Camera>| {
                let exact = capsules::hard_mask(&body, pose, camera)?;
                let mask = widened(exact, widening(camera, pose))?;
                let evidence = Evidence::Mask(Arc::new(mask));
                Ok(FitView { camera: Arc::clone(camera), evidence, weight: 1.0 })
            };
            cameras.iter().map(of).collect()
        };
        let views = truths.iter().map(see).collect::<Result<_, _>>()?;
        let widened_px =
            cameras.iter().map(|camera| widening(camera, &truths[0])).sum::<f64>() / cameras.len() as f64;
        Ok(Self { setting, every: options.every, share, widened_px, person, body, truths, views })
    }

    fn case(&self, options: &Options, cancel: &CancelToken) -> Result<Case, ExperimentError> {
        let adult = Arc::new(builtin::full_body());
        let failed = |error: BodyFitError| match error {
            BodyFitError::Cancelled => ExperimentError::Cancelled,
            error => ExperimentError::Body { person: self.person.name, error },
        };
        let start = start::perturb(
            &adult,
            &self.truths[0],
            options.start_angle_rad,
            options.start_distance_m,
            options.seed,
        );
        let generic = Proportions { surveyed: false, ..Proportions::default() };
        let old = BodyFitOptions { proportions: generic, widening: 0.0, ..BodyFitOptions::default() };
        let old = old.with_proportions(options.proportions[0]);
        let plan = Approach { start: start.clone(), size: None, frames: vec![0], step: 1 };
        let (size, first) = approach(
            &adult,
            &plan,
            &old,
            cancel,
            |frame| Ok::<_, BodyFitError>(self.views[frame].clone()),
            |_| ReferenceJoints::new(),
            |_, _| {},
        )
        .map_err(failed)?;
        let average = Arc::new(adult.scaled(size.exp())?);
        let start = &first[0].start;
        let (average_report, track) = self.follow(&average, start, 0.0, cancel)?;
        let all: Vec<usize> = (0..self.views.len()).collect();
        let to_fit = frames::spread(&all, BEFORE).into_iter().map(|frame| BodyFrame {
            frame,
            views: self.views[frame].clone(),
            start: track[frame].pose.clone(),
            joints: ReferenceJoints::new(),
        });
        let before =
            fit_body(adult.clone(), to_fit.collect(), Some(size), &old, cancel, |_| {}).map_err(failed)?;
        let before = self.follow(&Arc::new(before.model), start, 0.0, cancel)?.0;
        let fit = BodyFitOptions { widening: options.widening_deviation_m, ..BodyFitOptions::default() };
        let now = OwnSizesOptions {
            fit: fit.with_proportions(options.proportions[1]),
            ..OwnSizesOptions::default()
        };
        let own = own_sizes(
            &average,
            &track,
            &now,
            cancel,
            |frame| Ok::<_, OwnSizesError>(self.views[frame].clone()),
            |_| ReferenceJoints::new(),
            |_| {},
        )
        .map_err(|error| match error {
            OwnSizesError::Fit(error) => failed(error),
            error => ExperimentError::OwnSizes { person: self.person.name, error },
        })?;
        // The person's errors, and those of the track with the body that is followed in its place.
        let follow = |person: &Model, seen: Model, by_px| -> Result<BodyReport, ExperimentError> {
            let track_mm = self.follow(&Arc::new(seen), start, by_px, cancel)?.0.track_mm;
            Ok(self.errors(person, track_mm))
        };
        let narrow = own.widening_px();
        let found = follow(&own.fit.model, own.fit.as_seen(), 0.0)?;
        Ok(Case {
            setting: self.setting,
            widened: self.share,
            widened_px: self.widened_px,
            name: self.person.name,
            average: average_report,
            before,
            found,
            now: if own.is_taken() { found } else { follow(own.model(), own.as_seen(), 0.0)? },
            now_narrowed: if narrow == 0.0 {
                None
            } else {
                Some(follow(own.model(), own.model().clone(), narrow)?)
            },
            widening: own.fit.widening.map(|one| (one.px, one.deviation_px, one.is_believed)),
            doubts: own.doubts.iter().map(|doubt| format!("{doubt:?}")).collect(),
        })
    }

    /// Follows everything with a body, on masks that are narrowed by so many pixels.
    fn follow(
        &self,
        model: &Arc<Model>,
        start: &Pose,
        narrow_px: f64,
        cancel: &CancelToken,
    ) -> Result<(BodyReport, Vec<PosedFrame>), ExperimentError> {
        let rate = match self.setting {
            Setting::Around => 25.0,
            Setting::Phones => squats::FRAME_RATE,
        } / self.every as f64;
        let mut tracker = Tracker::new(Arc::clone(model), FitOptions::default(), start.clone())?
            .with_motion(Motion::Velocity, rate)?
            .with_search(WhenToSearch::WhenPoor);
        let (mut sum, mut count) = (0.0, 0.0);
        let mut track = Vec::new();
        for (frame, truth) in self.truths.iter().enumerate() {
            let views = self.views[frame].iter().map(|view| narrowed(view, narrow_px)).collect();
            let estimate = tracker.track_frame(frame, views, cancel)?;
            if cancel.is_cancelled() {
                return Err(ExperimentError::Cancelled);
            }
            let [truth, found] = [(&self.body, truth), (&**model, &estimate.pose)]
                .map(|(model, pose)| Kinematics::new(model, pose));
            for (truth, found) in truth.ends().iter().zip(found.ends()) {
                sum += truth.distance(*found);
                count += 1.0;
            }
            track.push(PosedFrame::from(&estimate));
        }
        Ok((self.errors(model, 1000.0 * sum / count), track))
    }

    fn errors(&self, model: &Model, track_mm: f64) -> BodyReport {
        let limbs = || model.limbs().iter().zip(self.body.limbs());
        let mean = |of: &dyn Fn(&backlit_tracking::body::Limb, &backlit_tracking::body::Limb) -> f64| {
            limbs().map(|(found, truth)| of(found, truth)).sum::<f64>() / model.limbs().len() as f64
        };
        BodyReport {
            length_mm: mean(&|found, truth| 1000.0 * (found.length - truth.length).abs()),
            radius_mm: mean(&|found, truth| 1000.0 * (found.radius - truth.radius).abs()),
            girth: mean(&|found, truth| (found.radius / truth.radius).ln()),
            track_mm,
        }
    }
}
