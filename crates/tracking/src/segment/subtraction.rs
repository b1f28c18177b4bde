//! Background subtraction: a frame and a background in, a mask out.
//!
//! A pixel is foreground if |i − g µ| > β max(σ, floor) in some channel, with g that channel's gain of a changed exposure.
//! The largest of the three z-scores decides, not their sum: noise is then judged channel by channel, and a difference in
//! one colour alone (skin before wood) is not diluted by the others.

use image::RgbImage;

use super::background::Background;
use super::bit_image::BitImage;
use super::dont_know::dark_places;
use super::luminance::Chroma;
use super::options::SegmentOptions;
use super::shadow::{ShadowTest, clear_shadows};
use super::stages::{Stage, Step};
use super::threshold::Threshold;
use super::{components, exposure};
use crate::numbers::Brief;
use crate::silhouette::{Label, Mask, MaskError};

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
    /// An option is negative, infinite or not a number, or a distance longer than any picture.
    #[error("`{option}` is {}; expected {expected}", Brief(*.value))]
    InvalidOption {
        /// The name of the option.
        option: &'static str,
        /// Its value.
        value: f32,
        /// What it may be.
        expected: &'static str,
    },
    /// (6.12) asks for the deviation of the background's gradient, and there is but one plate.
    #[error(
        "the shadow test by gradient (6.12) needs a background of several pictures: one plate has no deviation; expected more \
         pictures, or the test by brightness"
    )]
    NoDeviation,
    /// The frame has no pixels or too many.
    #[error(transparent)]
    Mask(#[from] MaskError),
}

/// Finds the subject in a frame.
///
/// # Errors
/// If the frame and the background differ in size, if an option is not a usable number, or if the frame has no pixels or
/// more than [`MAX_PIXELS`](crate::silhouette::MAX_PIXELS); if shadows are told by gradient and the background is one plate.
pub fn segment(
    frame: &RgbImage,
    background: &Background,
    options: &SegmentOptions,
) -> Result<Mask, SegmentError> {
    run(frame, background, options, &mut |_| {})
}

