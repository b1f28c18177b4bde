//! A movement followed at several speeds: what carrying the motion from frame to frame is worth.
//!
//! The upper body's movement of Figs. 5.5 and 5.6 runs at 1, 2, 3 and 4 times its speed, 25 frames a second; cameras see hard
//! masks whose borders are noisy, with specks in the background and holes in the subject. Squats before two telephones are
//! filmed at 30 frames a second, or only every second or fourth frame, with masks some 17 % larger than the person and the
//! search that real footage gets. Exercises are followed with the prior of likely poses, as a track is by default. Errors are of every frame, of filtered and, with the Kalman filter, of smoothed poses.

use std::sync::Arc;

use anyhow::Result;
use backlit_formats::prior_file;
use backlit_lab::experiment::credibility::Credibility;
use backlit_lab::synthetic::masks::{noisy, widened};
use backlit_lab::synthetic::{capsules, exercise, squats, upper_body};
use backlit_plot::{Axis, Figure, FigureOrSheet, Line};
use backlit_tracking::body::{Model, Pose, builtin};
use backlit_tracking::camera::Camera;
use backlit_tracking::fit::{FitOptions, FitView, Preset};
use backlit_tracking::metrics::mean_joint_error_mm;
use backlit_tracking::residual::learnt_prior::LearntPrior;
use backlit_tracking::search::start::perturb;
use backlit_tracking::track::{KalmanOptions, Motion, Track, Tracker, WhenToSearch, smoothed};
use clap::{Args, ValueEnum};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;
use serde::Serialize;

use super::measures::ErrorStatistics;
use super::{Experiment, Run, check_least};
use crate::numbers::within;
use crate::output::number;
use crate::table::Table;
use crate::take_options::StartNoise;

/// Frames that the fixed-lag smoother waits.
const LAG: usize = 5;

/// The upper body followed at one to four times its speed through noisy masks, by kind of motion
#[derive(Debug, Args, Serialize)]
pub(crate) struct Speeds {
    /// Who moves before which cameras
    #[arg(long, value_enum, default_value_t)]
    movement: Movement,
    #[arg(skip)]
    size_px: [u64; 2],
    /// Cameras around the upper body [1 to 64]
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = within(1..=64_usize))]
    cameras: usize,
    /// Frames of every track [1 to 10000] [default: 50; of squats 100; of exercises 240]
    #[arg(long, value_name = "N", value_parser = within(1..=10_000_usize))]
    frames: Option<usize>,
    /// Times the movement's own speed; for squats, only every Nth frame is seen [1 to 100] [default: 1,2,3,4; of squats 1,2,4; of exercises 1,2]
    #[arg(long, value_name = "N", value_delimiter = ',', value_parser = within(1..=100_usize))]
    speeds: Option<Vec<usize>>,
    /// Number of starts [1 to 1000] [default: 5; of squats and exercises 2]
    #[arg(long, value_name = "N", value_parser = within(1..=1000_usize))]
    starts: Option<usize>,
    /// Seed of the random starts and of all noise [0 to 4294967295]
    #[arg(long, value_name = "S", default_value_t = 1, value_parser = within(0..=4_294_967_295_u64))]
    seed: u64,
    /// How far every joint of a start is turned and its root moved [0 to 180deg, 0 to 100m]
    #[arg(long, value_name = "ANGLE,DISTANCE", default_value = "5deg,3cm")]
    #[serde(flatten)]
    start_noise: StartNoise,
    /// Share of the pixels at a silhouette's border that are wrong.
    #[arg(skip = 0.1)]
    border_noise: f64,
    /// Share of all other pixels that are wrong.
    #[arg(skip = 1e-4)]
    speckle: f64,
    /// By how much masks are too wide all round.
    #[arg(skip)]
    widened_px: f64,
    #[arg(skip = WhenToSearch::Never)]
    search: WhenToSearch,
    #[arg(skip)]
    #[serde(rename = "ways")]
    methods: Vec<MotionMethod>,
}

