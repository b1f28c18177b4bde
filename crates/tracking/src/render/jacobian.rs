//! The dense Jacobian ∂Λ/∂X: height·width × columns, row-major pixels. For tests, inspection and export.

use glam::{DMat3, DVec3};
use nalgebra::{DMatrix, DVector, SVector};

use super::View;
use super::kernels::scalar::RowWinners;
use super::wrench::Wrench;
use crate::body::{Kinematics, Parameters};
use crate::camera::Camera;

/// ∂λ/∂X for every pixel of a prepared view, in grey levels per metre, radian or raw coefficient.
///
/// Rows of pixels without gradient are zero. Memory is pixels × columns × 8 bytes.
pub fn dense_jacobian(
    view: &View,
    kinematics: &Kinematics,
    camera: &Camera,
    parameters: Parameters,
) -> DMatrix<f64> {
    let columns = parameters.columns(kinematics.world_rotations().len());
    let mut jacobian = DMatrix::zeros(view.size[0] * view.size[1], columns);
    let mut maps = Vec::with_capacity(kinematics.limb_count());
    for limb in 0..kinematics.limb_count() {
        let mut map = DMatrix::zeros(7, columns);
        kinematics.fill_map(limb, parameters, &mut map);
        maps.push(map);
    }
    for_each_gradient(view, |x, y, limb, wrench| {
        let h = wrench.rotated(camera.camera_from_world().rotation.transpose()).to_array();
        let mut row = jacobian.row_mut(y * view.size[0] + x);
        for (column, value) in row.iter_mut().enumerate() {
            *value = (0..7).map(|i| h[i] * maps[limb][(i, column)]).sum();
        }
    });
    jacobian
}

/// J v as a picture: how every pixel changes along a direction v of the state, [`dense_jacobian`] times v without
/// its memory. Row-major, zero where there is no gradient.
///
/// # Panics
/// If the direction has not as many entries as the state has columns.
pub fn jacobian_along(
    view: &View,
    kinematics: &Kinematics,
    camera: &Camera,
    parameters: Parameters,
    direction: &[f64],
) -> Vec<f64> {
    let motion = BodyMotion::along(kinematics, camera, parameters, direction);
    let mut picture = vec![0.0; view.size[0] * view.size[1]];
    for_each_gradient(view, |x, y, limb, wrench| {
        picture[y * view.size[0] + x] = motion.change(limb, wrench);
    });
    picture
}

/// How every limb moves along a direction of the state, for one camera.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyMotion {
    /// By limb: velocity of its first joint, turn, scaling; world axes.
    limbs: Vec<SVector<f64, 7>>,
    world_from_camera: DMat3,
}

impl BodyMotion {
    /// Along a direction v of the state.
    ///
    /// # Panics
    /// If the direction has not as many entries as the state has columns.
    pub fn along(
        kinematics: &Kinematics,
        camera: &Camera,
        parameters: Parameters,
        direction: &[f64],
    ) -> Self {
        let direction = DVector::from_column_slice(direction);
        let mut map = DMatrix::zeros(7, parameters.columns(kinematics.world_rotations().len()));
        let mut limbs = Vec::with_capacity(kinematics.limb_count());
        for limb in 0..kinematics.limb_count() {
            kinematics.fill_map(limb, parameters, &mut map);
            let motion = &map * &direction;
            limbs.push(SVector::from_column_slice(motion.as_slice()));
        }
        Self { limbs, world_from_camera: camera.camera_from_world().rotation.transpose() }
    }

    /// How λ changes of a pixel that pulls at a limb with this wrench, in camera axes.
    pub(crate) fn change(&self, limb: usize, wrench: Wrench) -> f64 {
        let h = wrench.rotated(self.world_from_camera).to_array();
        (0..7).map(|i| h[i] * self.limbs[limb][i]).sum()
    }

    /// How a limb moves along a unit of the direction, in camera axes: the velocity of its first joint, metres, and how a
    /// point given from there moves against that, by a turn and a scaling about it.
    pub(crate) fn in_camera(&self, limb: usize) -> (DVec3, impl Fn(DVec3) -> DVec3) {
        let m = &self.limbs[limb];
        let camera_from_world = self.world_from_camera.transpose();
        let [velocity, turn] = [0, 3].map(|at| camera_from_world * DVec3::new(m[at], m[at + 1], m[at + 2]));
        let stretch = m[6];
        (velocity, move |arm| turn.cross(arm) + stretch * arm)
    }
}

/// Calls `visit(x, y, limb, wrench in camera axes)` for every pixel that has a gradient.
pub(super) fn for_each_gradient(view: &View, mut visit: impl FnMut(usize, usize, usize, Wrench)) {
    let mut row = RowWinners::default();
    for y in 0..view.size[1] {
        row.find(view, y, 1, 0);
        for x in row.touched() {
            let Some(winner) = row.winner(x) else { continue };
            let primitive = &view.primitives[winner];
            if let Some(wrench) = primitive.sample(view.ray(x, y)).wrench {
                visit(x, y, primitive.limb, wrench);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::body::Pose;
    use crate::body::builtin::upper_body;
    use crate::fixtures;
    use crate::render::{Ramp, RendererKind};

    #[test]
    fn one_column_is_that_of_the_dense_jacobian() {
        let model = upper_body();
        let kinematics = Kinematics::new(&model, &Pose::rest(&model));
        let intrinsics = [40.0, 40.0, 23.5, 17.5];
        let camera = fixtures::camera([48, 36], intrinsics, [0.4, 0.2, 3.0], [0.0, 0.3, 0.0], DVec3::Y);
        let view = View::new(&model, &kinematics, &camera, RendererKind::Capsule, Ramp::Half);
        for parameters in [Parameters::Raw, Parameters::Tangent] {
            let dense = dense_jacobian(&view, &kinematics, &camera, parameters);
            for column in 0..dense.ncols() {
                let mut unit = vec![0.0; dense.ncols()];
                unit[column] = 1.0;
                let picture = jacobian_along(&view, &kinematics, &camera, parameters, &unit);
                let expected = dense.column(column);
                let same = expected.iter().zip(picture).all(|(a, b)| *a as f32 == b as f32);
                assert!(same, "{parameters:?} column {column}");
            }
            assert!(dense.column(0).iter().any(|value| *value != 0.0));
            let direction = DVector::from_fn(dense.ncols(), |i, _| (i as f64 * 1.7).sin());
            let expected = &dense * &direction;
            let picture = jacobian_along(&view, &kinematics, &camera, parameters, direction.as_slice());
            for (expected, found) in expected.iter().zip(&picture) {
                assert!((expected - found).abs() < 1e-9 * expected.abs().max(1.0), "{expected} {found}");
            }
        }
    }
}
