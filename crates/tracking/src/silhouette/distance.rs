//! The signed Euclidean distance of every pixel from the silhouette's border, in pixels.
//!
//! With S the centres of the subject pixels and B those of the background pixels,
//!
//! - outside: sd(p) = min over q in S of ‖p − q‖ − ½,
//! - inside: sd(p) = ½ − min over q in B of ‖p − q‖,
//!
//! so the border lies halfway between neighbouring pixel centres and sd is negative inside. With U those of the unknown
//! pixels, B is B ∪ U if all of them are background, and S is S ∪ U if all are subject: sd lies between what the two
//! give. For a known pixel one of them is sd as above, and the other has min(|sd|, min over q in U of ‖p − q‖ − ½) for
//! its length. The squared distance splits
//! (Felzenszwalb & Huttenlocher, "Distance Transforms of Sampled Functions", Theory of Computing 8, 2012):
//!
//! d²(x, y) = min over x' of (x − x')² + g(x', y)², where g(x', y) is the distance to the nearest seed in column x'.
//!
//! A scan down and one up find g for all columns; [`RowSearch`] finds the minimum in each row. The scan up goes on one row
//! ahead of the search, so it is never stored.

use std::ops::Range;

use pulp::{Simd, WithSimd};

use crate::processor;

use super::mask::{Label, Mask, PixelBox};
use super::near_distance::{MAX_MARGIN, NearDistances};
use super::row_search::RowSearch;

/// Stands for "no seed in this column". Grows by less than 2²⁶ in a scan, so it can neither overflow nor be mistaken for
/// a distance in an image of at most 2²⁶ pixels.
const NO_SEED: i32 = 1 << 28;

/// The signed distance of every pixel from the border of the subject, in pixels; negative inside.
///
/// A subject pixel's distance is to the nearest pixel *known* to be background, and the other way round; what the unknown
/// pixels between them could change is the other end of its [`range`](Self::range). An unknown pixel itself has its
/// distance to the nearest subject pixel. Values are exact up to the rounding of `f32`. Where there is no border, because
/// no pixel is subject (or none is background), the distance is `width + height` (or its negative), farther than any real
/// one: it is never infinite and never NaN.
#[derive(Clone, Debug, PartialEq)]
pub struct SignedDistance {
    width: usize,
    height: usize,
    values: Vec<f32>,
    /// Distance from the nearest unknown pixel, less a half; empty where every pixel is known.
    to_unknown: Vec<f32>,
}

impl SignedDistance {
    /// The signed distances of a mask.
    pub fn from_mask(mask: &Mask) -> Self {
        let (width, height) = (mask.width(), mask.height());
        let (values, to_unknown) = processor::run(Transform { mask });
        Self { width, height, values, to_unknown }
    }

    /// The signed distances of a mask, exact where they are at most `reach_px` on either side. Beyond that they have the
    /// right sign and are at least `reach_px`, which is all that a ramp of that width needs, and several times faster.
    pub fn from_mask_within(mask: &Mask, reach_px: f32) -> Self {
        // A float cast saturates; one pixel more makes room for the half pixel to the border.
        let margin = (reach_px.ceil() as usize).saturating_add(1);
        match mask.bounds() {
            Some(subject) if margin <= MAX_MARGIN && mask.labels().contains(&Label::Background) => {
                let work = NearDistances { mask, subject, margin, far: far(mask) };
                let (values, to_unknown) = processor::run(work);
                Self { width: mask.width(), height: mask.height(), values, to_unknown }
            }
            _ => Self::from_mask(mask),
        }
    }

    /// Width in pixels.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> usize {
        self.height
    }

    /// All distances in pixels, row by row.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// The least and the greatest distance that a pixel may have: with all unknown pixels subject, and with all
    /// background. Of a pixel that is unknown itself −½ stands for the least: it may lie anywhere inside.
    ///
    /// # Panics
    /// If there is no such pixel.
    pub fn range(&self, pixel: usize) -> [f32; 2] {
        let known = self.values[pixel];
        match self.to_unknown.get(pixel) {
            None => [known; 2],
            Some(&unknown) if known > 0.0 => [known.min(unknown), known],
            Some(&unknown) => [known, known.max(-unknown)],
        }
    }

    /// Distances from the nearest unknown pixel, less a half, row by row; none where every pixel is known.
    pub(crate) fn to_unknown(&self) -> Option<&[f32]> {
        (!self.to_unknown.is_empty()).then_some(&self.to_unknown)
    }
}

