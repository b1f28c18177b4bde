//! How a grey level changes with the limb's radius, the ray's distance held: ∂λ/∂r at fixed d².
//!
//! | ramp | ∂(λ/255)/∂r |
//! |---|---|
//! | `thesis`, and `width` as wide as it may be | −d²/r³ |
//! | `half` | −2 d²/r³ |
//! | `width` w | −(d²/r² + 1) / 4w |
//! | `distance` wᵢ, wₒ | −1 / (wᵢ + wₒ) |
//! | `distance`, wᵢ = c r as wide as it may be | −((1 − c) + c λ/255) / (c r + wₒ) |
//!
//! Widths in pixels become metres as in [`ramp`](super::ramp).

use super::primitive::{Primitive, Solid};
use super::ramp::{BACKGROUND, Ramp, WIDEST_INNER, WIDEST_WIDTH};

impl Ramp {
    /// ∂λ/∂r, grey levels per metre, of a solid of this radius and depth (metres) where the squared distance of the
    /// ray is given (m²). Zero where the ramp is clipped.
    #[must_use]
    pub(crate) fn radius_rate(self, radius: f64, depth: f64, focal_px: f64, squared: f64) -> f64 {
        let solid = self.for_solid(radius, depth, focal_px);
        let level = solid.unclipped(squared);
        if !(level > 0.0 && level < 1.0) {
            return 0.0;
        }
        // As wide as for_solid makes them.
        let z = if depth > radius { depth } else { radius };
        let metres = |px: f64| px * z / focal_px;
        let share = squared / (radius * radius);
        let rate = match self {
            Self::Thesis => -share / radius,
            Self::Half => -2.0 * share / radius,
            Self::Width { px } if metres(px) > WIDEST_WIDTH * radius => -share / radius,
            Self::Width { px } => -(share + 1.0) / (4.0 * metres(px)),
            Self::Distance { inner_px, outer_px } => {
                let (inner, outer) = (metres(inner_px), metres(outer_px));
                if inner > WIDEST_INNER * radius {
                    -((1.0 - WIDEST_INNER) + WIDEST_INNER * level) / (WIDEST_INNER * radius + outer)
                } else {
                    -1.0 / (inner + outer)
                }
            }
        };
        BACKGROUND * rate
    }
}

impl Primitive {
    /// ∂λ/∂r of this solid, grey levels per metre, where a ray's squared distance is given (m²).
    #[must_use]
    pub(crate) fn radius_rate(&self, ramp: Ramp, focal_px: f64, squared: f64) -> f64 {
        let (Solid::Capsule { p0, p1 }
        | Solid::Cylinder { p0, p1 }
        | Solid::Spheres { p0, p1, .. }
        | Solid::Sphere { p0, p1, .. }) = self.solid;
        ramp.radius_rate(self.radius, 0.5 * (p0.z + p1.z), focal_px, squared)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_match_differences() {
        let ramps = [
            Ramp::Thesis,
            Ramp::Half,
            Ramp::Width { px: 3.0 },
            Ramp::Width { px: 300.0 },
            Ramp::Distance { inner_px: 1.5, outer_px: 9.0 },
            Ramp::Distance { inner_px: 60.0, outer_px: 9.0 },
        ];
        let (radius, focal, h) = (0.06, 400.0, 1e-7);
        let mut failures = Vec::new();
        let mut compared = 0;
        for ramp in ramps {
            for depth in [1.0, 3.0] {
                for d in [0.001, 0.01, 0.035, 0.05, 0.06, 0.07, 0.085] {
                    let level = |r: f64| ramp.for_solid(r, depth, focal).sample(d * d).level;
                    let numeric = (level(radius + h) - level(radius - h)) / (2.0 * h);
                    let analytic = ramp.radius_rate(radius, depth, focal, d * d);
                    compared += usize::from(analytic != 0.0);
                    if (numeric - analytic).abs() > 1e-4 * (1.0 + numeric.abs()) {
                        failures.push(format!("{ramp}, z {depth}, d {d}: {numeric} {analytic}"));
                    }
                }
            }
        }
        assert!(compared > 30, "{compared}");
        assert!(failures.is_empty(), "{}", failures.join("\n"));
    }
}
