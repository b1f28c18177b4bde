//! A take tracked as capsules and as spheres: joint error, overlap and time a frame.
//!
//! ```text
//! BACKLIT_DATA=… cargo run --release -p backlit-lab --example spheres -- tests/takes/balancing every=3
//! ```
//!
//! The body is fitted with keypoints as `backlit fit-body` does; the take is tracked with it from the keypoints' start, moved by 5°
//! and 3 cm; from every so many of the tracked frames spheres are made, and the take is tracked again with them. Then the same with
//! spheres of frames of the first half alone, tracked in the second. Further words: `levels=2`, `rounds=3`, `share=0.75`, `body=FILE`
//! writes the spheres.

use std::error::Error;
use std::ops::Range;
use std::sync::Arc;
use std::time::Instant;

use backlit_formats::{Footage, Take, model_file};
use backlit_tracking::body::{Model, Pose, builtin};
use backlit_tracking::body_fit::{Approach, BodyFitOptions, approach, fit_body, frames, scale};
use backlit_tracking::body_spheres::{PosedViews, SphereBodyOptions, sphere_body};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{FitOptions, Preset};
use backlit_tracking::metrics::{JointErrors, ReferenceJoints};
use backlit_tracking::render::RendererKind;
use backlit_tracking::search::start;
use backlit_tracking::track::{Motion, Tracker, WhenToSearch};

/// Frames that sizes are fitted to, and every so many that are tracked on the way.
const FITTED: usize = 8;
const STEP: usize = 3;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("usage: spheres TAKE [spheres=N] [every=N] …")?;
    let word = |name: &str| {
        std::env::args().find_map(|word| Some(word.strip_prefix(name)?.strip_prefix('=')?.to_owned()))
    };
    let number = |name: &str, usual: f64| word(name).map_or(Ok(usual), |word| word.parse::<f64>());
    let usual = SphereBodyOptions::default();
    let options = SphereBodyOptions {
        spheres: number("spheres", usual.spheres as f64)? as usize,
        levels: number("levels", usual.levels as f64)? as usize,
        rounds: number("rounds", usual.rounds as f64)? as usize,
        steps: number("steps", usual.steps as f64)? as usize,
        share: number("share", usual.share)?,
        centre_deviation: number("centre", usual.centre_deviation)?,
        radius_deviation: number("radius", usual.radius_deviation)?,
        ..usual
    };
    let every = number("every", 4.0)? as usize;
    let footage = Footage::new(Take::open_with_model(path.as_ref(), builtin::full_body())?);
    let count = footage.take().frame_count();
    let model = Arc::new(fitted(&footage, 0..count)?);
    println!(
        "| body | spheres | joint error, mm: mean | median | without offsets | IoU | ms a frame, median |"
    );
    println!("|---|---|---|---|---|---|---|");
    let capsules = track(&footage, &model, RendererKind::Capsule, 0..count)?;
    capsules.print("capsules", "");
    track(&footage, &model, RendererKind::SphereTree { spheres: None }, 0..count)?.print("equal spheres", "");
    for (name, built, tracked) in [
        ("spheres of all frames", 0..count, 0..count),
        ("spheres of the first half, in the second", 0..count / 2, count / 2..count),
    ] {
        let chosen: Vec<usize> = built.step_by(every).collect();
        let posed = posed(&footage, &chosen, &capsules.poses)?;
        let began = Instant::now();
        let fit = FitOptions::preset(Preset::Robust);
        let body = sphere_body(&model, posed, &options, &fit, &CancelToken::new(), |_| {})?;
        eprintln!("  {:.1} s, IoU {:?}, rms {:?}", began.elapsed().as_secs_f64(), body.iou, body.rms);
        let counts = format!("{:?}", body.spheres);
        if let Some(file) = word("body") {
            model_file::write(file.as_ref(), &body.model)?;
        }
        let spheres = RendererKind::SphereTree { spheres: None };
        if tracked.start > 0 {
            track(&footage, &model, RendererKind::Capsule, tracked.clone())?
                .print("capsules, second half", "");
        }
        track(&footage, &Arc::new(body.model), spheres, tracked)?.print(name, &counts);
    }
    Ok(())
}

