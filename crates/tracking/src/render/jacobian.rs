//! The dense Jacobian ∂Λ/∂X: height·width × columns, row-major pixels. For tests, inspection and export.

use nalgebra::DMatrix;

use super::View;
use super::kernels::scalar::RowWinners;
use super::wrench::Wrench;
use crate::body::{Kinematics, Parameters};
use crate::camera::Camera;

/// ∂λ/∂X for every pixel of a prepared view, in grey levels per metre, radian or raw coefficient.
///
/// Rows of pixels without gradient are zero. Memory is pixels × columns × 8 bytes.
#[must_use]
pub fn dense_jacobian(
    view: &View,
    kinematics: &Kinematics,
    camera: &Camera,
    parameters: Parameters,
) -> DMatrix<f64> {
    let columns = parameters.columns(kinematics.world_rotations().len());
    let mut jacobian = DMatrix::zeros(view.width() * view.height(), columns);
    let mut maps = Vec::with_capacity(kinematics.limb_count());
    for limb in 0..kinematics.limb_count() {
        let mut map = DMatrix::zeros(7, columns);
        kinematics.fill_map(limb, parameters, &mut map);
        maps.push(map);
    }
    for_each_gradient(view, |x, y, limb, wrench| {
        let h = wrench.rotated(camera.camera_from_world().rotation.transpose()).to_array();
        let mut row = jacobian.row_mut(y * view.width() + x);
        for (column, value) in row.iter_mut().enumerate() {
            *value = (0..7).map(|i| h[i] * maps[limb][(i, column)]).sum();
        }
    });
    jacobian
}

/// Calls `visit(x, y, limb, wrench in camera axes)` for every pixel that has a gradient.
pub fn for_each_gradient(view: &View, mut visit: impl FnMut(usize, usize, usize, Wrench)) {
    let mut row = RowWinners::default();
    for y in 0..view.height() {
        row.find(view, y, 1, 0);
        for x in row.touched() {
            let Some(winner) = row.winner(x) else { continue };
            let primitive = &view.primitives()[winner];
            if let Some(wrench) = primitive.sample(view.ray(x, y)).wrench {
                visit(x, y, primitive.limb, wrench);
            }
        }
    }
}
