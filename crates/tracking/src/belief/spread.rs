//! What a frame leaves to the ends of a pose's limbs, by the curvature of its cost.
//!
//! With H = JᵀJ of the frame, R = [`PIXEL_DEVIATION`]² and P₀ what is known of any pose, the covariance of the columns is
//! (H/R + P₀⁻¹)⁻¹, and that of an end with the Jacobian K is K (H/R + P₀⁻¹)⁻¹ Kᵀ. R is whitened: along a contour neighbouring
//! residuals err together, so that many pixels tell as much as a few, and each counts with a deviation that is far larger than
//! its own.

use glam::{DMat3, DVec3};
use nalgebra::{Cholesky, DMatrix, Dyn};

use crate::body::{Kinematics, Model, Parameters};
use crate::optimize::NormalEquations;

/// Deviation of a pixel's residual, grey levels: model and silhouette err together over whole edges.
const PIXEL_DEVIATION: f64 = 200.0;
/// What is known of a pose before it is seen: deviations of the root, metres, and of a rotation, radians.
const ROOT_DEVIATION_M: f64 = 0.5;
const TURN_DEVIATION: f64 = 0.8;

/// What is known of the columns of a pose where these equations tell of it, and before: H/R + P₀⁻¹.
fn information(jtj: &DMatrix<f64>) -> Option<Cholesky<f64, Dyn>> {
    let mut information = jtj / (PIXEL_DEVIATION * PIXEL_DEVIATION);
    for column in 0..information.nrows() {
        let deviation = if column < 3 { ROOT_DEVIATION_M } else { TURN_DEVIATION };
        information[(column, column)] += 1.0 / (deviation * deviation);
    }
    information.cholesky()
}

/// Of the ends of all limbs: their derivatives by the tangent columns.
pub(crate) fn end_jacobians(model: &Model, kinematics: &Kinematics) -> Vec<DMatrix<f64>> {
    (0..model.limbs().len()).map(|limb| kinematics.end_jacobian(limb, Parameters::Tangent)).collect()
}

/// The covariance that a frame leaves to the end of every limb, square metres.
pub(crate) fn end_covariances(ends: &[DMatrix<f64>], equations: &NormalEquations) -> Vec<DMat3> {
    let factor = information(&equations.jtj);
    let of_end = |end: &DMatrix<f64>| match &factor {
        Some(factor) => {
            let covariance = end * factor.solve(&end.transpose());
            let column = |at: usize| DVec3::from_slice(covariance.column(at).as_slice());
            DMat3::from_cols(column(0), column(1), column(2))
        }
        None => DMat3::IDENTITY / 3.0,
    };
    ends.iter().map(of_end).collect()
}

/// How far a point with this covariance is off, the root of its mean square, metres.
pub fn deviation_m(covariance: &DMat3) -> f64 {
    (covariance.x_axis.x + covariance.y_axis.y + covariance.z_axis.z).max(0.0).sqrt()
}

/// How far the end of every limb goes in one step where one camera is left out, metres, of the camera that moves it most: the
/// influence of the camera (R. D. Cook, "Detection of influential observation in linear regression", 1977). Where the fit ended
/// the pulls of all cameras and priors are in balance, so that without camera c the step is −(H − H꜀)⁻¹ g꜀.
pub(crate) fn left_out_shifts(
    ends: &[DMatrix<f64>],
    all: &NormalEquations,
    cameras: &[NormalEquations],
) -> Vec<f64> {
    let mut shifts = vec![0.0_f64; ends.len()];
    for camera in cameras.iter().filter(|camera| camera.jtj.trace() > 0.0 && cameras.len() > 1) {
        let Some(factor) = information(&(&all.jtj - &camera.jtj)) else { continue };
        let step = factor.solve(&(&camera.jtr / (PIXEL_DEVIATION * PIXEL_DEVIATION)));
        for (shift, end) in shifts.iter_mut().zip(ends) {
            *shift = shift.max((end * &step).norm());
        }
    }
    shifts
}
