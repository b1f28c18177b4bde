//! Which pixels of a reduced mask are subject: by how many millimetres joints are off for several rules, and by how much the
//! subject's area grows. `cargo run -p backlit-lab --example reduced_masks`

use std::error::Error;
use std::sync::Arc;

use backlit_lab::synthetic::{capsules, motion, people::PEOPLE, studio};
use backlit_tracking::body::{Kinematics, Model, Pose, builtin};
use backlit_tracking::camera::Camera;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{Evidence, FitOptions, FitView, Preset};
use backlit_tracking::search::start::perturb;
use backlit_tracking::silhouette::{Label, Mask};
use backlit_tracking::track::Tracker;

const MOMENTS: [usize; 4] = [0, 13, 27, 41];

/// What a block with this share of subject pixels is, at a place of the reduced mask.
type Rule = fn(f64, usize) -> Label;

fn is_subject(is: bool) -> Label {
    if is { Label::Subject } else { Label::Background }
}

const RULES: [(&str, Rule); 6] =
    [
        ("half and more", |share, _| is_subject(share >= 0.5)),
        ("more than half", |share, _| is_subject(share > 0.5)),
        ("half: every other", |share, at| {
            is_subject(if share == 0.5 { at.is_multiple_of(2) } else { share > 0.5 })
        }),
        ("half: unknown", |share, _| if share == 0.5 { Label::Unknown } else { is_subject(share > 0.5) }),
        ("a quarter to three: unknown", |share, _| {
            if (0.25..=0.75).contains(&share) { Label::Unknown } else { is_subject(share > 0.5) }
        }),
        ("all mixed: unknown", |share, _| {
            if share > 0.0 && share < 1.0 { Label::Unknown } else { is_subject(share > 0.5) }
        }),
    ];

/// A mask with squares of `by`² pixels decided by a rule.
fn reduced(mask: &Mask, by: usize, rule: Rule) -> Option<Mask> {
    let (width, height) = (mask.width() / by, mask.height() / by);
    let label = |index: usize| {
        let (x, y) = (index % width, index / width);
        let inside =
            (0..by * by).filter(|k| mask.get(x * by + k % by, y * by + k / by) == Some(Label::Subject));
        rule(inside.count() as f64 / (by * by) as f64, x + y)
    };
    Mask::new(width, height, (0..width * height).map(label).collect()).ok()
}

fn off_mm(model: &Model, found: &Pose, truth: &Pose) -> f64 {
    let [found, truth] = [found, truth].map(|pose| Kinematics::new(model, pose));
    let off = found.ends().iter().zip(truth.ends()).map(|(a, b)| a.distance(*b));
    1e3 * off.sum::<f64>() / truth.ends().len() as f64
}

fn main() -> Result<(), Box<dyn Error>> {
    println!("{:<28} {:>3} {:>10} {:>10}", "rule", "by", "mm", "area %");
    for by in [2_usize, 3, 4] {
        for (name, rule) in RULES {
            let (mut off, mut count, mut small_area, mut full_area) = (0.0, 0.0, 0.0, 0.0);
            for person in &PEOPLE {
                let body = Arc::new(person.of(&builtin::full_body())?);
                for frame in MOMENTS {
                    let truth = motion::pose(&body, frame as f64);
                    let mut views = Vec::new();
                    for camera in studio::cameras().cameras() {
                        let side = |side: u64| side * by as u64;
                        let full: Camera = camera.without_distortion().resized(side(96), side(128))?;
                        let exact = capsules::hard_mask(&body, &truth, &full)?;
                        let mask = reduced(&exact, by, rule).ok_or("a mask without pixels")?;
                        full_area += exact.count(Label::Subject) as f64;
                        small_area += (mask.count(Label::Subject) * by * by) as f64;
                        let camera = Arc::new(full.reduced(by as u32)?);
                        views.push(FitView { camera, evidence: Evidence::Mask(Arc::new(mask)), weight: 1.0 });
                    }
                    let start = perturb(&body, &truth, 0.1, 0.02, frame as u64);
                    let options = FitOptions::preset(Preset::Robust);
                    let mut tracker = Tracker::new(Arc::clone(&body), options, start)?;
                    let found = tracker.track_frame(frame, views, &CancelToken::new())?;
                    off += off_mm(&body, &found.pose, &truth);
                    count += 1.0;
                }
            }
            println!(
                "{name:<28} {by:>3} {:>10.2} {:>+10.2}",
                off / count,
                100.0 * (small_area / full_area - 1.0)
            );
        }
    }
    Ok(())
}
