//! A picture's numbers as its file has them.

use std::io::Cursor;
use std::path::Path;

use backlit_tracking::silhouette::MAX_PIXELS;
use image::{DynamicImage, RgbImage};
use png::{BitDepth, ColorType};

use crate::{Result, images};

/// Channels that differ by more make a colour: videos and JPEG leave grey a little coloured.
const COLOURED: u8 = 24;
const PNG_SIGNATURE: [u8; 4] = [0x89, b'P', b'N', b'G'];
/// So much of a mask is nearly black or nearly white.
const LIKELY: f64 = 0.9;
/// Palettes have as many colours.
const PALETTE_WHITE: u16 = 255;

/// What a mask's picture says of each pixel, row by row.
#[derive(Debug, Clone)]
pub(crate) struct Numbers {
    /// Width and height.
    pub(crate) size: [usize; 2],
    /// Grey levels as they are in the file, or indices of a coloured palette.
    pub(crate) numbers: Vec<u16>,
    /// The number that is white.
    pub(crate) white: u16,
    /// 0 is transparent, 255 opaque.
    pub(crate) alpha: Option<Vec<u8>>,
    /// The numbers are how bright colours are.
    pub(crate) is_coloured: bool,
    /// The numbers are places in a coloured palette.
    pub(crate) is_index: bool,
}

#[cfg(test)]
impl Numbers {
    /// Grey levels, `width` a row.
    pub(super) fn grey(width: usize, numbers: &[u16]) -> Self {
        let size = [width, numbers.len() / width];
        let numbers = numbers.to_vec();
        Self { size, numbers, white: 255, alpha: None, is_coloured: false, is_index: false }
    }
}

impl Numbers {
    /// Of a picture's file.
    pub(crate) fn decode(path: &Path, bytes: &[u8]) -> Result<Self> {
        if bytes.starts_with(&PNG_SIGNATURE)
            && let Some(packed) = packed(path, bytes)?
        {
            return Ok(packed);
        }
        Ok(Self::of_decoded(images::decode_any(path, bytes)?))
    }

    /// Whether it looks like a mask: nearly all pixels are nearly black or white, or have small numbers.
    pub(crate) fn is_likely(&self) -> bool {
        let is_clear = self.alpha.as_ref().is_some_and(|alpha| alpha.iter().any(|&alpha| alpha < 128));
        if is_clear || self.is_index {
            return true;
        }
        let (low, high) = (self.white / 8, self.white - self.white / 8);
        let ends = self.numbers.iter().filter(|&&number| number <= low || number >= high).count();
        !self.is_coloured && ends as f64 >= LIKELY * self.numbers.len() as f64
    }

    /// Of a video's frame.
    pub(crate) fn of_picture(picture: &RgbImage) -> Self {
        let grey = |pixel: &image::Rgb<u8>| {
            // As the image library does it: grey stays what it is.
            let [r, g, b] = pixel.0.map(u32::from);
            ((2126 * r + 7152 * g + 722 * b) / 10_000) as u16
        };
        Self {
            size: [picture.width() as usize, picture.height() as usize],
            numbers: picture.pixels().map(grey).collect(),
            white: PALETTE_WHITE,
            alpha: None,
            is_coloured: is_coloured(picture),
            is_index: false,
        }
    }

    fn of_decoded(picture: DynamicImage) -> Self {
        let size = [picture.width() as usize, picture.height() as usize];
        let alpha = picture.color().has_alpha().then(|| picture.to_rgba8().pixels().map(|p| p[3]).collect());
        if picture.color().has_color() {
            return Self { alpha, ..Self::of_picture(&picture.into_rgb8()) };
        }
        let (numbers, white) = match picture {
            DynamicImage::ImageLuma16(_) | DynamicImage::ImageLumaA16(_) => {
                (picture.into_luma16().into_raw(), u16::MAX)
            }
            _ => (picture.into_luma8().into_raw().into_iter().map(u16::from).collect(), PALETTE_WHITE),
        };
        Self { size, numbers, white, alpha, is_coloured: false, is_index: false }
    }
}

fn is_coloured(picture: &RgbImage) -> bool {
    picture.pixels().any(|pixel| {
        let [r, g, b] = pixel.0;
        r.max(g).max(b) - r.min(g).min(b) > COLOURED
    })
}

