//! A take with reference keypoints tracked with and without a prior learnt from motion, by sets of its cameras and rates:
//!
//! ```text
//! BACKLIT_DATA=… cargo run --release -p backlit-lab --example prior_footage -- tests/takes/balancing PRIOR [WEIGHTS …]
//! ```
//!
//! PRIOR is a file of `backlit prior`; WEIGHTS are POSE,STEP,APART, those of poses, steps and of limbs inside one another. The
//! average body starts 5° and 3 cm off the keypoints.

use std::error::Error;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use backlit_formats::{Footage, Take, prior_file};
use backlit_tracking::body::builtin;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{FitOptions, FitView};
use backlit_tracking::metrics::{JointErrors, ReferenceJoints};
use backlit_tracking::residual::learnt_prior::LearntPrior;
use backlit_tracking::search::start;
use backlit_tracking::statistics::Statistics;
use backlit_tracking::track::{Motion, Tracker, WhenToSearch};

/// Indices of the cameras that see it, and every how manieth frame they do.
const CASES: [(&[usize], usize); 6] =
    [(&[0, 1, 2, 3], 1), (&[0, 1, 2, 3], 6), (&[0, 1], 1), (&[1, 2], 1), (&[0], 1), (&[1], 1)];

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let usage = "usage: prior_footage TAKE PRIOR [POSE,STEP,APART …]";
    let (take, file) = (arguments.next().ok_or(usage)?, arguments.next().ok_or(usage)?);
    let footage = Footage::new(Take::open_with_model(take.as_ref(), builtin::full_body())?);
    let learnt = LearntPrior::new(Arc::new(prior_file::read(Path::new(&file))?));
    let usual = FitOptions { prior: Some(learnt.clone()), ..FitOptions::default() };
    let mut ways = vec![("silhouettes alone".to_owned(), FitOptions::default())];
    for words in arguments {
        let numbers = words.split(',').map(str::parse::<f64>).collect::<Result<Vec<_>, _>>()?;
        let [pose_weight, step_weight, apart] = numbers[..] else { return Err(usage.into()) };
        let prior = LearntPrior { pose_weight, step_weight, ..learnt.clone() };
        let prior = (pose_weight + step_weight > 0.0).then_some(prior);
        ways.push((words, FitOptions { prior, interpenetration_weight: apart, ..FitOptions::default() }));
    }
    if ways.len() == 1 {
        ways.push(("prior".to_owned(), usual));
    }
    let frames = footage.take().frame_count();
    let all: Vec<usize> = (0..footage.take().rig().count()).collect();
    let views: Result<Vec<Vec<FitView>>, _> =
        (0..frames).map(|frame| footage.fit_views(&all, frame)).collect();
    let views = views?;
    println!("| cameras | every | way | mean, mm | median | without offsets | IoU | ms |");
    println!("|---|---|---|---|---|---|---|---|");
    for (cameras, every) in CASES {
        for (name, fit) in &ways {
            let found = track(&footage, &views, cameras, every, fit)?;
            println!("| {cameras:?} | {every} | {name} | {found} |");
        }
    }
    Ok(())
}

fn track(
    footage: &Footage,
    views: &[Vec<FitView>],
    cameras: &[usize],
    every: usize,
    fit: &FitOptions,
) -> Result<String, Box<dyn Error>> {
    let (take, model) = (footage.take(), footage.take().model());
    let joints =
        |frame| take.reference().map_or_else(ReferenceJoints::new, |reference| reference.joints(frame));
    let start = start::from_joints(model, &joints(0)).ok_or("no keypoints")?;
    let start = start::perturb(model, &start, 5f64.to_radians(), 0.03, 1);
    let mut tracker = Tracker::new(Arc::clone(model), fit.clone(), start)?
        .with_motion(Motion::Velocity, take.frame_rate())?
        .with_search(WhenToSearch::WhenPoor);
    let (mut errors, mut overlaps, mut ms) = (JointErrors::default(), Vec::new(), Vec::new());
    for frame in (0..views.len()).step_by(every) {
        let seen = cameras.iter().map(|&camera| views[frame][camera].clone()).collect();
        let began = Instant::now();
        let estimate = tracker.track_frame(frame, seen, &CancelToken::new())?;
        ms.push(1e3 * began.elapsed().as_secs_f64());
        errors.add(model, &estimate.pose, &joints(frame));
        overlaps.extend(estimate.iou());
    }
    let (all, without) = errors.overall().zip(errors.overall_without_offsets()).ok_or("no keypoints")?;
    let iou = overlaps.iter().sum::<f64>() / overlaps.len().max(1) as f64;
    let ms = Statistics::of(&ms).map_or(0.0, |all| all.median);
    Ok(format!("{:.0} | {:.0} | {:.0} | {iou:.3} | {ms:.2}", all.mean, all.median, without.mean))
}
