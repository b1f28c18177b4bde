//! The pixels that a body may touch.

use std::ops::Range;

use super::primitive::PixelBox;

/// The pixels of a picture that a body may touch, as a span of columns for each row: all others are background.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Footprint {
    first_row: usize,
    /// First column and one past the last, for each row from the first on.
    spans: Vec<[u32; 2]>,
}

/// A row on which there is nothing.
const NOTHING: [u32; 2] = [u32::MAX, 0];

impl Footprint {
    /// The whole picture.
    #[must_use]
    pub fn whole([width, height]: [usize; 2]) -> Self {
        Self { first_row: 0, spans: vec![[0, width as u32]; height] }
    }

    /// Everything in these boxes, and what lies between them on a row.
    pub(super) fn of(boxes: impl Iterator<Item = PixelBox> + Clone) -> Self {
        let all = boxes.clone().fold(PixelBox::default(), PixelBox::union);
        let mut footprint = Self::on_rows(all.rows[0]..all.rows[1]);
        boxes.filter(|one| !one.is_empty()).for_each(|one| {
            footprint.add(one.rows[0]..one.rows[1], |_| one.columns.map(|column| column as u32));
        });
        footprint
    }

    fn on_rows(rows: Range<usize>) -> Self {
        Self { first_row: rows.start, spans: vec![NOTHING; rows.len()] }
    }

    /// Widens rows that it has.
    fn add(&mut self, rows: Range<usize>, columns: impl Fn(usize) -> [u32; 2]) {
        for y in rows {
            let (span, [from, to]) = (&mut self.spans[y - self.first_row], columns(y));
            *span = [span[0].min(from), span[1].max(to)];
        }
    }

    /// The rows on which it may have pixels.
    #[must_use]
    pub fn rows(&self) -> Range<usize> {
        self.first_row..self.first_row + self.spans.len()
    }

    /// Its columns on a row.
    #[must_use]
    #[inline]
    pub fn columns(&self, y: usize) -> Range<usize> {
        let span = y.checked_sub(self.first_row).and_then(|row| self.spans.get(row));
        span.filter(|[from, to]| from < to).map_or(0..0, |[from, to]| *from as usize..*to as usize)
    }

    /// Whether a pixel is in it.
    #[must_use]
    pub fn contains(&self, x: usize, y: usize) -> bool {
        self.columns(y).contains(&x)
    }

    /// What both touch, and what lies between them on a row.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        if self.spans.is_empty() || other.spans.is_empty() {
            return if self.spans.is_empty() { other.clone() } else { self.clone() };
        }
        let ([from, to], [other_from, other_to]) =
            [self, other].map(|one| [one.rows().start, one.rows().end]).into();
        let mut both = Self::on_rows(from.min(other_from)..to.max(other_to));
        for one in [self, other] {
            both.add(one.rows(), |y| one.spans[y - one.first_row]);
        }
        both
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn boxed(columns: [usize; 2], rows: [usize; 2]) -> PixelBox {
        PixelBox { columns, rows }
    }

    #[test]
    fn it_holds_every_box_and_nothing_beside_them() {
        let boxes = [boxed([3, 5], [2, 4]), PixelBox::default(), boxed([8, 9], [3, 7])];
        let footprint = Footprint::of(boxes.into_iter());
        let rows: Vec<_> = (0..9).map(|y| footprint.columns(y)).collect();
        assert_eq!(rows, [0..0, 0..0, 3..5, 3..9, 8..9, 8..9, 8..9, 0..0, 0..0]);
        assert_eq!(footprint.rows(), 2..7);
        assert!(footprint.contains(8, 6) && !footprint.contains(3, 6) && !footprint.contains(8, 7));
        assert_eq!(Footprint::of([PixelBox::default()].into_iter()), Footprint::default());
    }

    #[test]
    fn a_union_holds_both_row_by_row() {
        let [a, b] =
            [boxed([3, 5], [2, 4]), boxed([8, 9], [6, 7])].map(|one| Footprint::of([one].into_iter()));
        let both = a.union(&b);
        let rows: Vec<_> = both.rows().map(|y| both.columns(y)).collect();
        assert_eq!(rows, [3..5, 3..5, 0..0, 0..0, 8..9]);
        assert_eq!((a.union(&Footprint::default()), Footprint::default().union(&b)), (a.clone(), b));
        let whole = Footprint::whole([4, 3]);
        assert_eq!((whole.rows(), whole.columns(2), whole.columns(3)), (0..3, 0..4, 0..0));
    }
}
