//! A body from the text of a model file, cameras from the numbers of a calibration.
//!
//! `cargo run -p backlit-tracking --example own_cameras_and_body`
//!
//! Both are checked once, when they are made; what is wrong is said by its field's name.

use std::error::Error;

use backlit_tracking::body::{Kinematics, Model, ModelSpec, Pose};
use backlit_tracking::camera::{Camera, CameraFromWorld, Distortion, Intrinsics, Rectification};
use backlit_tracking::geometry::rotation::exp;
use backlit_tracking::render::{Ramp, RendererKind, predict};
use glam::{DMat3, DVec3};

/// Metres. A limb grows from its parent's end, in its own rest direction; one without a parent grows from the root.
const BODY: &str = r#"
format = "backlit-body 1"
name = "desk lamp"

[[limb]]
name = "lower arm"
direction = [0.3, 0.0, 1.0]
length = 0.4
radius = 0.03

[[limb]]
name = "upper arm"
parent = "lower arm"
direction = [-0.5, 0.0, 1.0]
length = 0.35
radius = 0.03

# Turns with the upper arm: no rotation of its own.
[[limb]]
name = "shade"
parent = "upper arm"
rigid_with = "upper arm"
direction = [-1.0, 0.0, -0.4]
length = 0.12
radius = 0.08
"#;

fn main() -> Result<(), Box<dyn Error>> {
    let model = Model::new(&toml::from_str::<ModelSpec>(BODY)?)?;
    println!("{}: {} limbs, {} rotations", model.name(), model.limbs().len(), model.rotation_count());

    // A pose is the root's place and a quaternion a rotation, here with the upper arm bent by 30°.
    let mut pose = Pose::rest(&model);
    let upper_arm = model.limb_index("upper arm").ok_or("the body has no upper arm")?;
    let bend = exp(DVec3::Y * 30_f64.to_radians());
    pose.rotations[model.limbs()[upper_arm].rotation] = bend;
    let kinematics = Kinematics::new(&model, &pose);

    // OpenCV's conventions: x right, y down, z forward; x_camera = rotation · x_world + translation. The rows of the
    // rotation are the camera's axes in the world: this camera looks along +y, its own y points down in the world.
    let rotation = DMat3::from_cols(DVec3::X, -DVec3::Z, DVec3::Y).transpose();
    let camera_from_world = CameraFromWorld { rotation, translation: rotation * -DVec3::new(0.1, -1.6, 0.4) };
    let pinhole = Intrinsics { fx: 95.0, fy: 95.0, cx: 39.5, cy: 29.5 };
    let lens = Distortion::OpenCv { k1: -0.12, k2: 0.01, p1: 0.0, p2: 0.0, k3: 0.0 };
    let camera = Camera::new("from the front", [80, 60], pinhole, lens, camera_from_world)?;
    println!("\"{}\" stands at {:.2}", camera.name(), camera.centre());
    for (limb, end) in model.limbs().iter().zip(kinematics.ends()) {
        match camera.project(*end) {
            Some(pixel) => println!("  the end of the {} is at pixel {pixel:.1}", limb.name),
            None => println!("  the end of the {} is behind it", limb.name),
        }
    }

    // Fits work on pictures without the lens: rectify a picture once, then use the ideal camera.
    let rectification = Rectification::new(&camera);
    println!("{} pixels of the ideal picture have no data", rectification.unseen().len());
    let ideal = camera.without_distortion();
    let drawn = predict(&model, &kinematics, &ideal, RendererKind::Capsule, Ramp::Half);
    for row in drawn.lambda.chunks(drawn.width).step_by(2) {
        let line: String = row.iter().map(|level| if *level < 127.5 { '#' } else { ' ' }).collect();
        println!("{}", line.trim_end());
    }

    // What is wrong is said by its name.
    let orphan = BODY.replace("parent = \"lower arm\"", "parent = \"lowest arm\"");
    if let Err(problem) = Model::new(&toml::from_str::<ModelSpec>(&orphan)?) {
        println!("A body whose limb has no parent: {problem}");
    }
    if let Err(problem) = Camera::new("", [80, 60], pinhole, Distortion::None, *camera.camera_from_world()) {
        println!("A camera without a name: {problem}");
    }
    Ok(())
}
