//! The share of background among the known pixels of a small box around each pixel, and that of known pixels.
//!
//! Counts of a box of at most 15² pixels fit a byte, so sums run over 16 or 32 pixels at once: first down the columns,
//! row by row, then along the row.

use pulp::{Simd, WithSimd};

use crate::processor;

use super::mask::{Label, Mask};
use super::measurement::weight;

/// The largest radius whose counts fit a byte.
const MAX_RADIUS: usize = 7;

/// Replaces the values by, for each pixel, the first level · (background pixels) / (known pixels), counted in the box of
/// (2 · `radius` + 1)² around it and in the image; by the second level where none is known. The weight of a known pixel
/// becomes (known pixels) / (pixels) of its box, that of an unknown one nothing.
pub(super) fn box_average(
    mask: &Mask,
    radius: usize,
    levels: [f32; 2],
    values: &mut Vec<f32>,
    weights: &mut Vec<f32>,
) {
    values.clear();
    weights.clear();
    if radius <= MAX_RADIUS {
        processor::run(BoxAverage { mask, radius, levels, values, weights });
    } else {
        wide_box_average(mask, radius, levels, values, weights);
    }
}

/// How many entries of a row of this many lie within a radius of one of them.
fn within(radius: usize, size: usize, at: usize) -> usize {
    at.saturating_add(radius + 1).min(size) - at.saturating_sub(radius)
}

/// The arguments of [`box_average`] for a small box, whose work is compiled once more for wider vectors.
struct BoxAverage<'a> {
    mask: &'a Mask,
    radius: usize,
    levels: [f32; 2],
    values: &'a mut Vec<f32>,
    weights: &'a mut Vec<f32>,
}

impl WithSimd for BoxAverage<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { mask, radius, levels: [level, unknown_level], values, weights } = self;
        let (width, height) = (mask.width(), mask.height());
        // Counts of each column within the rows of the box, with the radius on both sides.
        let [mut known, mut background] =
            [const { Vec::<u8>::new() }; 2].map(|_| vec![0; width + 2 * radius]);
        let [mut known_in_box, mut background_in_box] =
            [const { Vec::<u8>::new() }; 2].map(|_| vec![0; width]);
        values.reserve_exact(width * height);
        weights.reserve_exact(width * height);
        let columns_in_box: Vec<f32> = (0..width).map(|x| within(radius, width, x) as f32).collect();
        let row = |y: usize| &mask.labels()[y * width..][..width];
        for y in 0..height + radius {
            if y < height {
                let counts = known[radius..].iter_mut().zip(&mut background[radius..]).zip(row(y));
                for ((known, background), &label) in counts {
                    *known += u8::from(label != Label::Unknown);
                    *background += u8::from(label == Label::Background);
                }
            }
            if y > 2 * radius {
                let counts =
                    known[radius..].iter_mut().zip(&mut background[radius..]).zip(row(y - 2 * radius - 1));
                for ((known, background), &label) in counts {
                    *known -= u8::from(label != Label::Unknown);
                    *background -= u8::from(label == Label::Background);
                }
            }
            if y < radius {
                continue;
            }
            sum_windows(&known, 2 * radius + 1, &mut known_in_box);
            sum_windows(&background, 2 * radius + 1, &mut background_in_box);
            values.extend(known_in_box.iter().zip(&background_in_box).map(|(&known, &background)| {
                let share = level * f32::from(background) / f32::from(known);
                if known == 0 { unknown_level } else { share }
            }));
            let rows_in_box = within(radius, height, y - radius) as f32;
            let known = known_in_box.iter().zip(&columns_in_box).zip(row(y - radius));
            weights.extend(known.map(|((&known, &columns), label)| {
                weight(label) * f32::from(known) / (columns * rows_in_box)
            }));
        }
    }
}

/// The sum of each entry and the `length` − 1 that follow.
#[inline(always)]
fn sum_windows(counts: &[u8], length: usize, sums: &mut [u8]) {
    sums.fill(0);
    for shift in 0..length {
        for (sum, &count) in sums.iter_mut().zip(&counts[shift..]) {
            *sum += count;
        }
    }
}

/// [`box_average`] for a box of any size.
fn wide_box_average(
    mask: &Mask,
    radius_px: usize,
    [level, unknown_level]: [f32; 2],
    values: &mut Vec<f32>,
    weights: &mut Vec<f32>,
) {
    let (width, height) = (mask.width(), mask.height());
    let mut sums = ColumnSums::new(width);
    let mut prefix = Vec::with_capacity(width + 1);
    let row = |y: usize| &mask.labels()[y * width..(y + 1) * width];
    (0..radius_px.min(height)).for_each(|y| sums.add(row(y)));
    for y in 0..height {
        if let Some(entering) = y.checked_add(radius_px).filter(|&entering| entering < height) {
            sums.add(row(entering));
        }
        if let Some(leaving) = y.checked_sub(radius_px + 1) {
            sums.remove(row(leaving));
        }
        sums.prefix_into(&mut prefix);
        for x in 0..width {
            let [low, high] = [x.saturating_sub(radius_px), x.saturating_add(radius_px + 1).min(width)];
            let (known, background) = (prefix[high].0 - prefix[low].0, prefix[high].1 - prefix[low].1);
            values.push(match known {
                0 => unknown_level,
                _ => level * background as f32 / known as f32,
            });
            let pixels = within(radius_px, width, x) * within(radius_px, height, y);
            weights.push(weight(&row(y)[x]) * known as f32 / pixels as f32);
        }
    }
}

/// How many known and how many background pixels each column has in the rows added so far.
struct ColumnSums {
    known: Vec<u32>,
    background: Vec<u32>,
}

impl ColumnSums {
    fn new(width: usize) -> Self {
        Self { known: vec![0; width], background: vec![0; width] }
    }

    fn add(&mut self, row: &[Label]) {
        for ((known, background), &label) in self.known.iter_mut().zip(&mut self.background).zip(row) {
            *known += u32::from(label != Label::Unknown);
            *background += u32::from(label == Label::Background);
        }
    }

    fn remove(&mut self, row: &[Label]) {
        for ((known, background), &label) in self.known.iter_mut().zip(&mut self.background).zip(row) {
            *known -= u32::from(label != Label::Unknown);
            *background -= u32::from(label == Label::Background);
        }
    }

    /// The sums of all columns left of each; one entry more than there are columns.
    fn prefix_into(&self, prefix: &mut Vec<(u32, u32)>) {
        prefix.clear();
        let mut sum = (0, 0);
        prefix.push(sum);
        for (known, background) in self.known.iter().zip(&self.background) {
            sum = (sum.0 + known, sum.1 + background);
            prefix.push(sum);
        }
    }
}
