//! Fits a body to the silhouettes of two cameras.
//!
//! `cargo run -p backlit-tracking --example fit_masks`
//!
//! The masks are drawn from a pose that the fit does not know, so that its answer can be compared with the truth.
//! With masks of your own there is only [`Mask::new`] or [`Mask::from_gray`] in place of `silhouette`.

use std::error::Error;
use std::sync::Arc;

use backlit_tracking::body::{Kinematics, Model, Parameters, Pose, builtin};
use backlit_tracking::camera::{Camera, CameraFromWorld, Distortion, Intrinsics};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{Evidence, Fit, FitOptions, FitView, Preset};
use backlit_tracking::render::{Ramp, RendererKind, predict};
use backlit_tracking::silhouette::{Label, Mask};
use glam::DVec3;

fn main() -> Result<(), Box<dyn Error>> {
    // The report's upper body. Its truth is a little bent; the fit starts some degrees off.
    let model = Arc::new(builtin::upper_body());
    let columns = Parameters::Tangent.columns(model.rotation_count());
    let bend: Vec<f64> = (0..columns).map(|column| 0.25 * (2.0 * column as f64).sin()).collect();
    let truth = Pose::rest(&model).retract(Parameters::Tangent, &bend);
    let off: Vec<f64> = (0..columns).map(|column| 0.12 * (column as f64).cos()).collect();
    let start = truth.retract(Parameters::Tangent, &off);

    let mut views = Vec::new();
    for (name, at) in [("front", DVec3::new(0.0, 0.0, 2.4)), ("side", DVec3::new(2.4, 0.0, 0.3))] {
        let camera_from_world = CameraFromWorld::looking_at(at, DVec3::new(0.0, 0.25, 0.0), DVec3::Y);
        let pinhole = Intrinsics { fx: 140.0, fy: 140.0, cx: 47.5, cy: 35.5 };
        let camera = Camera::new(name, [96, 72], pinhole, Distortion::None, camera_from_world)?;
        let mask = silhouette(&model, &truth, &camera)?;
        views.push(FitView {
            camera: Arc::new(camera),
            evidence: Evidence::Mask(Arc::new(mask)),
            weight: 1.0,
        });
    }
    let front = Arc::clone(&views[0].camera);
    let seen = silhouette(&model, &truth, &front)?;
    println!("Before: what the front camera sees (·), the model (o), both (#)");
    print_overlay(&seen, &silhouette(&model, &start, &front)?);

    // Robust: wide ramps first, then narrow ones; joint limits and priors keep what no camera sees.
    let mut fit = Fit::new(Arc::clone(&model), views, start.clone(), FitOptions::preset(Preset::Robust))?;
    let summary = fit.run(&CancelToken::new(), |_| {});
    for stage in summary.iterations.chunk_by(|a, b| a.stage == b.stage) {
        let rejected = stage.iter().filter(|iteration| !iteration.accepted).count();
        let (number, rms) = stage.last().map_or((0, 0.0), |last| (last.stage + 1, last.rms));
        let steps = stage.len();
        println!(
            "Stage {number}: {steps} steps, {rejected} taken back; {rms:.2} grey levels a pixel by its ramp"
        );
    }

    println!("After:");
    print_overlay(&seen, &silhouette(&model, &summary.pose, &front)?);
    println!("It ended because: {}.", summary.termination);
    let (before, after) = (farthest_mm(&model, &start, &truth), farthest_mm(&model, &summary.pose, &truth));
    println!("The joint that is farthest off: {before:.0} mm at the start, {after:.1} mm after the fit.");
    Ok(())
}

/// The mask that a camera would give of a pose.
fn silhouette(model: &Model, pose: &Pose, camera: &Camera) -> Result<Mask, Box<dyn Error>> {
    let drawn = predict(model, &Kinematics::new(model, pose), camera, RendererKind::Capsule, Ramp::Half);
    let label = |&level: &f32| if level < 127.5 { Label::Subject } else { Label::Background };
    Ok(Mask::new(drawn.width, drawn.height, drawn.lambda.iter().map(label).collect())?)
}

/// Two masks over each other; a character is as high as two pixels.
fn print_overlay(seen: &Mask, model: &Mask) {
    for y in (0..seen.height()).step_by(2) {
        let is_subject = |mask: &Mask, x| mask.get(x, y) == Some(Label::Subject);
        let line: String = (0..seen.width())
            .map(|x| match (is_subject(seen, x), is_subject(model, x)) {
                (true, true) => '#',
                (true, false) => '·',
                (false, true) => 'o',
                (false, false) => ' ',
            })
            .collect();
        println!("{}", line.trim_end());
    }
}

/// The largest distance between the joints of two poses, millimetres.
fn farthest_mm(model: &Model, pose: &Pose, truth: &Pose) -> f64 {
    let (found, truth) = (Kinematics::new(model, pose), Kinematics::new(model, truth));
    let distances = found.ends().iter().zip(truth.ends()).map(|(a, b)| a.distance(*b));
    1000.0 * distances.fold(0.0, f64::max)
}
