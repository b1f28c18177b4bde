//! Figs. 5.5 and 5.6: a body followed through a sequence, at 192 × 144 and at 48 × 36 pixels.
//!
//! Two cameras, 50 frames. The report's figures are of real data (section 5.2); ours are of a take, or of a simulated upper
//! body. As in the report, its method takes 25 iterations a frame and begins each at the last one's pose; where the
//! truth is known it is also given its own grey levels. All others see hard masks and do as their preset does.

use std::sync::Arc;

use backlit_tracking::body::{Parameters, Pose};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{DataView, FitOptions, FitView, Preset};
use backlit_tracking::optimize::Method;
use backlit_tracking::render::Ramp;
use backlit_tracking::search::start::perturb;
use backlit_tracking::statistics::Statistics;
use backlit_tracking::track::{LOST_BELOW_IOU, Motion, Tracker};
use serde::Serialize;

use super::fig52::medians;
use super::sequence::Sequence;
use super::{ExperimentError, Progress, Simulation, scene};

/// Most iterations of a frame, as in the report.
pub const ITERATIONS: usize = 25;
/// The frames that the report shows, counted from 0.
pub const FRAMES: [usize; 5] = [0, 8, 16, 24, 32];

/// What to vary.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Options {
    /// Number of starts in the first frame.
    pub starts: usize,
    /// Seed of the starts.
    pub seed: u64,
    /// How far every joint of a start is turned from the sequence's, radians.
    pub angle_rad: f64,
    /// How far the root of a start is from there, metres.
    pub distance_m: f64,
    /// The ways that are compared.
    pub ways: Vec<Way>,
}

/// A way to follow: a name, what it sees, and every choice.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Way {
    /// What it is called in tables and plots.
    pub name: String,
    /// How its data are made; grey levels of the truth are of simulations only.
    pub simulation: Simulation,
    /// Its choices.
    pub fit: FitOptions,
    /// How motion is carried from frame to frame.
    pub motion: Motion,
}

impl Default for Options {
    fn default() -> Self {
        Self { starts: 20, seed: 1, angle_rad: 5f64.to_radians(), distance_m: 0.03, ways: ways() }
    }
}

/// Pull towards the pose that a frame began with, in [`lm_half`]: weak, for what the cameras do not see.
const WEAK_PRIOR: f64 = 1.0;

/// Both presets, the report's with [`ITERATIONS`] and also on its own grey levels, and what suits tiny pictures.
#[must_use]
pub fn ways() -> Vec<Way> {
    let way = |name: &str, simulation, preset, fit: FitOptions| {
        let motion = Motion::of_preset(Some(preset));
        Way { name: name.to_owned(), simulation, fit, motion }
    };
    let report = FitOptions::preset(Preset::Report).with_iterations(ITERATIONS);
    // As it is: its stages suit the scale and end by themselves.
    let robust = FitOptions::preset(Preset::Robust);
    vec![
        way("Report 2004, its own grey levels", Simulation::Prediction, Preset::Report, report.clone()),
        way("Report 2004, masks", Simulation::Mask, Preset::Report, report),
        way("Robust, masks", Simulation::Mask, Preset::Robust, robust),
        way("LM, half ramp, weak prior, masks", Simulation::Mask, Preset::Robust, lm_half()),
    ]
}

/// Tangent Levenberg-Marquardt on hard masks with the half ramp and a weak prior, without annealing.
#[must_use]
pub fn lm_half() -> FitOptions {
    let mut fit = FitOptions {
        parameters: Parameters::Tangent,
        method: Method::LevenbergMarquardt,
        damping: 0.01,
        proximal_weight: WEAK_PRIOR,
        largest_turn: Some(0.3),
        largest_move: Some(0.15),
        ..FitOptions::preset(Preset::Report)
    }
    .with_ramp(Ramp::Half);
    fit.stages[0].data = DataView::Hard;
    fit
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
    /// Mean joint errors of all frames of all starts; `None` where no joint is known.
    pub joint_error_mm: Option<Spread>,
    /// Frames of all starts that count as lost.
    pub lost: usize,
    /// One entry a start.
    pub sequences: Vec<Followed>,
}

/// Statistics of mean joint errors, millimetres.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
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
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Followed {
    /// Mean joint error, millimetres, of every frame in which joints are known.
    pub joint_errors_mm: Vec<f64>,
    /// Overlap with the hard masks, all cameras together, frame by frame.
    pub iou: Vec<f64>,
    /// Iterations, frame by frame.
    pub iterations: Vec<usize>,
    /// Frames that count as lost.
    pub lost: usize,
    /// What was found, frame by frame.
    #[serde(skip)]
    pub poses: Vec<Pose>,
}

/// Follows the sequence in every way from every start. Ways that need a truth which is not known are left out.
///
/// # Errors
/// Options that make no sense, or `cancel`.
pub fn run(
    options: &Options,
    sequence: &Sequence,
    cancel: &CancelToken,
    mut on_progress: impl FnMut(Progress),
) -> Result<Report, ExperimentError> {
    if options.starts == 0 {
        return Err(ExperimentError::Option { option: "starts", value: 0.0, expected: "1 or more" });
    }
    let total = options.ways.len() * options.starts;
    let mut ways = Vec::new();
    for way in &options.ways {
        let frames = 0..sequence.moments.len();
        let views: Option<Vec<_>> =
            frames.map(|frame| way.views(sequence, frame).transpose()).collect::<Option<Vec<_>>>();
        let Some(views) = views else { continue };
        let views = views.into_iter().collect::<Result<Vec<_>, _>>()?;
        let mut sequences = Vec::new();
        for start in 0..options.starts {
            on_progress(Progress { done: ways.len() * options.starts + start, total });
            let seed = options.seed.wrapping_add(start as u64);
            let from = perturb(&sequence.model, &sequence.start, options.angle_rad, options.distance_m, seed);
            sequences.push(follow(sequence, &views, from, way, cancel)?);
        }
        ways.push(WayReport::of(&way.name, sequences));
    }
    on_progress(Progress { done: total, total });
    Ok(Report { ways })
}

