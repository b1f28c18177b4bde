//! A plate learnt from footage in which the subject is always somewhere.
//!
//! Where it is known in each frame where the subject may be (a generous skeleton, a tracked body), a pixel's level is the
//! median over the frames in which it is free, or what it shows in nearly all frames if that is of the surface beside it. Where that is not known, it is the middle of the shortest interval that
//! holds half of the frames (the "shorth": Andrews et al., *Robust Estimates of Location*, 1972): what the pixel shows most
//! of the time. That is wrong where the subject never leaves, so pixels that cannot be told are unknown: those that have no
//! level that lasts, those that are still but enclosed by moving ones, and their neighbours of the same colour.

use image::RgbImage;
use rayon::prelude::*;

use super::background::BackgroundError;
use super::bit_image::BitImage;
use super::components;
use crate::silhouette::{Label, Mask};

/// A frame to learn from.
#[derive(Clone, Copy, Debug)]
pub struct LearningFrame<'a> {
    /// The picture.
    pub picture: &'a RgbImage,
    /// Where the subject may be: pixels that are not background in this mask are not learnt from. `None` where nobody knows.
    pub subject: Option<&'a Mask>,
}

/// How a plate is learnt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LearningOptions {
    /// A pixel is known if it is free in this many frames. Counts where the subject is known.
    pub min_free_frames: usize,
    /// Levels this far apart, in grey levels of a channel, are still of the same thing. Counts where the subject is unknown.
    pub same_level: u8,
    /// A level lasts if this share of the frames shows it. Counts where the subject is unknown.
    pub lasting_share: f64,
}

impl Default for LearningOptions {
    fn default() -> Self {
        Self { min_free_frames: 2, same_level: 14, lasting_share: 0.6 }
    }
}

/// What a camera sees without the subject, as far as that could be learnt.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LearntPlate {
    /// The picture; black where nothing is known.
    pub picture: RgbImage,
    /// Which pixels are known, row by row.
    pub known: Vec<bool>,
}

impl LearntPlate {
    /// The share of the pixels that are known, 0 to 1.
    #[must_use]
    pub fn known_share(&self) -> f64 {
        self.known.iter().filter(|&&known| known).count() as f64 / self.known.len().max(1) as f64
    }
}