/// Farther than any distance in an image.
fn far(mask: &Mask) -> f32 {
    (mask.width() + mask.height()) as f32
}

/// The work of a transform: signed distances, and those from unknown pixels if there are any. It is compiled once more for
/// wider vectors, and that copy runs where the processor has them.
struct Transform<'a> {
    mask: &'a Mask,
}

impl WithSimd for Transform<'_> {
    type Output = (Vec<f32>, Vec<f32>);

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> (Vec<f32>, Vec<f32>) {
        let (mask, far) = (self.mask, far(self.mask));
        let mut values = vec![far; mask.labels().len()];
        if let Some(subject) = mask.bounds() {
            write_distances_from(simd, mask, Label::Subject, subject, &mut values);
            write_inside(simd, mask, subject, far, &mut values);
        }
        let mut to_unknown = Vec::new();
        if let Some(unknown) = mask.bounds_of(Label::Unknown) {
            to_unknown.resize(values.len(), far);
            write_distances_from(simd, mask, Label::Unknown, unknown, &mut to_unknown);
        }
        (values, to_unknown)
    }
}

/// Writes the distance from the nearest pixel with a label, all of which lie in a box, less a half, to every pixel.
#[inline(always)]
fn write_distances_from<S: Simd>(simd: S, mask: &Mask, label: Label, bounds: PixelBox, values: &mut [f32]) {
    let (width, columns) = (mask.width(), bounds.x_min..bounds.x_max + 1);
    let mut scan = ColumnScan::new(mask, label, columns.clone(), 0..mask.height());
    let mut search = RowSearch::new(simd, width);
    for y in (0..mask.height()).rev() {
        let (above, below) = scan.up(y);
        search.set_columns(columns.start, above, below);
        let squared = search.minima(0..width);
        for (value, squared) in values[y * width..][..width].iter_mut().zip(squared) {
            *value = squared.sqrt() - 0.5;
        }
    }
}

/// Writes a half less the distance from the nearest background pixel to every subject pixel.
#[inline(always)]
fn write_inside<S: Simd>(simd: S, mask: &Mask, subject: PixelBox, far: f32, values: &mut [f32]) {
    let (width, rows) = (mask.width(), subject.y_min..subject.y_max + 1);
    let mut scan = ColumnScan::new(mask, Label::Background, 0..width, rows.clone());
    let mut search = RowSearch::new(simd, width);
    for y in rows.rev() {
        let labels = &mask.labels()[y * width..][..width];
        let (above, below) = scan.up(y);
        let Some((first, last)) = ends(labels, Label::Subject) else { continue };
        // Beyond the row's own nearest background pixels there is none that is nearer.
        let left = labels[..first].iter().rposition(|&label| label == Label::Background).unwrap_or(0);
        let right = labels[last..].iter().position(|&label| label == Label::Background);
        let columns = left..right.map_or(width, |right| last + right + 1);
        search.set_columns(left, &above[columns.clone()], &below[columns]);
        let squared = search.minima(first..last + 1);
        let found = values[y * width + first..].iter_mut().zip(squared).zip(&labels[first..]);
        for ((value, squared), &label) in found {
            let distance = squared.sqrt().min(far + 0.5);
            *value = if label == Label::Subject { 0.5 - distance } else { *value };
        }
    }
}

/// The first and the last pixel with a label, if there is one.
#[inline(always)]
fn ends(labels: &[Label], label: Label) -> Option<(usize, usize)> {
    let first = labels.iter().position(|&other| other == label);
    first.zip(labels.iter().rposition(|&other| other == label))
}