/// The numbers of a PNG that the image library would turn into colours or spread over more bits: palettes, and grey of less
/// than a byte. A palette of greys is grey. `None` for all others.
fn packed(path: &Path, bytes: &[u8]) -> Result<Option<Numbers>> {
    let broken = |error: png::DecodingError| images::broken(path, &error.to_string());
    let [width, height] = images::whole_size(path, bytes)?;
    if width.checked_mul(height).is_none_or(|pixels| pixels > MAX_PIXELS) {
        return Err(images::broken(path, &format!("{width}×{height} pixels are too many for a mask")));
    }
    let limits = png::Limits { bytes: 4 * MAX_PIXELS };
    let mut reader = png::Decoder::new_with_limits(Cursor::new(bytes), limits).read_info().map_err(broken)?;
    let info = reader.info();
    let (depth, is_palette) = (info.bit_depth, info.color_type == ColorType::Indexed);
    let is_narrow = matches!(depth, BitDepth::One | BitDepth::Two | BitDepth::Four);
    let is_packed = is_palette || (info.color_type == ColorType::Grayscale && is_narrow);
    if !is_packed {
        return Ok(None);
    }
    let colours: Vec<[u8; 3]> = info.palette.as_deref().unwrap_or_default().as_chunks::<3>().0.to_vec();
    let transparent = info.trns.as_deref().filter(|_| is_palette).map(<[u8]>::to_vec);
    let bits = depth as usize;
    let mut rows = vec![0; (width * bits).div_ceil(8) * height];
    reader.next_frame(&mut rows).map_err(broken)?;
    let row = |row: &[u8]| -> Vec<u16> {
        let at = |x: usize| row[x * bits / 8] >> (8 - bits - x * bits % 8);
        (0..width).map(|x| u16::from(at(x)) & ((1 << bits) - 1)).collect()
    };
    let mut numbers: Vec<u16> = rows.chunks_exact((width * bits).div_ceil(8)).flat_map(row).collect();
    let alpha = transparent.map(|alpha| {
        numbers.iter().map(|&index| alpha.get(usize::from(index)).copied().unwrap_or(255)).collect()
    });
    let is_index = is_palette && colours.iter().any(|[r, g, b]| r != g || g != b);
    if is_palette && !is_index {
        for number in &mut numbers {
            *number = colours.get(usize::from(*number)).map_or(0, |colour| u16::from(colour[0]));
        }
    }
    let white = if is_palette { PALETTE_WHITE } else { (1 << bits) - 1 };
    Ok(Some(Numbers { size: [width, height], numbers, white, alpha, is_coloured: false, is_index }))
}

#[cfg(test)]
mod tests {
    use image::{GrayAlphaImage, GrayImage, ImageFormat, LumaA};

    use super::*;

    /// A PNG of raw rows, as the format has them.
    fn png(color: ColorType, depth: BitDepth, palette: Option<Vec<u8>>, rows: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 5, 2);
        encoder.set_color(color);
        encoder.set_depth(depth);
        if let Some(palette) = palette {
            encoder.set_palette(palette);
        }
        encoder.write_header().unwrap().write_image_data(rows).unwrap();
        bytes
    }

    fn numbers(bytes: &[u8]) -> (Vec<u16>, u16) {
        let found = Numbers::decode(Path::new("a.png"), bytes).unwrap();
        assert_eq!(found.size, [5, 2]);
        (found.numbers, found.white)
    }

    #[test]
    fn numbers_are_those_of_the_file() {
        let of_bits = |rows: &[u8]| png(ColorType::Grayscale, BitDepth::Two, None, rows);
        let rows = [0b00_01_10_11, 0b01_000000, 0b11_00_00_01, 0b10_000000];
        assert_eq!(numbers(&of_bits(&rows)), (vec![0, 1, 2, 3, 1, 3, 0, 0, 1, 2], 3));
        let one = png(ColorType::Grayscale, BitDepth::One, None, &[0b0101_1000, 0b1111_1000]);
        assert_eq!(numbers(&one), (vec![0, 1, 0, 1, 1, 1, 1, 1, 1, 1], 1));
        // As DAVIS and its successors write people: the index counts, not the colour.
        let colours = vec![0, 0, 0, 128, 0, 0, 0, 128, 0];
        let ids = png(ColorType::Indexed, BitDepth::Eight, Some(colours), &[0, 1, 2, 2, 1, 0, 0, 1, 1, 2]);
        assert_eq!(numbers(&ids), (vec![0, 1, 2, 2, 1, 0, 0, 1, 1, 2], 255));
        // A program that makes files small gave grey levels a palette.
        let greys = vec![255, 255, 255, 0, 0, 0, 90, 90, 90];
        let grey = png(ColorType::Indexed, BitDepth::Eight, Some(greys), &[0, 1, 2, 2, 1, 0, 0, 1, 1, 2]);
        assert_eq!(numbers(&grey), (vec![255, 0, 90, 90, 0, 255, 255, 0, 0, 90], 255));
        let wide: Vec<u8> = (0..10_u16).flat_map(|k| (k * 300).to_be_bytes()).collect();
        let wide = png(ColorType::Grayscale, BitDepth::Sixteen, None, &wide);
        assert_eq!(numbers(&wide), ((0..10).map(|k| k * 300).collect(), u16::MAX));
        let mut cut = ids.clone();
        cut.truncate(ids.len() - 20);
        let message = Numbers::decode(Path::new("a.png"), &cut).unwrap_err().to_string();
        assert!(message.contains("a.png: is not a whole picture"), "{message}");
    }

    #[test]
    fn alpha_and_colours_are_told() {
        let encoded = |picture: DynamicImage| {
            let mut bytes = Cursor::new(Vec::new());
            picture.write_to(&mut bytes, ImageFormat::Png).unwrap();
            Numbers::decode(Path::new("a.png"), bytes.get_ref()).unwrap()
        };
        let with_alpha = encoded(GrayAlphaImage::from_pixel(3, 1, LumaA([7, 200])).into());
        assert_eq!((with_alpha.alpha, with_alpha.numbers), (Some(vec![200; 3]), vec![7; 3]));
        let grey = encoded(DynamicImage::ImageLuma8(GrayImage::from_pixel(3, 1, image::Luma([9]))));
        assert_eq!((grey.alpha, grey.is_coloured), (None, false));
        for (blue, is_coloured) in [(100, false), (90, false), (60, true)] {
            let picture = RgbImage::from_pixel(2, 2, image::Rgb([100, 100, blue]));
            assert_eq!(encoded(picture.into()).is_coloured, is_coloured, "{blue}");
        }
    }
}
