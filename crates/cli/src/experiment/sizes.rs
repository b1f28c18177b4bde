//! A person's own sizes found from a track with the average body, silhouettes exact and too wide: what they are worth after.
//!
//! The builds of [`PEOPLE`] go through a movement before four cameras around them or before two telephones; the average body is
//! scaled to the first frame and followed; sizes come from that track; then everything is followed again with each body.

use std::sync::Arc;

use anyhow::{Context, Result};
use backlit_lab::synthetic::masks::widened;
use backlit_lab::synthetic::people::{BREADTH, PEOPLE, Person};
use backlit_lab::synthetic::{capsules, motion, squats, studio};
use backlit_tracking::body::{Kinematics, Limb, Model, Pose, builtin};
use backlit_tracking::body_fit::widening::narrowed;
use backlit_tracking::body_fit::{
    Approach, BodyFitError, BodyFitOptions, CLOTHED, OwnSizesError, OwnSizesOptions, PosedFrame, approach,
    own_sizes,
};
use backlit_tracking::camera::Camera;
use backlit_tracking::fit::{FitOptions, FitView};
use backlit_tracking::metrics::ReferenceJoints;
use backlit_tracking::residual::Proportions;
use backlit_tracking::search::start;
use backlit_tracking::track::{Motion, Tracker, WhenToSearch};
use clap::Args;
use serde::Serialize;

use super::{Experiment, Run};
use crate::interrupt::Interrupted;
use crate::numbers::within;
use crate::table::Table;

/// Cameras and movement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
enum Setting {
    /// Four cameras all around, the built-in movement.
    Around,
    /// Two telephones 37° apart, squats.
    Phones,
}

impl Setting {
    fn label(self) -> &'static str {
        match self {
            Self::Around => "four cameras around",
            Self::Phones => "two phones, 37°",
        }
    }
}

/// People's sizes found from a track with the average body, through silhouettes that are wider than they are, and what
/// a track with them is worth: four cameras around, and two phones
#[derive(Debug, Args, Serialize)]
pub(crate) struct OwnSizes {
    #[arg(skip = vec![Setting::Around, Setting::Phones])]
    settings: Vec<Setting>,
    /// By how much silhouettes are too wide, per cent of the person's breadth [0 to 50]
    #[arg(long, value_name = "PERCENT,…", value_delimiter = ',', value_parser = percent, default_value = "0,3,6")]
    widened: Vec<f64>,
    #[arg(skip = PEOPLE.len())]
    people: usize,
    /// Frames that are followed.
    #[arg(skip = 60_usize)]
    frames: usize,
    /// Only every Nth frame of the movement is seen [1 to 20]
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = within(1..=20_u32))]
    every: u32,
    #[arg(skip = 5.0_f64.to_radians())]
    start_angle_rad: f64,
    #[arg(skip = 0.03)]
    start_distance_m: f64,
    /// Seed of the poses that tracks begin with [0 to 4294967295]
    #[arg(long, value_name = "S", default_value_t = 1, value_parser = within(0..=4_294_967_295_u64))]
    seed: u64,
    /// How much the proportions count in the first frame, and afterwards.
    #[arg(skip = [20.0, CLOTHED])]
    proportions: [f64; 2],
    #[arg(skip = BodyFitOptions::default().widening)]
    widening_deviation_m: f64,
}

/// 0 to 50 %, as a share.
fn percent(text: &str) -> Result<f64, &'static str> {
    let percent = text.parse().ok().filter(|percent| (0.0..=50.0).contains(percent));
    percent.map(|percent: f64| percent / 100.0).ok_or("expected per cent from 0 to 50")
}

#[derive(Debug, Serialize)]
pub(crate) struct Report {
    cases: Vec<Case>,
}

/// One build before one set of cameras with one widening.
#[derive(Debug, Serialize)]
struct Case {
    setting: Setting,
    /// By how much masks are too wide across the shoulders, as a share.
    widened: f64,
    /// The same, pixels all round.
    widened_px: f64,
    name: &'static str,
    /// The average body, scaled as a whole to the first frame.
    average: BodyErrors,
    /// Sizes as they are fitted, whether taken or not.
    found: BodyErrors,
    /// The body that is gone on with, as the masks show it.
    now: BodyErrors,
    /// The person instead, on masks that are narrowed by what was found; `None` where nothing sure was.
    now_narrowed: Option<BodyErrors>,
    /// The widening that was found, pixels, its deviation, and whether it is believed.
    widening: Option<(f64, f64, bool)>,
    /// What spoke against the sizes, in short.
    doubts: Vec<String>,
}

