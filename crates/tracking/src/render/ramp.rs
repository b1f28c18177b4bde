//! Ramps: from the distance d of a ray to a limb of radius r, to a grey level.
//!
//! | ramp | λ/255, clipped to 0 … 1 | dark inside | 50 % at | white outside |
//! |---|---|---|---|---|
//! | `thesis` (4.16) | d²/(2r²) − 1/8 | r/2 | 1.118 r | 3r/2 |
//! | `half` | d²/r² − 1/2 | 0.707 r | r | 1.225 r |
//! | `width` w | (d² − r²)/(4rw) + 1/2, w ≤ r/2 | | r | |
//! | `distance` wᵢ, wₒ | (d − r + wᵢ)/(wᵢ + wₒ), wᵢ ≤ 0.9 r | r − wᵢ | | r + wₒ |
//!
//! Widths are given in pixels and become metres at the limb's depth z (of its middle, along the optical
//! axis): w = px · z/f. That they follow the depth is part of the derivative.
//!
//! How a grey level changes with the limb's radius, the ray's distance held: ∂λ/∂r at fixed d².
//!
//! | ramp | ∂(λ/255)/∂r |
//! |---|---|
//! | `thesis`, and `width` as wide as it may be | −d²/r³ |
//! | `half` | −2 d²/r³ |
//! | `width` w | −(d²/r² + 1) / 4w |
//! | `distance` wᵢ, wₒ | −1 / (wᵢ + wₒ) |
//! | `distance`, wᵢ = c r as wide as it may be | −((1 − c) + c λ/255) / (c r + wₒ) |

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::primitive::Primitive;
use super::renderer::ParseError;

/// The background's grey level.
pub const BACKGROUND: f64 = 255.0;
/// Widest inner half of a `distance` ramp, as a fraction of the radius.
pub(super) const WIDEST_INNER: f64 = 0.9;
/// Widest `width` ramp, as a fraction of the radius: there the limb's axis is just black.
pub(super) const WIDEST_WIDTH: f64 = 0.5;
/// Widths of this many pixels and more are a mistake.
const WIDEST_PX: f64 = 1e6;
/// Widths never shrink below this many metres, so that a slope stays finite.
const NARROWEST: f64 = 1e-6;

/// How a distance becomes a grey level.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Ramp {
    /// The report's: α = 1/(2r²), β = −1/8.
    Thesis,
    /// α = 1/r², β = −1/2: half grey at the limb's surface.
    #[default]
    Half,
    /// Half grey at the surface, slope 1/(2w) there.
    Width {
        /// w in pixels.
        px: f64,
    },
    /// Linear in d, for data made from a distance transform with the same widths.
    Distance {
        /// Width inside the surface, pixels.
        inner_px: f64,
        /// Width outside, pixels.
        outer_px: f64,
    },
}

impl FromStr for Ramp {
    type Err = ParseError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let expected = "a ramp; expected thesis, half, width=PX or distance=INNER,OUTER (pixels above 0)";
        let error = || ParseError(text.to_owned(), expected.into());
        let pixels = |part: &str| part.trim().parse::<f64>().ok().ok_or_else(error);
        let ramp = match text.split_once('=') {
            None if text == "thesis" => Self::Thesis,
            None if text == "half" => Self::Half,
            Some(("width", px)) => Self::Width { px: pixels(px)? },
            Some(("distance", widths)) => {
                let (inner, outer) = widths.split_once(',').unwrap_or((widths, widths));
                Self::Distance { inner_px: pixels(inner)?, outer_px: pixels(outer)? }
            }
            _ => return Err(error()),
        };
        if ramp.is_valid() { Ok(ramp) } else { Err(error()) }
    }
}

impl fmt::Display for Ramp {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Thesis => write!(f, "thesis"),
            Self::Half => write!(f, "half"),
            Self::Width { px } => write!(f, "width={px}"),
            Self::Distance { inner_px, outer_px } => write!(f, "distance={inner_px},{outer_px}"),
        }
    }
}

/// A ramp for one solid: its radius and depth are known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SolidRamp {
    /// Its formula.
    pub form: RampForm,
    /// Metres beyond which λ is background.
    pub reach: f64,
}

/// A solid's ramp by its formula; `…_rate` is the derivative by the solid's depth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum RampForm {
    /// λ/255 = α d² + β.
    Quadratic { alpha: f64, beta: f64, alpha_rate: f64, beta_rate: f64 },
    /// λ/255 = (d − start) / width.
    Linear { start: f64, width: f64, start_rate: f64, width_rate: f64 },
}

