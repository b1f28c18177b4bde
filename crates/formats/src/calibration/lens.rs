//! From numbers in OpenCV's order to a lens, and from rotation vectors to matrices and back.

use backlit_tracking::camera::Distortion;
use glam::{DMat3, DQuat, DVec3};

use super::tree::Field;
use crate::Result;

/// Coefficients k1 k2 p1 p2 k3 k4 k5 k6 of OpenCV, or fewer; those of a thin prism or a tilted sensor must be 0.
pub(super) fn opencv(field: &Field<'_>) -> Result<Distortion> {
    let numbers = field.numbers()?;
    match opencv_lens(&numbers) {
        Some(lens) => Ok(lens),
        None if numbers.len() > 8 && numbers.len() <= 14 => Err(field.error(
            "a lens with a thin prism or a tilted sensor",
            "k1 k2 p1 p2 k3 k4 k5 k6, and zeros after them",
        )),
        None => Err(field.other_count(numbers.len(), "4, 5, 8, 12 or 14 coefficients of OpenCV")),
    }
}

/// As [`opencv`]; `None` for another number of coefficients or what no lens of ours can hold.
pub(super) fn opencv_lens(numbers: &[f64]) -> Option<Distortion> {
    if ![0, 1, 2, 4, 5, 8, 12, 14].contains(&numbers.len())
        || numbers.iter().skip(8).any(|&value| value != 0.0)
    {
        return None;
    }
    let value = |index: usize| numbers.get(index).copied().unwrap_or(0.0);
    let [k1, k2, p1, p2, k3] = [0, 1, 2, 3, 4].map(value);
    let [k4, k5, k6] = [5, 6, 7].map(value);
    Some(if numbers.iter().all(|&value| value == 0.0) {
        Distortion::None
    } else if [k4, k5, k6] == [0.0; 3] {
        Distortion::OpenCv { k1, k2, p1, p2, k3 }
    } else {
        Distortion::Rational { k1, k2, p1, p2, k3, k4, k5, k6 }
    })
}

/// The four coefficients of a fisheye; fewer are followed by zeros. A fisheye without any is still none of a pinhole.
pub(super) fn fisheye(field: &Field<'_>) -> Result<Distortion> {
    let numbers = field.numbers()?;
    // Tools that keep five write zeros after the fourth.
    if numbers.is_empty() || numbers.iter().skip(4).any(|&value| value != 0.0) {
        return Err(field.other_count(numbers.len(), "the four coefficients of a fisheye"));
    }
    let value = |index: usize| numbers.get(index).copied().unwrap_or(0.0);
    Ok(Distortion::Fisheye { k1: value(0), k2: value(1), k3: value(2), k4: value(3) })
}

/// The rotation about this axis by the vector's length, radians (Rodrigues).
pub(super) fn rotation_from_vector(vector: [f64; 3]) -> DMat3 {
    let vector = DVec3::from_array(vector);
    let angle = vector.length();
    if angle < 1e-12 {
        // To first order; beyond that nothing is left of it.
        let DVec3 { x, y, z } = vector;
        return DMat3::from_cols(DVec3::new(1.0, z, -y), DVec3::new(-z, 1.0, x), DVec3::new(y, -x, 1.0));
    }
    DMat3::from_axis_angle(vector / angle, angle)
}

/// The vector of a rotation: [`rotation_from_vector`] gives the rotation again.
pub(super) fn vector_from_rotation(rotation: DMat3) -> [f64; 3] {
    let quaternion = DQuat::from_mat3(&rotation).normalize();
    let quaternion = if quaternion.w < 0.0 { -quaternion } else { quaternion };
    let axis = quaternion.xyz();
    let sine = axis.length();
    let factor = if sine < 1e-12 { 2.0 } else { 2.0 * sine.atan2(quaternion.w) / sine };
    (axis * factor).to_array()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vectors_and_rotations_are_each_other_s_inverse() {
        for vector in [
            [0.0; 3],
            [1e-13, 0.0, 0.0],
            [1e-7, -2e-7, 3e-7],
            [1.2, -0.4, 0.7],
            [0.0, 3.1, 0.0],
            [-2.2, 2.2, 0.1],
        ] {
            let rotation = rotation_from_vector(vector);
            let again = rotation_from_vector(vector_from_rotation(rotation));
            assert!((rotation - again).to_cols_array().iter().all(|x| x.abs() < 1e-14), "{vector:?}");
        }
    }

    #[test]
    fn coefficients_are_as_many_as_they_need_be() {
        assert_eq!(opencv_lens(&[0.0; 5]), Some(Distortion::None));
        assert!(matches!(opencv_lens(&[0.1, 0.0, 0.0, 0.0]), Some(Distortion::OpenCv { .. })));
        assert!(matches!(
            opencv_lens(&[0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.2]),
            Some(Distortion::Rational { k6: 0.2, .. })
        ));
        let mut prism = [0.0; 14];
        assert_eq!(opencv_lens(&prism), Some(Distortion::None));
        prism[9] = 1e-3;
        assert_eq!((opencv_lens(&prism), opencv_lens(&[0.1; 3])), (None, None));
    }
}
