//! Limbs that silhouettes do not hold, with and without cues of the pictures (6.3).
//!
//! The figure in loose, patterned clothes folds its arms, puts its hands on its hips, squats with the arms to the front,
//! crosses its legs before two telephones 37° apart, and walks before two from one side
//! ([`Occlusion`]). Masks are exact ones widened all round; pictures are drawn, exposed and
//! grey; keypoints are true joints with an offset each, noise, and some that are nowhere near. The average body follows
//! at several frame rates in several ways: silhouettes alone, with each cue, with all. Errors are those of the ends of arms
//! and legs that are covered at the true pose ([`Coverage`](backlit_tracking::cues::Coverage)), and of those that are not.

mod footage;

use std::sync::Arc;
use std::time::Instant;

use backlit_tracking::body::{Kinematics, Model, Pose, builtin};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::cues::{Cue, CueOptions, CueReach, CueStrength, CueWatch, WatchedCamera};
use backlit_tracking::fit::{Evidence, FitOptions, FitView};
use backlit_tracking::render::RendererKind;
use backlit_tracking::residual::learnt_prior::LearntPrior;
use backlit_tracking::search::start::perturb;
use backlit_tracking::statistics::Statistics;
use backlit_tracking::track::{FrameEstimate, Tracker, WhenToSearch};
use serde::Serialize;

pub use self::footage::{FilmedFrame, film};
use super::{ExperimentError, Progress};
use crate::synthetic::occlusions::Occlusion;

/// Frames a second that are drawn; a rate is one of every so manieth of them.
pub const DRAWN_RATE: f64 = 60.0;
/// A joint that is farther off is lost, millimetres.
const LOST_MM: f64 = 150.0;
/// Words in the names of limbs that count: arms and legs. Feet are told apart, since no keypoint shows where they point.
const LIMBS: [&str; 5] = ["upper arm", "forearm", "hand", "thigh", "calf"];
const FOOT: &str = "foot";

/// What to vary.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Options {
    /// The movements.
    pub movements: Vec<Occlusion>,
    /// Every how manieth of [`DRAWN_RATE`] frames a second is seen: 1 is 60, 4 is 15, 8 is 7.5.
    pub every: Vec<usize>,
    /// Seconds of each movement.
    pub seconds: f64,
    /// Pixels across and down.
    pub size_px: [u64; 2],
    /// How much too wide masks are all round, as a share of the breadth of the shoulders.
    pub too_wide: f64,
    /// Contrast of the pattern on clothes and sleeves.
    pub pattern: f64,
    /// Seed of noise and starts.
    pub seed: u64,
    /// So many of the two cameras see it.
    pub cameras: usize,
    /// The ways that are compared.
    pub ways: Vec<Way>,
}

/// A way to follow: a name, and its cues if it has any.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Way {
    /// What it is called in tables.
    pub name: String,
    /// Its cues.
    pub cues: Option<CueOptions>,
    /// How a frame is fitted: a prior learnt from motion is among the choices.
    pub fit: FitOptions,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            movements: Occlusion::ALL.to_vec(),
            every: vec![1, 4, 8],
            seconds: 6.0,
            size_px: [180, 320],
            too_wide: 0.045,
            pattern: 0.5,
            seed: 1,
            cameras: 2,
            ways: ways(),
        }
    }
}

/// Weights of edges, which are off by default: of the cue alone, and beside all others.
const EDGES_ALONE: f64 = 3e3;
const EDGES_BESIDE: f64 = 1e3;

/// Silhouettes alone, each cue, the default ones together, all of them; keypoints at all limbs too.
#[must_use]
pub fn ways() -> Vec<Way> {
    let defaults = CueOptions::default();
    let with_edges = |weight: f64| CueOptions { edges: CueStrength { weight, ..defaults.edges }, ..defaults };
    let way = |name: &str, cues: CueOptions| Way {
        name: name.to_owned(),
        cues: Some(cues),
        fit: FitOptions::default(),
    };
    let keypoints = defaults.only(&[Cue::Keypoints]);
    let mut ways = vec![Way { name: "silhouettes alone".to_owned(), cues: None, fit: FitOptions::default() }];
    ways.extend(Cue::ALL.map(|cue| way(cue.name(), with_edges(EDGES_ALONE).only(&[cue]))));
    ways.push(way("flow, stereo", defaults.only(&[Cue::Flow, Cue::Stereo])));
    ways.push(way("keypoints, flow, stereo", defaults));
    ways.push(way("all cues", with_edges(EDGES_BESIDE)));
    ways.push(way("keypoints at all limbs", CueOptions { reach: CueReach::All, ..keypoints }));
    ways
}

