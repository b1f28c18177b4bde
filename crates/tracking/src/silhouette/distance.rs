//! The signed Euclidean distance of every pixel from the silhouette's border, in pixels.
//!
//! With S the centres of the subject pixels and B those of the background pixels,
//!
//! - outside: sd(p) = min over q in S of ‖p − q‖ − ½,
//! - inside: sd(p) = ½ − min over q in B of ‖p − q‖,
//!
//! so the border lies halfway between neighbouring pixel centres and sd is negative inside. The squared distance splits
//! (Felzenszwalb & Huttenlocher, "Distance Transforms of Sampled Functions", Theory of Computing 8, 2012):
//!
//! d²(x, y) = min over x' of (x − x')² + g(x', y)², where g(x', y) is the distance to the nearest seed in column x'.
//!
//! A first pass finds g for all columns, a second the lower envelope of the parabolas in each row. Beyond the nearest seed
//! of its own row a pixel need not look, so each run between two seeds has an envelope of its own.

use super::mask::{Label, Mask};
use super::near_distance::{MAX_MARGIN, near_distances};

/// Stands for "no seed in this column". Grows by less than 2²⁶ in a pass, so it can neither overflow nor be mistaken for
/// a distance in an image of at most 2²⁶ pixels.
const NO_SEED: i32 = 1 << 28;

/// The signed distance of every pixel from the border of the subject, in pixels; negative inside.
///
/// Unknown pixels are seeds for nobody: a subject pixel's distance is to the nearest pixel *known* to be background, and
/// the other way round. An unknown pixel itself has its distance to the nearest subject pixel. Values are exact up to the
/// rounding of `f32`. Where there is no border, because no pixel is subject (or none is background), the distance is
/// `width + height` (or its negative), farther than any real one: it is never infinite and never NaN.
#[derive(Clone, Debug, PartialEq)]
pub struct SignedDistance {
    width: usize,
    height: usize,
    values: Vec<f32>,
}

impl SignedDistance {
    /// The signed distances of a mask.
    pub fn from_mask(mask: &Mask) -> Self {
        let (width, height) = (mask.width(), mask.height());
        let far = (width + height) as f32;
        let mut values = vec![far; width * height];
        let mut envelope = Envelope { parabolas: Vec::with_capacity(width) };
        let outside = column_distances(mask, Label::Subject);
        for ((values, g), labels) in rows(&mut values, &outside, mask.labels(), width) {
            for_runs(labels, Label::Subject, |run| {
                envelope.build(g, &run);
                if envelope.squared_distances(values, &run) {
                    values[run.start..run.end].iter_mut().for_each(|value| *value = value.sqrt() - 0.5);
                }
            });
        }
        let inside = column_distances(mask, Label::Background);
        let mut squared = vec![0.0; width];
        for ((values, g), labels) in rows(&mut values, &inside, mask.labels(), width) {
            if !labels.contains(&Label::Subject) {
                continue;
            }
            for_runs(labels, Label::Background, |run| {
                let pixels = run.start..run.end;
                squared[pixels.clone()].fill((far + 0.5).powi(2));
                envelope.build(g, &run);
                envelope.squared_distances(&mut squared, &run);
                let found = values[pixels.clone()].iter_mut().zip(&squared[pixels.clone()]);
                for ((value, squared), &label) in found.zip(&labels[pixels]) {
                    *value = if label == Label::Subject { 0.5 - squared.sqrt() } else { *value };
                }
            });
        }
        Self { width, height, values }
    }

