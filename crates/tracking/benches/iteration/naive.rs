//! The baseline: every pixel against every limb, a dense Jacobian, a dense product; scalar, in f64.
//!
//! This is what equations 4.10, 4.16 and 4.22 say when they are written down one after the other. It shares
//! the formulas of one ray and one limb with the library, and nothing of how the library goes about it.

use backlit_tracking::body::{Kinematics, Model, Parameters, Pose};
use backlit_tracking::camera::Camera;
use backlit_tracking::optimize::NormalEquations;
use backlit_tracking::render::{BACKGROUND, Ramp, RendererKind, View};
use backlit_tracking::silhouette::Measurement;
use nalgebra::DMatrix;

/// JᵀJ, Jᵀρ and the cost of all cameras at a pose.
pub(crate) fn equations(
    model: &Model,
    pose: &Pose,
    cameras: &[(Camera, Measurement)],
    (renderer, ramp): (RendererKind, Ramp),
    parameters: Parameters,
) -> NormalEquations {
    let columns = parameters.columns(model.rotation_count());
    let mut equations = NormalEquations::zeros(columns);
    let mut jtj = vec![0.0; columns * columns];
    let kinematics = Kinematics::new(model, pose);
    for (camera, data) in cameras {
        let pixels = camera.width() * camera.height();
        let mut jacobian = vec![0.0; pixels * columns];
        let mut residuals = vec![0.0; pixels];
        let view = View::new(model, &kinematics, camera, renderer, ramp);
        let world_from_camera = camera.camera_from_world().rotation.transpose();
        let maps: Vec<DMatrix<f64>> = (0..model.limbs().len())
            .map(|limb| {
                let mut map = DMatrix::zeros(7, columns);
                kinematics.fill_map(limb, parameters, &mut map);
                map
            })
            .collect();
        for y in 0..camera.height() {
            for x in 0..camera.width() {
                let pixel = y * camera.width() + x;
                let pull = view.pull_by_every_solid(x, y);
                let data = f64::from(data.values()[pixel]);
                residuals[pixel] = data - pull.map_or(BACKGROUND, |pull| pull.level);
                if let Some(pull) = pull
                    && let Some(wrench) = pull.wrench
                {
                    let wrench = wrench.rotated(world_from_camera).to_array();
                    let row = &mut jacobian[pixel * columns..(pixel + 1) * columns];
                    let motions = maps[pull.limb].as_slice().chunks_exact(7);
                    for (entry, motion) in row.iter_mut().zip(motions) {
                        *entry = wrench.iter().zip(motion).map(|(force, rate)| force * rate).sum();
                    }
                }
            }
        }
        for (row, &residual) in jacobian.chunks(columns).zip(&residuals) {
            for (i, &entry) in row.iter().enumerate() {
                let products = &mut jtj[i * columns + i..(i + 1) * columns];
                products.iter_mut().zip(&row[i..]).for_each(|(product, other)| *product += entry * other);
                equations.jtr[i] += entry * residual;
            }
            equations.cost += residual * residual;
        }
    }
    // Symmetric: one half was summed.
    for i in 0..columns {
        for j in i..columns {
            equations.jtj[(i, j)] = jtj[i * columns + j];
            equations.jtj[(j, i)] = jtj[i * columns + j];
        }
    }
    equations
}