/// The same ways with a prior learnt from motion beside them.
#[must_use]
pub fn with_prior(ways: &[Way], prior: &LearntPrior) -> Vec<Way> {
    let with = |way: &Way| Way {
        name: format!("{}, prior", way.name),
        fit: FitOptions { prior: Some(prior.clone()), ..way.fit.clone() },
        ..way.clone()
    };
    ways.iter().map(with).collect()
}

/// What came of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// Movement by movement, rate by rate, way by way.
    pub cases: Vec<Case>,
}

/// One movement at one rate in one way. Errors are millimetres.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Case {
    /// The movement.
    pub movement: Occlusion,
    /// Frames a second.
    pub rate: f64,
    /// The way's name.
    pub way: String,
    /// Mean error of the ends of covered limbs.
    pub covered_mm: Option<f64>,
    /// 95 % of them lie below.
    pub covered_p95_mm: Option<f64>,
    /// Share of the ends of covered limbs that are lost.
    pub covered_lost: f64,
    /// Mean error of the ends of feet, covered or not.
    pub feet_mm: Option<f64>,
    /// Mean error of the ends of limbs that are not covered.
    pub seen_mm: Option<f64>,
    /// Mean error in frames in which no limb is covered.
    pub nothing_covered_mm: Option<f64>,
    /// Mean error of all limbs' ends, the trunk's too.
    pub all_mm: f64,
    /// Share of the lost ends whose limb was said to be unsure.
    pub lost_said: Option<f64>,
    /// Share of all parts and frames that were said to be unsure.
    pub unsure: f64,
    /// Frames that were reported lost.
    pub frames_lost: usize,
    /// Median time of a frame, milliseconds.
    pub frame_ms: f64,
    /// Frames.
    pub frames: usize,
}

/// Follows every movement at every rate in every way.
///
/// # Errors
/// Options that make no sense, or `cancel`.
pub fn run(
    options: &Options,
    cancel: &CancelToken,
    mut on_progress: impl FnMut(Progress),
) -> Result<Report, ExperimentError> {
    check(options)?;
    let model = Arc::new(builtin::full_body());
    // Frames that no rate sees are not drawn.
    let step = options.every.iter().copied().fold(0, greatest_common_divisor).max(1);
    let (mut done, mut cases) = (0, Vec::new());
    let total = options.movements.len() * (1 + options.every.len() * options.ways.len());
    for &movement in &options.movements {
        on_progress(Progress { done, total });
        let mut drawn = film(&model, movement, options, step, cancel)?;
        for frame in &mut drawn {
            frame.cameras.truncate(options.cameras);
            frame.cues.cameras.truncate(options.cameras);
        }
        done += 1;
        for &every in &options.every {
            let seen: Vec<&FilmedFrame> = drawn.iter().step_by(every / step).collect();
            for way in &options.ways {
                on_progress(Progress { done, total });
                done += 1;
                let rate = DRAWN_RATE / every as f64;
                let tally = follow(&model, &seen, rate, way, options.seed, cancel)?;
                cases.push(tally.case(movement, rate, way));
            }
        }
    }
    on_progress(Progress { done: total, total });
    Ok(Report { cases })
}

fn check(options: &Options) -> Result<(), ExperimentError> {
    let error = |option, value, expected| Err(ExperimentError::Option { option, value, expected });
    if !(options.seconds > 0.0 && options.seconds <= 600.0) {
        return error("seconds", options.seconds, "more than 0, at most 600");
    }
    if !(0.0..=0.5).contains(&options.too_wide) {
        return error("too_wide", options.too_wide, "a share from 0 to 0.5");
    }
    if !(0.0..=1.0).contains(&options.pattern) {
        return error("pattern", options.pattern, "a contrast from 0 to 1");
    }
    if !(1..=2).contains(&options.cameras) {
        return error("cameras", options.cameras as f64, "1 or 2");
    }
    match options.every.iter().find(|every| **every == 0) {
        Some(_) => error("every", 0.0, "1 or more"),
        None => Ok(()),
    }
}

fn greatest_common_divisor(a: usize, b: usize) -> usize {
    if b == 0 { a } else { greatest_common_divisor(b, a % b) }
}

/// Errors of one track.
#[derive(Debug, Default)]
struct Tally {
    covered: Vec<f64>,
    feet: Vec<f64>,
    seen: Vec<f64>,
    nothing_covered: Vec<f64>,
    all: Vec<f64>,
    lost: usize,
    lost_said: usize,
    parts: usize,
    unsure: usize,
    frames_lost: usize,
    ms: Vec<f64>,
}