/// The same; `watch` is told of every step.
pub(super) fn run(
    frame: &RgbImage,
    background: &Background,
    options: &SegmentOptions,
    watch: &mut dyn FnMut(Step<'_>),
) -> Result<Mask, SegmentError> {
    options.check()?;
    let (width, height) = (frame.width() as usize, frame.height() as usize);
    if (width, height) != (background.width(), background.height()) {
        let background = (background.width(), background.height());
        return Err(SegmentError::SizeMismatch { frame: (width, height), background });
    }
    if background.is_plate() && options.shadow.is_some_and(|shadow| shadow.test == ShadowTest::Gradient) {
        return Err(SegmentError::NoDeviation);
    }
    let mut mask = Mask::filled(width, height, Label::Background)?;
    let gains = if options.match_exposure { exposure::gains(frame, background) } else { [1.0; 3] };
    let SegmentOptions { z_threshold: z, noise_floor, grey, .. } = *options;
    let threshold =
        Threshold { gains, z, noise_floor, grey, chroma: options.chroma.as_ref().map(Chroma::new) };

    watch(Step::Compared(&|| threshold.excess(frame, background)));
    let mut subject = threshold.foreground(frame, background);
    watch(Step::Subject(Stage::Threshold, &subject));
    if let Some(low) = options.hysteresis_z.filter(|low| *low < z) {
        let mut weak = threshold.with_z(low).foreground(frame, background);
        components::keep_touching(&mut weak, &subject);
        subject = weak;
        watch(Step::Subject(Stage::Hysteresis, &subject));
    }
    if let Some(region) = options.region {
        subject.retain(|x, y| region.contains(x, y));
    }
    if let Some(unknown) = background.unknown() {
        subject.subtract(unknown);
    }
    if options.region.is_some() || background.unknown().is_some() {
        watch(Step::Subject(Stage::Region, &subject));
    }
    let shadow = options.shadow.as_ref().map(|options| {
        let shadow = clear_shadows(&mut subject, frame, background, &threshold, options);
        watch(Step::Subject(Stage::Shadow, &subject));
        (shadow, options.label())
    });
    clean(&mut subject, background, options, watch);

    paint(&mut mask, &subject, Label::Subject);
    let dark = options.dont_know.as_ref().map(|dont_know| {
        let surely = threshold.with_z(dont_know.sure_z);
        let mut dark = dark_places(frame, background, gains, dont_know);
        dark.retain(|x, y| !(subject.get(x, y) && surely.is_off(frame, background, y * width + x)));
        paint(&mut mask, &dark, Label::Unknown);
        dark
    });
    if let Some((mut shadow, label)) = shadow {
        // What was closed or filled is subject all the same.
        shadow.subtract(&subject);
        dark.iter().for_each(|dark| shadow.subtract(dark));
        paint(&mut mask, &shadow, label);
        for y in 0..height {
            shadow.runs(y, true).flatten().for_each(|x| mask.mark_shadow(y * width + x));
        }
    }
    if let Some(unknown) = background.unknown() {
        let mut unknown = unknown.clone();
        unknown.subtract(&subject);
        paint(&mut mask, &unknown, Label::Unknown);
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

/// Takes specks out, fills gaps and holes, and drops what is too small.
fn clean(
    subject: &mut BitImage,
    background: &Background,
    options: &SegmentOptions,
    watch: &mut dyn FnMut(Step<'_>),
) {
    subject.open_and_close(options.opening_px, options.closing_px);
    watch(Step::Subject(Stage::Morphology, subject));
    if options.min_component_px > 1 {
        components::drop_small(subject, options.min_component_px, 0.0);
    }
    if options.min_group_fraction > 0.0 {
        let mut groups = subject.clone();
        // A body may hide its own middle from the background: its parts belong together all the same.
        if let Some(unknown) = background.unknown() {
            groups.add(unknown);
        }
        groups.dilate(options.group_px);
        components::drop_small(&mut groups, 0, options.min_group_fraction);
        subject.intersect(&groups);
    }
    watch(Step::Subject(Stage::Components, subject));
    if options.fill_holes_px > 0 {
        components::fill_holes(subject, options.fill_holes_px);
        watch(Step::Subject(Stage::Holes, subject));
    }
}

/// A mask of background, and this label where pixels are set.
pub(super) fn labels_of(pixels: &BitImage, label: Label) -> Result<Mask, MaskError> {
    let mut mask = Mask::filled(pixels.width, pixels.height, Label::Background)?;
    paint(&mut mask, pixels, label);
    Ok(mask)
}

/// Labels the pixels that are set.
fn paint(mask: &mut Mask, pixels: &BitImage, label: Label) {
    let width = mask.width();
    for (y, row) in mask.labels_mut().chunks_exact_mut(width).enumerate() {
        pixels.runs(y, true).for_each(|run| row[run].fill(label));
    }
}

#[cfg(test)]
mod tests {
    use image::Rgb;
    use rand::RngExt;
    use rand_pcg::Pcg64Mcg;
    use rand_pcg::rand_core::SeedableRng;

    use super::*;
    use crate::segment::{BETA, BETA_GREY, ChromaOptions, DontKnowOptions, ShadowOptions};
    use crate::silhouette::Region;

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
        let mask = segment(frame, &Background::from_frames([plate, plate]).unwrap(), options).unwrap();
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
        // µ = 120, σ = 28.3, βσ = 117.4.
        for (level, expected) in [(237, 0), (238, 32)] {
            let frame = RgbImage::from_pixel(8, 4, Rgb([120, level, 120]));
            let mask = segment(&frame, &background, &plain()).unwrap();
            assert_eq!(mask.count(Label::Subject), expected, "at level {level}");
        }
    }

    /// β promises one pixel in 10⁴, whichever channel is off. Levels are whole numbers, so σ puts the limit between two of them.
    #[test]
    fn one_pixel_of_noise_in_ten_thousand_is_subject() {
        let deviation = 42.5 / BETA;
        let mut random = Pcg64Mcg::seed_from_u64(6);
        let background = Background::from_plate(&RgbImage::from_pixel(1000, 1000, Rgb([128; 3])));
        let mut frame = RgbImage::new(1000, 1000);
        for pair in frame.as_mut().chunks_mut(2) {
            let [u, v]: [f32; 2] = [random.random(), random.random()];
            let (radius, turn) = ((-2.0 * (1.0 - u).ln()).sqrt(), std::f32::consts::TAU * v);
            for (level, normal) in pair.iter_mut().zip([radius * turn.cos(), radius * turn.sin()]) {
                *level = (128.0 + deviation * normal).round() as u8;
            }
        }
        let options = SegmentOptions { noise_floor: deviation, ..plain() };
        let found = segment(&frame, &background, &options).unwrap().count(Label::Subject);
        // A hundred, give or take four deviations.
        assert!(found.abs_diff(100) <= 40, "{found} of a million");
    }

    /// (4.25) knows brightness alone: of a red as bright as the wall it sees nothing, and one pixel of noise in 10⁴ is subject.
    #[test]
    fn the_reports_measurement_is_grey_and_has_two_classes() {
        let frames = [100, 110].map(|level| RgbImage::from_pixel(4, 1, Rgb([level; 3])));
        let background = Background::from_frames(&frames).unwrap();
        // µ = 105, σ = 7.07: β σ = 27.5. The red is as bright as µ.
        let mut frame = RgbImage::from_pixel(4, 1, Rgb([105; 3]));
        frame.put_pixel(0, 0, Rgb([132; 3]));
        frame.put_pixel(1, 0, Rgb([133; 3]));
        frame.put_pixel(2, 0, Rgb([200, 65, 60]));
        let literal = SegmentOptions::default().report(false);
        assert!(
            (literal.z_threshold, literal.noise_floor) == (BETA_GREY, 0.0)
                && (BETA_GREY - 3.891).abs() < 1e-3
        );
        assert_eq!(segment(&frame, &background, &literal).unwrap(), Mask::from_ascii(".#..").unwrap());
        let coloured = SegmentOptions { grey: false, ..literal };
        assert_eq!(segment(&frame, &background, &coloured).unwrap(), Mask::from_ascii(".##.").unwrap());
        // Dark before dark is decided, and a plate keeps the noise floor.
        let (plate, frame) = (scene("dddd...."), scene("ddd#...."));
        let literal = SegmentOptions::default().report(true);
        assert_eq!(literal.noise_floor, SegmentOptions::default().noise_floor);
        let mask = segment(&frame, &Background::from_plate(&plate), &literal).unwrap();
        assert_eq!(mask, Mask::from_ascii("...#....").unwrap());
    }

    /// Pixels off by 30 levels are faint, those of `#` are not.
    #[test]
    fn what_is_faint_is_subject_where_it_touches_what_is_not() {
        let text = "##ff.... ...ff.f. ........ ff......";
        let mut frame = scene(text);
        for (pixel, what) in frame.pixels_mut().zip(text.bytes().filter(|byte| *byte != b' ')) {
            if what == b'f' {
                *pixel = Rgb([WALL.0[0] + 30, WALL.0[1], WALL.0[2]]);
            }
        }
        let strict = SegmentOptions { z_threshold: 8.0, ..plain() };
        assert_mask(&frame, &wall(), &strict, "##......\n........\n........\n........");
        let followed = SegmentOptions { hysteresis_z: Some(5.0), ..strict };
        assert_mask(&frame, &wall(), &followed, "####....\n...##...\n........\n........");
    }

    /// With luminance judged mildly and chroma sharply a shadow is background without any test of its own.
    #[test]
    fn luminance_and_chroma_are_judged_apart() {
        let frame = scene("##..ss.. ##..ss.. ........ ........");
        let apart = SegmentOptions { z_threshold: 9.0, chroma: Some(ChromaOptions::default()), ..plain() };
        assert_mask(&frame, &wall(), &apart, "##......\n##......\n........\n........");
        let together = SegmentOptions { chroma: None, z_threshold: 5.0, ..apart };
        assert_mask(&frame, &wall(), &together, "##..##..\n##..##..\n........\n........");
    }

    #[test]
    fn small_groups_go_and_parts_of_a_body_stay() {
        let frame = scene("###....... ###....... .......... #.......## ..........");
        let plate = RgbImage::from_pixel(10, 5, WALL);
        let options = SegmentOptions { group_px: 1, min_group_fraction: 0.7, ..plain() };
        assert_mask(&frame, &plate, &options, "###.......\n###.......\n..........\n#.........\n..........");
    }

    /// A shirt, a shadow, and cloth of the wall's own colour and a shadow's brightness but with stripes, before a chequered wall.
    /// The shadow's edge is steeper than the wall, so it stays foreground until the opening.
    #[test]
    fn shadow_is_a_class_and_cloth_of_another_texture_is_not() {
        let text = "
            ....................
            .#####sssss...ttttt.
            .#####sssss...ttttt.
            .#####sssss...ttttt.
            .#####sssss...ttttt.
            .#####sssss...ttttt.
            ....................
        ";
        let rows: Vec<&[u8]> = text.split_whitespace().map(str::as_bytes).collect();
        let wall = |x: u32, y: u32| [0, 20, -30].map(|tint| 100 + tint + 12 * ((x / 2 + y / 2) % 2) as i32);
        let picture = |light: &dyn Fn(u8, u32) -> f32| {
            RgbImage::from_fn(rows[0].len() as u32, rows.len() as u32, |x, y| {
                let what = rows[y as usize][x as usize];
                let colour = if what == b'#' { [200, 90, 80] } else { wall(x, y) };
                Rgb(colour.map(|level| (light(what, x) * level as f32).round() as u8))
            })
        };
        let stripes = |x: u32| if x % 4 < 2 { 0.65 } else { 0.85 };
        let frame = picture(&|what, x| match what {
            b's' => 0.75,
            b't' => stripes(x),
            _ => 1.0,
        });
        let plate =
            RgbImage::from_fn(frame.width(), frame.height(), |x, y| Rgb(wall(x, y).map(|level| level as u8)));
        let by_brightness = "
            ....................
            .######.......#####.
            .######sss....#####.
            .######sss....#####.
            .######sss....#####.
            .######.......#####.
            ....................
        ";
        // At its edge the cloth is by chance as steep as the wall.
        let by_gradient = "
            ....................
            .######.........###.
            .######sss.....s###.
            .######sss.....s###.
            .######sss......###.
            .######.........###.
            ....................
        ";
        for (test, expected) in [(ShadowTest::Brightness, by_brightness), (ShadowTest::Gradient, by_gradient)]
        {
            for (unknown, character) in [(false, "-"), (true, "~")] {
                let shadow = Some(ShadowOptions { test, unknown, ..ShadowOptions::default() });
                let options = SegmentOptions { shadow, noise_floor: 1.0, opening_px: 1, ..plain() };
                assert_mask(&frame, &plate, &options, &expected.replace('s', character));
            }
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
        let brighter = |level: u8| (f32::from(level) * 1.2) as u8;
        let frame = RgbImage::from_fn(40, 40, |x, y| Rgb(plate.get_pixel(x, y).0.map(brighter)));
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
        let shadow = Some(ShadowOptions { test: ShadowTest::Gradient, ..ShadowOptions::default() });
        let by_gradient = SegmentOptions { shadow, ..plain() };
        assert_eq!(segment(&wall(), &background, &by_gradient), Err(SegmentError::NoDeviation));
        let still = Background::from_frames([&wall(), &wall()]).unwrap();
        assert!(segment(&wall(), &still, &by_gradient).is_ok());
        let none = RgbImage::new(0, 0);
        let result = segment(&none, &Background::from_plate(&none), &plain());
        assert!(matches!(result, Err(SegmentError::Mask(MaskError::Empty { .. }))));
    }
}
