//! From luma and two chroma planes to RGB, as ffmpeg and OpenCV do it: each chroma sample stands for its whole block.
//!
//! ```text
//! R = Y' + 2 (1 − r) V'    B = Y' + 2 (1 − b) U'    G = Y' − (2 b (1 − b) U' + 2 r (1 − r) V') / (1 − r − b)
//! ```
//!
//! with Y' = (Y − 16) · 255/219 and U', V' = (U − 128, V − 128) · 255/224 in the limited range, or as they are in the
//! full one; r and b are the weights of red and blue in luma (ITU-T H.273, 8.3 and its table 4). Each product is rounded
//! down, as ffmpeg does it with the vectors of an x86: pictures are then the same to the bit, and a plate that it wrote
//! fits the footage. They are darker by one grey level than the exact numbers.

use image::RgbImage;

use super::orientation::Orientation;
use crate::images::{averaged, reduced};

/// Bits behind the point of a factor, and those by which samples are shifted to be multiplied.
const FACTOR_BITS: u32 = 13;
const SAMPLE_BITS: u32 = 3;

/// What a stream says of its colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Colour {
    /// `matrix_coefficients` of ITU-T H.273; 2 is "not said".
    pub(super) matrix: u8,
    /// Luma from 0 to 255 rather than 16 to 235.
    pub(super) full_range: bool,
}

impl Default for Colour {
    fn default() -> Self {
        Self { matrix: 2, full_range: false }
    }
}

impl Colour {
    /// The weights of red and blue. What is not said is BT.601, as with ffmpeg and OpenCV.
    fn weights(self) -> (f64, f64) {
        match self.matrix {
            1 => (0.2126, 0.0722),
            4 => (0.30, 0.11),
            7 => (0.212, 0.087),
            9 | 10 => (0.2627, 0.0593),
            _ => (0.299, 0.114),
        }
    }
}

/// Three planes of 8 bits, rows one after the other. Chroma is halved as often as the shifts say, rounded down.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Planes {
    pub(super) size: [usize; 2],
    pub(super) planes: [Vec<u8>; 3],
    /// log2 of luma samples per chroma sample, across and down.
    pub(super) shift: [u32; 2],
    pub(super) colour: Colour,
}

impl Planes {
    fn chroma_size(&self) -> [usize; 2] {
        [self.size[0] >> self.shift[0], self.size[1] >> self.shift[1]]
    }

    /// Whether every plane has the length that its size says, and every luma sample its chroma.
    pub(super) fn is_sound(&self) -> bool {
        let [width, height] = self.size;
        let [chroma_width, chroma_height] = self.chroma_size();
        let whole = chroma_width << self.shift[0] == width && chroma_height << self.shift[1] == height;
        let [y, u, v] = &self.planes;
        let chroma = chroma_width * chroma_height;
        whole && y.len() == width * height && u.len() == chroma && v.len() == chroma
    }

    /// The picture, turned, with each square of `divisor`² pixels averaged to one; rows and columns that fill no
    /// square are left out.
    pub(super) fn picture(self, orientation: Orientation, divisor: usize) -> RgbImage {
        let turned = self.turned(orientation);
        let fits = turned.shift.iter().all(|shift| divisor.is_multiple_of(1 << shift));
        if divisor > 1 && fits { turned.reduced(divisor).to_rgb() } else { reduced(turned.to_rgb(), divisor) }
    }

    fn turned(self, orientation: Orientation) -> Self {
        if orientation == Orientation::default() {
            return self;
        }
        let (size, chroma) = (self.size, self.chroma_size());
        let [y, u, v] = &self.planes;
        let planes = [orientation.turn(y, size), orientation.turn(u, chroma), orientation.turn(v, chroma)];
        let [across, down] = self.shift;
        let shift = if orientation.turns.is_multiple_of(2) { [across, down] } else { [down, across] };
        Self { size: orientation.size(size), planes, shift, colour: self.colour }
    }

    /// Averages of squares of `divisor`, a multiple of the chroma's blocks; chroma is then as large as luma.
    fn reduced(self, divisor: usize) -> Self {
        let size = self.size.map(|side| side / divisor);
        let chroma = self.chroma_size();
        let blocks = self.shift.map(|shift| divisor >> shift);
        let [y, u, v] = &self.planes;
        let planes = [
            averaged::<1>(y, self.size[0], size, [divisor; 2]),
            averaged::<1>(u, chroma[0], size, blocks),
            averaged::<1>(v, chroma[0], size, blocks),
        ];
        Self { size, planes, shift: [0; 2], colour: self.colour }
    }

