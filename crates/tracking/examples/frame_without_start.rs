//! One frame from PNG masks, without a start: `cargo run -p backlit-tracking --example frame_without_start [FOLDER]`.
//!
//! FOLDER has front.png, right.png, back.png and left.png, white where the subject is; without one they are drawn first.

use std::path::PathBuf;
use std::sync::Arc;

use backlit_tracking::glam::DQuat;
use backlit_tracking::image;
use backlit_tracking::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let model = Arc::new(builtin::full_body());
    let given = std::env::args().nth(1).map(PathBuf::from);
    let mut views = Vec::new();
    for (index, name) in ["front", "right", "back", "left"].into_iter().enumerate() {
        let from = DQuat::from_rotation_z(1.57 * index as f64) * DVec3::new(0.0, 3.6, 1.2);
        let place = CameraFromWorld::looking_at(from, DVec3::Z * 0.9, DVec3::Z);
        let pinhole = Intrinsics { fx: 220.0, fy: 220.0, cx: 79.5, cy: 79.5 };
        let camera = Camera::new(name, [160, 160], pinhole, Distortion::None, place)?;
        let path = given.clone().unwrap_or_else(std::env::temp_dir).join(name).with_extension("png");
        if given.is_none() {
            let pose = Pose { root: DVec3::Z * 0.95, ..Pose::rest(&model) };
            let joints = Kinematics::new(&model, &pose);
            let drawn = predict(&model, &joints, &camera, RendererKind::Capsule, Ramp::Half);
            drawn.to_mask()?.to_gray().save(&path)?;
        }
        views.push(FitView::of_mask(camera, Mask::from_gray(&image::open(&path)?.to_luma8())?));
    }
    let found = without_start(&model, &views, &WithoutStartOptions::default(), &CancelToken::new())?;
    for (limb, end) in model.limbs().iter().zip(Kinematics::new(&model, found.pose()).ends()) {
        println!("{:<20} ends at {end:.2}", limb.name);
    }
    Ok(())
}
