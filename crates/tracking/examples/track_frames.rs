//! Follows a body through a short sequence of silhouettes.
//!
//! `cargo run -p backlit-tracking --example track_frames`
//!
//! An arm swings in front of two cameras. The tracker is told where the body is in the first frame; each later frame
//! starts from the one before it.

use std::error::Error;
use std::sync::Arc;

use backlit_tracking::body::{Kinematics, Model, Pose, builtin};
use backlit_tracking::camera::{Camera, CameraFromWorld, Distortion, Intrinsics};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{Evidence, FitOptions, FitView, Preset};
use backlit_tracking::geometry::rotation::exp;
use backlit_tracking::render::{Ramp, RendererKind, predict};
use backlit_tracking::silhouette::{Label, Mask};
use backlit_tracking::track::{Track, Tracker};
use glam::DVec3;

const FRAMES: usize = 12;

fn main() -> Result<(), Box<dyn Error>> {
    let model = Arc::new(builtin::upper_body());
    let arm = model.limb_index("right upper arm").ok_or("the body has no right upper arm")?;
    // One quaternion a rotation; several limbs may share one.
    let arm = model.limbs()[arm].rotation;
    let truth = |frame: usize| {
        let mut pose = Pose::rest(&model);
        pose.root.x += 0.01 * frame as f64;
        pose.rotations[arm] = exp(DVec3::Z * (-0.08 * frame as f64)) * pose.rotations[arm];
        pose
    };
    let mut cameras = Vec::new();
    for (name, at) in [("front", DVec3::new(0.0, 0.0, 3.2)), ("right", DVec3::new(3.2, 0.0, 0.0))] {
        let camera_from_world = CameraFromWorld::looking_at(at, DVec3::new(0.0, 0.25, 0.0), DVec3::Y);
        let pinhole = Intrinsics { fx: 260.0, fy: 260.0, cx: 95.5, cy: 71.5 };
        cameras.push(Arc::new(Camera::new(name, [192, 144], pinhole, Distortion::None, camera_from_world)?));
    }

    let mut tracker = Tracker::new(Arc::clone(&model), FitOptions::preset(Preset::Robust), truth(0))?;
    let mut track = Track::default();
    println!("frame  iterations  rms    overlap  farthest joint");
    for frame in 0..FRAMES {
        let mut views = Vec::new();
        for camera in &cameras {
            let mask = Arc::new(silhouette(&model, &truth(frame), camera)?);
            views.push(FitView { camera: Arc::clone(camera), evidence: Evidence::Mask(mask), weight: 1.0 });
        }
        let estimate = tracker.track_frame(frame, views, &CancelToken::new())?;
        println!(
            "{frame:5}  {:10}  {:5.2}  {:6.1}%  {:8.1} mm{}",
            estimate.iterations,
            estimate.rms.unwrap_or_default(),
            100.0 * estimate.iou().unwrap_or_default(),
            farthest_mm(&model, &estimate.pose, &truth(frame)),
            if estimate.is_lost() { ", lost" } else { "" }
        );
        track.frames.insert(frame, estimate);
    }

    // A track is its estimates by frame: any path can be read out of it.
    let wrist = model.limb_index("right forearm").ok_or("the body has no right forearm")?;
    println!("\nThe right wrist's path, metres:");
    for (frame, estimate) in &track.frames {
        let at = Kinematics::new(&model, &estimate.pose).ends()[wrist];
        println!("{frame:5}  {:6.3} {:6.3} {:6.3}", at.x, at.y, at.z);
    }
    Ok(())
}

/// The mask that a camera would give of a pose.
fn silhouette(model: &Model, pose: &Pose, camera: &Camera) -> Result<Mask, Box<dyn Error>> {
    let drawn = predict(model, &Kinematics::new(model, pose), camera, RendererKind::Capsule, Ramp::Half);
    let label = |&level: &f32| if level < 127.5 { Label::Subject } else { Label::Background };
    Ok(Mask::new(drawn.width, drawn.height, drawn.lambda.iter().map(label).collect())?)
}

/// The largest distance between the joints of two poses, millimetres.
fn farthest_mm(model: &Model, pose: &Pose, truth: &Pose) -> f64 {
    let (found, truth) = (Kinematics::new(model, pose), Kinematics::new(model, truth));
    let distances = found.ends().iter().zip(truth.ends()).map(|(a, b)| a.distance(*b));
    1000.0 * distances.fold(0.0, f64::max)
}