/// Learns a plate from frames of one camera that stands still. Frames whose subject is not known count only if that of
/// none is known.
///
/// # Errors
/// Fewer than two frames, more than 65 535, or pictures and masks of different sizes.
pub fn learn_plate(
    frames: &[LearningFrame<'_>],
    options: &LearningOptions,
) -> Result<LearntPlate, BackgroundError> {
    let [first, _, ..] = frames else {
        return Err(BackgroundError::TooFewFrames(frames.len()));
    };
    if frames.len() > usize::from(u16::MAX) {
        return Err(BackgroundError::TooManyFrames(u32::from(u16::MAX)));
    }
    let expected = first.picture.dimensions();
    for (index, frame) in frames.iter().enumerate() {
        let of_mask = frame.subject.map(|mask| (mask.width() as u32, mask.height() as u32));
        let sizes = [Some(frame.picture.dimensions()), of_mask];
        if let Some(found) = sizes.into_iter().flatten().find(|&size| size != expected) {
            return Err(BackgroundError::SizeMismatch { index, expected, found });
        }
    }
    let masked: Vec<(&RgbImage, &Mask)> =
        frames.iter().filter_map(|frame| Some((frame.picture, frame.subject?))).collect();
    if masked.is_empty() {
        let pictures: Vec<&RgbImage> = frames.iter().map(|frame| frame.picture).collect();
        Ok(from_pictures(&pictures, options))
    } else {
        Ok(from_free_pixels(&masked, options))
    }
}

/// A pixel at a time: the level of each channel, `None` where it is not known.
fn each_pixel<T: Send>(
    (width, height): (u32, u32),
    pixel: impl Fn(usize, &mut [Vec<u8>; 3]) -> T + Sync,
) -> Vec<T> {
    let width = width as usize;
    let rows = (0..height as usize).into_par_iter().map(|y| {
        let mut levels = [const { Vec::new() }; 3];
        (y * width..(y + 1) * width).map(|index| pixel(index, &mut levels)).collect::<Vec<T>>()
    });
    rows.collect::<Vec<_>>().into_iter().flatten().collect()
}

fn from_free_pixels(frames: &[(&RgbImage, &Mask)], options: &LearningOptions) -> LearntPlate {
    let size = frames[0].0.dimensions();
    let levels = each_pixel(size, |index, levels| {
        let free = frames.iter().filter(|(_, mask)| mask.labels()[index] == Label::Background);
        gather(levels, free.map(|(picture, _)| &picture.as_raw()[3 * index..][..3]));
        let is_known = levels[0].len() >= options.min_free_frames.max(1);
        is_known.then(|| levels.each_mut().map(|levels| median(levels)))
    });
    let pictures: Vec<&RgbImage> = frames.iter().map(|(picture, _)| *picture).collect();
    plate(size, &grown(levels, &pictures, options))
}

/// Generous masks hide more than the subject does: a pixel that shows the same in nearly all frames, and hardly anything else
/// than the known pixel beside it, is of the scene too. From the known pixels on, as far as that leads.
fn grown(
    mut levels: Vec<Option<[u8; 3]>>,
    pictures: &[&RgbImage],
    options: &LearningOptions,
) -> Vec<Option<[u8; 3]>> {
    let size = pictures[0].dimensions();
    let still = each_pixel(size, |index, levels| {
        let found = lasting(index, pictures, levels, options);
        found.lasts(STILL_BESIDE, pictures.len()).then_some(found.level)
    });
    let neighbours = |pixel: usize| neighbours(pixel, size.0 as usize, size.1 as usize);
    let mut pending: Vec<usize> = (0..levels.len()).filter(|&pixel| levels[pixel].is_some()).collect();
    while let Some(pixel) = pending.pop() {
        let Some(level) = levels[pixel] else { continue };
        for next in neighbours(pixel).filter(|&next| next < still.len()) {
            let (None, Some(found)) = (levels[next], still[next]) else { continue };
            if level.iter().zip(found).all(|(&a, b)| a.abs_diff(b) <= SAME_SURFACE) {
                levels[next] = Some(found);
                pending.push(next);
            }
        }
    }
    levels
}

/// The pixels above, below and at both sides.
fn neighbours(pixel: usize, width: usize, height: usize) -> impl Iterator<Item = usize> {
    let (x, y) = (pixel % width, pixel / width);
    let sides = [(x > 0, pixel.wrapping_sub(1)), (x + 1 < width, pixel + 1)];
    let ends = [(y > 0, pixel.wrapping_sub(width)), (y + 1 < height, pixel + width)];
    sides.into_iter().chain(ends).filter_map(|(inside, next)| inside.then_some(next))
}

fn plate((width, height): (u32, u32), levels: &[Option<[u8; 3]>]) -> LearntPlate {
    let pixels = levels.iter().flat_map(|level| level.unwrap_or_default()).collect();
    let picture = RgbImage::from_raw(width, height, pixels).unwrap_or_default();
    LearntPlate { picture, known: levels.iter().map(Option::is_some).collect() }
}

/// The levels of pixels, channel by channel, in the place of what was there.
fn gather<'a>(levels: &mut [Vec<u8>; 3], pixels: impl Iterator<Item = &'a [u8]>) {
    levels.iter_mut().for_each(Vec::clear);
    for pixel in pixels {
        levels.iter_mut().zip(pixel).for_each(|(levels, &level)| levels.push(level));
    }
}

fn median(levels: &mut [u8]) -> u8 {
    let middle = levels.len() / 2;
    *levels.select_nth_unstable(middle).1
}

/// What a pixel shows most of the time.
struct Lasting {
    level: [u8; 3],
    /// In how many frames it is seen.
    frames: usize,
}

impl Lasting {
    /// Whether it is seen in this share of this many frames.
    fn lasts(&self, share: f64, count: usize) -> bool {
        self.frames as f64 >= share * count as f64
    }
}

/// The share of frames from which on a pixel counts as still.
const STILL: f64 = 0.97;
/// The same for one that may be of the scene beside it: a shadow passes now and then.
const STILL_BESIDE: f64 = 0.9;
/// Neighbours whose channels differ by no more are of the same surface, grey levels.
const SAME_SURFACE: u8 = 8;

