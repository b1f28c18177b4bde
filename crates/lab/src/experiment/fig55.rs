//! Figs. 5.5 and 5.6: the upper body followed through a simulated sequence, at 192 × 144 and at 48 × 36 pixels.
//!
//! Two cameras see a smooth movement of 50 frames; every frame may take 25 iterations and starts where constant
//! velocity leads. The report's method is given both its own grey levels, as in a simulation, and hard masks, as
//! in life; all others see hard masks. Joint error and overlap with the hard masks are measured in every frame.

use std::sync::Arc;

use backlit_tracking::body::{Model, Parameters, Pose, builtin};
use backlit_tracking::camera::Camera;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{FitOptions, FitView, Preset};
use backlit_tracking::metrics::{Statistics, mean_joint_error_mm};
use backlit_tracking::optimize::Method;
use backlit_tracking::render::Ramp;
use backlit_tracking::search::start::perturb;
use backlit_tracking::silhouette::Mask;
use backlit_tracking::track::{LOST_BELOW_IOU, Tracker};
use serde::Serialize;

use super::fig52::medians;
use super::{ExperimentError, Progress, Simulation, scene};
use crate::synthetic::{capsules, upper_body};

/// Most iterations of a frame, as in the report.
pub const ITERATIONS: usize = 25;

/// What to vary.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Options {
    /// Pixels across and down: 192 × 144 in Fig. 5.5, 48 × 36 in Fig. 5.6.
    pub size_px: [u64; 2],
    /// Cameras.
    pub cameras: usize,
    /// Frames, from the movement's first.
    pub frames: usize,
    /// Number of starts in the first frame.
    pub starts: usize,
    /// Seed of the starts.
    pub seed: u64,
    /// How far every joint of a start is turned from the truth, radians.
    pub angle_rad: f64,
    /// How far the root of a start is from the truth, metres.
    pub distance_m: f64,
    /// The ways that are compared.
    pub ways: Vec<Way>,
}

/// A way to follow: a name, what it sees, and every choice.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Way {
    /// What it is called in tables and plots.
    pub name: String,
    /// How its data are made.
    pub simulation: Simulation,
    /// Its choices.
    pub fit: FitOptions,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            size_px: [192, 144],
            cameras: 2,
            frames: 50,
            starts: 20,
            seed: 1,
            angle_rad: 5f64.to_radians(),
            distance_m: 0.03,
            ways: ways(),
        }
    }
}

/// Pull towards the pose that a frame began with, in [`lm_half`]: weak, for what the cameras do not see.
const WEAK_PRIOR: f64 = 1.0;

/// Both presets, the report's with [`ITERATIONS`] and also on its own grey levels, and what suits tiny pictures.
#[must_use]
pub fn ways() -> Vec<Way> {
    let way = |name: &str, simulation, fit: FitOptions| Way { name: name.to_owned(), simulation, fit };
    let report = FitOptions::preset(Preset::Report).with_iterations(ITERATIONS);
    // As it is: its stages suit the scale and end by themselves.
    let robust = FitOptions::preset(Preset::Robust);
    vec![
        way("Report 2004, its own grey levels", Simulation::Prediction, report.clone()),
        way("Report 2004, masks", Simulation::Mask, report),
        way("Robust, masks", Simulation::Mask, robust),
        way("LM, half ramp, weak prior, masks", Simulation::Mask, lm_half()),
    ]
}

/// Tangent Levenberg-Marquardt on hard masks with the half ramp and a weak prior, without annealing.
#[must_use]
pub fn lm_half() -> FitOptions {
    FitOptions {
        parameters: Parameters::Tangent,
        method: Method::LevenbergMarquardt,
        damping: 0.01,
        proximal_weight: WEAK_PRIOR,
        largest_turn: Some(0.3),
        largest_move: Some(0.15),
        ..FitOptions::preset(Preset::Report)
    }
    .with_ramp(Ramp::Half)
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
    /// Median over the starts of the mean joint error, frame by frame, millimetres.
    pub median_joint_error_mm: Vec<f64>,
    /// Median over the starts of the overlap (IoU of all cameras together), frame by frame.
    pub median_iou: Vec<f64>,
    /// Mean joint errors of all frames of all starts.
    pub joint_error_mm: Spread,
    /// Frames of all starts that count as lost.
    pub lost: usize,
    /// One sequence a start.
    pub sequences: Vec<Sequence>,
}

/// Statistics of mean joint errors, millimetres.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Spread {
    /// Arithmetic mean.
    pub mean: f64,
    /// Half lie below.
    pub median: f64,
    /// 95 % lie below.
    pub p95: f64,
    /// The largest.
    pub max: f64,
}

/// One start, followed to the end.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sequence {
    /// Mean joint error, frame by frame, millimetres.
    pub joint_errors_mm: Vec<f64>,
    /// Overlap with the hard masks, all cameras together, frame by frame.
    pub iou: Vec<f64>,
    /// Iterations, frame by frame.
    pub iterations: Vec<usize>,
    /// Frames that count as lost.
    pub lost: usize,
}