fn joints_of(take: &Take, frame: usize) -> ReferenceJoints {
    take.reference().map(|reference| reference.joints(frame)).unwrap_or_default()
}

fn cameras(footage: &Footage) -> Vec<usize> {
    (0..footage.take().rig().count()).collect()
}

fn posed(footage: &Footage, chosen: &[usize], poses: &[Pose]) -> Result<Vec<PosedViews>, Box<dyn Error>> {
    let cameras = cameras(footage);
    let posed = chosen.iter().map(|&frame| {
        let views = footage.fit_views(&cameras, frame)?;
        Ok(PosedViews { frame, views, pose: poses[frame].clone() })
    });
    posed.collect()
}

fn fitted(footage: &Footage, part: Range<usize>) -> Result<Model, Box<dyn Error>> {
    let (take, cancel) = (footage.take(), CancelToken::new());
    let model = Arc::clone(take.model());
    let options = BodyFitOptions::for_people(&model, true);
    let wanted = frames::spread(&part.collect::<Vec<_>>(), FITTED);
    let known: Vec<ReferenceJoints> = wanted.iter().map(|&frame| joints_of(take, frame)).collect();
    let size = scale::from_joints(&model, &known);
    let scaled = model.scaled(size.unwrap_or(0.0).exp())?;
    let start = start::from_joints(&scaled, &joints_of(take, wanted[0])).ok_or("no keypoints")?;
    let plan = Approach { start, size, frames: wanted, step: STEP };
    let cameras = cameras(footage);
    let views = |frame| -> Result<_, Box<dyn Error>> { Ok(footage.fit_views(&cameras, frame)?) };
    let joints = |frame| joints_of(take, frame);
    let (size, frames) = approach(&model, &plan, &options, &cancel, views, joints, |_, _| {})?;
    Ok(fit_body(model, frames, Some(size), &options, &cancel, |_| {})?.model)
}

/// A track, how far it is from the keypoints, how well it overlaps and how long it takes.
struct Tracked {
    poses: Vec<Pose>,
    errors: [f64; 3],
    iou: f64,
    ms: f64,
}

impl Tracked {
    fn print(&self, name: &str, counts: &str) {
        let [mean, median, without] = self.errors;
        println!(
            "| {name} | {counts} | {mean:.1} | {median:.1} | {without:.1} | {:.3} | {:.2} |",
            self.iou, self.ms
        );
    }
}

fn track(
    footage: &Footage,
    model: &Arc<Model>,
    renderer: RendererKind,
    part: Range<usize>,
) -> Result<Tracked, Box<dyn Error>> {
    let (take, cancel) = (footage.take(), CancelToken::new());
    let cameras = cameras(footage);
    let start = start::from_joints(model, &joints_of(take, part.start)).ok_or("no keypoints")?;
    let start = start::perturb(model, &start, 5f64.to_radians(), 0.03, 1);
    let options = FitOptions { renderer, ..FitOptions::preset(Preset::Robust) };
    let mut tracker = Tracker::new(Arc::clone(model), options, start)?
        .with_motion(Motion::of_preset(Some(Preset::Robust)), take.frame_rate())?
        .with_search(WhenToSearch::WhenPoor);
    let (mut errors, mut iou) = (JointErrors::default(), 0.0);
    let (mut poses, mut times) = (Vec::new(), Vec::new());
    for frame in part.clone() {
        let views = footage.fit_views(&cameras, frame)?;
        let began = Instant::now();
        let estimate = tracker.track_frame(frame, views, &cancel)?;
        times.push(1000.0 * began.elapsed().as_secs_f64());
        errors.add(model, &estimate.pose, &joints_of(take, frame));
        iou += estimate.iou().unwrap_or(0.0) / part.len() as f64;
        poses.push(estimate.pose);
    }
    times.sort_by(f64::total_cmp);
    let (all, without) = errors.overall().zip(errors.overall_without_offsets()).ok_or("no keypoints")?;
    Ok(Tracked { poses, errors: [all.mean, all.median, without.mean], iou, ms: times[times.len() / 2] })
}