/// What a pixel shows most of the time.
fn lasting(
    index: usize,
    pictures: &[&RgbImage],
    levels: &mut [Vec<u8>; 3],
    options: &LearningOptions,
) -> Lasting {
    let pixels = || pictures.iter().map(|picture| &picture.as_raw()[3 * index..][..3]);
    gather(levels, pixels());
    let level = levels.each_mut().map(|levels| middle_of_shortest_half(levels));
    let same = |pixel: &&[u8]| pixel.iter().zip(level).all(|(&a, b)| a.abs_diff(b) <= options.same_level);
    Lasting { level, frames: pixels().filter(same).count() }
}

fn from_pictures(pictures: &[&RgbImage], options: &LearningOptions) -> LearntPlate {
    let size = pictures[0].dimensions();
    let (width, height) = (size.0 as usize, size.1 as usize);
    let same = |a: &[u8], b: &[u8]| a.iter().zip(b).all(|(&a, &b)| a.abs_diff(b) <= options.same_level);
    let found = each_pixel(size, |index, levels| lasting(index, pictures, levels, options));
    let mut unknown = BitImage::empty(width, height);
    let (mut moving, mut enclosed) = (unknown.clone(), unknown.clone());
    for (y, row) in found.chunks_exact(width).enumerate() {
        let bits =
            |is: &dyn Fn(&Lasting) -> bool| row.iter().map(|pixel| u8::from(is(pixel))).collect::<Vec<_>>();
        moving.set_row(y, &bits(&|pixel| !pixel.lasts(STILL, pictures.len())));
        unknown.set_row(y, &bits(&|pixel| !pixel.lasts(options.lasting_share, pictures.len())));
    }
    // Specks of noise enclose nothing; a body's outline may be broken where it leaves its own colour.
    let reach = (height / 60).max(1);
    components::drop_small(&mut moving, width * height / 5000, 0.0);
    moving.open_and_close(0, reach);
    for y in 0..height {
        moving.runs(y, true).collect::<Vec<_>>().into_iter().for_each(|run| enclosed.fill(y, run, true));
    }
    components::fill_holes(&mut enclosed, usize::MAX);
    enclosed.subtract(&moving);
    // What moves beside it and has its colour is likelier to be the same body than the wall.
    let mut pending: Vec<usize> = Vec::new();
    for y in 0..height {
        pending.extend(enclosed.runs(y, true).flatten().map(|x| y * width + x));
    }
    for &pixel in &pending {
        unknown.fill(pixel / width, pixel % width..pixel % width + 1, true);
    }
    while let Some(pixel) = pending.pop() {
        for next in neighbours(pixel, width, height) {
            let (nx, ny) = (next % width, next / width);
            if moving.get(nx, ny) && !unknown.get(nx, ny) && same(&found[next].level, &found[pixel].level) {
                unknown.fill(ny, nx..nx + 1, true);
                pending.push(next);
            }
        }
    }
    let levels: Vec<Option<[u8; 3]>> = found
        .iter()
        .enumerate()
        .map(|(index, pixel)| (!unknown.get(index % width, index / width)).then_some(pixel.level))
        .collect();
    plate(size, &levels)
}

/// The median of the shortest interval that holds half of the levels. At least one level.
fn middle_of_shortest_half(levels: &mut [u8]) -> u8 {
    levels.sort_unstable();
    let half = levels.len() / 2 + 1;
    let widths = levels.windows(half).map(|window| window[half - 1] - window[0]);
    let at = widths.enumerate().min_by_key(|&(_, width)| width).map_or(0, |(at, _)| at);
    levels[at + half / 2]
}

#[cfg(test)]
mod tests {
    use image::Rgb;

    use super::*;
    use crate::fixtures;

    const BODY: Rgb<u8> = Rgb([200, 150, 120]);
    const WALL: Rgb<u8> = Rgb([90, 110, 130]);

    fn wall(x: u32, y: u32) -> Rgb<u8> {
        Rgb([WALL[0] + (x % 7) as u8, WALL[1] + (y % 5) as u8, WALL[2]])
    }

