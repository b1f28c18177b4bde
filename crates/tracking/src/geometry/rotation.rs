//! Rotations: exponential and logarithm of SO(3), and the raw quaternions of the 2004 report.
//!
//! Perturbations act from the left, in the parent's frame: q ← exp(ω) q, with ω in radians.
//! A raw quaternion (equation 4.15) need not be of unit length: x ↦ q x q* turns *and scales* by |q|².

use glam::{DMat3, DQuat, DVec3};

/// Below this angle (radians) the closed forms lose digits and series take over.
const SMALL_ANGLE: f64 = 1e-4;

/// exp: so(3) → unit quaternion, for a rotation vector in radians.
///
/// ```
/// use backlit_tracking::geometry::rotation::{exp, log};
/// let omega = glam::DVec3::new(0.3, -0.2, 0.9);
/// assert!((log(exp(omega)) - omega).length() < 1e-15);
/// ```
pub fn exp(omega: DVec3) -> DQuat {
    let angle = omega.length();
    let half = 0.5 * angle;
    // sin(θ/2)/θ
    let scale = if angle < SMALL_ANGLE { 0.5 - angle * angle / 48.0 } else { half.sin() / angle };
    let v = omega * scale;
    DQuat::from_xyzw(v.x, v.y, v.z, half.cos())
}

/// log: unit quaternion → rotation vector in radians, of length at most π.
pub fn log(q: DQuat) -> DVec3 {
    // q and −q are the same rotation; take the short way round.
    let (v, w) = if q.w < 0.0 { (-q.xyz(), -q.w) } else { (q.xyz(), q.w) };
    let sine = v.length();
    if sine < SMALL_ANGLE {
        // 2·asin(s)/s ≈ 2 + s²/3, for a unit quaternion
        return v * (2.0 + sine * sine / 3.0);
    }
    v * (2.0 * sine.atan2(w) / sine)
}

/// The matrix `[v]×` with `[v]× x = v × x`.
pub fn skew(v: DVec3) -> DMat3 {
    DMat3::from_cols(DVec3::new(0.0, v.z, -v.y), DVec3::new(-v.z, 0.0, v.x), DVec3::new(v.y, -v.x, 0.0))
}

/// The left Jacobian of SO(3): d/dω log(exp(φ + ω) exp(−φ)) at ω = 0.
///
/// `J = I + (1 − cos θ)/θ² [φ]× + (θ − sin θ)/θ³ [φ]×²`, θ = |φ|.
pub fn left_jacobian(phi: DVec3) -> DMat3 {
    let angle = phi.length();
    let s = skew(phi);
    let squared = angle * angle;
    let (first, second) = if angle < 1e-3 {
        (0.5 - squared / 24.0, 1.0 / 6.0 - squared / 120.0)
    } else {
        ((1.0 - angle.cos()) / squared, (angle - angle.sin()) / (squared * angle))
    };
    DMat3::IDENTITY + s * first + (s * s) * second
}

/// Inverse of the left Jacobian of SO(3): d/dω log(exp(ω) exp(φ)) at ω = 0.
///
/// `J⁻¹ = I − ½[φ]× + (1/θ² − (1 + cos θ)/(2 θ sin θ)) [φ]×²`, θ = |φ| < 2π.
pub fn left_jacobian_inverse(phi: DVec3) -> DMat3 {
    let angle = phi.length();
    let s = skew(phi);
    let second = if angle < 1e-3 {
        1.0 / 12.0 + angle * angle / 720.0
    } else {
        // (1 + cos θ)/sin θ = cot(θ/2), which stays well behaved at θ = π.
        let half = 0.5 * angle;
        1.0 / (angle * angle) - half.cos() / (2.0 * angle * half.sin())
    };
    DMat3::IDENTITY - s * 0.5 + (s * s) * second
}

/// The matrix of x ↦ q x q*, for a quaternion of any length (4.15): |q|² times a rotation.
pub fn raw_matrix(q: DQuat) -> DMat3 {
    let (x, y, z, w) = (q.x, q.y, q.z, q.w);
    DMat3::from_cols(
        DVec3::new(w * w + x * x - y * y - z * z, 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)),
        DVec3::new(2.0 * (x * y - w * z), w * w - x * x + y * y - z * z, 2.0 * (y * z + w * x)),
        DVec3::new(2.0 * (x * z + w * y), 2.0 * (y * z - w * x), w * w - x * x - y * y + z * z),
    )
}

/// How a raw quaternion's coefficients move the vectors that it carries.
///
/// d(q x q*)/dqᵢ = ωᵢ × (q x q*) + σᵢ (q x q*), with ηᵢ = eᵢ q⁻¹, ωᵢ = 2 vec(ηᵢ) and σᵢ = 2 Re(ηᵢ).
/// Returns `(ωᵢ, σᵢ)` for i = w, x, y, z.
pub fn raw_rates(q: DQuat) -> [(DVec3, f64); 4] {
    let inverse_norm = 1.0 / q.length_squared();
    let (v, w) = (q.xyz() * inverse_norm, q.w * inverse_norm);
    [
        (-2.0 * v, 2.0 * w),
        (2.0 * (w * DVec3::X - DVec3::X.cross(v)), 2.0 * v.x),
        (2.0 * (w * DVec3::Y - DVec3::Y.cross(v)), 2.0 * v.y),
        (2.0 * (w * DVec3::Z - DVec3::Z.cross(v)), 2.0 * v.z),
    ]
}