#[derive(Debug, Clone, Copy, Serialize)]
struct BodyErrors {
    length_mm: f64,
    radius_mm: f64,
    /// Mean logarithm of all radii beside the true ones.
    girth: f64,
    /// Mean error of all joints in all frames, followed with this body.
    track_mm: f64,
}

impl Experiment for OwnSizes {
    const NAME: &'static str = "sizes";
    type Report = Report;

    fn run(&mut self, run: &Run) -> Result<Report> {
        let people = &PEOPLE[..self.people.min(PEOPLE.len())];
        let total = self.settings.len() * self.widened.len() * people.len();
        let mut cases = Vec::new();
        for &setting in &self.settings {
            for &share in &self.widened {
                for person in people {
                    run.progress(cases.len(), total)?;
                    cases.push(FilmedPerson::new(self, setting, share, person)?.case(run)?);
                }
            }
        }
        Ok(Report { cases })
    }

    fn table(&self, report: &Report) -> String {
        let mean = |cases: &&[Case], of: &dyn Fn(&Case) -> f64| {
            cases.iter().map(of).sum::<f64>() / cases.len() as f64
        };
        let mm = |cases: &&[Case], of: &dyn Fn(&Case) -> f64| format!("{:.1}", mean(cases, of));
        let girth = |cases: &&[Case], of: &dyn Fn(&Case) -> f64| {
            format!("{:+.1} %", 100.0 * (mean(cases, of).exp() - 1.0))
        };
        let worst = |cases: &&[Case], of: fn(&Case) -> f64| {
            format!("{:.1}", cases.iter().map(of).fold(0.0, f64::max))
        };
        let too_wide = |cases: &&[Case]| {
            format!("{:.0} %, {:.1} px", 100.0 * cases[0].widened, mean(cases, &|case| case.widened_px))
        };
        let refused = |cases: &&[Case]| cases.iter().filter(|case| !case.doubts.is_empty()).count();
        Table::of(
            report.cases.chunk_by(|a, b| a.setting == b.setting && a.widened == b.widened),
            &[
                ("mm, means of all builds", &|cases| cases[0].setting.label().to_owned()),
                ("too wide", &too_wide),
                ("lengths", &|cases| mm(cases, &|case| case.now.length_mm)),
                ("radii", &|cases| mm(cases, &|case| case.now.radius_mm)),
                ("girth", &|cases| girth(cases, &|case| case.now.girth)),
                ("joints: average body", &|cases| mm(cases, &|case| case.average.track_mm)),
                ("own sizes", &|cases| mm(cases, &|case| case.now.track_mm)),
                ("worst build: average body", &|cases| worst(cases, |case| case.average.track_mm)),
                ("own sizes", &|cases| worst(cases, |case| case.now.track_mm)),
                ("not taken", &|cases| format!("{} of {}", refused(cases), cases.len())),
            ],
        )
    }
}

/// Names the person that sizes could not be fitted to.
fn of_person<T>(person: &Person, fit: Result<T, BodyFitError>) -> Result<T> {
    match fit {
        Err(BodyFitError::Cancelled) => Err(Interrupted.into()),
        fit => fit.context(person.name),
    }
}

/// What is seen of one person.
struct FilmedPerson<'a> {
    options: &'a OwnSizes,
    setting: Setting,
    share: f64,
    widened_px: f64,
    person: &'static Person,
    body: Model,
    truths: Vec<Pose>,
    views: Vec<Vec<FitView>>,
}

