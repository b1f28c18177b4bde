//! Luminance and chroma of a colour, compared apart: a shadow changes the light that falls on a thing, not its colour.
//!
//! Of a difference (r, g, b) of two colours (JFIF, BT.601; blue and red chroma)
//!
//! ```text
//! Y = 0.299 r + 0.587 g + 0.114 b     Cb = −0.169 r − 0.331 g + 0.5 b     Cr = 0.5 r − 0.419 g − 0.081 b
//! ```
//!
//! Each is off where it exceeds its threshold times its deviation, which is no smaller than its floor. The deviation of chroma is that
//! of three independent channels, the root of Σ k² σ² with the factors k above; luminance has the deviation that was measured of the
//! grey picture.

use serde::{Deserialize, Serialize};

use super::options::BETA;

const BLUE: [f32; 3] = [-0.168_736, -0.331_264, 0.5];
const RED: [f32; 3] = [0.5, -0.418_688, -0.081_312];

/// How chroma is compared where it is looked at apart from luminance, which has the segmentation's own threshold.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ChromaOptions {
    /// How many deviations a pixel's chroma must be off to be foreground.
    pub z_threshold: f32,
    /// The smallest deviation of chroma that is believed, grey levels.
    pub noise_floor: f32,
}

impl Default for ChromaOptions {
    fn default() -> Self {
        Self { z_threshold: BETA, noise_floor: 2.5 }
    }
}

/// The test of chroma.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chroma {
    pub(super) z: f32,
    pub(super) noise_floor: f32,
}

impl Chroma {
    pub(super) fn new(options: &ChromaOptions) -> Self {
        Self { z: options.z_threshold, noise_floor: options.noise_floor }
    }

    /// Whether the chroma of a difference is off, where the channels have these deviations.
    pub(super) fn is_off(&self, off: [f32; 3], deviation: [f32; 3]) -> bool {
        [BLUE, RED].iter().any(|weights| dot(*weights, off).abs() > self.limit(*weights, deviation))
    }

    /// By how many thresholds it is off.
    pub(super) fn excess(&self, off: [f32; 3], deviation: [f32; 3]) -> f32 {
        let over = |weights: [f32; 3]| dot(weights, off).abs() / self.limit(weights, deviation);
        over(BLUE).max(over(RED))
    }

    fn limit(&self, weights: [f32; 3], deviation: [f32; 3]) -> f32 {
        let variance = dot(weights.map(|k| k * k), deviation.map(|sigma| sigma * sigma));
        self.z * variance.sqrt().max(self.noise_floor)
    }
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Brightness as the eye weighs it (BT.601).
pub(super) fn luma([red, green, blue]: [f32; 3]) -> f32 {
    0.299 * red + 0.587 * green + 0.114 * blue
}
