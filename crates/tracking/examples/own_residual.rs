//! A residual of one's own in a fit: the root stays at a height. `cargo run -p backlit-tracking --example own_residual`.

use std::sync::Arc;

use backlit_tracking::prelude::*;

/// ρ = height − root.y, with a weight per m².
#[derive(Debug)]
struct Height {
    metres: f64,
    weight: f64,
}

impl Residual for Height {
    fn add(&self, at: &ResidualPoint<'_>, equations: &mut NormalEquations) {
        let (residual, weight) = (self.metres - at.pose.root.y, at.unit * self.weight);
        equations.cost += weight * residual * residual;
        equations.jtr[1] += weight * residual;
        equations.jtj[(1, 1)] += weight;
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let model = Arc::new(builtin::upper_body());
    let place = CameraFromWorld::looking_at(DVec3::Z * 2.4, DVec3::Y * 0.25, DVec3::Y);
    let pinhole = Intrinsics { fx: 140.0, fy: 140.0, cx: 47.5, cy: 35.5 };
    let camera = Camera::new("front", [96, 72], pinhole, Distortion::None, place)?;
    let start = Pose::rest(&model);
    let joints = Kinematics::new(&model, &start);
    let mask = predict(&model, &joints, &camera, RendererKind::Capsule, Ramp::Half).to_mask()?;
    let height: Arc<dyn Residual> = Arc::new(Height { metres: 0.1, weight: 1e4 });
    let views = vec![FitView::of_mask(camera, mask)];
    let mut fit = Fit::new(model, views, start, FitOptions::default())?.with_residual(height);
    println!("root at {:.3}", fit.run(&CancelToken::new(), |_| {}).pose.root);
    Ok(())
}