    /// A block, `width` pixels across, that steps to the side by one pixel a frame, and goes up and down by two.
    fn footage(width: u32, count: u32) -> (Vec<RgbImage>, Vec<Mask>) {
        let is_body = move |k: u32, x: u32, y: u32| {
            (20 + k..20 + k + width).contains(&x) && (9 + k % 3..49 + k % 3).contains(&y)
        };
        let picture =
            |k: u32| RgbImage::from_fn(96, 60, |x, y| if is_body(k, x, y) { BODY } else { wall(x, y) });
        // Generous: three pixels more on every side.
        let mask = |k: u32| {
            let columns = (17 + k) as usize..(23 + k + width) as usize;
            fixtures::covered([96, 60], |x, y| columns.contains(&x) && (7..53).contains(&y))
        };
        ((0..count).map(picture).collect(), (0..count).map(mask).collect())
    }

    fn learn(pictures: &[RgbImage], masks: Option<&[Mask]>) -> LearntPlate {
        let frames: Vec<LearningFrame<'_>> = pictures
            .iter()
            .enumerate()
            .map(|(k, picture)| LearningFrame { picture, subject: masks.map(|masks| &masks[k]) })
            .collect();
        learn_plate(&frames, &LearningOptions::default()).unwrap()
    }

    /// Whatever is known is right.
    fn assert_true(plate: &LearntPlate) {
        for (x, y, pixel) in plate.picture.enumerate_pixels() {
            if plate.known[(y * 96 + x) as usize] {
                assert_eq!(*pixel, wall(x, y), "{x} {y}");
            }
        }
    }

    #[test]
    fn what_is_free_in_a_few_frames_is_learnt_where_the_subject_is_known() {
        let (pictures, masks) = footage(12, 24);
        let plate = learn(&pictures, Some(&masks));
        assert_true(&plate);
        // A block of 12 + 6 that moves by 24 is away from every pixel for some frames.
        assert_eq!(plate.known_share(), 1.0);
        let (pictures, masks) = footage(40, 24);
        let plate = learn(&pictures, Some(&masks));
        assert_true(&plate);
        // 40 + 6 pixels wide: the columns 17 + 24 − 2 to 63 − 1 + 1 are free in less than two frames. Of the rows, those that
        // the block itself never reaches are as the wall beside them.
        let unknown = plate.known.iter().filter(|&&known| !known).count();
        assert_eq!(unknown, 42 * (63 + 1 - (17 + 24 - 2)));
    }

    #[test]
    fn what_lasts_is_learnt_where_the_subject_is_not_known() {
        let plate = learn(&footage(8, 24).0, None);
        assert_true(&plate);
        assert_eq!(plate.known_share(), 1.0);
        // A block that never leaves its middle: the middle and its sides are unknown, never taken for the wall.
        let plate = learn(&footage(40, 24).0, None);
        assert_true(&plate);
        assert!(!plate.known[30 * 96 + 50], "the middle of the block");
        assert!(plate.known_share() > 0.6, "{}", plate.known_share());
    }

    #[test]
    fn a_median_of_few_frames_is_not_moved_by_one() {
        let mut pictures: Vec<RgbImage> = (0..5).map(|_| RgbImage::from_fn(96, 60, wall)).collect();
        pictures[3] = RgbImage::from_pixel(96, 60, BODY);
        let masks = vec![Mask::filled(96, 60, Label::Background).unwrap(); 5];
        for masks in [None, Some(&masks[..])] {
            let plate = learn(&pictures, masks);
            assert_true(&plate);
            assert_eq!(plate.known_share(), 1.0);
        }
    }

    #[test]
    fn unequal_or_too_few_frames_are_errors() {
        let (a, b) = (RgbImage::new(4, 4), RgbImage::new(4, 5));
        let frame = |picture| LearningFrame { picture, subject: None };
        let learn = |frames: &[LearningFrame<'_>]| learn_plate(frames, &LearningOptions::default());
        assert_eq!(learn(&[frame(&a)]), Err(BackgroundError::TooFewFrames(1)));
        let mismatch = BackgroundError::SizeMismatch { index: 1, expected: (4, 4), found: (4, 5) };
        assert_eq!(learn(&[frame(&a), frame(&b)]), Err(mismatch.clone()));
        let mask = Mask::filled(4, 5, Label::Background).unwrap();
        let masked = LearningFrame { picture: &a, subject: Some(&mask) };
        assert_eq!(learn(&[frame(&a), masked]), Err(mismatch));
    }
}
