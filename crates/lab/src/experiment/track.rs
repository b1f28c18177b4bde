//! A movement followed at several speeds: what carrying the motion from frame to frame is worth.
//!
//! The upper body's movement of Figs. 5.5 and 5.6 runs at 1, 2, 3 and 4 times its speed, 25 frames a second; cameras see hard
//! masks whose borders are noisy, with specks in the background and holes in the subject. Squats before two telephones are
//! filmed at 30 frames a second or every so many of them, with masks that are too wide. Joint errors of every frame, of
//! filtered and, with the Kalman filter, of smoothed poses.

use std::sync::Arc;

use backlit_tracking::body::{Model, Pose, builtin};
use backlit_tracking::camera::Camera;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{Evidence, FitOptions, FitView, Preset};
use backlit_tracking::metrics::mean_joint_error_mm;
use backlit_tracking::search::start::perturb;
use backlit_tracking::silhouette::{Label, Mask, MaskError, SignedDistance};
use backlit_tracking::statistics::Statistics;
use backlit_tracking::track::{KalmanOptions, Motion, Track, Tracker, WhenToSearch, smoothed};
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;
use serde::Serialize;

use super::{ExperimentError, Progress};
use crate::synthetic::{capsules, squats, upper_body};

/// Who moves before which cameras.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Movement {
    /// The report's upper body before cameras around it; a speed is how many times as fast it moves.
    #[default]
    UpperBody,
    /// The full body before two telephones 37° apart; a speed is every how manieth frame is seen.
    Squats,
}

/// What to vary.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Options {
    /// Who moves before which cameras.
    pub movement: Movement,
    /// Pixels across and down.
    pub size_px: [u64; 2],
    /// Cameras; squats have two.
    pub cameras: usize,
    /// Frames of every track.
    pub frames: usize,
    /// Times the movement's own speed.
    pub speeds: Vec<usize>,
    /// Starts in the first frame, each with noise of its own.
    pub starts: usize,
    /// Seed of starts and noise.
    pub seed: u64,
    /// How far every joint of a start is turned from the truth, radians.
    pub angle_rad: f64,
    /// How far the root of a start is from the truth, metres.
    pub distance_m: f64,
    /// Share of the pixels at a silhouette's border that are wrong.
    pub border_noise: f64,
    /// Share of all other pixels that are wrong.
    pub speckle: f64,
    /// By how much masks are too wide all round, pixels.
    pub widened_px: f64,
    /// When other poses are looked for.
    pub search: WhenToSearch,
    /// The ways that are compared.
    pub ways: Vec<Way>,
}

/// A way to follow: a name and every choice.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Way {
    /// What it is called in tables.
    pub name: String,
    /// The choices of a frame's fit.
    pub fit: FitOptions,
    /// How motion is carried on.
    pub motion: Motion,
    /// Whether later frames smooth earlier ones; needs the Kalman filter.
    pub smooth: bool,
    /// Only so many later frames do; all where `None`.
    pub lag: Option<usize>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            movement: Movement::UpperBody,
            size_px: [192, 144],
            cameras: 2,
            frames: 50,
            speeds: vec![1, 2, 3, 4],
            starts: 5,
            seed: 1,
            angle_rad: 5f64.to_radians(),
            distance_m: 0.03,
            border_noise: 0.1,
            speckle: 1e-4,
            widened_px: 0.0,
            search: WhenToSearch::Never,
            ways: ways(),
        }
    }
}

impl Options {
    /// Squats before two telephones: masks some 17 % larger than the person, the search that real footage gets.
    #[must_use]
    pub fn squats() -> Self {
        Self {
            movement: Movement::Squats,
            size_px: [180, 320],
            frames: 100,
            speeds: vec![1, 2, 4],
            starts: 2,
            widened_px: 2.0,
            search: WhenToSearch::WhenPoor,
            ways: ways().split_off(1),
            ..Self::default()
        }
    }
}

/// Frames that the fixed-lag smoother waits.
const LAG: usize = 5;

/// The report's preset, and the robust one with every kind of motion.
#[must_use]
pub fn ways() -> Vec<Way> {
    let way = |name: &str, preset, motion, smooth| Way {
        name: name.to_owned(),
        fit: FitOptions::preset(preset),
        motion,
        smooth,
        lag: None,
    };
    let kalman = Motion::Kalman(KalmanOptions::default());
    vec![
        way("Report 2004, from the last pose", Preset::Report, Motion::Still, false),
        way("Robust, from the last pose", Preset::Robust, Motion::Still, false),
        way("Robust, constant velocity", Preset::Robust, Motion::Velocity, false),
        way("Robust, Kalman", Preset::Robust, kalman, false),
        Way { lag: Some(LAG), ..way("Robust, Kalman, 5 frames late", Preset::Robust, kalman, true) },
        way("Robust, Kalman, smoothed", Preset::Robust, kalman, true),
    ]
}