impl RampForm {
    /// λ/255 = slope · m + offset, with m = d² or, where the third is true, m = d.
    #[inline]
    pub(crate) fn line(&self) -> (f32, f32, bool) {
        match *self {
            Self::Quadratic { alpha, beta, .. } => (alpha as f32, beta as f32, false),
            Self::Linear { start, width, .. } => ((1.0 / width) as f32, (-start / width) as f32, true),
        }
    }

    /// ∂λ/∂z = constant + slope · m, with m = d² for quadratic ramps and m = λ/255 for linear ones;
    /// `None` where the width is fixed.
    #[inline]
    pub(crate) fn depth_line(&self) -> Option<(f32, f32)> {
        let (constant, slope) = match *self {
            Self::Quadratic { alpha_rate, beta_rate, .. } => (beta_rate, alpha_rate),
            Self::Linear { width, start_rate, width_rate, .. } => (-start_rate / width, -width_rate / width),
        };
        (constant != 0.0 || slope != 0.0)
            .then_some(((BACKGROUND * constant) as f32, (BACKGROUND * slope) as f32))
    }
}

/// A grey level and how it changes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RampSample {
    /// λ, 0 to 255.
    pub level: f64,
    /// ∂λ/∂d², per m².
    pub by_squared: f64,
    /// ∂λ/∂z of the solid's depth, per metre; zero for ramps without a width in pixels.
    pub by_depth: f64,
}

impl Ramp {
    /// Whether its widths are finite and above zero.
    pub fn is_valid(self) -> bool {
        let is_width = |px: f64| px.is_finite() && px > 0.0 && px < WIDEST_PX;
        match self {
            Self::Thesis | Self::Half => true,
            Self::Width { px } => is_width(px),
            Self::Distance { inner_px, outer_px } => is_width(inner_px) && is_width(outer_px),
        }
    }

    /// The ramp for a solid of this radius (metres) whose middle is at depth z (metres), seen with a focal
    /// length in pixels.
    pub(crate) fn for_solid(self, radius: f64, depth: f64, focal_px: f64) -> SolidRamp {
        // Solids at or behind the camera plane take the width of one a radius away, held fixed.
        let (z, follows) = if depth > radius { (depth, 1.0) } else { (radius, 0.0) };
        let metres = |px: f64, widest: f64| {
            let width = px * z / focal_px;
            if width > widest {
                (widest, 0.0)
            } else if width < NARROWEST {
                (NARROWEST, 0.0)
            } else {
                (width, follows * px / focal_px)
            }
        };
        match self {
            Self::Thesis => SolidRamp::quadratic(0.5 / (radius * radius), -0.125, 0.0, 0.0),
            Self::Half => SolidRamp::quadratic(1.0 / (radius * radius), -0.5, 0.0, 0.0),
            Self::Width { px } => {
                let (w, rate) = metres(px, WIDEST_WIDTH * radius);
                let alpha = 0.25 / (radius * w);
                let beta = 0.5 - 0.25 * radius / w;
                SolidRamp::quadratic(alpha, beta, -alpha * rate / w, 0.25 * radius * rate / (w * w))
            }
            Self::Distance { inner_px, outer_px } => {
                let (inner, inner_rate) = metres(inner_px, WIDEST_INNER * radius);
                let (outer, outer_rate) = metres(outer_px, f64::INFINITY);
                let form = RampForm::Linear {
                    start: radius - inner,
                    width: inner + outer,
                    start_rate: -inner_rate,
                    width_rate: inner_rate + outer_rate,
                };
                SolidRamp { form, reach: radius + outer }
            }
        }
    }
}

impl SolidRamp {
    fn quadratic(alpha: f64, beta: f64, alpha_rate: f64, beta_rate: f64) -> Self {
        let form = RampForm::Quadratic { alpha, beta, alpha_rate, beta_rate };
        Self { form, reach: ((1.0 - beta) / alpha).sqrt() }
    }

    /// Metres within which λ is 0; `None` if it is nowhere.
    pub(crate) fn darkness(&self) -> Option<f64> {
        let within = match self.form {
            RampForm::Quadratic { alpha, beta, .. } => (-beta / alpha).max(0.0).sqrt(),
            RampForm::Linear { start, .. } => start,
        };
        (within > 0.0).then_some(within)
    }

    /// λ/255 before clipping: what is compared between solids. Infinite for no candidate.
    #[inline]
    pub(crate) fn unclipped(&self, squared: f64) -> f64 {
        match self.form {
            RampForm::Quadratic { alpha, beta, .. } => alpha * squared + beta,
            RampForm::Linear { start, width, .. } => (squared.sqrt() - start) / width,
        }
    }

