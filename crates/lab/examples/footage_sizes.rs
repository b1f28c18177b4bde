//! Sizes of the person of a take, as they were found before real people's girths were known and as they are now, and the
//! take tracked with them:
//!
//! ```text
//! BACKLIT_DATA=… cargo run --release -p backlit-lab --example footage_sizes -- tests/takes/balancing
//! ```
//!
//! The take needs reference keypoints: they make the starts, and all of them judge the tracks. The same as `backlit fit-body`
//! and then `backlit track --start reference --start-noise 5deg,3cm --seed 1`, sized on all frames, or on the first half
//! while the second is tracked.

use std::error::Error;
use std::ops::Range;
use std::sync::Arc;

use backlit_formats::{Footage, Take};
use backlit_tracking::body::{Model, builtin};
use backlit_tracking::body_fit::{
    Approach, BodyFit, BodyFitOptions, CLOTHED, WELL_SEEN, approach, fit_body, frames, scale,
};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{FitOptions, Preset};
use backlit_tracking::metrics::{JointErrors, ReferenceJoints};
use backlit_tracking::residual::Proportions;
use backlit_tracking::search::start;
use backlit_tracking::track::{Motion, Tracker, WhenToSearch};

/// Frames that sizes are fitted to.
const FITTED: usize = 8;
/// On the way to them every so many frames are tracked.
const STEP: usize = 3;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("usage: footage_sizes TAKE")?;
    let footage = Footage::new(Take::open_with_model(path.as_ref(), builtin::full_body())?);
    let count = footage.take().frame_count();
    let by_hand = Take::open(path.as_ref())?;
    println!(
        "| body | joint error, mm: mean | median | without offsets | IoU | second half only: mean | IoU |"
    );
    for (name, body) in [("full body, as it is", footage.take().model()), ("set by hand", by_hand.model())] {
        let [all, half] = [0..count, count / 2..count].map(|part| track(&footage, body, part));
        println!("| {name} | {} | {} |", all?.text(), half?.short());
    }
    for (name, is_new, keypoints, weight) in [
        ("with keypoints, before", false, true, 1.0),
        ("with keypoints, now", true, true, WELL_SEEN),
        ("silhouettes alone, before", false, false, 20.0),
        ("silhouettes alone, now", true, false, CLOTHED),
    ] {
        let proportions = Proportions { surveyed: is_new, ..Proportions::default() };
        let widening = if is_new { BodyFitOptions::default().widening } else { 0.0 };
        let options = BodyFitOptions { proportions, widening, ..BodyFitOptions::default() };
        let options = options.with_proportions(weight);
        let whole = sizes(&footage, keypoints, 0..count, &options)?;
        let first = sizes(&footage, keypoints, 0..count / 2, &options)?;
        let all = track(&footage, &Arc::new(whole.model), 0..count)?;
        let half = track(&footage, &Arc::new(first.model), count / 2..count)?;
        println!("| {name} | {} | {} |", all.text(), half.short());
        eprintln!("  size {:.3}, girth {:.3}, {:?}", whole.size, whole.girth, whole.widening);
    }
    Ok(())
}

fn joints_of(take: &Take, frame: usize) -> ReferenceJoints {
    take.reference().map(|reference| reference.joints(frame)).unwrap_or_default()
}

fn sizes(
    footage: &Footage,
    keypoints: bool,
    part: Range<usize>,
    options: &BodyFitOptions,
) -> Result<BodyFit, Box<dyn Error>> {
    let (take, cancel) = (footage.take(), CancelToken::new());
    let model = Arc::clone(take.model());
    let joints = |frame: usize| if keypoints { joints_of(take, frame) } else { ReferenceJoints::new() };
    let wanted = frames::spread(&part.collect::<Vec<_>>(), FITTED);
    let known: Vec<ReferenceJoints> = wanted.iter().map(|&frame| joints(frame)).collect();
    let size = scale::from_joints(&model, &known);
    let scaled = model.scaled(size.unwrap_or(0.0).exp())?;
    let start = start::from_joints(&scaled, &joints_of(take, wanted[0])).ok_or("no keypoints")?;
    let plan = Approach { start, size, frames: wanted, step: STEP };
    let cameras: Vec<usize> = (0..take.rig().count()).collect();
    let views = |frame| -> Result<_, Box<dyn Error>> { Ok(footage.fit_views(&cameras, frame)?) };
    let (size, frames) = approach(&model, &plan, options, &cancel, views, joints, |_, _| {})?;
    Ok(fit_body(model, frames, Some(size), options, &cancel, |_| {})?)
}

/// How far a track is from the keypoints, millimetres, and how well it overlaps.
struct Errors {
    mean_mm: f64,
    median_mm: f64,
    without_offsets_mm: f64,
    iou: f64,
}

impl Errors {
    fn text(&self) -> String {
        let Self { mean_mm, median_mm, without_offsets_mm, iou } = self;
        format!("{mean_mm:.1} | {median_mm:.1} | {without_offsets_mm:.1} | {iou:.3}")
    }

    fn short(&self) -> String {
        format!("{:.1} | {:.3}", self.mean_mm, self.iou)
    }
}

fn track(footage: &Footage, model: &Arc<Model>, part: Range<usize>) -> Result<Errors, Box<dyn Error>> {
    let (take, cancel) = (footage.take(), CancelToken::new());
    let cameras: Vec<usize> = (0..take.rig().count()).collect();
    let start = start::from_joints(model, &joints_of(take, part.start)).ok_or("no keypoints")?;
    let start = start::perturb(model, &start, 5f64.to_radians(), 0.03, 1);
    let mut tracker = Tracker::new(Arc::clone(model), FitOptions::preset(Preset::Robust), start)?
        .with_motion(Motion::of_preset(Some(Preset::Robust)), take.frame_rate())?
        .with_search(WhenToSearch::WhenPoor);
    let (mut errors, mut iou) = (JointErrors::default(), 0.0);
    for frame in part.clone() {
        let estimate = tracker.track_frame(frame, footage.fit_views(&cameras, frame)?, &cancel)?;
        errors.add(model, &estimate.pose, &joints_of(take, frame));
        iou += estimate.iou().unwrap_or(0.0) / part.len() as f64;
    }
    let (all, without) = errors.overall().zip(errors.overall_without_offsets()).ok_or("no keypoints")?;
    Ok(Errors { mean_mm: all.mean, median_mm: all.median, without_offsets_mm: without.mean, iou })
}