/// Who moves before which cameras.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
enum Movement {
    /// The report's upper body, before cameras around it
    #[default]
    UpperBody,
    /// The full body, before two phones 37° apart whose masks are too wide
    Squats,
    /// A walk, squats, signals and boxing with the prior of likely poses, before three cameras
    Exercise,
}

/// How motion is carried on, and every choice of a frame's fit.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct MotionMethod {
    name: String,
    fit: FitOptions,
    motion: Motion,
    /// Whether later frames smooth earlier ones; needs the Kalman filter.
    smooth: bool,
    /// How many later frames do; all where `None`.
    lag: Option<usize>,
}

/// The report's preset, and the robust one with every kind of motion.
fn methods() -> Vec<MotionMethod> {
    let method = |name: &str, preset, motion, smooth| MotionMethod {
        name: name.to_owned(),
        fit: FitOptions::preset(preset),
        motion,
        smooth,
        lag: None,
    };
    let kalman = Motion::Kalman(KalmanOptions::default());
    let steered = Motion::Kalman(KalmanOptions { steers: true, ..KalmanOptions::default() });
    vec![
        method("Report 2004, from the last pose", Preset::Report, Motion::Still, false),
        method("Robust, from the last pose", Preset::Robust, Motion::Still, false),
        method("Robust, constant velocity", Preset::Robust, Motion::Velocity, false),
        method("Robust, Kalman", Preset::Robust, kalman, false),
        method("Robust, Kalman that steers", Preset::Robust, steered, false),
        MotionMethod {
            lag: Some(LAG),
            ..method("Robust, Kalman, 5 frames late", Preset::Robust, kalman, true)
        },
        method("Robust, Kalman, smoothed", Preset::Robust, kalman, true),
    ]
}

#[derive(Debug, Serialize)]
pub(crate) struct Report {
    ways: Vec<TrackedMethod>,
}

#[derive(Debug, Serialize)]
struct TrackedMethod {
    name: String,
    speeds: Vec<AtSpeed>,
}

/// One method at one speed, over all frames of all starts.
#[derive(Debug, Serialize)]
struct AtSpeed {
    speed: usize,
    #[serde(flatten)]
    errors: ErrorStatistics,
    frames: usize,
    /// Of a Kalman filter: 1 where it errs as it says.
    nis: Option<f64>,
    nees: Option<f64>,
}

impl Experiment for Speeds {
    const NAME: &'static str = "track";
    type Report = Report;

    fn run(&mut self, run: &Run) -> Result<Report> {
        let (model, cameras) = self.scene()?;
        let [starts, frames] = [self.starts, self.frames].map(Option::unwrap_or_default);
        check_least("starts", starts, 1)?;
        check_least("frames", frames, 1)?;
        let speeds = self.speeds.as_deref().unwrap_or_default();
        let (mut done, total) = (0, self.methods.len() * speeds.len());
        let mut ways = Vec::new();
        for method in &self.methods {
            let mut found = Vec::new();
            for &speed in speeds {
                run.progress(done, total)?;
                done += 1;
                let (mut errors, mut credibility) = (Vec::new(), Credibility::default());
                for start in 0..starts {
                    let seed = self.seed.wrapping_add(start as u64);
                    let (of_start, sum) =
                        self.follow(&model, &cameras, method, [frames, speed], seed, run)?;
                    errors.extend(of_start);
                    credibility += sum;
                }
                let (statistics, frames) = (ErrorStatistics::of(&errors).unwrap_or_default(), errors.len());
                let (nis, nees) = (credibility.nis(), credibility.nees());
                found.push(AtSpeed { speed, errors: statistics, frames, nis, nees });
            }
            ways.push(TrackedMethod { name: method.name.clone(), speeds: found });
        }
        Ok(Report { ways })
    }