/// What came of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// One entry a way.
    pub ways: Vec<WayReport>,
}

/// What came of one way.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WayReport {
    /// Its name.
    pub name: String,
    /// One entry a speed.
    pub speeds: Vec<SpeedReport>,
}

/// One way at one speed, over all frames of all starts.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpeedReport {
    /// Times the movement's own speed.
    pub speed: usize,
    /// Mean joint error, millimetres.
    pub mean_mm: f64,
    /// 95 % of the frames lie below, millimetres.
    pub p95_mm: f64,
    /// Worst frame, millimetres.
    pub max_mm: f64,
    /// Frames of all starts.
    pub frames: usize,
}

/// Follows the movement in every way, at every speed, from every start.
///
/// # Errors
/// Options that make no sense, or `cancel`.
pub fn run(
    options: &Options,
    cancel: &CancelToken,
    mut on_progress: impl FnMut(Progress),
) -> Result<Report, ExperimentError> {
    for (option, value) in [("starts", options.starts), ("frames", options.frames)] {
        if value == 0 {
            return Err(ExperimentError::Option { option, value: 0.0, expected: "1 or more" });
        }
    }
    let (model, cameras) = match options.movement {
        Movement::UpperBody => {
            (builtin::upper_body(), upper_body::cameras(options.cameras, options.size_px)?)
        }
        Movement::Squats => (builtin::full_body(), squats::cameras(options.size_px)?),
    };
    let model = Arc::new(model);
    let total = options.ways.len() * options.speeds.len();
    let mut done = 0;
    let mut ways = Vec::new();
    for way in &options.ways {
        let mut speeds = Vec::new();
        for &speed in &options.speeds {
            on_progress(Progress { done, total });
            let mut errors = Vec::new();
            for start in 0..options.starts {
                let seed = options.seed.wrapping_add(start as u64);
                errors.extend(follow(&model, &cameras, options, way, speed, seed, cancel)?);
            }
            speeds.push(SpeedReport::of(speed, &errors));
            done += 1;
        }
        ways.push(WayReport { name: way.name.clone(), speeds });
    }
    on_progress(Progress { done: total, total });
    Ok(Report { ways })
}

/// Mean joint errors of one track, frame by frame, millimetres.
fn follow(
    model: &Arc<Model>,
    cameras: &[Arc<Camera>],
    options: &Options,
    way: &Way,
    speed: usize,
    seed: u64,
    cancel: &CancelToken,
) -> Result<Vec<f64>, ExperimentError> {
    let rate = match options.movement {
        Movement::UpperBody => upper_body::FRAME_RATE,
        Movement::Squats => squats::FRAME_RATE / speed as f64,
    };
    let truth = |frame: usize| match options.movement {
        Movement::UpperBody => upper_body::motion(model, frame * speed),
        Movement::Squats => squats::pose(model, frame as f64 / rate),
    };
    let truths: Vec<Pose> = (0..options.frames).map(truth).collect();
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let start = perturb(model, &truths[0], options.angle_rad, options.distance_m, seed);
    let mut tracker = Tracker::new(Arc::clone(model), way.fit.clone(), start)?
        .with_motion(way.motion, rate)?
        .with_search(options.search);
    let mut track = Track::default();
    for (frame, truth) in truths.iter().enumerate() {
        let mut views = Vec::new();
        for camera in cameras {
            let mask = widened(capsules::hard_mask(model, truth, camera)?, options.widened_px)?;
            let mask = noisy(&mask, options.border_noise, options.speckle, &mut random);
            views.push(FitView {
                camera: Arc::clone(camera),
                evidence: Evidence::Mask(Arc::new(mask)),
                weight: 1.0,
            });
        }
        track.frames.insert(frame, tracker.track_frame(frame, views, cancel)?);
        if cancel.is_cancelled() {
            return Err(ExperimentError::Cancelled);
        }
    }
    if way.smooth {
        track = smoothed(&track, way.lag)?;
    }
    let poses = track.frames.values().map(|estimate| &estimate.pose);
    Ok(poses.zip(&truths).map(|(pose, truth)| mean_joint_error_mm(model, pose, truth)).collect())
}

