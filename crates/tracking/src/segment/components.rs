//! Connected components of a binary image: drop small ones, fill small holes.
//!
//! Components are joined from runs of equal pixels, row by row, by union-find with path halving. The older run is always
//! the root, so the numbering does not depend on anything but the image.

use std::ops::Range;

use super::bit_image::BitImage;

/// Which neighbours belong together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Connectivity {
    /// Neighbours that share an edge.
    Four,
    /// Neighbours that share an edge or a corner.
    Eight,
}

/// Clears every 8-connected component with fewer pixels than `min_px` or than `min_fraction` of the largest one.
pub(super) fn drop_small(image: &mut BitImage, min_px: usize, min_fraction: f32) {
    let components = Components::find(image, true, Connectivity::Eight);
    let largest = components.sizes.iter().copied().max().unwrap_or(0);
    let limit = min_px.max((f64::from(min_fraction) * largest as f64).ceil() as usize);
    components.paint(image, false, |root| components.sizes[root] < limit);
}

/// Clears every 8-connected component that holds none of the `seeds`, pixels of an image of the same size.
pub(super) fn keep_touching(image: &mut BitImage, seeds: &BitImage) {
    let components = Components::find(image, true, Connectivity::Eight);
    let mut is_seeded = vec![false; components.runs.len()];
    for (run, &root) in components.runs.iter().zip(&components.parents) {
        is_seeded[root] |= seeds
            .runs_from(run.y, run.columns.start, true)
            .next()
            .is_some_and(|seed| seed.start < run.columns.end);
    }
    components.paint(image, false, |root| !is_seeded[root]);
}

/// Sets every hole of at most `max_px` pixels: a 4-connected component of clear pixels that does not reach the image's
/// border.
pub(super) fn fill_holes(image: &mut BitImage, max_px: usize) {
    let components = Components::find(image, false, Connectivity::Four);
    components.paint(image, true, |root| components.sizes[root] <= max_px && !components.at_border[root]);
}

/// A run of equal pixels.
#[derive(Clone, Debug)]
struct PixelRun {
    y: usize,
    columns: Range<usize>,
}

/// The runs of one value, joined. Entries of `sizes` and `at_border` count only at roots.
#[derive(Default)]
struct Components {
    runs: Vec<PixelRun>,
    parents: Vec<usize>,
    sizes: Vec<usize>,
    at_border: Vec<bool>,
}

impl Components {
    fn find(image: &BitImage, value: bool, connectivity: Connectivity) -> Self {
        let mut found = Self::default();
        let reach = usize::from(connectivity == Connectivity::Eight);
        let mut above = 0..0;
        for y in 0..image.height {
            let first = found.runs.len();
            let mut candidate = above.start;
            for columns in image.runs(y, value) {
                let is_at_side = columns.start == 0 || columns.end == image.width;
                found.push(
                    PixelRun { y, columns: columns.clone() },
                    is_at_side || y == 0 || y + 1 == image.height,
                );
                // The runs above that reach this one; the last of them may reach the next one too.
                while candidate < above.end && found.runs[candidate].columns.end + reach <= columns.start {
                    candidate += 1;
                }
                let mut touching = candidate;
                while touching < above.end && found.runs[touching].columns.start < columns.end + reach {
                    found.join(touching);
                    touching += 1;
                }
            }
            above = first..found.runs.len();
        }
        // A parent is never younger than its child, so one pass leads every run straight to its root.
        for run in 0..found.runs.len() {
            found.parents[run] = found.parents[found.parents[run]];
        }
        found
    }

    fn push(&mut self, run: PixelRun, at_border: bool) {
        self.parents.push(self.runs.len());
        self.sizes.push(run.columns.len());
        self.at_border.push(at_border);
        self.runs.push(run);
    }

    /// Joins the newest run with an older one.
    fn join(&mut self, older: usize) {
        let (a, b) = (self.root(older), self.root(self.runs.len() - 1));
        if a != b {
            let (root, child) = (a.min(b), a.max(b));
            self.parents[child] = root;
            self.sizes[root] += self.sizes[child];
            self.at_border[root] |= self.at_border[child];
        }
    }

    fn root(&mut self, mut run: usize) -> usize {
        while self.parents[run] != run {
            self.parents[run] = self.parents[self.parents[run]];
            run = self.parents[run];
        }
        run
    }

    /// Writes `value` to the components whose root is chosen.
    fn paint(&self, image: &mut BitImage, value: bool, choose: impl Fn(usize) -> bool) {
        for (run, &root) in self.runs.iter().zip(&self.parents) {
            if choose(root) {
                image.fill(run.y, run.columns.clone(), value);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn small_components_go_and_diagonal_neighbours_stay_together() {
        let mut image = BitImage::from_ascii("#....## .#...## ..#.... ......#");
        for (min_px, min_fraction, expected) in
            [(3, 0.0, "#....## .#...## ..#.... ......."), (0, 0.9, ".....## .....## ....... .......")]
        {
            drop_small(&mut image, min_px, min_fraction);
            assert_eq!(image, BitImage::from_ascii(expected), "{min_px} px, {min_fraction}");
        }
    }

    #[test]
    fn small_inner_holes_are_filled() {
        let mut image = BitImage::from_ascii(".######.. ##.#..#.# #.##..#.# #######.#");
        for (max_px, expected) in
            [(2, ".######.. ####..#.# ####..#.# #######.#"), (4, ".######.. #######.# #######.# #######.#")]
        {
            fill_holes(&mut image, max_px);
            assert_eq!(image, BitImage::from_ascii(expected), "{max_px} px");
        }
    }

    /// Component of every pixel of a value, by flooding.
    fn flood(bits: &[u8], width: usize, value: u8, eight: bool) -> Vec<Option<usize>> {
        let mut labels = vec![None; bits.len()];
        for seed in 0..bits.len() {
            let mut stack = vec![seed];
            while let Some(i) = stack.pop() {
                if bits[i] != value || labels[i].is_some() {
                    continue;
                }
                labels[i] = Some(seed);
                stack.extend((0..bits.len()).filter(|&j| {
                    let (dx, dy) = ((i % width).abs_diff(j % width), (i / width).abs_diff(j / width));
                    dx <= 1 && dy <= 1 && (eight || dx + dy <= 1)
                }));
            }
        }
        labels
    }

    proptest! {
        #[test]
        fn components_are_those_of_flooding(
            width in 1..11_usize,
            bits in proptest::collection::vec(0..2_u8, 70),
            eight in any::<bool>(),
            value in 0..2_u8,
        ) {
            let bits = &bits[..70 / width * width];
            let connectivity = if eight { Connectivity::Eight } else { Connectivity::Four };
            let found = Components::find(&BitImage::from_bytes(bits, width), value == 1, connectivity);
            let start = |run: usize| found.runs[run].y * width + found.runs[run].columns.start;
            let mut labels = vec![None; bits.len()];
            for run in 0..found.runs.len() {
                let root = found.parents[run];
                labels[start(run)..][..found.runs[run].columns.len()].fill(Some(start(root)));
            }
            let expected = flood(bits, width, value, eight);
            prop_assert_eq!(&labels, &expected);
            for root in (0..found.runs.len()).filter(|&run| found.parents[run] == run) {
                let label = Some(start(root));
                prop_assert_eq!(found.sizes[root], labels.iter().filter(|&&other| other == label).count());
            }
        }
    }
}
