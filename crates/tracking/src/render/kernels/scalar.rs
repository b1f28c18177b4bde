//! The reference kernel: one pixel, one solid at a time, in f64.

use glam::DVec3;

use crate::render::View;

/// No solid is near this pixel.
pub(crate) const NOBODY: u32 = u32::MAX;

/// The winners of one row, reused from row to row.
#[derive(Debug, Clone, Default)]
pub(crate) struct RowWinners {
    /// Per pixel, λ/255 before clipping of the darkest solid.
    levels: Vec<f64>,
    /// Per pixel, the index of that solid, or [`NOBODY`].
    winners: Vec<u32>,
    /// Rays of the touched pixels, from the first touched one on.
    rays: Vec<DVec3>,
    touched: (usize, usize),
}

impl RowWinners {
    /// Finds, for every `stride`-th pixel of row y from `offset` on, the darkest solid.
    ///
    /// Ties go to the first solid. A solid that is not within reach of the pixel does not win it.
    pub(crate) fn find(&mut self, view: &View, y: usize, stride: usize, offset: usize) {
        let width = view.size[0];
        self.levels.clear();
        self.levels.resize(width, 1.0);
        self.winners.clear();
        self.winners.resize(width, NOBODY);
        let on_row = || view.on_row(y);
        let low = on_row().map(|(_, p)| p.bounds.columns[0]).min().unwrap_or(width);
        let high = on_row().map(|(_, p)| p.bounds.columns[1]).max().unwrap_or(0);
        // First sampled pixel at or after a column.
        let sampled = |x: usize| offset + x.saturating_sub(offset).div_ceil(stride) * stride;
        let start = sampled(low);
        self.touched = (start, high);
        self.rays.clear();
        self.rays.extend((start..high).step_by(stride).map(|x| view.ray(x, y)));
        for (index, primitive) in on_row() {
            let [first, past] = primitive.bounds.columns;
            for x in (sampled(first)..past).step_by(stride) {
                let level = primitive.ramp.unclipped(primitive.squared(self.rays[(x - start) / stride]));
                if level < self.levels[x] {
                    self.levels[x] = level;
                    self.winners[x] = index as u32;
                }
            }
        }
    }

    /// Index into [`View::primitives`] of the solid that wins pixel x; `None` for background.
    #[inline]
    pub(crate) fn winner(&self, x: usize) -> Option<usize> {
        match self.winners[x] {
            NOBODY => None,
            index => Some(index as usize),
        }
    }

    /// λ/255 before clipping at pixel x: above 0 and below 1 on a ramp.
    #[inline]
    pub(crate) fn level(&self, x: usize) -> f64 {
        self.levels[x]
    }

    /// Columns that any solid may touch: from the first sampled one, end excluded.
    pub(crate) fn touched(&self) -> std::ops::Range<usize> {
        self.touched.0..self.touched.1.max(self.touched.0)
    }
}