/// The mask with all that lies within so many pixels of its subject.
pub(super) fn widened(mask: Mask, by_px: f64) -> Result<Mask, MaskError> {
    if by_px <= 0.0 {
        return Ok(mask);
    }
    let distances = SignedDistance::from_mask(&mask);
    let (width, height) = (mask.width(), mask.height());
    let label = |&distance: &f32| {
        if f64::from(distance) < by_px { Label::Subject } else { Label::Background }
    };
    Mask::new(width, height, distances.values()[..width * height].iter().map(label).collect())
}

/// The mask with wrong pixels: a share of those beside a pixel of the other kind, and a share of all others.
#[must_use]
pub fn noisy(mask: &Mask, border_noise: f64, speckle: f64, random: &mut Pcg64Mcg) -> Mask {
    let (width, height) = (mask.width(), mask.height());
    let at = |x: usize, y: usize| mask.labels()[y * width + x];
    let labels = (0..width * height).map(|pixel| {
        let (x, y) = (pixel % width, pixel / width);
        let own = at(x, y);
        let beside = [
            (x > 0).then(|| at(x - 1, y)),
            (x + 1 < width).then(|| at(x + 1, y)),
            (y > 0).then(|| at(x, y - 1)),
            (y + 1 < height).then(|| at(x, y + 1)),
        ];
        let is_border = beside.into_iter().flatten().any(|label| label != own);
        let is_wrong = random.random_bool(if is_border { border_noise } else { speckle });
        match own {
            Label::Subject if is_wrong => Label::Background,
            Label::Background if is_wrong => Label::Subject,
            label => label,
        }
    });
    let labels: Vec<Label> = labels.collect();
    let mut noisy = mask.clone();
    noisy.labels_mut().copy_from_slice(&labels);
    noisy
}

impl SpeedReport {
    fn of(speed: usize, errors: &[f64]) -> Self {
        let (mean_mm, p95_mm, max_mm) =
            Statistics::of(errors).map_or((0.0, 0.0, 0.0), |all| (all.mean, all.p95, all.max));
        Self { speed, mean_mm, p95_mm, max_mm, frames: errors.len() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A lag that reaches every frame's end is the whole smoother, one of none the filter; between them, waiting
    /// helps.
    #[test]
    fn a_fixed_lag_lies_between_filter_and_smoother() {
        let kalman = ways().remove(3);
        let of = |smooth, lag| Way { smooth, lag, ..kalman.clone() };
        let ways =
            vec![of(false, None), of(true, Some(0)), of(true, Some(3)), of(true, Some(50)), of(true, None)];
        let options = Options { frames: 15, starts: 1, speeds: vec![1], ways, ..Options::default() };
        let report = run(&options, &CancelToken::new(), |_| {}).unwrap();
        let mean: Vec<f64> = report.ways.iter().map(|way| way.speeds[0].mean_mm).collect();
        assert!((mean[0] - mean[1]).abs() < 1e-9 && (mean[3] - mean[4]).abs() < 1e-9, "{mean:?}");
        assert!(mean[2] < mean[0] && mean[4] < 0.95 * mean[0], "{mean:?}");
    }

    /// What two telephones see of squats with raised arms decides little: there the filter once lost an arm for good.
    #[test]
    fn no_kalman_mode_is_worse_than_plain_velocity() {
        let options = Options {
            frames: 45,
            starts: 1,
            speeds: vec![2, 4],
            ways: ways().split_off(2),
            ..Options::squats()
        };
        let report = run(&options, &CancelToken::new(), |_| {}).unwrap();
        let [plain, kalman @ ..] = &report.ways[..] else { unreachable!() };
        for way in kalman {
            for (found, plain) in way.speeds.iter().zip(&plain.speeds) {
                assert!(found.mean_mm <= 1.01 * plain.mean_mm, "{}: {found:?} {plain:?}", way.name);
            }
        }
    }

    #[test]
    fn the_robust_preset_follows_four_times_the_speed_through_noise() {
        let options = Options { frames: 12, starts: 1, speeds: vec![4], ..Options::default() };
        let report = run(&options, &CancelToken::new(), |_| {}).unwrap();
        for way in &report.ways[1..] {
            let found = &way.speeds[0];
            assert!(found.max_mm < 50.0 && found.mean_mm < 8.0, "{}: {found:?}", way.name);
        }
    }
}