    fn to_rgb(&self) -> RgbImage {
        let [width, height] = self.size;
        let chroma_width = self.chroma_size()[0];
        let [y, u, v] = &self.planes;
        let matrix = Matrix::new(self.colour);
        let mut out = vec![0; width * height * 3];
        let mut terms = [0; 3].map(|_| vec![0; width]);
        for row in 0..height {
            if row & ((1 << self.shift[1]) - 1) == 0 {
                let from = (row >> self.shift[1]) * chroma_width;
                let chroma = [u, v].map(|plane| &plane[from..from + chroma_width]);
                matrix.terms(chroma, self.shift[0], &mut terms);
            }
            let luma = &y[row * width..(row + 1) * width];
            matrix.row(luma, &terms, &mut out[row * width * 3..(row + 1) * width * 3]);
        }
        RgbImage::from_raw(width as u32, height as u32, out).unwrap_or_default()
    }
}

/// Fixed-point factors, so that (sample << [`SAMPLE_BITS`]) · factor >> 16 is the product, rounded down.
struct Matrix {
    luma: i16,
    black: i16,
    red_v: i16,
    green: [i16; 2],
    blue_u: i16,
}

/// Pixels that are worked out together, as vectors do it.
const LANES: usize = 16;

/// The upper half of a product.
fn product(sample: i16, factor: i16) -> i16 {
    ((i32::from(sample << SAMPLE_BITS) * i32::from(factor)) >> (FACTOR_BITS + SAMPLE_BITS)) as i16
}

impl Matrix {
    fn new(colour: Colour) -> Self {
        let (kr, kb) = colour.weights();
        let kg = 1.0 - kr - kb;
        let (luma, chroma, black) =
            if colour.full_range { (1.0, 1.0, 0) } else { (255.0 / 219.0, 255.0 / 224.0, 16) };
        let fixed = |factor: f64| (factor * f64::from(1 << FACTOR_BITS)).round() as i16;
        Self {
            luma: fixed(luma),
            black,
            red_v: fixed(2.0 * (1.0 - kr) * chroma),
            green: [kb * (1.0 - kb), kr * (1.0 - kr)].map(|part| fixed(-2.0 * part / kg * chroma)),
            blue_u: fixed(2.0 * (1.0 - kb) * chroma),
        }
    }

    /// What chroma adds to red, green and blue.
    fn chroma(&self, u: u8, v: u8) -> [i16; 3] {
        let (u, v) = (i16::from(u) - 128, i16::from(v) - 128);
        let green = product(u, self.green[0]) + product(v, self.green[1]);
        [product(v, self.red_v), green, product(u, self.blue_u)]
    }

    /// What a row of chroma adds, a term a pixel: each sample stands for its block.
    fn terms(&self, [u, v]: [&[u8]; 2], shift: u32, [red, green, blue]: &mut [Vec<i16>; 3]) {
        let samples = u.iter().zip(v).map(|(&u, &v)| self.chroma(u, v));
        if shift == 0 {
            for (((red, green), blue), terms) in red.iter_mut().zip(green).zip(blue).zip(samples) {
                [*red, *green, *blue] = terms;
            }
            return;
        }
        for (block, terms) in samples.enumerate() {
            let columns = block << shift..(block + 1) << shift;
            for (all, term) in [&mut *red, green, blue].into_iter().zip(terms) {
                all[columns.clone()].fill(term);
            }
        }
    }

    /// A row of pixels.
    fn row(&self, luma: &[u8], terms: &[Vec<i16>; 3], out: &mut [u8]) {
        let [red, green, blue] = terms.each_ref().map(|terms| terms.as_chunks::<LANES>());
        let (lanes, rest) = luma.as_chunks::<LANES>();
        let (pixels, last) = out.as_chunks_mut::<{ 3 * LANES }>();
        let terms = red.0.iter().zip(green.0).zip(blue.0);
        for ((luma, ((red, green), blue)), pixels) in lanes.iter().zip(terms).zip(pixels) {
            let [red, green, blue] = self.lanes(luma, [red, green, blue]);
            for (k, pixel) in pixels.as_chunks_mut().0.iter_mut().enumerate() {
                *pixel = [red[k], green[k], blue[k]];
            }
        }
        for (k, (&luma, pixel)) in rest.iter().zip(last.as_chunks_mut().0).enumerate() {
            let luma = product(i16::from(luma) - self.black, self.luma);
            *pixel = [red.1[k], green.1[k], blue.1[k]].map(|term| (luma + term).clamp(0, 255) as u8);
        }
    }

