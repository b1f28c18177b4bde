//! How a frame is segmented.

use serde::{Deserialize, Serialize};

use super::dont_know::DontKnowOptions;
use super::luminance::ChromaOptions;
use super::shadow::ShadowOptions;
use super::subtraction::SegmentError;
use crate::silhouette::Region;

/// β: the z-score that some of three independent channels of normal noise exceeds, on either side, once in 10⁴ pixels. Each
/// has the share 1 − (1 − 10⁻⁴)^⅓ (Šidák); where their noise goes together, fewer pixels exceed it. One channel alone would have
/// the report's 3.891, and three of those three times as many false pixels.
pub const BETA: f32 = 4.149_4;
/// The report's β (4.25): the z-score that normal noise of one grey level exceeds once in 10⁴ pixels.
pub const BETA_GREY: f32 = 3.890_6;
/// The low threshold of the hysteresis that suits most footage, of the high one.
pub const HYSTERESIS: f32 = 0.6;
/// Longer than the side of any picture: growing a mask by more means nothing.
const MAX_DISTANCE_PX: f32 = 16_384.0;

/// How a frame is segmented. The defaults suit indoor footage of a few hundred pixels' height with JPEG noise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SegmentOptions {
    /// β: how many deviations a pixel must be off in some channel to be foreground.
    pub z_threshold: f32,
    /// The smallest deviation that is believed, grey levels: noise of compression and of a plate made from few frames.
    pub noise_floor: f32,
    /// Hysteresis: pixels off by this many deviations are foreground too if they touch, one after the other, such as exceed
    /// `z_threshold`. None, or no less than `z_threshold`, is one threshold.
    pub hysteresis_z: Option<f32>,
    /// Whether grey levels are compared (4.25), not the three channels.
    pub grey: bool,
    /// Luminance and chroma compared apart, not the three channels; none compares these. Where `grey` is set chroma is not looked at.
    pub chroma: Option<ChromaOptions>,
    /// Whether the frame's exposure may differ from the background's; then one gain per channel is found by a median.
    pub match_exposure: bool,
    /// Shadow test; none leaves shadows in the foreground. By default shadow weighs nothing.
    pub shadow: Option<ShadowOptions>,
    /// Opening by a square of (2n + 1)² pixels, against specks.
    pub opening_px: usize,
    /// Closing by a square of (2n + 1)² pixels, against gaps.
    pub closing_px: usize,
    /// The smallest component that is kept, pixels.
    pub min_component_px: usize,
    /// Components that meet when each is grown by this much form a group: a body may fall apart. Pixels.
    pub group_px: usize,
    /// The smallest group that is kept, as a fraction of the largest one's area (both grown by `group_px`).
    pub min_group_fraction: f32,
    /// The largest hole that is filled, pixels.
    pub fill_holes_px: usize,
    /// Don't-know test; none decides every pixel.
    pub dont_know: Option<DontKnowOptions>,
    /// Where the subject may be; all else is background.
    pub region: Option<Region>,
    /// Whether subject that no other camera [supports](crate::visual_hull::unsupported_parts) is unknown. [`segment`](super::segment)
    /// knows one camera only; `Footage` of the crate `formats` does it for all.
    pub needs_support: bool,
}

impl Default for SegmentOptions {
    fn default() -> Self {
        Self {
            z_threshold: BETA,
            noise_floor: 5.0,
            hysteresis_z: None,
            grey: false,
            chroma: None,
            match_exposure: true,
            shadow: Some(ShadowOptions::default()),
            opening_px: 1,
            closing_px: 2,
            min_component_px: 40,
            group_px: 4,
            min_group_fraction: 0.2,
            fill_holes_px: 30,
            dont_know: Some(DontKnowOptions::default()),
            region: None,
            needs_support: true,
        }
    }
}

impl SegmentOptions {
    /// (4.25) to the letter: grey levels, [`BETA_GREY`], every pixel subject or background, and nothing cleaned afterwards. σ is
    /// believed however small it is. A plate has none, and there the noise floor stands for it. The region stays.
    #[must_use]
    pub fn report(&self, is_plate: bool) -> Self {
        Self {
            z_threshold: BETA_GREY,
            noise_floor: if is_plate { self.noise_floor } else { 0.0 },
            hysteresis_z: None,
            grey: true,
            chroma: None,
            match_exposure: false,
            shadow: None,
            opening_px: 0,
            closing_px: 0,
            min_component_px: 0,
            group_px: 0,
            min_group_fraction: 0.0,
            fill_holes_px: 0,
            dont_know: None,
            region: self.region,
            needs_support: false,
        }
    }

    /// The same with every pixel decided: shadow is background, and dark before dark is what the threshold says. Other cameras are not asked.
    #[must_use]
    pub fn decided(&self) -> Self {
        let shadow = self.shadow.map(|shadow| ShadowOptions { unknown: false, ..shadow });
        Self { shadow, dont_know: None, needs_support: false, ..self.clone() }
    }

    /// Checks the numbers.
    ///
    /// # Errors
    /// The first option that is negative, not finite, or a distance longer than any picture.
    pub fn check(&self) -> Result<(), SegmentError> {
        let shadow = self.shadow.unwrap_or_default();
        let dont_know = self.dont_know.unwrap_or_default();
        let chroma = self.chroma.unwrap_or_default();
        type Allowed = (fn(f32) -> bool, &'static str);
        let number: Allowed = (|value| value.is_finite() && value >= 0.0, "a finite number, 0 or above");
        let distance: Allowed = (|px| px <= MAX_DISTANCE_PX, "pixels, no more than a picture has on a side");
        let options = [
            ("z_threshold", self.z_threshold, number),
            ("noise_floor", self.noise_floor, number),
            ("hysteresis_z", self.hysteresis_z.unwrap_or_default(), number),
            ("chroma.z_threshold", chroma.z_threshold, number),
            ("chroma.noise_floor", chroma.noise_floor, number),
            ("min_group_fraction", self.min_group_fraction, number),
            ("shadow.darkest", shadow.darkest, number),
            ("shadow.brightest", shadow.brightest, number),
            ("shadow.colour_tolerance", shadow.colour_tolerance, number),
            ("shadow.gradient_tolerance", shadow.gradient_tolerance, number),
            ("dont_know.dark_level", dont_know.dark_level, number),
            ("dont_know.sure_z", dont_know.sure_z, number),
            ("opening_px", self.opening_px as f32, distance),
            ("closing_px", self.closing_px as f32, distance),
            ("group_px", self.group_px as f32, distance),
            ("dont_know.grow_px", dont_know.grow_px as f32, distance),
        ];
        match options.into_iter().find(|(_, value, (is_allowed, _))| !is_allowed(*value)) {
            Some((option, value, (_, expected))) => {
                Err(SegmentError::InvalidOption { option, value, expected })
            }
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_read_with_defaults_and_without_guessing() {
        let options: SegmentOptions = toml::from_str("closing_px = 3\n[shadow]\ndarkest = 0.5").unwrap();
        assert_eq!((options.closing_px, options.opening_px), (3, SegmentOptions::default().opening_px));
        assert_eq!(options.shadow.unwrap().darkest, 0.5);
        assert!(toml::from_str::<SegmentOptions>("closing = 3").is_err());
    }
}
