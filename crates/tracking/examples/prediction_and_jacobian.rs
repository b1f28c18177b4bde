//! Draws a prediction Λ(X) and a column of its Jacobian ∂Λ/∂X, and checks the column against differences.
//!
//! `cargo run -p backlit-tracking --example prediction_and_jacobian`
//!
//! Λ is a picture: 0 where the model is, 255 where it is not, a ramp between. A column of the Jacobian is a picture
//! too: how each grey level changes as one number of the pose does. Only pixels on a ramp change.

use std::error::Error;

use backlit_tracking::body::{Kinematics, Parameters, Pose, builtin};
use backlit_tracking::camera::{Camera, CameraFromWorld, Distortion, Intrinsics};
use backlit_tracking::optimize::gradient_check::{DifferenceOptions, check_column};
use backlit_tracking::render::{Ramp, RendererKind, View, jacobian_along, prediction};
use glam::DVec3;

/// Characters from subject to background.
const SHADES: [char; 6] = ['@', '%', '+', '-', '.', ' '];

fn main() -> Result<(), Box<dyn Error>> {
    let model = builtin::upper_body();
    let pose = Pose::rest(&model);
    let kinematics = Kinematics::new(&model, &pose);
    let camera_from_world =
        CameraFromWorld::looking_at(DVec3::new(0.3, 0.1, 2.6), DVec3::new(0.0, 0.25, 0.0), DVec3::Y);
    let pinhole = Intrinsics { fx: 120.0, fy: 120.0, cx: 47.5, cy: 35.5 };
    let camera = Camera::new("camera", [96, 72], pinhole, Distortion::None, camera_from_world)?;

    // A ramp is what makes the picture differentiable: without one, λ would jump from 0 to 255.
    let (renderer, ramp) = (RendererKind::Capsule, Ramp::Width { px: 4.0 });
    let view = View::new(&model, &kinematics, &camera, renderer, ramp);
    let levels = prediction::levels(&view);
    println!("Λ(X), {} × {} pixels:", camera.width(), camera.height());
    print(&camera, &levels, |level| {
        let shade = (level / 255.0 * SHADES.len() as f64) as usize;
        SHADES[shade.min(SHADES.len() - 1)]
    });

    // The columns of the state: three of the root, then three a rotation (tangent coordinates). This one swings the
    // right upper arm about the camera's line of sight, near enough.
    let arm = model.limb_index("right upper arm").ok_or("the body has no right upper arm")?;
    let rotation = model.limbs()[arm].rotation;
    let column = Parameters::Tangent.first_column(rotation) + 2;
    let mut direction = vec![0.0; Parameters::Tangent.columns(model.rotation_count())];
    direction[column] = 1.0;
    let derivative = jacobian_along(&view, &kinematics, &camera, Parameters::Tangent, &direction);
    println!("\n∂Λ/∂X, column {column}: darker (#) and brighter (-) as the right arm turns about z:");
    print(&camera, &derivative, |slope| match slope {
        slope if slope < -1.0 => '#',
        slope if slope > 1.0 => '-',
        _ => ' ',
    });

    // The same by differences of whole pictures; where a pixel changes its limb they cannot tell, and say so.
    let levels_at = |offset: f64| {
        let moved = pose.nudged(Parameters::Tangent, column, offset);
        let kinematics = Kinematics::new(&model, &moved);
        prediction::levels(&View::new(&model, &kinematics, &camera, renderer, ramp))
    };
    let name = |pixel: usize| format!("pixel ({}, {})", pixel % camera.width(), pixel / camera.width());
    let check = check_column(&derivative, levels_at, name, &DifferenceOptions::default());
    println!("\nAgainst differences: {check}");
    Ok(())
}

/// A picture in characters, each as high as two pixels.
fn print(camera: &Camera, picture: &[f64], character: impl Fn(f64) -> char) {
    for row in picture.chunks(camera.width()).step_by(2) {
        let line: String = row.iter().map(|value| character(*value)).collect();
        println!("{}", line.trim_end());
    }
}