impl Tally {
    fn add(&mut self, model: &Model, estimate: &FrameEstimate, truth: &Pose, covered: &[bool]) {
        let [found, truth] = [&estimate.pose, truth].map(|pose| Kinematics::new(model, pose));
        self.frames_lost += usize::from(estimate.is_lost());
        self.parts += estimate.holds.len();
        self.unsure += estimate.unsure_limbs().count();
        let counts = |name: &str| LIMBS.iter().any(|word| name.contains(word));
        let mut all = model.limbs().iter().zip(covered);
        let is_nothing_covered = !all.any(|(limb, covered)| *covered && counts(&limb.name));
        for (index, limb) in model.limbs().iter().enumerate() {
            let error = 1000.0 * found.ends()[index].distance(truth.ends()[index]);
            self.all.push(error);
            if limb.name.contains(FOOT) {
                self.feet.push(error);
            }
            if !counts(&limb.name) {
                continue;
            }
            if is_nothing_covered {
                self.nothing_covered.push(error);
            }
            if !covered[index] {
                self.seen.push(error);
                continue;
            }
            self.covered.push(error);
            if error > LOST_MM {
                self.lost += 1;
                let owner = model.rotation_owners()[limb.rotation];
                self.lost_said += usize::from(estimate.unsure_limbs().any(|unsure| unsure == owner));
            }
        }
    }

    fn case(&self, movement: Occlusion, rate: f64, way: &Way) -> Case {
        let mean = |errors: &[f64]| Statistics::of(errors).map(|all| all.mean);
        Case {
            movement,
            rate,
            way: way.name.clone(),
            covered_mm: mean(&self.covered),
            covered_p95_mm: Statistics::of(&self.covered).map(|all| all.p95),
            covered_lost: self.lost as f64 / self.covered.len().max(1) as f64,
            feet_mm: mean(&self.feet),
            seen_mm: mean(&self.seen),
            nothing_covered_mm: mean(&self.nothing_covered),
            all_mm: mean(&self.all).unwrap_or_default(),
            lost_said: (self.lost > 0).then(|| self.lost_said as f64 / self.lost as f64),
            unsure: self.unsure as f64 / self.parts.max(1) as f64,
            frames_lost: self.frames_lost,
            frame_ms: Statistics::of(&self.ms).map_or(0.0, |all| all.median),
            frames: self.ms.len(),
        }
    }
}

fn follow(
    model: &Arc<Model>,
    frames: &[&FilmedFrame],
    rate: f64,
    way: &Way,
    seed: u64,
    cancel: &CancelToken,
) -> Result<Tally, ExperimentError> {
    let mut tally = Tally::default();
    let Some(first) = frames.first() else { return Ok(tally) };
    let start = perturb(model, &first.truth, 5f64.to_radians(), 0.03, seed);
    let mut tracker = Tracker::new(Arc::clone(model), way.fit.clone(), start)?
        .with_motion(backlit_tracking::track::Motion::Velocity, rate)?
        .with_search(WhenToSearch::WhenPoor);
    if let Some(cues) = way.cues {
        tracker = tracker.with_cues(cues)?;
    }
    for (number, frame) in frames.iter().enumerate() {
        let view = |watched: &WatchedCamera| {
            let mask = Arc::clone(watched.mask.as_ref()?);
            Some(FitView { camera: Arc::clone(&watched.camera), evidence: Evidence::Mask(mask), weight: 1.0 })
        };
        let views = frame.cameras.iter().filter_map(view).collect();
        let began = Instant::now();
        let estimate = tracker.track_frame_with_cues(number, views, frame.cues.clone(), cancel)?;
        tally.ms.push(1e3 * began.elapsed().as_secs_f64());
        if cancel.is_cancelled() {
            return Err(ExperimentError::Cancelled);
        }
        tally.add(model, &estimate, &frame.truth, &covered_at_truth(model, frame)?);
    }
    Ok(tally)
}

/// Which limbs the silhouettes would not hold at the true pose.
fn covered_at_truth(model: &Arc<Model>, frame: &FilmedFrame) -> Result<Vec<bool>, ExperimentError> {
    let watch = CueWatch::new(Arc::clone(model), CueOptions::default(), RendererKind::Capsule)?;
    let coverage = watch.coverage(&Kinematics::new(model, &frame.truth), &frame.cameras);
    Ok((0..model.limbs().len()).map(|limb| coverage.is_covered(limb)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_that_make_no_sense_are_named() {
        let bad = [
            (Options { seconds: 0.0, ..Options::default() }, "seconds"),
            (Options { too_wide: 2.0, ..Options::default() }, "too_wide"),
            (Options { pattern: f64::NAN, ..Options::default() }, "pattern"),
            (Options { every: vec![0], ..Options::default() }, "every"),
            (Options { cameras: 3, ..Options::default() }, "cameras"),
        ];
        for (options, word) in bad {
            let error = run(&options, &CancelToken::new(), |_| {}).unwrap_err();
            assert!(error.to_string().contains(word), "{error}");
        }
    }
}