impl<'a> FilmedPerson<'a> {
    fn new(options: &'a OwnSizes, setting: Setting, share: f64, person: &'static Person) -> Result<Self> {
        let body = person.of(&builtin::full_body())?;
        let truth = |index: usize| {
            let frame = index * options.every as usize;
            person.standing(match setting {
                Setting::Around => motion::pose(&body, frame as f64 % 60.0),
                Setting::Phones => squats::pose(&body, frame as f64 / squats::FRAME_RATE),
            })
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
        let see = |pose: &Pose| -> Result<Vec<FitView>> {
            let of = |camera: &Arc<Camera>| {
                let exact = capsules::hard_mask(&body, pose, camera)?;
                Ok(FitView::of_mask(camera.clone(), widened(exact, widening(camera, pose))?))
            };
            cameras.iter().map(of).collect()
        };
        let views = truths.iter().map(see).collect::<Result<_>>()?;
        let widened_px =
            cameras.iter().map(|camera| widening(camera, &truths[0])).sum::<f64>() / cameras.len() as f64;
        Ok(Self { options, setting, share, widened_px, person, body, truths, views })
    }

    fn case(&self, run: &Run) -> Result<Case> {
        let options = self.options;
        let adult = Arc::new(builtin::full_body());
        let cancel = &run.cancel;
        let (angle_rad, distance_m) = (options.start_angle_rad, options.start_distance_m);
        let start = start::perturb(&adult, &self.truths[0], angle_rad, distance_m, options.seed);
        let generic = Proportions { surveyed: false, ..Proportions::default() };
        let old = BodyFitOptions { proportions: generic, widening: 0.0, ..BodyFitOptions::default() };
        let old = old.with_proportions(options.proportions[0]);
        let plan = Approach { start: start.clone(), size: None, frames: vec![0], step: 1 };
        let approached = approach(
            &adult,
            &plan,
            &old,
            cancel,
            |frame| Ok::<_, BodyFitError>(self.views[frame].clone()),
            |_| ReferenceJoints::new(),
            |_, _| {},
        );
        let (size, first) = of_person(self.person, approached)?;
        let average = Arc::new(adult.scaled(size.exp())?);
        let start = &first[0].start;
        let (average_report, track) = self.follow(&average, start, 0.0, run)?;
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
        );
        let own = match own {
            Err(OwnSizesError::Fit(error)) => of_person(self.person, Err(error))?,
            own => own.context(self.person.name)?,
        };
        // The person's errors, and those of the track with the body that is followed in its place.
        let follow = |person: &Model, seen: Model, by_px| -> Result<BodyErrors> {
            let track_mm = self.follow(&Arc::new(seen), start, by_px, run)?.0.track_mm;
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
            found,
            now: if own.is_taken() { found } else { follow(own.model(), own.as_seen(), 0.0)? },
            now_narrowed: (narrow != 0.0)
                .then(|| follow(own.model(), own.model().clone(), narrow))
                .transpose()?,
            widening: own.fit.widening.map(|one| (one.px, one.deviation_px, one.is_believed)),
            doubts: own.doubts.iter().map(|doubt| format!("{doubt:?}")).collect(),
        })
    }

    /// Follows everything with a body, on masks that are narrowed by this many pixels.
    fn follow(
        &self,
        model: &Arc<Model>,
        start: &Pose,
        narrow_px: f64,
        run: &Run,
    ) -> Result<(BodyErrors, Vec<PosedFrame>)> {
        let rate = match self.setting {
            Setting::Around => 25.0,
            Setting::Phones => squats::FRAME_RATE,
        } / f64::from(self.options.every);
        let mut tracker = Tracker::new(Arc::clone(model), FitOptions::default(), start.clone())?
            .with_motion(Motion::Velocity, rate)?
            .with_search(WhenToSearch::WhenPoor);
        let (mut sum, mut count) = (0.0, 0.0);
        let mut track = Vec::new();
        for (frame, truth) in self.truths.iter().enumerate() {
            let views = self.views[frame].iter().map(|view| narrowed(view, narrow_px)).collect();
            let estimate = tracker.track_frame(frame, views, &run.cancel)?;
            run.check()?;
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

    fn errors(&self, model: &Model, track_mm: f64) -> BodyErrors {
        let limbs = || model.limbs().iter().zip(self.body.limbs());
        let mean = |of: &dyn Fn(&Limb, &Limb) -> f64| {
            limbs().map(|(found, truth)| of(found, truth)).sum::<f64>() / model.limbs().len() as f64
        };
        BodyErrors {
            length_mm: mean(&|found, truth| 1000.0 * (found.length - truth.length).abs()),
            radius_mm: mean(&|found, truth| 1000.0 * (found.radius - truth.radius).abs()),
            girth: mean(&|found, truth| (found.radius / truth.radius).ln()),
            track_mm,
        }
    }
}