/// A rotation taken apart about an axis: q = exp(swing) exp(twist · axis), swing ⊥ axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SwingTwist {
    /// Rotation vector perpendicular to the axis, radians.
    pub swing: DVec3,
    /// Angle about the axis, radians, in (−π, π].
    pub twist: f64,
}

/// Takes a unit quaternion apart about a unit axis.
pub fn swing_twist(q: DQuat, axis: DVec3) -> SwingTwist {
    let along = q.xyz().dot(axis);
    let mut twist = 2.0 * along.atan2(q.w);
    if twist > std::f64::consts::PI {
        twist -= std::f64::consts::TAU;
    } else if twist <= -std::f64::consts::PI {
        twist += std::f64::consts::TAU;
    }
    let swing = log(q * exp(-twist * axis));
    SwingTwist { swing, twist }
}

/// Derivatives of [`swing_twist`] by a left perturbation q ← exp(ω) q at ω = 0.
///
/// Returns d twist/dω as a vector and d swing/dω as a matrix. Where the twist is not defined (a swing of
/// half a turn) both are finite but mean nothing.
pub fn swing_twist_rates(q: DQuat, axis: DVec3) -> (DVec3, DMat3) {
    let (v, w) = (q.xyz(), q.w);
    let along = v.dot(axis);
    // dq_w = −½ v·ω and dq_vec = ½ (w ω + ω × v), so d(axis·q_vec) = ½ (w axis + v × axis)·ω.
    let rate_along = 0.5 * (w * axis + v.cross(axis));
    let rate_w = -0.5 * v;
    let norm = (along * along + w * w).max(1e-12);
    let twist_rate = 2.0 * (w * rate_along - along * rate_w) / norm;
    let parts = swing_twist(q, axis);
    let turned_axis = exp(parts.swing) * axis;
    // ω = ω_swing + (R_swing axis) dtwist
    let outer =
        DMat3::from_cols(turned_axis * twist_rate.x, turned_axis * twist_rate.y, turned_axis * twist_rate.z);
    (twist_rate, left_jacobian_inverse(parts.swing) * (DMat3::IDENTITY - outer))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn vector(limit: f64) -> impl Strategy<Value = DVec3> {
        (-limit..limit, -limit..limit, -limit..limit).prop_map(|(x, y, z)| DVec3::new(x, y, z))
    }

    proptest! {
        #[test]
        fn log_undoes_exp(omega in vector(1.8)) {
            prop_assert!((log(exp(omega)) - omega).length() < 1e-12);
        }

        #[test]
        fn raw_matrix_is_the_rotation_times_the_squared_norm(omega in vector(2.0), norm in 0.5..1.5f64) {
            let q = exp(omega);
            let raw = raw_matrix(q * norm);
            let expected = DMat3::from_quat(q) * (norm * norm);
            prop_assert!(raw.abs_diff_eq(expected, 1e-12));
        }

        #[test]
        fn raw_rates_match_differences(omega in vector(2.0), norm in 0.5..1.5f64, x in vector(1.0)) {
            let q = exp(omega) * norm;
            let h = 1e-6;
            let turned = raw_matrix(q) * x;
            for (i, (rate, scale)) in raw_rates(q).into_iter().enumerate() {
                let mut e = [0.0; 4];
                e[(i + 3) % 4] = h; // glam stores x, y, z, w
                let e = DQuat::from_array(e);
                let numeric = (raw_matrix(q + e) * x - raw_matrix(q - e) * x) / (2.0 * h);
                let analytic = rate.cross(turned) + scale * turned;
                prop_assert!((numeric - analytic).length() < 1e-8, "coefficient {i}: {numeric} {analytic}");
            }
        }

        #[test]
        fn left_jacobian_inverse_matches_differences(phi in vector(1.7)) {
            let h = 1e-6;
            let analytic = left_jacobian_inverse(phi);
            for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
                let numeric = (log(exp(axis * h) * exp(phi)) - log(exp(-axis * h) * exp(phi))) / (2.0 * h);
                prop_assert!((numeric - analytic * axis).length() < 1e-7);
            }
        }

        #[test]
        fn swing_and_twist_make_the_rotation_again(omega in vector(1.4), axis in vector(1.0)) {
            prop_assume!(axis.length() > 0.1);
            let axis = axis.normalize();
            let q = exp(omega);
            let parts = swing_twist(q, axis);
            prop_assert!(parts.swing.dot(axis).abs() < 1e-9);
            let again = exp(parts.swing) * exp(parts.twist * axis);
            prop_assert!(log(again * q.inverse()).length() < 1e-9);
        }

        #[test]
        fn swing_twist_rates_match_differences(omega in vector(1.2), axis in vector(1.0)) {
            prop_assume!(axis.length() > 0.1);
            let axis = axis.normalize();
            let q = exp(omega);
            let (twist, swing) = swing_twist_rates(q, axis);
            let h = 1e-6;
            for e in [DVec3::X, DVec3::Y, DVec3::Z] {
                let (plus, minus) = (swing_twist(exp(e * h) * q, axis), swing_twist(exp(-e * h) * q, axis));
                prop_assert!(((plus.twist - minus.twist) / (2.0 * h) - twist.dot(e)).abs() < 1e-6);
                prop_assert!(((plus.swing - minus.swing) / (2.0 * h) - swing * e).length() < 1e-6);
            }
        }
    }
}
