//! From numbers to shares of subject, and from shares to a mask.
//!
//! Shares can be averaged, as the colours of footage are, and labels cannot. So a mask is reduced and rectified as a picture of
//! three channels, 0 to 255: how much of a pixel is known and subject, how much is known, how much is marked as shadow.

use backlit_tracking::silhouette::{Label, Mask};
use image::{Rgb, RgbImage};

use super::{MaskValues, Numbers};

const ALL: u8 = 255;
const HALF: u8 = 128;
/// Levels by which our own masks mark shadow.
const SHADOW_LEVELS: [u64; 2] = [32, 96];

/// The shares of each pixel.
pub(crate) fn shares(numbers: &Numbers, values: &MaskValues) -> RgbImage {
    let white = u64::from(numbers.white.max(1));
    let level = |number: u16| (u64::from(number) * 255 / white).min(255);
    let sure = |is_subject: bool| [if is_subject { ALL } else { 0 }, ALL, 0];
    let pixel = |index: usize| {
        let number = numbers.numbers.get(index).copied().unwrap_or(0);
        match values {
            MaskValues::Grey => [level(number) as u8, ALL, 0],
            MaskValues::Alpha => {
                [numbers.alpha.as_ref().and_then(|alpha| alpha.get(index)).copied().unwrap_or(ALL), ALL, 0]
            }
            MaskValues::NonZero => sure(number > 0),
            MaskValues::Ids(ids) => sure(ids.contains(&number)),
            MaskValues::Classes => {
                let level = level(number);
                let shadow = if SHADOW_LEVELS.contains(&level) { ALL } else { 0 };
                match level {
                    0..=63 => [0, ALL, shadow],
                    64..=191 => [0, 0, shadow],
                    _ => [ALL, ALL, 0],
                }
            }
        }
    };
    let [width, height] = numbers.size;
    RgbImage::from_fn(width as u32, height as u32, |x, y| Rgb(pixel(y as usize * width + x as usize)))
}

/// The mask of shares: unknown where less than half is known, subject where half of what is known is. `None` for a picture
/// without pixels.
pub(crate) fn mask_of(shares: &RgbImage) -> Option<Mask> {
    let label = |pixel: &Rgb<u8>| match pixel.0 {
        [_, known, _] if known < HALF => Label::Unknown,
        // Half of an odd number was rounded.
        [subject, known, _] if (2 * u16::from(subject)).abs_diff(u16::from(known)) <= 1 => Label::Unknown,
        [subject, known, _] if 2 * u16::from(subject) > u16::from(known) => Label::Subject,
        _ => Label::Background,
    };
    let labels = shares.pixels().map(label).collect();
    let mut mask = Mask::new(shares.width() as usize, shares.height() as usize, labels).ok()?;
    for (index, _) in shares.pixels().enumerate().filter(|(_, pixel)| pixel[2] >= HALF) {
        mask.mark_shadow(index);
    }
    Some(mask)
}

/// The shares as a picture: white subject, black background, middle grey where nothing is known.
pub(crate) fn drawn(shares: &RgbImage) -> RgbImage {
    let mut out = shares.clone();
    for pixel in out.pixels_mut() {
        let [subject, known, _] = pixel.0;
        *pixel = Rgb([subject.saturating_add((ALL - known) / 2); 3]);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::images::reduced;

    #[test]
    fn every_kind_of_values_finds_its_subject() {
        let mut numbers = Numbers::grey(6, &[0, 1, 3, 127, 128, 255]);
        numbers.alpha = Some(vec![0, 255, 127, 128, 1, 254]);
        let found = |values: MaskValues| mask_of(&shares(&numbers, &values)).unwrap().to_string();
        assert_eq!(found(MaskValues::Grey), "...??#\n");
        assert_eq!(found(MaskValues::Alpha), ".#??.#\n");
        assert_eq!(found(MaskValues::NonZero), ".#####\n");
        assert_eq!(found(MaskValues::Ids(vec![3, 255])), "..#..#\n");
        assert_eq!(found(MaskValues::Classes), "...??#\n");
        let wide = Numbers { white: 15, ..Numbers::grey(4, &[0, 7, 8, 15]) };
        assert_eq!(mask_of(&shares(&wide, &MaskValues::Grey)).unwrap().to_string(), "..##\n");
    }

    #[test]
    fn our_own_masks_are_read_as_they_were_written() {
        let mask = Mask::from_ascii("#.-~?\n?#.##\n").unwrap();
        let numbers: Vec<u16> = mask.to_gray().into_raw().into_iter().map(u16::from).collect();
        let shares = shares(&Numbers::grey(5, &numbers), &MaskValues::Classes);
        assert_eq!(mask_of(&shares).unwrap(), mask);
        assert_eq!(drawn(&shares).get_pixel(4, 0), &Rgb([127; 3]));
        assert_eq!(drawn(&shares).get_pixel(0, 0), &Rgb([255; 3]));
    }

    #[test]
    fn a_reduced_mask_is_decided_by_area() {
        let text = "
            ######..
            ###.#...
            ???#..?.
            ?..#??.?
        ";
        let mask = Mask::from_ascii(text).unwrap();
        let numbers: Vec<u16> = mask.to_gray().into_raw().into_iter().map(u16::from).collect();
        let shares = shares(&Numbers::grey(8, &numbers), &MaskValues::Classes);
        // Three of four unknown; half of two known; one of two known; half known and empty.
        assert_eq!(mask_of(&reduced(shares, 2)).unwrap().to_string(), "###.\n?#..\n");
    }

    #[test]
    fn exactly_half_is_nobody_s() {
        let halves = Numbers::grey(6, &[255, 255, 255, 0, 0, 0, 255, 0, 255, 0, 255, 0]);
        let mask = mask_of(&reduced(shares(&halves, &MaskValues::NonZero), 2)).unwrap();
        assert_eq!(mask.to_string(), "#?.\n");
    }
}
