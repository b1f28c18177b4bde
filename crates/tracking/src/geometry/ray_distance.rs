//! Distance of a ray to a limb, by candidate, with its derivatives by the limb's two joints.
//!
//! The camera's centre is the origin; u is the ray's unit direction; p0, p1 are the joints, a = p1 − p0,
//! b = u·a. All lengths in metres. Candidates that lie behind the camera (s ≤ 0) do not exist.
//!
//! | candidate | distance | ∂d²/∂p0 | ∂d²/∂p1 |
//! |---|---|---|---|
//! | axis, 0 ≤ t ≤ 1 | δ = s u − p0 − t a | −2(1−t) δ | −2t δ |
//! | round end, or sphere at fraction τ with centre q | δ = (u·q) u − q | −2(1−τ) δ | −2τ δ |
//! | flat cap at p0 | h = s u − p0, s = a·p0/b, κ = h·u/b | 2κ(a + h) − 2h | −2κ h |
//! | flat cap at p1 | h = s u − p1, s = a·p1/b, κ = h·u/b | 2κ h | 2κ(a − h) − 2h |
//!
//! The axis candidate's t and s are stationary, so their own motion drops out (the report's appendix A
//! reaches the same numbers the long way). Source: equations 4.16 to 4.21 and appendix A of the report.

use glam::DVec3;

/// A limb's axis is taken as parallel to the ray where sin² of the angle between them is below this.
const PARALLEL_SIN_SQUARED: f64 = 1e-12;

/// One candidate: its squared distance, where it is along the ray, and its derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Candidate {
    /// Squared distance d² in m².
    pub squared: f64,
    /// Distance s along the ray in metres, always positive.
    pub depth: f64,
    /// ∂d²/∂p0, metres.
    pub by_p0: DVec3,
    /// ∂d²/∂p1, metres.
    pub by_p1: DVec3,
}

impl Candidate {
    /// A point fixed in the limb at a fraction of its axis, δ from the ray.
    #[inline(always)]
    fn at(depth: f64, delta: DVec3, fraction: f64) -> Self {
        let (by_p0, by_p1) = (-2.0 * (1.0 - fraction) * delta, -2.0 * fraction * delta);
        Self { squared: delta.length_squared(), depth, by_p0, by_p1 }
    }
}

/// The ray against the axis of the limb p0 p1.
///
/// `None` if the closest point lies beyond either joint or behind the camera, or if the two are parallel.
pub fn ray_axis(u: DVec3, p0: DVec3, p1: DVec3) -> Option<Candidate> {
    let a = p1 - p0;
    let b = u.dot(a);
    let length_squared = a.length_squared();
    let denominator = length_squared - b * b;
    if denominator <= PARALLEL_SIN_SQUARED * length_squared {
        return None;
    }
    let along = u.dot(p0);
    let t = (along * b - a.dot(p0)) / denominator;
    let depth = t * b + along;
    if !(0.0..=1.0).contains(&t) || depth <= 0.0 {
        return None;
    }
    let delta = depth * u - p0 - t * a;
    Some(Candidate::at(depth, delta, t))
}

/// The ray against a point fixed in the limb at `fraction` of its axis (0 = p0, 1 = p1): a round end or a
/// sphere's centre.
pub fn ray_point(u: DVec3, centre: DVec3, fraction: f64) -> Option<Candidate> {
    let depth = u.dot(centre);
    if depth <= 0.0 {
        return None;
    }
    let delta = depth * u - centre;
    Some(Candidate::at(depth, delta, fraction))
}

/// Which end of a limb a flat cap closes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cap {
    /// At p0.
    Start,
    /// At p1.
    End,
}