/// Distances of pixels to the nearest seed in their column, for some columns and rows: at least [`NO_SEED`] without one.
struct ColumnScan<'a> {
    mask: &'a Mask,
    seed: Label,
    columns: Range<usize>,
    first_row: usize,
    /// To the nearest seed at or above each pixel.
    above: Vec<i32>,
    /// To the nearest seed at or below each pixel of the row that the scan up has come to.
    below: Vec<i32>,
}

impl<'a> ColumnScan<'a> {
    /// Scans down through the rows, and up from the last row of the image to where the rows end.
    #[inline(always)]
    fn new(mask: &'a Mask, seed: Label, columns: Range<usize>, rows: Range<usize>) -> Self {
        let mut above = Vec::with_capacity(rows.len() * columns.len());
        let below = vec![NO_SEED; columns.len()];
        let mut scan = Self { mask, seed, columns, first_row: rows.start, above: Vec::new(), below };
        for y in 0..rows.end {
            scan.step(y);
            if y >= rows.start {
                above.extend_from_slice(&scan.below);
            }
        }
        scan.below.fill(NO_SEED);
        for y in (rows.end..mask.height()).rev() {
            scan.step(y);
        }
        Self { above, ..scan }
    }

    /// Goes on to row `y`, which follows from below, and gives the distances up and down from it.
    #[inline(always)]
    fn up(&mut self, y: usize) -> (&[i32], &[i32]) {
        self.step(y);
        let width = self.columns.len();
        (&self.above[(y - self.first_row) * width..][..width], &self.below)
    }

    /// Carries the distances on to row `y`, which is the next up or down.
    #[inline(always)]
    fn step(&mut self, y: usize) {
        let labels = &self.mask.labels()[y * self.mask.width()..][self.columns.clone()];
        for (nearest, &label) in self.below.iter_mut().zip(labels) {
            *nearest = if label == self.seed { 0 } else { *nearest + 1 };
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn brute_force(mask: &Mask) -> Vec<f32> {
        let (width, height) = (mask.width(), mask.height());
        let nearest = |x: usize, y: usize, seed: Label| {
            let mut best: Option<usize> = None;
            for (i, &label) in mask.labels().iter().enumerate() {
                if label == seed {
                    let squared = (i % width).abs_diff(x).pow(2) + (i / width).abs_diff(y).pow(2);
                    best = Some(best.map_or(squared, |best| best.min(squared)));
                }
            }
            best.map_or((width + height) as f32 + 0.5, |squared| (squared as f32).sqrt()) - 0.5
        };
        (0..width * height)
            .map(|i| match mask.labels()[i] {
                Label::Subject => -nearest(i % width, i / width, Label::Background),
                _ => nearest(i % width, i / width, Label::Subject),
            })
            .collect()
    }

    fn any_mask() -> impl Strategy<Value = Mask> {
        let label = prop_oneof![
            6 => Just(Label::Background),
            3 => Just(Label::Subject),
            1 => Just(Label::Unknown)
        ];
        (1..24_usize, 1..24_usize, 0..3_usize, proptest::collection::vec(label, 24 * 24)).prop_map(
            |(width, height, scale, labels)| {
                // Blocks of pixels give larger flat areas than single pixels do.
                let at = |i: usize| labels[((i / width) >> scale) * 24 + ((i % width) >> scale)];
                Mask::new(width, height, (0..width * height).map(at).collect()).unwrap()
            },
        )
    }

    /// The mask with all unknown pixels given a label.
    fn filled(mask: &Mask, label: Label) -> Mask {
        let fill = |&old: &Label| if old == Label::Unknown { label } else { old };
        Mask::new(mask.width(), mask.height(), mask.labels().iter().map(fill).collect()).unwrap()
    }

    proptest! {
        #[test]
        fn equals_brute_force(mask in any_mask()) {
            let found = SignedDistance::from_mask(&mask);
            prop_assert_eq!(found.values(), brute_force(&mask), "in\n{}", mask);
        }

        #[test]
        fn the_range_is_what_the_unknown_could_change(mask in any_mask(), reach in 0.0..12_f32) {
            let [least, greatest] = [Label::Subject, Label::Background].map(|label| brute_force(&filled(&mask, label)));
            let (all, near) = (SignedDistance::from_mask(&mask), SignedDistance::from_mask_within(&mask, reach));
            for (i, label) in mask.labels().iter().enumerate() {
                let found = all.range(i);
                if *label == Label::Unknown {
                    prop_assert!(found[0] == -0.5 && found[1] == all.values()[i], "{found:?} in\n{mask}");
                    continue;
                }
                prop_assert_eq!(found, [least[i], greatest[i]], "pixel {} in\n{}", i, mask);
                for (near, all) in near.range(i).into_iter().zip(found) {
                    prop_assert!(near == all || near.signum() == all.signum() && near.abs().min(all.abs()) >= reach);
                }
            }
        }

        #[test]
        fn within_reach_nothing_changes(mask in any_mask(), reach in prop_oneof![0.0..12_f32, Just(1e9), Just(f32::NAN)]) {
            let all = SignedDistance::from_mask(&mask);
            let near = SignedDistance::from_mask_within(&mask, reach);
            for (near, all) in near.values().iter().zip(all.values()) {
                if all.abs() <= reach {
                    prop_assert_eq!(near, all);
                } else if !reach.is_nan() {
                    prop_assert!(near.signum() == all.signum() && near.abs() >= reach, "{} for {}", near, all);
                }
            }
        }
    }

    /// Wide and sparse, so that a row has several blocks and the nearest seed is often far.
    fn wide_mask() -> impl Strategy<Value = Mask> {
        let seeds = proptest::collection::vec((0..160_usize, 0..7_usize, 0..3_usize), 0..9);
        (1..160_usize, 1..7_usize, 0..3_usize, seeds).prop_map(|(width, height, ground, seeds)| {
            let labels = [Label::Background, Label::Subject, Label::Unknown];
            let mut mask = Mask::filled(width, height, labels[ground]).unwrap();
            for (x, y, label) in seeds {
                mask.labels_mut()[y % height * width + x % width] = labels[label];
            }
            mask
        })
    }

    fn by_scalars(mask: &Mask) -> SignedDistance {
        let (values, to_unknown) = Transform { mask }.with_simd(pulp::Scalar::new());
        SignedDistance { width: mask.width(), height: mask.height(), values, to_unknown }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(150))]

        #[test]
        fn wide_rows_equal_brute_force(mask in wide_mask()) {
            let (distance, expected) = (SignedDistance::from_mask(&mask), brute_force(&mask));
            prop_assert_eq!(distance.values(), &expected, "in\n{}", mask);
            prop_assert_eq!(by_scalars(&mask), distance, "in\n{}", mask);
        }
    }