impl Way {
    /// What it sees of a frame; `None` where that takes a truth and there is none.
    pub(super) fn views(
        &self,
        sequence: &Sequence,
        frame: usize,
    ) -> Result<Option<Vec<FitView>>, ExperimentError> {
        let moment = &sequence.moments[frame];
        if self.simulation == Simulation::Mask {
            return Ok(Some(moment.views.clone()));
        }
        let Some(truth) = &moment.truth else { return Ok(None) };
        let (ramp, renderer) = (self.fit.final_ramp(), self.fit.renderer);
        let see = |view: &FitView| {
            scene::view(&sequence.model, truth, &view.camera, self.simulation, renderer, ramp)
        };
        moment.views.iter().map(see).collect::<Result<_, _>>().map(Some)
    }
}

fn follow(
    sequence: &Sequence,
    views: &[Vec<FitView>],
    from: Pose,
    way: &Way,
    cancel: &CancelToken,
) -> Result<Followed, ExperimentError> {
    let model = &sequence.model;
    let mut tracker = Tracker::new(Arc::clone(model), way.fit.clone(), from)?
        .with_motion(way.motion, sequence.frame_rate)?;
    let mut followed = Followed::default();
    for (frame, (moment, views)) in sequence.moments.iter().zip(views).enumerate() {
        let estimate = tracker.track_frame(frame, views.clone(), cancel)?;
        if cancel.is_cancelled() {
            return Err(ExperimentError::Cancelled);
        }
        let overlap = scene::overlap(model, &estimate.pose, &moment.views, way.fit.renderer);
        let iou = overlap.iou().unwrap_or(0.0);
        followed.joint_errors_mm.extend(moment.joint_error_mm(model, &estimate.pose));
        followed.iou.push(iou);
        followed.iterations.push(estimate.iterations);
        followed.lost += usize::from(iou < LOST_BELOW_IOU);
        followed.poses.push(estimate.pose);
    }
    Ok(followed)
}

impl WayReport {
    fn of(name: &str, sequences: Vec<Followed>) -> Self {
        let all: Vec<f64> = sequences.iter().flat_map(|one| one.joint_errors_mm.iter().copied()).collect();
        let spread =
            |all: Statistics| Spread { mean: all.mean, median: all.median, p95: all.p95, max: all.max };
        Self {
            name: name.to_owned(),
            median_joint_error_mm: medians(sequences.iter().map(|one| one.joint_errors_mm.clone())),
            median_iou: medians(sequences.iter().map(|one| one.iou.clone())),
            joint_error_mm: Statistics::of(&all).map(spread),
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
        let options = Options { starts: 2, ..Options::default() };
        let sequence = Sequence::simulated([192, 144], 2, 8).unwrap();
        let report = run(&options, &sequence, &CancelToken::new(), |_| {}).unwrap();
        let last = |list: &[f64]| *list.last().unwrap();
        let [own, thesis, robust] = [0, 1, 2].map(|way| &report.ways[way]);
        assert_eq!(thesis.sequences[0].iterations, [ITERATIONS; 8]);
        assert!(robust.sequences.iter().all(|one| one.iterations.iter().all(|&n| n <= ITERATIONS)));
        assert!(last(&thesis.median_joint_error_mm) < 60.0, "{:?}", thesis.median_joint_error_mm);
        assert!(last(&own.median_joint_error_mm) < 0.5 * last(&thesis.median_joint_error_mm));
        assert!(last(&robust.median_joint_error_mm) < 0.7 * last(&thesis.median_joint_error_mm));
        assert!(last(&robust.median_iou) > 0.9, "{:?}", robust.median_iou);
    }

    /// As in section 5.2, the report's frames begin at the last one's pose. Without a truth nothing is given that
    /// needs one, and no error is made up.
    #[test]
    fn what_is_not_known_is_not_told() {
        let way = |name: &str| ways().into_iter().find(|way| way.name == name).unwrap();
        assert_eq!(way("Report 2004, masks").motion, Motion::Still);
        assert_eq!(way("Robust, masks").motion, Motion::Velocity);
        let mut sequence = Sequence::simulated([48, 36], 2, 2).unwrap();
        for moment in &mut sequence.moments {
            moment.truth = None;
            moment.joints.clear();
        }
        let options = Options { starts: 1, ..Options::default() };
        let report = run(&options, &sequence, &CancelToken::new(), |_| {}).unwrap();
        let names: Vec<&str> = report.ways.iter().map(|way| way.name.as_str()).collect();
        assert_eq!(names, ["Report 2004, masks", "Robust, masks", "LM, half ramp, weak prior, masks"]);
        assert!(report.ways.iter().all(|way| way.joint_error_mm.is_none() && way.median_iou.len() == 2));
    }
}
