//! A silhouette in coarse cells, run by run.

use crate::silhouette::{Label, Mask};

/// Cells along the longer side of a picture, at most.
const LONGER_SIDE: usize = 320;

/// A mask in cells: a few kilobytes a frame, so that those of a whole recording can be kept.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct MaskCells {
    /// Pixels along a cell's side; cells that the picture cuts are left out.
    pub(crate) side: usize,
    /// Columns and rows.
    pub(crate) size: [usize; 2],
    /// Labels row by row, each with how many cells in a row have it.
    runs: Vec<(Label, u32)>,
}

impl MaskCells {
    /// A cell is subject if more than half of its pixels are, and unknown if more than half are either.
    pub(crate) fn of(mask: &Mask) -> Self {
        let side = mask.width().max(mask.height()).div_ceil(LONGER_SIDE).max(1);
        let size = [mask.width(), mask.height()].map(|length| (length / side).max(1));
        let [columns, rows] = size;
        let mut runs: Vec<(Label, u32)> = Vec::new();
        let mut counts = vec![[0_usize; 2]; columns];
        for row in 0..rows {
            counts.fill([0; 2]);
            for y in row * side..((row + 1) * side).min(mask.height()) {
                let labels = &mask.labels()[y * mask.width()..][..(columns * side).min(mask.width())];
                for (pixels, [subject, unknown]) in labels.chunks(side).zip(&mut counts) {
                    *subject += pixels.iter().filter(|label| **label == Label::Subject).count();
                    *unknown += pixels.iter().filter(|label| **label == Label::Unknown).count();
                }
            }
            for [subject, unknown] in &counts {
                let label = match side * side {
                    all if 2 * subject > all => Label::Subject,
                    all if 2 * (subject + unknown) > all => Label::Unknown,
                    _ => Label::Background,
                };
                match runs.last_mut() {
                    Some((last, count)) if *last == label => *count += 1,
                    _ => runs.push((label, 1)),
                }
            }
        }
        Self { side, size, runs }
    }

    /// The cells as a mask.
    pub(crate) fn mask(&self) -> Mask {
        let [columns, rows] = self.size;
        let labels = self.runs.iter().flat_map(|&(label, count)| std::iter::repeat_n(label, count as usize));
        Mask::new(columns, rows, labels.collect()).expect("there are as many cells as were counted")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_masks_are_kept_as_they_are() {
        let mask = Mask::from_ascii("..##?\n.###?\n.....").unwrap();
        let cells = MaskCells::of(&mask);
        assert_eq!((cells.side, cells.size), (1, [5, 3]));
        assert_eq!(cells.mask(), mask);
    }

    #[test]
    fn large_masks_are_halved_by_majority() {
        let mut mask = Mask::filled(641, 4, Label::Background).unwrap();
        let side = MaskCells::of(&mask).side;
        assert_eq!(side, 3);
        // Five of nine pixels of the first cell, four of nine of the second, three unknown beside two of the third.
        for (x, y, label) in [
            (0, 0, Label::Subject),
            (1, 0, Label::Subject),
            (2, 0, Label::Subject),
            (0, 1, Label::Subject),
            (1, 1, Label::Subject),
            (3, 0, Label::Subject),
            (4, 0, Label::Subject),
            (5, 0, Label::Subject),
            (3, 1, Label::Subject),
            (6, 0, Label::Unknown),
            (7, 0, Label::Unknown),
            (8, 0, Label::Unknown),
            (6, 1, Label::Subject),
            (7, 1, Label::Subject),
        ] {
            mask.labels_mut()[y * 641 + x] = label;
        }
        let cells = MaskCells::of(&mask);
        assert_eq!(cells.size, [213, 1]);
        let first: Vec<Label> = cells.mask().labels()[..4].to_vec();
        assert_eq!(first, [Label::Subject, Label::Background, Label::Unknown, Label::Background]);
    }
}
