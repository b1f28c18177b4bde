//! Follows a swinging arm through a dozen frames: `cargo run -p backlit-tracking --example track`.

use std::sync::Arc;

use backlit_tracking::geometry::rotation::exp;
use backlit_tracking::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let model = Arc::new(builtin::upper_body());
    let limb = model.limb_index("right upper arm").ok_or("the body has no right upper arm")?;
    let truth = |frame: usize| {
        let mut pose = Pose::rest(&model);
        pose.rotations[model.limbs()[limb].rotation] = exp(DVec3::Z * (-0.08 * frame as f64));
        pose
    };
    let mut cameras = Vec::new();
    for (name, from) in [("front", DVec3::new(0.0, 0.0, 3.2)), ("right", DVec3::new(3.2, 0.0, 0.0))] {
        let place = CameraFromWorld::looking_at(from, DVec3::new(0.0, 0.25, 0.0), DVec3::Y);
        let pinhole = Intrinsics { fx: 260.0, fy: 260.0, cx: 95.5, cy: 71.5 };
        cameras.push(Arc::new(Camera::new(name, [192, 144], pinhole, Distortion::None, place)?));
    }
    let mut tracker = Tracker::new(Arc::clone(&model), FitOptions::preset(Preset::Robust), truth(0))?;
    for frame in 0..12 {
        // Silhouettes of a known pose stand for segmented footage.
        let joints = Kinematics::new(&model, &truth(frame));
        let mut views = Vec::new();
        for camera in &cameras {
            let drawn = predict(&model, &joints, camera, RendererKind::Capsule, Ramp::Half);
            views.push(FitView::of_mask(Arc::clone(camera), drawn.to_mask()?));
        }
        let estimate = tracker.track_frame(frame, views, &CancelToken::new())?;
        let off_mm = mean_joint_error_mm(&model, &estimate.pose, &truth(frame));
        println!("frame {frame:2}: overlap {:?}, joints {off_mm:.1} mm off", estimate.iou());
    }
    Ok(())
}