    fn lanes(&self, luma: &[u8; LANES], terms: [&[i16; LANES]; 3]) -> [[u8; LANES]; 3] {
        let luma = luma.map(|luma| product(i16::from(luma) - self.black, self.luma));
        terms.map(|terms| std::array::from_fn(|k| (luma[k] + terms[k]).clamp(0, 255) as u8))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn planes(size: [usize; 2], shift: [u32; 2], colour: Colour) -> Planes {
        let [w, h] = size;
        let (cw, ch) = (w >> shift[0], h >> shift[1]);
        let make = |count: usize, a: usize| (0..count).map(|k| (40 + k * a % 160) as u8).collect();
        Planes { size, shift, colour, planes: [make(w * h, 7), make(cw * ch, 13), make(cw * ch, 29)] }
    }

    /// The formulas in plain numbers.
    fn exact(planes: &Planes, x: usize, y: usize) -> [f64; 3] {
        let chroma = (y >> planes.shift[1]) * (planes.size[0] >> planes.shift[0]) + (x >> planes.shift[0]);
        let (kr, kb) = planes.colour.weights();
        let luma = f64::from(planes.planes[0][y * planes.size[0] + x]);
        let [u, v] = [1, 2].map(|k| f64::from(planes.planes[k][chroma]) - 128.0);
        let (luma, u, v) = if planes.colour.full_range {
            (luma, u, v)
        } else {
            ((luma - 16.0) * 255.0 / 219.0, u * 255.0 / 224.0, v * 255.0 / 224.0)
        };
        let (red, blue) = (luma + 2.0 * (1.0 - kr) * v, luma + 2.0 * (1.0 - kb) * u);
        [red, (luma - kr * red - kb * blue) / (1.0 - kr - kb), blue]
    }

    #[test]
    fn every_matrix_and_layout_gives_the_formula() {
        for matrix in [1, 2, 4, 5, 6, 7, 9] {
            for (full_range, shift) in [(false, [1, 1]), (true, [1, 0]), (false, [0, 1]), (true, [0, 0])] {
                let planes = planes([12, 8], shift, Colour { matrix, full_range });
                assert!(planes.is_sound());
                let rgb = planes.to_rgb();
                for (x, y, pixel) in rgb.enumerate_pixels() {
                    let exact = exact(&planes, x as usize, y as usize);
                    for (found, exact) in pixel.0.iter().zip(exact) {
                        let exact = exact.clamp(0.0, 255.0);
                        // Two or three products are rounded down.
                        let off = exact - f64::from(*found);
                        assert!((-0.1..3.1).contains(&off), "{matrix} {x} {y}: {found} {exact}");
                    }
                }
            }
        }
    }

    /// How far each sample of a reduced picture is from the average of the full one.
    fn differences(planes: &Planes, orientation: Orientation, divisor: usize) -> Vec<f64> {
        let full = planes.clone().picture(orientation, 1);
        let small = planes.clone().picture(orientation, divisor);
        let d = divisor as u32;
        assert_eq!(small.dimensions(), (full.width() / d, full.height() / d));
        let at = |x: u32, y: u32, k: usize| f64::from(full.get_pixel(x, y).0[k]);
        let mean = |x: u32, y: u32, k: usize| {
            let sum: f64 = (0..d * d).map(|n| at(x * d + n % d, y * d + n / d, k)).sum();
            sum / f64::from(d * d)
        };
        let pixels = small.enumerate_pixels();
        pixels.flat_map(|(x, y, pixel)| [0, 1, 2].map(|k| f64::from(pixel.0[k]) - mean(x, y, k))).collect()
    }

    #[test]
    fn a_reduced_picture_is_the_average_of_the_full_one() {
        let cases = [
            ([16, 8], 0, 2),
            ([16, 24], 1, 4),
            ([14, 10], 0, 4),
            ([18, 12], 3, 3),
            ([6, 4], 2, 1),
            ([32, 32], 3, 8),
        ];
        for (size, turns, divisor) in cases {
            let orientation = Orientation { mirrored: turns == 3, turns };
            let mut planes = planes(size, [1, 1], Colour::default());
            // Weak colours: an average of planes cannot know of what is clipped.
            for chroma in &mut planes.planes[1..] {
                chroma.iter_mut().for_each(|value| *value = 116 + *value / 10);
            }
            let all = differences(&planes, orientation, divisor);
            let mean = all.iter().sum::<f64>() / all.len() as f64;
            assert!(mean.abs() < 1.0, "{size:?}: off by {mean} in the mean");
            planes.planes[1].fill(120);
            planes.planes[2].fill(135);
            // Both sides round luma: to whole levels, and its product down.
            for off in differences(&planes, orientation, divisor) {
                assert!(off.abs() < 1.6, "{size:?}: {off}");
            }
        }
    }
}
