//! Background subtraction: a frame and a background in, a mask out.
//!
//! A pixel is foreground if |i − g µ| > β max(σ, floor) in some channel, with g that channel's gain of a changed exposure.
//! The largest of the three z-scores decides, not their sum: noise is then judged channel by channel, and a difference in
//! one colour alone (skin before wood) is not diluted by the others.

use std::sync::Arc;

use image::RgbImage;
use serde::{Deserialize, Serialize};

use super::background::Background;
use super::dont_know::{DontKnowOptions, dark_places};
use super::shadow::{ShadowOptions, clear_shadows};
use super::threshold::{Limits, Threshold};
use super::{components, exposure};
use crate::silhouette::{Label, Mask, MaskError, Region};

/// The z-score that normal noise exceeds, on either side, once in 10⁴ pixels.
pub const BETA: f32 = 3.891;
/// Longer than the side of any picture: growing a mask by more means nothing.
const MAX_DISTANCE_PX: usize = 16_384;

/// Why a frame could not be segmented.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SegmentError {
    /// The frame and the background differ in size.
    #[error("the frame has {}×{} pixels, the background {}×{}", frame.0, frame.1, background.0, background.1)]
    SizeMismatch {
        /// Width and height of the frame.
        frame: (usize, usize),
        /// Width and height of the background.
        background: (usize, usize),
    },
    /// An option is negative, infinite or not a number.
    #[error("segmentation option `{option}` cannot be {value}")]
    InvalidOption {
        /// The name of the option.
        option: &'static str,
        /// Its value.
        value: f32,
    },
    /// The frame has no pixels or too many.
    #[error(transparent)]
    Mask(#[from] MaskError),
}

/// How a frame is segmented. The defaults suit indoor footage of a few hundred pixels' height with JPEG noise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SegmentOptions {
    /// β: how many deviations a pixel must be off to be foreground.
    pub z_threshold: f32,
    /// The smallest deviation that is believed, grey levels: noise of compression and of a plate made from few frames.
    pub noise_floor: f32,
    /// Whether the frame's exposure may differ from the background's; then one gain per channel is found by a median.
    pub match_exposure: bool,
    /// Shadow test; none leaves shadows in the foreground.
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
}

impl Default for SegmentOptions {
    fn default() -> Self {
        Self {
            z_threshold: BETA,
            noise_floor: 5.0,
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
        }
    }
}

impl SegmentOptions {
    /// Checks the numbers.
    ///
    /// # Errors
    ///
    /// The first option that is negative, not finite, or a distance longer than any picture.
    pub fn check(&self) -> Result<(), SegmentError> {
        let shadow = self.shadow.unwrap_or_default();
        let dont_know = self.dont_know.unwrap_or_default();
        let numbers = [
            ("z_threshold", self.z_threshold),
            ("noise_floor", self.noise_floor),
            ("min_group_fraction", self.min_group_fraction),
            ("shadow.darkest", shadow.darkest),
            ("shadow.brightest", shadow.brightest),
            ("shadow.colour_tolerance", shadow.colour_tolerance),
            ("shadow.gradient_tolerance", shadow.gradient_tolerance),
            ("dont_know.dark_level", dont_know.dark_level),
            ("dont_know.sure_z", dont_know.sure_z),
        ];
        let distances = [
            ("opening_px", self.opening_px),
            ("closing_px", self.closing_px),
            ("group_px", self.group_px),
            ("dont_know.grow_px", dont_know.grow_px),
        ];
        let bad_number = numbers.into_iter().find(|(_, value)| !(value.is_finite() && *value >= 0.0));
        let bad_distance = distances.into_iter().find(|(_, px)| *px > MAX_DISTANCE_PX);
        match bad_number.or(bad_distance.map(|(option, px)| (option, px as f32))) {
            Some((option, value)) => Err(SegmentError::InvalidOption { option, value }),
            None => Ok(()),
        }
    }
}

/// Finds the subject in a frame. For many frames of one camera [`Segmenter`] does the same.
///
/// # Errors
///
/// If the frame and the background differ in size, if an option is not a usable number, or if the frame has no pixels or
/// more than [`MAX_PIXELS`](crate::silhouette::MAX_PIXELS).
pub fn segment(
    frame: &RgbImage,
    background: &Background,
    options: &SegmentOptions,
) -> Result<Mask, SegmentError> {
    options.check()?;
    find_subject(frame, background, options, None)
}

/// A background and options, made ready for many frames.
///
/// Where the exposure is not matched ([`SegmentOptions::match_exposure`]), the levels that are background are the same in
/// every frame, and are worked out once. The masks are those of [`segment`], to the bit.
#[derive(Clone, Debug)]
pub struct Segmenter {
    background: Arc<Background>,
    options: SegmentOptions,
    limits: Option<Limits>,
}