    /// The signed distances of a mask, exact where they are at most `reach_px` on either side. Beyond that they have the
    /// right sign and are at least `reach_px`, which is all that a ramp of that width needs, and several times faster.
    pub fn from_mask_within(mask: &Mask, reach_px: f32) -> Self {
        // A float cast saturates; one pixel more makes room for the half pixel to the border.
        let margin = (reach_px.ceil() as usize).saturating_add(1);
        match mask.bounds() {
            Some(bounds) if margin <= MAX_MARGIN && mask.labels().contains(&Label::Background) => {
                let values = near_distances(mask, bounds, margin, (mask.width() + mask.height()) as f32);
                Self { width: mask.width(), height: mask.height(), values }
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
}

/// The rows of three images of the same width, side by side.
fn rows<'a>(
    values: &'a mut [f32],
    g: &'a [i32],
    labels: &'a [Label],
    width: usize,
) -> impl Iterator<Item = ((&'a mut [f32], &'a [i32]), &'a [Label])> {
    values.chunks_exact_mut(width).zip(g.chunks_exact(width)).zip(labels.chunks_exact(width))
}

/// For each pixel the distance to the nearest pixel with label `seed` in the same column, or at least [`NO_SEED`].
fn column_distances(mask: &Mask, seed: Label) -> Vec<i32> {
    let width = mask.width();
    let mut g: Vec<i32> =
        mask.labels().iter().map(|&label| if label == seed { 0 } else { NO_SEED }).collect();
    for y in 1..mask.height() {
        let (above, here) = g.split_at_mut(y * width);
        for (here, above) in here[..width].iter_mut().zip(&above[(y - 1) * width..]) {
            *here = (*here).min(above + 1);
        }
    }
    for y in (1..mask.height()).rev() {
        let (above, here) = g.split_at_mut(y * width);
        for (above, here) in above[(y - 1) * width..].iter_mut().zip(&here[..width]) {
            *above = (*above).min(here + 1);
        }
    }
    g
}

/// A run of pixels without seed, and the row's seeds at its ends where there are any: `[first, start)` has at most one
/// pixel, and so has `[end, last)`.
struct Run {
    first: usize,
    start: usize,
    end: usize,
    last: usize,
}

/// Calls `visit` for every maximal run of pixels that do not have the label `seed`.
fn for_runs(labels: &[Label], seed: Label, mut visit: impl FnMut(Run)) {
    let mut x = 0;
    while let Some(skipped) = labels[x..].iter().position(|&label| label != seed) {
        let start = x + skipped;
        let end = labels[start..].iter().position(|&label| label == seed).map_or(labels.len(), |n| start + n);
        visit(Run { first: start.saturating_sub(1), start, end, last: (end + 1).min(labels.len()) });
        x = end;
    }
}

/// The parabola (x − apex)² + height, as a function of x, and where it meets the one left of it in the envelope: at
/// x = `crossing` / (2 `gap`).
#[derive(Clone, Copy, Debug, Default)]
struct Parabola {
    apex: f64,
    height: f64,
    gap: f64,
    crossing: f64,
}

impl Parabola {
    /// This parabola as the right neighbour of `left`.
    fn after(self, left: Self) -> Self {
        let gap = self.apex - left.apex;
        Self { gap, crossing: self.height - left.height + gap * (self.apex + left.apex), ..self }
    }
}

/// The lower envelope of parabolas, from left to right. Kept between rows only to save allocations.
#[derive(Debug)]
struct Envelope {
    parabolas: Vec<Parabola>,
}

impl Envelope {
    /// The envelope of the columns of a run.
    fn build(&mut self, g: &[i32], run: &Run) {
        self.parabolas.clear();
        for (x, &g) in (run.first..run.last).zip(&g[run.first..run.last]) {
            if g >= NO_SEED {
                continue;
            }
            let mut new =
                Parabola { apex: x as f64, height: f64::from(g) * f64::from(g), ..Parabola::default() };
            while let Some(&last) = self.parabolas.last() {
                new = new.after(last);
                // The last parabola is nowhere the lowest if it meets its left neighbour no earlier than the new one.
                // Exact while (w² + h²)·w < 2⁵³, that is for sides up to 100 000 pixels.
                let hidden = self.parabolas.len() > 1 && last.crossing * new.gap >= new.crossing * last.gap;
                if !hidden {
                    break;
                }
                self.parabolas.pop();
            }
            self.parabolas.push(new);
        }
    }

    /// Writes d² for each pixel of the run. If there is no parabola it leaves the pixels alone and returns false.
    fn squared_distances(&self, values: &mut [f32], run: &Run) -> bool {
        let mut x = run.start;
        for (index, parabola) in self.parabolas.iter().enumerate() {
            let end = match self.parabolas.get(index + 1) {
                // A float cast rounds down, and to 0 what is left of the image.
                Some(next) => ((0.5 * next.crossing / next.gap + 1.0) as usize).clamp(x, run.end),
                None => run.end,
            };
            let (apex, height) = (parabola.apex as f32, parabola.height as f32);
            for (offset, value) in values[x..end].iter_mut().enumerate() {
                let distance = (x + offset) as f32 - apex;
                *value = distance * distance + height;
            }
            x = end;
        }
        !self.parabolas.is_empty()
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

    proptest! {
        #[test]
        fn equals_brute_force(mask in any_mask()) {
            let distance = SignedDistance::from_mask(&mask);
            for (i, (found, expected)) in distance.values().iter().zip(brute_force(&mask)).enumerate() {
                prop_assert!(
                    (found - expected).abs() <= 1e-6 * expected.abs(),
                    "pixel {i}: {found} instead of {expected} in\n{mask}"
                );
            }
        }
    }

    proptest! {
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
    fn the_border_lies_halfway_between_pixel_centres() {
        let mask = Mask::from_ascii("..##..").unwrap();
        assert_eq!(SignedDistance::from_mask(&mask).values(), [1.5, 0.5, -0.5, -0.5, 0.5, 1.5]);
    }

    #[test]
    fn unknown_pixels_are_no_border() {
        let mask = Mask::from_ascii(".?##?.").unwrap();
        assert_eq!(SignedDistance::from_mask(&mask).values(), [1.5, 0.5, -1.5, -1.5, 0.5, 1.5]);
    }

    #[test]
    fn without_a_border_the_distance_is_far_but_finite() {
        for (label, expected) in [(Label::Background, 7.0), (Label::Subject, -7.0), (Label::Unknown, 7.0)] {
            let mask = Mask::filled(4, 3, label).unwrap();
            assert_eq!(SignedDistance::from_mask(&mask).values(), [expected; 12]);
        }
    }
}