    fn table(&self, report: &Report) -> String {
        let rows = report.ways.iter().flat_map(|one| one.speeds.iter().map(move |found| (one, found)));
        Table::of(
            rows,
            &[
                ("method", &|(method, _)| method.name.clone()),
                ("speed", &|(_, found)| format!("{}×", found.speed)),
                ("joint error, mm: mean", &|(_, found)| number(found.errors.mean_mm, 2)),
                ("95 %", &|(_, found)| number(found.errors.p95_mm, 2)),
                ("max", &|(_, found)| number(found.errors.max_mm, 1)),
                ("NIS", &|(_, found)| found.nis.map_or_else(String::new, |nis| number(nis, 2))),
                ("NEES", &|(_, found)| found.nees.map_or_else(String::new, |nees| number(nees, 2))),
            ],
        )
    }

    fn pictures(&self, report: &Report) -> Vec<(String, FigureOrSheet)> {
        let line = |(style, method): (_, &TrackedMethod)| {
            let points = method.speeds.iter().map(|found| [found.speed as f64, found.errors.max_mm]);
            Line::of_points(&method.name, style, points.collect())
        };
        let ([width, height], cameras) = (self.size_px, self.cameras);
        let [frames, starts] = [self.frames, self.starts].map(Option::unwrap_or_default);
        let figure = Figure {
            title: match self.movement {
                Movement::UpperBody => "Upper body followed through noisy masks: worst frame",
                Movement::Squats => "Squats followed through masks that are too wide: worst frame",
                Movement::Exercise => "Exercises followed through noisy masks: worst frame",
            }
            .to_owned(),
            subtitle: format!(
                "{width} × {height} pixels, {cameras} cameras, {frames} frames of {starts} starts"
            ),
            x: Axis::linear("times the speed"),
            y: Axis::log("largest joint error of a frame, mm"),
            lines: report.ways.iter().enumerate().map(line).collect(),
        };
        vec![("track".to_owned(), FigureOrSheet::Figure(figure))]
    }
}

impl Speeds {
    /// Body and cameras; what was not asked for gets the movement's own numbers.
    fn scene(&mut self) -> Result<(Arc<Model>, Vec<Arc<Camera>>)> {
        let (model, cameras, [frames, starts], speeds) = match self.movement {
            Movement::UpperBody => {
                self.size_px = [192, 144];
                let cameras = upper_body::cameras(self.cameras, self.size_px)?;
                (builtin::upper_body(), cameras, [50, 5], vec![1, 2, 3, 4])
            }
            Movement::Squats => {
                (self.cameras, self.size_px) = (2, [180, 320]);
                (self.widened_px, self.search) = (2.0, WhenToSearch::WhenPoor);
                (builtin::full_body(), squats::cameras(self.size_px)?, [100, 2], vec![1, 2, 4])
            }
            Movement::Exercise => {
                (self.cameras, self.size_px) = (exercise::MOST_CAMERAS, [120, 160]);
                let cameras = exercise::cameras(self.cameras, self.size_px)?;
                (builtin::full_body(), cameras, [240, 2], vec![1, 2])
            }
        };
        if self.methods.is_empty() {
            self.methods = methods().split_off(usize::from(self.movement != Movement::UpperBody));
            if self.movement == Movement::Exercise {
                let prior = LearntPrior::new(prior_file::people());
                self.methods.iter_mut().for_each(|method| method.fit.prior = Some(prior.clone()));
            }
        }
        self.frames.get_or_insert(frames);
        self.starts.get_or_insert(starts);
        self.speeds.get_or_insert(speeds);
        Ok((Arc::new(model), cameras))
    }