impl Segmenter {
    /// Makes a background ready.
    ///
    /// # Errors
    ///
    /// If an option is not a usable number.
    pub fn new(background: Arc<Background>, options: SegmentOptions) -> Result<Self, SegmentError> {
        options.check()?;
        let fixed = !options.match_exposure;
        let limits = fixed.then(|| Limits::new(&background, options.z_threshold, options.noise_floor));
        Ok(Self { background, options, limits })
    }

    /// Finds the subject in a frame.
    ///
    /// # Errors
    ///
    /// If the frame and the background differ in size, or if the frame has no pixels or more than
    /// [`MAX_PIXELS`](crate::silhouette::MAX_PIXELS).
    pub fn segment(&self, frame: &RgbImage) -> Result<Mask, SegmentError> {
        find_subject(frame, &self.background, &self.options, self.limits.as_ref())
    }
}

/// [`segment`] with options that were checked, and with limits that were made from them or without.
fn find_subject(
    frame: &RgbImage,
    background: &Background,
    options: &SegmentOptions,
    limits: Option<&Limits>,
) -> Result<Mask, SegmentError> {
    let (width, height) = (frame.width() as usize, frame.height() as usize);
    if (width, height) != (background.width(), background.height()) {
        let background = (background.width(), background.height());
        return Err(SegmentError::SizeMismatch { frame: (width, height), background });
    }
    let mut mask = Mask::filled(width, height, Label::Background)?;
    let gains = if options.match_exposure { exposure::gains(frame, background) } else { [1.0; 3] };
    let threshold = Threshold { gains, z: options.z_threshold, noise_floor: options.noise_floor };

    let mut subject = match limits {
        Some(limits) => limits.foreground(frame),
        None => threshold.foreground(frame, background),
    };
    if let Some(region) = options.region {
        subject.retain(|x, y| region.contains(x, y));
    }
    if let Some(shadow) = &options.shadow {
        let (labels, label) = (mask.labels_mut(), shadow.label());
        clear_shadows(&mut subject, frame, background, gains, shadow, |index| labels[index] = label);
    }
    subject.open_and_close(options.opening_px, options.closing_px);
    if options.min_component_px > 1 {
        components::drop_small(&mut subject, options.min_component_px, 0.0);
    }
    if options.min_group_fraction > 0.0 {
        let mut groups = subject.clone();
        groups.dilate(options.group_px);
        components::drop_small(&mut groups, 0, options.min_group_fraction);
        subject.intersect(&groups);
    }
    if options.fill_holes_px > 0 {
        components::fill_holes(&mut subject, options.fill_holes_px);
    }

    for (y, row) in mask.labels_mut().chunks_exact_mut(width).enumerate() {
        subject.runs(y, true).for_each(|run| row[run].fill(Label::Subject));
    }
    if let Some(dont_know) = &options.dont_know {
        let surely = Threshold { z: dont_know.sure_z, ..threshold };
        let mut dark = dark_places(frame, background, gains, dont_know);
        dark.retain(|x, y| !(subject.get(x, y) && surely.is_off(frame, background, y * width + x)));
        for (y, row) in mask.labels_mut().chunks_exact_mut(width).enumerate() {
            dark.runs(y, true).for_each(|run| row[run].fill(Label::Unknown));
        }
    }
    if let Some(region) = options.region {
        for (index, label) in mask.labels_mut().iter_mut().enumerate() {
            if !region.contains(index % width, index / width) {
                *label = Label::Background;
            }
        }
    }
    Ok(mask)
}

#[cfg(test)]
mod tests {
    use image::Rgb;

    use super::*;

    const WALL: Rgb<u8> = Rgb([120, 130, 110]);

    /// A wall, and before it what an ASCII image says: `#` a red subject, `s` a shadow, `d` dark clothes.
    fn scene(text: &str) -> RgbImage {
        let rows: Vec<&[u8]> = text.split_whitespace().map(str::as_bytes).collect();
        RgbImage::from_fn(rows[0].len() as u32, rows.len() as u32, |x, y| {
            match rows[y as usize][x as usize] {
                b'#' => Rgb([200, 90, 80]),
                b's' => Rgb(WALL.0.map(|level| (f32::from(level) * 0.75).round() as u8)),
                b'd' => Rgb([20, 22, 18]),
                _ => WALL,
            }
        })
    }

    /// No cleaning, so that each test sees the effect of what it switches on.
    fn plain() -> SegmentOptions {
        SegmentOptions {
            match_exposure: false,
            shadow: None,
            opening_px: 0,
            closing_px: 0,
            min_component_px: 0,
            group_px: 0,
            min_group_fraction: 0.0,
            fill_holes_px: 0,
            dont_know: None,
            ..SegmentOptions::default()
        }
    }

    fn assert_mask(frame: &RgbImage, plate: &RgbImage, options: &SegmentOptions, expected: &str) {
        let mask = segment(frame, &Background::from_plate(plate), options).unwrap();
        let expected = Mask::from_ascii(expected).unwrap();
        assert_eq!(mask, expected, "found\n{mask}instead of\n{expected}");
    }

    fn wall() -> RgbImage {
        RgbImage::from_pixel(8, 4, WALL)
    }

