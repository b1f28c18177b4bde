//! The share of background among the known pixels of a small box around each pixel, and that of known pixels.
//!
//! Counts of a box of at most 15² pixels fit a byte, so sums run over 16 or 32 pixels at once: first down the columns,
//! row by row, then along the row.

use pulp::{Simd, WithSimd};

use crate::processor;

use super::mask::{Label, Mask};
use super::measurement::{BACKGROUND_LEVEL, UNKNOWN_LEVEL, weight};

/// The largest radius whose counts fit a byte.
const MAX_RADIUS: usize = 7;

/// Replaces the values by, for each pixel, 255 · (background pixels) / (known pixels), counted in the box of
/// (2 · `radius` + 1)² around it and in the image; by [`UNKNOWN_LEVEL`] where none is known. The weight of a known pixel
/// becomes (known pixels) / (pixels) of its box, that of an unknown one nothing.
pub(super) fn box_average(mask: &Mask, radius: usize, values: &mut Vec<f32>, weights: &mut Vec<f32>) {
    values.clear();
    weights.clear();
    if radius <= MAX_RADIUS {
        processor::run(BoxAverage { mask, radius, values, weights });
    } else {
        wide_box_average(mask, radius, values, weights);
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
    values: &'a mut Vec<f32>,
    weights: &'a mut Vec<f32>,
}

impl WithSimd for BoxAverage<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { mask, radius, values, weights } = self;
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
                let share = BACKGROUND_LEVEL * f32::from(background) / f32::from(known);
                if known == 0 { UNKNOWN_LEVEL } else { share }
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
fn wide_box_average(mask: &Mask, radius: usize, values: &mut Vec<f32>, weights: &mut Vec<f32>) {
    let (width, height) = (mask.width(), mask.height());
    let row = |y: usize| &mask.labels()[y * width..][..width];
    let counts = |label: Label| [label != Label::Unknown, label == Label::Background].map(usize::from);
    // Known and background pixels of each column within the rows of the box; then of all columns left of each.
    let mut columns = vec![[0; 2]; width];
    let mut before = vec![[0; 2]; width + 1];
    let mut entered = 0;
    for y in 0..height {
        while entered < y.saturating_add(radius + 1).min(height) {
            for (column, &label) in columns.iter_mut().zip(row(entered)) {
                *column = [0, 1].map(|kind| column[kind] + counts(label)[kind]);
            }
            entered += 1;
        }
        if let Some(leaving) = y.checked_sub(radius + 1) {
            for (column, &label) in columns.iter_mut().zip(row(leaving)) {
                *column = [0, 1].map(|kind| column[kind] - counts(label)[kind]);
            }
        }
        for (x, column) in columns.iter().enumerate() {
            before[x + 1] = [0, 1].map(|kind| before[x][kind] + column[kind]);
        }
        for x in 0..width {
            let [low, high] = [x.saturating_sub(radius), x.saturating_add(radius + 1).min(width)];
            let [known, background] = [0, 1].map(|kind| before[high][kind] - before[low][kind]);
            values.push(match known {
                0 => UNKNOWN_LEVEL,
                _ => BACKGROUND_LEVEL * background as f32 / known as f32,
            });
            let pixels = within(radius, width, x) * within(radius, height, y);
            weights.push(weight(&row(y)[x]) * known as f32 / pixels as f32);
        }
    }
}