    /// Mean joint errors of one track, frame by frame, millimetres, and whether its filter erred as it said.
    fn follow(
        &self,
        model: &Arc<Model>,
        cameras: &[Arc<Camera>],
        method: &MotionMethod,
        [frames, speed]: [usize; 2],
        seed: u64,
        run: &Run,
    ) -> Result<(Vec<f64>, Credibility)> {
        let rate = match self.movement {
            Movement::UpperBody => upper_body::FRAME_RATE,
            Movement::Squats => squats::FRAME_RATE / speed as f64,
            Movement::Exercise => exercise::FRAME_RATE,
        };
        let truth = |frame: usize| match self.movement {
            Movement::UpperBody => upper_body::motion(model, frame * speed),
            Movement::Squats => squats::pose(model, frame as f64 / rate),
            Movement::Exercise => exercise::pose(model, (frame * speed) as f64 / rate),
        };
        let truths: Vec<Pose> = (0..frames).map(truth).collect();
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let noise = self.start_noise;
        let start = perturb(model, &truths[0], noise.angle_rad, noise.distance_m, seed);
        let mut tracker = Tracker::new(Arc::clone(model), method.fit.clone(), start)?
            .with_motion(method.motion, rate)?
            .with_search(self.search);
        let mut track = Track::default();
        for (frame, truth) in truths.iter().enumerate() {
            let mut views = Vec::new();
            for camera in cameras {
                let mask = widened(capsules::hard_mask(model, truth, camera)?, self.widened_px)?;
                let mask = noisy(&mask, self.border_noise, self.speckle, &mut random);
                views.push(FitView::of_mask(camera.clone(), mask));
            }
            track.frames.insert(frame, tracker.track_frame(frame, views, &run.cancel)?);
            run.check()?;
        }
        if method.smooth {
            track = smoothed(&track, method.lag)?;
        }
        let (mut errors, mut credibility) = (Vec::new(), Credibility::default());
        for (estimate, truth) in track.frames.values().zip(&truths) {
            errors.push(mean_joint_error_mm(model, &estimate.pose, truth));
            credibility += Credibility::of_frame(model, estimate, truth);
        }
        Ok((errors, credibility))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::arguments::defaults;

    fn report(movement: Movement, frames: usize, speeds: &[usize], methods: Vec<MotionMethod>) -> Report {
        let (frames, speeds) = (Some(frames), Some(speeds.to_vec()));
        let mut small = Speeds { movement, frames, speeds, starts: Some(1), methods, ..defaults() };
        small.run(&Run::hidden()).unwrap()
    }

    /// A lag that reaches every frame's end is the whole smoother, one of none the filter; between them, waiting
    /// helps.
    #[test]
    fn a_fixed_lag_lies_between_filter_and_smoother() {
        let kalman = methods().remove(3);
        let lags = [(false, None), (true, Some(0)), (true, Some(3)), (true, Some(50)), (true, None)]
            .map(|(smooth, lag)| MotionMethod { smooth, lag, ..kalman.clone() });
        let report = report(Movement::UpperBody, 15, &[1], lags.into());
        let mean: Vec<f64> = report.ways.iter().map(|method| method.speeds[0].errors.mean_mm).collect();
        assert!((mean[0] - mean[1]).abs() < 1e-9 && (mean[3] - mean[4]).abs() < 1e-9, "{mean:?}");
        assert!(mean[2] < mean[0] && mean[4] < 0.95 * mean[0], "{mean:?}");
    }

    /// What two telephones see of squats with raised arms decides little: there the filter once lost an arm for good.
    #[test]
    fn no_kalman_mode_that_follows_the_fit_is_worse_than_plain_velocity() {
        let mut following = methods().split_off(2);
        following
            .retain(|method| !matches!(method.motion, Motion::Kalman(KalmanOptions { steers: true, .. })));
        let report = report(Movement::Squats, 45, &[2, 4], following);
        let [plain, kalman @ ..] = &report.ways[..] else { unreachable!() };
        for method in kalman {
            for (found, plain) in method.speeds.iter().zip(&plain.speeds) {
                let within = found.errors.mean_mm <= 1.01 * plain.errors.mean_mm;
                assert!(within, "{}: {found:?} {plain:?}", method.name);
            }
        }
    }

    #[test]
    fn the_robust_preset_follows_four_times_the_speed_through_noise() {
        let report = report(Movement::UpperBody, 12, &[4], Vec::new());
        for method in &report.ways[1..] {
            let AtSpeed { errors, .. } = method.speeds[0];
            assert!(errors.max_mm < 50.0 && errors.mean_mm < 8.0, "{}: {errors:?}", method.name);
        }
    }
}