    /// The grey level at d² with its derivatives, which are zero where the ramp is clipped.
    pub(crate) fn sample(&self, squared: f64) -> RampSample {
        let unclipped = self.unclipped(squared);
        if !(0.0..1.0).contains(&unclipped) || unclipped == 0.0 {
            let level = if unclipped > 0.0 { BACKGROUND } else { 0.0 };
            return RampSample { level, by_squared: 0.0, by_depth: 0.0 };
        }
        let (by_squared, by_depth) = match self.form {
            RampForm::Quadratic { alpha, alpha_rate, beta_rate, .. } => {
                (alpha, alpha_rate * squared + beta_rate)
            }
            RampForm::Linear { width, start_rate, width_rate, .. } => {
                (0.5 / (width * squared.sqrt()), -(start_rate + unclipped * width_rate) / width)
            }
        };
        RampSample {
            level: BACKGROUND * unclipped,
            by_squared: BACKGROUND * by_squared,
            by_depth: BACKGROUND * by_depth,
        }
    }
}

impl Ramp {
    /// ∂λ/∂r, grey levels per metre, of a solid of this radius and depth (metres) where the squared distance of the
    /// ray is given (m²). Zero where the ramp is clipped.
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
    pub(crate) fn radius_rate(&self, ramp: Ramp, focal_px: f64, squared: f64) -> f64 {
        let [p0, p1] = self.solid.joints;
        ramp.radius_rate(self.radius, 0.5 * (p0.z + p1.z), focal_px, squared)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::Failures;

    const RAMPS: [Ramp; 5] = [
        Ramp::Thesis,
        Ramp::Half,
        Ramp::Width { px: 3.0 },
        Ramp::Width { px: 300.0 },
        Ramp::Distance { inner_px: 6.0, outer_px: 9.0 },
    ];

    #[test]
    fn levels_are_those_of_the_table() {
        let level = |ramp: Ramp, d: f64| ramp.for_solid(0.06, 3.0, 400.0).sample(d * d).level;
        assert!(level(Ramp::Thesis, 0.0299) == 0.0 && level(Ramp::Thesis, 0.0901) == 255.0);
        for ramp in [Ramp::Half, Ramp::Width { px: 3.0 }, Ramp::Width { px: 300.0 }] {
            assert!((level(ramp, 0.06) - 127.5).abs() < 1e-9, "{ramp}");
        }
        // 3 px at 3 m and f = 400 px are 22.5 mm.
        let ramp = Ramp::Distance { inner_px: 3.0, outer_px: 3.0 };
        assert!((level(ramp, 0.06) - 127.5).abs() < 1e-9);
        assert!((level(ramp, 0.06 + 0.01125) - 191.25).abs() < 1e-9);
    }

    #[test]
    fn derivatives_match_differences() {
        let (r, f) = (0.06, 400.0);
        for ramp in RAMPS {
            for z in [0.03, 1.0, 3.0] {
                for d in [0.01, 0.035, 0.05, 0.06, 0.07, 0.085] {
                    let (squared, h) = (d * d, 1e-7);
                    let here = ramp.for_solid(r, z, f).sample(squared);
                    let at = |squared: f64, z: f64| ramp.for_solid(r, z, f).sample(squared).level;
                    let by_squared = (at(squared + h, z) - at(squared - h, z)) / (2.0 * h);
                    let by_depth = (at(squared, z + h) - at(squared, z - h)) / (2.0 * h);
                    for (numeric, analytic) in [(by_squared, here.by_squared), (by_depth, here.by_depth)] {
                        let off = (numeric - analytic).abs();
                        assert!(off < 1e-3 * (1.0 + numeric.abs()), "{ramp} {d} {z}");
                    }
                }
            }
        }
    }

    #[test]
    fn background_begins_at_the_reach() {
        for ramp in RAMPS {
            let ramp = ramp.for_solid(0.05, 2.5, 300.0);
            assert!((ramp.unclipped(ramp.reach * ramp.reach) - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn text_and_back() {
        for ramp in RAMPS {
            assert_eq!(ramp.to_string().parse(), Ok(ramp));
        }
        assert!("width=-1".parse::<Ramp>().unwrap_err().to_string().contains("expected thesis"));
    }

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
        let mut failures = Failures::default();
        let mut compared = 0;
        for ramp in ramps {
            for depth in [1.0, 3.0] {
                for d in [0.001, 0.01, 0.035, 0.05, 0.06, 0.07, 0.085] {
                    let level = |r: f64| ramp.for_solid(r, depth, focal).sample(d * d).level;
                    let numeric = (level(radius + h) - level(radius - h)) / (2.0 * h);
                    let analytic = ramp.radius_rate(radius, depth, focal, d * d);
                    compared += usize::from(analytic != 0.0);
                    let what = format_args!("{ramp}, z {depth}, d {d}");
                    failures.near(what, analytic, numeric, 1e-4 * (1.0 + numeric.abs()));
                }
            }
        }
        assert!(compared > 30, "{compared}");
    }
}