    #[test]
    fn a_long_reach_is_exact_too() {
        let mut labels = vec![Label::Background; 3 * 400];
        labels[400] = Label::Subject;
        let mask = Mask::new(400, 3, labels).unwrap();
        let (all, near) = (SignedDistance::from_mask(&mask), SignedDistance::from_mask_within(&mask, 150.0));
        for row in 0..3 {
            assert_eq!(near.values()[400 * row..][..150], all.values()[400 * row..][..150]);
            assert!(near.values()[400 * row..][150..400].iter().all(|&value| value >= 149.5));
        }
    }

    #[test]
    fn the_border_lies_halfway_between_pixel_centres_and_unknown_pixels_are_none() {
        for (mask, expected) in
            [("..##..", [1.5, 0.5, -0.5, -0.5, 0.5, 1.5]), (".?##?.", [1.5, 0.5, -1.5, -1.5, 0.5, 1.5])]
        {
            let found = SignedDistance::from_mask(&Mask::from_ascii(mask).unwrap());
            assert_eq!(found.values(), expected, "{mask}");
        }
    }

    #[test]
    fn without_a_border_the_distance_is_far_but_finite() {
        for (label, expected) in [(Label::Background, 7.0), (Label::Subject, -7.0), (Label::Unknown, 7.0)] {
            let mask = Mask::filled(4, 3, label).unwrap();
            assert_eq!(SignedDistance::from_mask(&mask).values(), [expected; 12]);
        }
    }
}
