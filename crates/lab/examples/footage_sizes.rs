//! Sizes of the person of a take, by each way, and the take tracked with them:
//!
//! ```text
//! BACKLIT_DATA=… cargo run --release -p backlit-lab --example footage_sizes -- tests/takes/balancing
//! ```
//!
//! The take needs reference keypoints: the first frame's make the starts, and all of them judge the tracks.

use std::error::Error;
use std::sync::Arc;

use backlit_formats::{Footage, Take};
use backlit_tracking::body::{Model, builtin};
use backlit_tracking::body_fit::{Approach, BodyFitOptions, CLOTHED, approach, fit_body, frames, scale};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{FitOptions, Preset};
use backlit_tracking::metrics::{JointErrors, ReferenceJoints};
use backlit_tracking::residual::Proportions;
use backlit_tracking::search::start;
use backlit_tracking::track::{Motion, Tracker, WhenToSearch};

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("usage: footage_sizes TAKE")?;
    let footage = Footage::new(Take::open_with_model(path.as_ref(), builtin::full_body())?);
    let take = footage.take();
    let model = Arc::clone(take.model());
    report("full body, as it is", &footage, &model, None)?;
    let only = std::env::args().nth(2);
    for (name, surveyed, widening, keypoints, weight) in [
        ("generic prior, keypoints", false, 0.0, true, 1.0),
        ("surveyed prior, keypoints", true, 0.0, true, 1.0),
        ("surveyed prior and widening, keypoints", true, 0.02, true, 1.0),
        ("generic prior, silhouettes", false, 0.0, false, CLOTHED),
        ("surveyed prior, silhouettes", true, 0.0, false, CLOTHED),
        ("surveyed prior, silhouettes, weight 20", true, 0.0, false, 20.0),
        ("surveyed prior and widening, silhouettes", true, 0.02, false, CLOTHED),
        ("surveyed prior and widening, silhouettes, 5", true, 0.02, false, 5.0),
    ] {
        if only.as_ref().is_some_and(|only| !name.contains(only.as_str())) {
            continue;
        }
        let proportions = Proportions { surveyed, ..Proportions::default() };
        let options = BodyFitOptions { proportions, widening, ..BodyFitOptions::default() };
        let options = options.with_proportions(weight);
        let joints = |frame: usize| if keypoints { joints_of(take, frame) } else { ReferenceJoints::new() };
        let wanted = frames::spread(&(0..take.frame_count()).collect::<Vec<_>>(), 8);
        let known: Vec<ReferenceJoints> = wanted.iter().map(|&frame| joints(frame)).collect();
        let size = scale::from_joints(&model, &known);
        let scaled = model.scaled(size.unwrap_or(0.0).exp())?;
        let start = start::from_joints(&scaled, &joints_of(take, wanted[0])).ok_or("no keypoints")?;
        let plan = Approach { start, size, frames: wanted, step: 3 };
        let cameras: Vec<usize> = (0..take.rig().count()).collect();
        let cancel = CancelToken::new();
        let (size, frames) = approach(
            &model,
            &plan,
            &options,
            &cancel,
            |frame| -> Result<_, Box<dyn Error>> { Ok(footage.fit_views(&cameras, frame)?) },
            joints,
            |_, _| {},
        )?;
        let fit = fit_body(Arc::clone(&model), frames, Some(size), &options, &cancel, |_| {})?;
        println!(
            "{name}: size {:.3}, girth {:.3}, IoU of the fit {:.3}, {:?}",
            fit.size,
            fit.girth,
            fit.iou[1].unwrap_or(0.0),
            fit.widening
        );
        report(name, &footage, &Arc::new(fit.model.clone()), Some(&fit))?;
    }
    Ok(())
}

fn joints_of(take: &Take, frame: usize) -> ReferenceJoints {
    take.reference().map(|reference| reference.joints(frame)).unwrap_or_default()
}

fn report(
    name: &str,
    footage: &Footage,
    model: &Arc<Model>,
    fit: Option<&backlit_tracking::body_fit::BodyFit>,
) -> Result<(), Box<dyn Error>> {
    let take = footage.take();
    let cameras: Vec<usize> = (0..take.rig().count()).collect();
    let cancel = CancelToken::new();
    let start = start::from_joints(model, &joints_of(take, 0)).ok_or("no keypoints")?;
    let start = start::perturb(model, &start, 5f64.to_radians(), 0.03, 1);
    let narrow = fit.and_then(|fit| fit.widening).map_or(0.0, |widening| widening.believed_px());
    for by_px in if narrow == 0.0 { vec![0.0] } else { vec![0.0, narrow] } {
        let mut tracker = Tracker::new(Arc::clone(model), FitOptions::preset(Preset::Robust), start.clone())?
            .with_motion(Motion::Velocity, take.frame_rate())?
            .with_search(WhenToSearch::WhenPoor);
        let (mut errors, mut ious) = (JointErrors::default(), Vec::new());
        for frame in 0..take.frame_count() {
            let views = footage.fit_views(&cameras, frame)?;
            let views = views
                .iter()
                .map(|view| backlit_tracking::body_fit::widening::narrowed(view, by_px))
                .collect();
            let estimate = tracker.track_frame(frame, views, &cancel)?;
            errors.add(model, &estimate.pose, &joints_of(take, frame));
            ious.push(estimate.iou().unwrap_or(0.0));
        }
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
        let all = errors.overall().ok_or("no joints")?;
        let without = errors.overall_without_offsets().ok_or("no joints")?;
        println!(
            "  {name}, narrowed by {by_px:.2} px: mean {:.1} mm, median {:.1}, without offsets {:.1}, IoU {:.3}",
            all.mean,
            all.median,
            without.mean,
            mean(&ious)
        );
    }
    Ok(())
}
