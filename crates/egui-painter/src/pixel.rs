//! Arithmetic on premultiplied RGBA pixels of four bytes, all channels at once.
//!
//! A pixel is a `u32` with red in its lowest byte. Spread out, its channels are the four 16-bit lanes of a
//! `u64`, which leaves room for the products.

use egui::Color32;

const LANES: u64 = 0x00FF_00FF_00FF_00FF;
const HALF: u64 = 0x0080_0080_0080_0080;
const ONES: u64 = 0x0001_0001_0001_0001;

/// Opaque white: the neutral element of [`modulate`].
pub(crate) const WHITE: u32 = 0xFFFF_FFFF;

pub(crate) fn pack(colour: Color32) -> u32 {
    u32::from_le_bytes(colour.to_array())
}

pub(crate) fn alpha(pixel: u32) -> u32 {
    pixel >> 24
}

fn spread(pixel: u32) -> u64 {
    let x = u64::from(pixel);
    let x = (x | (x << 16)) & 0x0000_FFFF_0000_FFFF;
    (x | (x << 8)) & LANES
}

fn gather(lanes: u64) -> u32 {
    let x = (lanes | (lanes >> 8)) & 0x0000_FFFF_0000_FFFF;
    (x | (x >> 16)) as u32
}

/// Every channel times `factor` / 255, rounded to the nearest.
fn scale(lanes: u64, factor: u32) -> u64 {
    let product = lanes * u64::from(factor) + HALF;
    ((product + ((product >> 8) & LANES)) >> 8) & LANES
}

/// Channel times channel / 255, rounded to the nearest.
#[inline]
pub(crate) fn modulate(texel: u32, colour: u32) -> u32 {
    if texel == WHITE {
        return colour;
    }
    if texel == (texel & 0xFF) * 0x0101_0101 {
        return gather(scale(spread(colour), texel & 0xFF));
    }
    let (texel, colour) = (texel.to_le_bytes(), colour.to_le_bytes());
    u32::from_le_bytes(std::array::from_fn(|channel| {
        let product = u32::from(texel[channel]) * u32::from(colour[channel]) + 128;
        ((product + (product >> 8)) >> 8) as u8
    }))
}

/// Premultiplied `source` over `target`; sums past 255 (additive colours) saturate.
#[inline]
pub(crate) fn over(source: u32, target: u32) -> u32 {
    let sum = spread(source) + scale(spread(target), 255 - alpha(source));
    let overflow = (sum >> 8) & ONES;
    gather((sum | (overflow * 0xFF)) & LANES)
}

/// The mix of two pixels, `weight` / 256 of the second.
#[inline]
fn mix(a: u64, b: u64, weight: u32) -> u64 {
    ((a * u64::from(256 - weight) + b * u64::from(weight) + HALF) >> 8) & LANES
}

/// The mix of four pixels `[upper left, upper right, lower left, lower right]` with weights in 1/256.
#[inline]
pub(crate) fn bilinear(texels: [u32; 4], weight_x: u32, weight_y: u32) -> u32 {
    let upper = mix(spread(texels[0]), spread(texels[1]), weight_x);
    let lower = mix(spread(texels[2]), spread(texels[3]), weight_x);
    gather(mix(upper, lower, weight_y))
}

/// Puts `source` over every pixel of `row`.
#[inline]
pub(crate) fn fill(row: &mut [u32], source: u32) {
    match alpha(source) {
        255 => row.fill(source),
        _ if source == 0 => {}
        _ => row.iter_mut().for_each(|pixel| *pixel = over(source, *pixel)),
    }
}

/// Puts `source` over one pixel.
#[inline]
pub(crate) fn blend(pixel: &mut u32, source: u32) {
    match alpha(source) {
        255 => *pixel = source,
        _ if source == 0 => {}
        _ => *pixel = over(source, *pixel),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rgba(r: u8, g: u8, b: u8, a: u8) -> u32 {
        u32::from_le_bytes([r, g, b, a])
    }

    #[test]
    fn over_rounds_like_exact_arithmetic() {
        for alpha in [0_u8, 1, 77, 128, 200, 254, 255] {
            for below in 0..=255_u8 {
                let source = alpha / 2;
                let result =
                    over(rgba(source, 0, alpha, alpha), rgba(below, below, below, 255)).to_le_bytes();
                let kept = (f64::from(below) * f64::from(255 - alpha) / 255.0).round();
                assert_eq!(f64::from(result[0]), f64::from(source) + kept, "alpha {alpha} below {below}");
                assert_eq!(result[3], 255);
            }
        }
    }

    #[test]
    fn additive_colours_saturate() {
        assert_eq!(over(rgba(200, 10, 0, 0), rgba(100, 10, 5, 255)), rgba(255, 20, 5, 255));
    }

    #[test]
    fn modulation_by_a_grey_equals_modulation_by_channels() {
        for coverage in 0..=255_u8 {
            for value in [0_u8, 1, 99, 128, 254, 255] {
                let fast = modulate(rgba(coverage, coverage, coverage, coverage), rgba(value, 7, value, 255));
                let exact = |v: u8| (f64::from(coverage) * f64::from(v) / 255.0).round() as u8;
                assert_eq!(fast, rgba(exact(value), exact(7), exact(value), coverage));
            }
        }
        assert_eq!(modulate(rgba(255, 0, 51, 255), rgba(100, 100, 100, 255)), rgba(100, 0, 20, 255));
    }

    #[test]
    fn bilinear_meets_its_corners_and_its_middle() {
        let texels = [rgba(0, 0, 0, 255), rgba(200, 0, 0, 255), rgba(0, 100, 0, 255), rgba(200, 100, 0, 255)];
        assert_eq!(bilinear(texels, 0, 0), texels[0]);
        assert_eq!(bilinear(texels, 128, 128), rgba(100, 50, 0, 255));
        assert_eq!(bilinear([WHITE; 4], 37, 201), WHITE);
    }
}
