//! Signed distances up to a margin, by looking at every column within that margin.
//!
//! d²(x, y) = min over |k| ≤ margin of g²(x + k, y) + k², as in the exact transform, but in 16-bit lanes and without
//! branches: for the few dozen pixels that a ramp needs this beats the envelope of parabolas. A block of pixels stops
//! looking once k² reaches its largest d², so pixels near the border are cheap.

use std::ops::Range;

use pulp::{Simd, WithSimd};

use super::mask::{Label, Mask, PixelBox};

/// Distances of this many pixels or more are all the same: its square is the largest that fits 16 bits.
const FAR_PX: i16 = 181;

/// The widest margin: some way below [`FAR_PX`], so that what is beyond it cannot look nearer.
pub(super) const MAX_MARGIN: usize = 160;

/// Pixels that are worked on together.
const BLOCK: usize = 32;

/// How many columns on either side are looked at between two looks at the largest distance of a block.
const STEPS: usize = 4;

/// The signed distances of a mask, row by row: exact up to `margin` − ½, at least that beyond, and `far` outside the box
/// of the subject grown by `margin`; and in the same way those from the nearest unknown pixel, if there is any. The work is
/// compiled once more for wider vectors.
pub(super) struct NearDistances<'a> {
    pub(super) mask: &'a Mask,
    pub(super) subject: PixelBox,
    /// At most [`MAX_MARGIN`].
    pub(super) margin: usize,
    pub(super) far: f32,
}

impl WithSimd for NearDistances<'_> {
    type Output = (Vec<f32>, Vec<f32>);

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> (Vec<f32>, Vec<f32>) {
        let Self { mask, subject, margin, far } = self;
        let mut values = vec![far; mask.labels().len()];
        let window = Window::new(mask, subject, margin);
        window.write_distances_from::<false>(Label::Subject, &mut values);
        window.write_distances_from::<true>(Label::Background, &mut values);
        let mut to_unknown = Vec::new();
        if let Some(unknown) = mask.bounds_of(Label::Unknown) {
            to_unknown.resize(values.len(), far);
            Window::new(mask, unknown, margin).write_distances_from::<false>(Label::Unknown, &mut to_unknown);
        }
        (values, to_unknown)
    }
}

/// The part of a mask that is looked at: a box grown by the margin.
struct Window<'a> {
    rows: Range<usize>,
    columns: Range<usize>,
    labels: Vec<&'a [Label]>,
    image_width: usize,
    margin: usize,
}

impl<'a> Window<'a> {
    fn new(mask: &'a Mask, bounds: PixelBox, margin: usize) -> Self {
        let width = mask.width();
        let span =
            |min: usize, max: usize, size: usize| min.saturating_sub(margin)..(max + margin + 1).min(size);
        let columns = span(bounds.x_min, bounds.x_max, width);
        let rows = span(bounds.y_min, bounds.y_max, mask.height());
        let labels = rows.clone().map(|y| &mask.labels()[y * width..][columns.clone()]).collect();
        Self { rows, columns, labels, image_width: width, margin }
    }

    /// Writes the distance from the nearest pixel with a label, less a half; with `INSIDE` the opposite of that, and to
    /// subject pixels alone.
    #[inline(always)]
    fn write_distances_from<const INSIDE: bool>(&self, label: Label, values: &mut [f32]) {
        let width = self.columns.len();
        let distances = column_distances(&self.labels, label);
        let mut search = NearSearch::new(width, self.margin);
        for ((y, g), labels) in self.rows.clone().zip(distances.chunks_exact(width)).zip(&self.labels) {
            if INSIDE && !labels.contains(&Label::Subject) {
                continue;
            }
            let squared = search.squared_distances(g);
            let values = &mut values[y * self.image_width..][self.columns.clone()];
            for ((value, &squared), &label) in values.iter_mut().zip(squared).zip(*labels) {
                let distance = f32::from(squared).sqrt();
                *value = match (INSIDE, label) {
                    (false, _) => distance - 0.5,
                    (true, Label::Subject) => 0.5 - distance,
                    (true, _) => *value,
                };
            }
        }
    }
}

/// For each pixel the distance to the nearest pixel with label `seed` in the same column, at most [`FAR_PX`].
#[inline(always)]
fn column_distances(labels: &[&[Label]], seed: Label) -> Vec<i16> {
    let width = labels.first().map_or(0, |row| row.len());
    let mut g: Vec<i16> = Vec::with_capacity(width * labels.len());
    for row in labels {
        g.extend(row.iter().map(|&label| if label == seed { 0 } else { FAR_PX }));
    }
    for y in 1..labels.len() {
        let (above, here) = g.split_at_mut(y * width);
        for (here, above) in here[..width].iter_mut().zip(&above[(y - 1) * width..]) {
            *here = (*here).min(above + 1);
        }
    }
    for y in (1..labels.len()).rev() {
        let (above, here) = g.split_at_mut(y * width);
        for (above, here) in above[(y - 1) * width..].iter_mut().zip(&here[..width]) {
            *above = (*above).min(here + 1);
        }
    }
    g
}

/// Buffers for one row.
struct NearSearch {
    margin: usize,
    /// g² of the row, with the margin on both sides and up to a whole number of blocks.
    squares: Vec<i16>,
    found: Vec<i16>,
}

impl NearSearch {
    fn new(width: usize, margin: usize) -> Self {
        let blocks = width.next_multiple_of(BLOCK);
        // Looking goes in whole steps, so it may reach a little beyond the margin.
        let margin = margin.next_multiple_of(STEPS);
        Self { margin, squares: vec![FAR_PX * FAR_PX; blocks + 2 * margin], found: vec![0; blocks] }
    }

    /// The squared distances of a row with these column distances (and a few entries more, to fill a block).
    #[inline(always)]
    fn squared_distances(&mut self, g: &[i16]) -> &[i16] {
        let margin = self.margin;
        for (square, &g) in self.squares[margin..].iter_mut().zip(g) {
            *square = g * g;
        }
        for (start, found) in (margin..).step_by(BLOCK).zip(self.found.chunks_exact_mut(BLOCK)) {
            let in_reach = &self.squares[start - margin..start + BLOCK + margin];
            if in_reach.iter().fold(i16::MAX, |a, &b| a.min(b)) as usize > margin * margin {
                found.fill(FAR_PX * FAR_PX);
                continue;
            }
            let mut best = [0; BLOCK];
            best.copy_from_slice(&self.squares[start..start + BLOCK]);
            for first in (1..=margin).step_by(STEPS) {
                let largest = best.iter().fold(0, |a: i16, &b| a.max(b));
                if first * first >= largest as usize {
                    break;
                }
                for k in first..first + STEPS {
                    let left = &self.squares[start - k..start - k + BLOCK];
                    let right = &self.squares[start + k..start + k + BLOCK];
                    let square = (k * k) as i16;
                    for ((best, &left), &right) in best.iter_mut().zip(left).zip(right) {
                        *best = (*best).min(left.min(right).saturating_add(square));
                    }
                }
            }
            found.copy_from_slice(&best);
        }
        &self.found
    }
}