/// Follows the movement in every way from every start.
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
    let model = Arc::new(builtin::upper_body());
    let cameras = upper_body::cameras(options.cameras, options.size_px)?;
    let truths: Vec<Pose> = (0..options.frames).map(|frame| upper_body::motion(&model, frame)).collect();
    let moments = truths.into_iter().map(|truth| Moment::new(&model, &cameras, truth));
    let moments = moments.collect::<Result<Vec<Moment>, _>>()?;
    let total = options.ways.len() * options.starts;
    let mut ways = Vec::new();
    for way in &options.ways {
        let views = moments.iter().map(|moment| way.views(&model, &cameras, &moment.truth));
        let views = views.collect::<Result<Vec<_>, _>>()?;
        let mut sequences = Vec::new();
        for start in 0..options.starts {
            on_progress(Progress { done: ways.len() * options.starts + start, total });
            let seed = options.seed.wrapping_add(start as u64);
            let from = perturb(&model, &moments[0].truth, options.angle_rad, options.distance_m, seed);
            let tracker = Tracker::new(Arc::clone(&model), way.fit.clone(), from)?;
            sequences.push(follow(&model, &cameras, &moments, &views, tracker, way, cancel)?);
        }
        ways.push(WayReport::of(&way.name, sequences));
    }
    on_progress(Progress { done: total, total });
    Ok(Report { ways })
}

/// One frame's truth, and its hard masks.
struct Moment {
    truth: Pose,
    masks: Vec<Mask>,
}

impl Moment {
    fn new(model: &Model, cameras: &[Arc<Camera>], truth: Pose) -> Result<Self, ExperimentError> {
        let masks = cameras.iter().map(|camera| capsules::hard_mask(model, &truth, camera));
        let masks = masks.collect::<Result<Vec<_>, _>>()?;
        Ok(Self { truth, masks })
    }
}

impl Way {
    fn views(
        &self,
        model: &Model,
        cameras: &[Arc<Camera>],
        truth: &Pose,
    ) -> Result<Vec<FitView>, ExperimentError> {
        let ramp = self.fit.final_ramp();
        let see = |camera| scene::view(model, truth, camera, self.simulation, self.fit.renderer, ramp);
        cameras.iter().map(see).collect()
    }
}

fn follow(
    model: &Model,
    cameras: &[Arc<Camera>],
    moments: &[Moment],
    views: &[Vec<FitView>],
    mut tracker: Tracker,
    way: &Way,
    cancel: &CancelToken,
) -> Result<Sequence, ExperimentError> {
    let mut sequence =
        Sequence { joint_errors_mm: Vec::new(), iou: Vec::new(), iterations: Vec::new(), lost: 0 };
    for (frame, (moment, views)) in moments.iter().zip(views).enumerate() {
        let estimate = tracker.track_frame(frame, views.clone(), cancel)?;
        if cancel.is_cancelled() {
            return Err(ExperimentError::Cancelled);
        }
        let overlap = scene::overlap(model, &estimate.pose, cameras, &moment.masks, way.fit.renderer);
        let iou = overlap.iou().unwrap_or(0.0);
        sequence.joint_errors_mm.push(mean_joint_error_mm(model, &estimate.pose, &moment.truth));
        sequence.iou.push(iou);
        sequence.iterations.push(estimate.iterations);
        sequence.lost += usize::from(iou < LOST_BELOW_IOU);
    }
    Ok(sequence)
}

impl WayReport {
    fn of(name: &str, sequences: Vec<Sequence>) -> Self {
        let all: Vec<f64> = sequences.iter().flat_map(|one| one.joint_errors_mm.iter().copied()).collect();
        let overall = Statistics::of(&all);
        Self {
            name: name.to_owned(),
            median_joint_error_mm: medians(sequences.iter().map(|one| one.joint_errors_mm.clone())),
            median_iou: medians(sequences.iter().map(|one| one.iou.clone())),
            joint_error_mm: overall.map_or_else(Spread::default, |all| Spread {
                mean: all.mean,
                median: all.median,
                p95: all.p95,
                max: all.max,
            }),
            lost: sequences.iter().map(|one| one.lost).sum(),
            sequences,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_presets_follow_the_movement_and_the_robust_one_is_nearer() {
        let options = Options { frames: 8, starts: 2, ..Options::default() };
        let report = run(&options, &CancelToken::new(), |_| {}).unwrap();
        let last = |list: &[f64]| *list.last().unwrap();
        let [own, thesis, robust] = [0, 1, 2].map(|way| &report.ways[way]);
        assert_eq!(thesis.sequences[0].iterations, [ITERATIONS; 8]);
        assert!(robust.sequences.iter().all(|one| one.iterations.iter().all(|&n| n <= ITERATIONS)));
        assert!(last(&thesis.median_joint_error_mm) < 60.0, "{:?}", thesis.median_joint_error_mm);
        assert!(last(&own.median_joint_error_mm) < 0.5 * last(&thesis.median_joint_error_mm));
        assert!(last(&robust.median_joint_error_mm) < 0.7 * last(&thesis.median_joint_error_mm));
        assert!(last(&robust.median_iou) > 0.9, "{:?}", robust.median_iou);
    }
}