/// The ray against the plane of a flat cap: the distance of the hit from the cap's centre.
///
/// `None` if the ray runs in the plane or meets it behind the camera.
pub fn ray_cap(u: DVec3, p0: DVec3, p1: DVec3, cap: Cap) -> Option<Candidate> {
    let a = p1 - p0;
    let b = u.dot(a);
    if b * b <= PARALLEL_SIN_SQUARED * a.length_squared() {
        return None;
    }
    let centre = match cap {
        Cap::Start => p0,
        Cap::End => p1,
    };
    let depth = a.dot(centre) / b;
    if depth <= 0.0 {
        return None;
    }
    let h = depth * u - centre;
    let kappa = h.dot(u) / b;
    let (by_p0, by_p1) = match cap {
        Cap::Start => (2.0 * kappa * (a + h) - 2.0 * h, -2.0 * kappa * h),
        Cap::End => (2.0 * kappa * h, 2.0 * kappa * (a - h) - 2.0 * h),
    };
    Some(Candidate { squared: h.length_squared(), depth, by_p0, by_p1 })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn point(limit: f64) -> impl Strategy<Value = DVec3> {
        (-limit..limit, -limit..limit, 0.6..2.0f64).prop_map(|(x, y, z)| DVec3::new(x, y, z))
    }

    fn check(
        candidate: impl Fn(DVec3, DVec3) -> Option<Candidate>,
        p0: DVec3,
        p1: DVec3,
    ) -> Result<(), TestCaseError> {
        let Some(here) = candidate(p0, p1) else { return Ok(()) };
        let h = 1e-6;
        for e in [DVec3::X, DVec3::Y, DVec3::Z] {
            for (name, d0, d1, analytic) in
                [("p0", e, DVec3::ZERO, here.by_p0), ("p1", DVec3::ZERO, e, here.by_p1)]
            {
                let plus = candidate(p0 + d0 * h, p1 + d1 * h);
                let minus = candidate(p0 - d0 * h, p1 - d1 * h);
                if let (Some(plus), Some(minus)) = (plus, minus) {
                    let numeric = (plus.squared - minus.squared) / (2.0 * h);
                    let scale = 1.0 + here.squared + here.by_p0.length() + here.by_p1.length();
                    let error = (numeric - analytic.dot(e)).abs();
                    prop_assert!(error < 1e-5 * scale, "{name} {e}: {numeric} {analytic}");
                }
            }
        }
        Ok(())
    }

    proptest! {
        #[test]
        fn axis_derivatives(x in -0.4..0.4f64, y in -0.4..0.4f64, p0 in point(0.5), p1 in point(0.5)) {
            let u = DVec3::new(x, y, 1.0).normalize();
            check(|p0, p1| ray_axis(u, p0, p1), p0, p1)?;
        }

        #[test]
        fn sphere_derivatives(
            x in -0.4..0.4f64, y in -0.4..0.4f64, p0 in point(0.5), p1 in point(0.5), fraction in 0.0..1.0f64,
        ) {
            let u = DVec3::new(x, y, 1.0).normalize();
            check(|p0, p1| ray_point(u, p0.lerp(p1, fraction), fraction), p0, p1)?;
        }

        #[test]
        fn cap_derivatives(x in -0.4..0.4f64, y in -0.4..0.4f64, p0 in point(0.5), p1 in point(0.5)) {
            let u = DVec3::new(x, y, 1.0).normalize();
            // A plane seen edge-on has derivatives without bound: differences cannot tell there.
            prop_assume!((p1 - p0).length() > 0.05 && (u.dot(p1 - p0) / (p1 - p0).length()).abs() > 0.2);
            check(|p0, p1| ray_cap(u, p0, p1, Cap::Start), p0, p1)?;
            check(|p0, p1| ray_cap(u, p0, p1, Cap::End), p0, p1)?;
        }

        /// Appendix A by the letter: t and s differentiated too, their own motion included.
        #[test]
        fn axis_derivatives_the_long_way(x in -0.4..0.4f64, y in -0.4..0.4f64, p0 in point(0.5), p1 in point(0.5)) {
            let u = DVec3::new(x, y, 1.0).normalize();
            let Some(here) = ray_axis(u, p0, p1) else { return Ok(()) };
            let (a, w) = (p1 - p0, -p0);
            let (b, n) = (u.dot(a), (p1 - p0).length_squared() - u.dot(p1 - p0).powi(2));
            prop_assume!(n > 1e-3);
            let t = (a.dot(w) - u.dot(w) * b) / n;
            let delta = w + (t * b - u.dot(w)) * u - t * a;
            for e in [DVec3::X, DVec3::Y, DVec3::Z] {
                for (da, dw, analytic) in [(-e, -e, here.by_p0), (e, DVec3::ZERO, here.by_p1)] {
                    let db = u.dot(da);
                    let numerator = da.dot(w) + a.dot(dw) - u.dot(dw) * b - u.dot(w) * db;
                    let dt = (numerator - t * (2.0 * a.dot(da) - 2.0 * b * db)) / n;
                    let ds = dt * b + t * db - u.dot(dw);
                    let ddelta = dw + ds * u - dt * a - t * da;
                    prop_assert!((2.0 * delta.dot(ddelta) - analytic.dot(e)).abs() < 1e-9);
                }
            }
        }
    }

    #[test]
    fn candidates_behind_the_camera_or_parallel_do_not_exist() {
        let behind = DVec3::new(0.1, 0.0, -1.0);
        assert_eq!(ray_point(DVec3::Z, behind, 0.0), None);
        assert_eq!(ray_axis(DVec3::Z, behind, behind + DVec3::X * -0.3), None);
        assert_eq!(ray_axis(DVec3::Z, DVec3::new(0.1, 0.0, 1.0), DVec3::new(0.1, 0.0, 2.0)), None);
        assert_eq!(ray_cap(DVec3::Z, DVec3::new(0.1, 0.0, 1.0), DVec3::new(0.4, 0.0, 1.0), Cap::Start), None);
    }
}