    #[test]
    fn what_differs_is_subject() {
        let plate = RgbImage::from_pixel(9, 6, WALL);
        let frame = scene("......... ......... ..#.#.... ..#.#...# ......... .........");
        let raw = ".........\n.........\n..#.#....\n..#.#...#\n.........\n.........";
        assert_mask(&frame, &plate, &plain(), raw);
        let cleaned = SegmentOptions { closing_px: 1, min_component_px: 2, ..plain() };
        let expected = ".........\n.........\n..###....\n..###....\n.........\n.........";
        assert_mask(&frame, &plate, &cleaned, expected);
    }

    #[test]
    fn noise_within_the_deviation_is_background() {
        let frames = [100, 140].map(|level| RgbImage::from_pixel(8, 4, Rgb([level; 3])));
        let background = Background::from_frames(&frames).unwrap();
        // µ = 120, σ = 28.3, βσ = 110.
        for (level, expected) in [(229, 0), (231, 32)] {
            let frame = RgbImage::from_pixel(8, 4, Rgb([120, level, 120]));
            let mask = segment(&frame, &background, &plain()).unwrap();
            assert_eq!(mask.count(Label::Subject), expected, "at level {level}");
        }
    }

    #[test]
    fn small_groups_go_and_parts_of_a_body_stay() {
        let frame = scene("###....... ###....... .......... #.......## ..........");
        let plate = RgbImage::from_pixel(10, 5, WALL);
        let options = SegmentOptions { group_px: 1, min_group_fraction: 0.7, ..plain() };
        assert_mask(&frame, &plate, &options, "###.......\n###.......\n..........\n#.........\n..........");
    }

    #[test]
    fn shadow_is_background_or_unknown() {
        let frame = scene("........ .##ssss. .##ssss. ........");
        for (unknown, character) in [(false, "."), (true, "?")] {
            let shadow = Some(ShadowOptions { unknown, gradient_tolerance: 1e3, ..ShadowOptions::default() });
            let expected = "........\n.##ssss.\n.##ssss.\n........".replace('s', character);
            assert_mask(&frame, &wall(), &SegmentOptions { shadow, ..plain() }, &expected);
        }
    }

    #[test]
    fn dark_on_dark_is_unknown() {
        let plate = scene("dddd.... dddd.... dddd.... dddd....");
        let frame = scene("dddd.... dddd.... dddd##.. dddddd..");
        let dont_know = Some(DontKnowOptions { grow_px: 1, ..DontKnowOptions::default() });
        let options = SegmentOptions { dont_know, ..plain() };
        assert_mask(&frame, &plate, &options, "?????...\n?????...\n????##..\n????##..");
    }

    #[test]
    fn another_exposure_is_not_a_subject() {
        let plate = RgbImage::from_fn(40, 40, |x, y| Rgb([100 + x as u8, 100 + y as u8, 140]));
        let mut frame = plate.clone();
        frame
            .pixels_mut()
            .for_each(|pixel| *pixel = Rgb(pixel.0.map(|level| (f32::from(level) * 1.2) as u8)));
        let background = Background::from_plate(&plate);
        for (match_exposure, expected) in [(true, 0), (false, 1600)] {
            let mask = segment(&frame, &background, &SegmentOptions { match_exposure, ..plain() }).unwrap();
            assert_eq!(mask.count(Label::Subject), expected, "match_exposure = {match_exposure}");
        }
    }

    #[test]
    fn outside_the_region_is_background() {
        let frame = scene("######## ######## ######## ########");
        let region = Some(Region { x: 1, y: 1, width: 3, height: 9 });
        let options = SegmentOptions { region, ..plain() };
        assert_mask(&frame, &wall(), &options, "........\n.###....\n.###....\n.###....");
    }

    #[test]
    fn unusable_input_is_an_error() {
        let background = Background::from_plate(&wall());
        let result = segment(&RgbImage::new(8, 5), &background, &plain());
        assert_eq!(result, Err(SegmentError::SizeMismatch { frame: (8, 5), background: (8, 4) }));
        let options = SegmentOptions { noise_floor: f32::NAN, ..plain() };
        let result = segment(&wall(), &background, &options);
        assert!(matches!(result, Err(SegmentError::InvalidOption { option: "noise_floor", .. })));
        let none = RgbImage::new(0, 0);
        let result = segment(&none, &Background::from_plate(&none), &plain());
        assert!(matches!(result, Err(SegmentError::Mask(MaskError::Empty { .. }))));
    }

    #[test]
    fn options_are_read_with_defaults_and_without_guessing() {
        let options: SegmentOptions = toml::from_str("closing_px = 3\n[shadow]\ndarkest = 0.5").unwrap();
        assert_eq!((options.closing_px, options.opening_px), (3, SegmentOptions::default().opening_px));
        assert_eq!(options.shadow.unwrap().darkest, 0.5);
        assert!(toml::from_str::<SegmentOptions>("closing = 3").is_err());
    }
}
