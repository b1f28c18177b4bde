//! All solids of a view, and the columns that they may touch on each row: what the bands of a picture share.

use std::ops::Range;

use pulp::Simd;

use super::grid::PixelGrid;
use super::solid::LaneSolid;
use super::winners::{Band, Row};
use crate::render::View;

/// A view made ready for lanes.
#[derive(Debug, Clone, Default)]
pub(super) struct Ground {
    /// Places of the columns on the plane z = 1.
    pub xs: Vec<f32>,
    pub solids: Vec<LaneSolid>,
    /// The columns of every solid on each of its rows, one solid after the other.
    pub spans: Vec<[u32; 2]>,
    /// By row, the columns that any solid may touch.
    pub touched: Vec<[u32; 2]>,
    /// Place of the first row on the plane z = 1, and from one to the next.
    y_line: [f64; 2],
}

impl Ground {
    /// Takes a view's solids. Spans are still to be cut.
    pub(super) fn prepare(&mut self, view: &View, grid: &PixelGrid) {
        let pinhole = view.pinhole();
        self.xs.clear();
        let (start, step) = ((grid.offset as f64 - pinhole.cx) / pinhole.fx, grid.stride as f64 / pinhole.fx);
        self.xs.extend((0..grid.pitch).map(|column| (start + column as f64 * step) as f32));
        self.y_line = [(grid.offset as f64 - pinhole.cy) / pinhole.fy, grid.stride as f64 / pinhole.fy];
        self.solids.clear();
        self.spans.clear();
        for (index, primitive) in view.primitives().iter().enumerate() {
            let Some(mut solid) = LaneSolid::new(primitive, pinhole, grid) else { continue };
            solid.primitive = index;
            solid.spans = self.spans.len();
            self.spans.resize(solid.spans + solid.rows[1] - solid.rows[0], [0; 2]);
            self.solids.push(solid);
        }
    }

    /// The columns that each solid, and any of them, may touch on each row.
    #[inline(always)]
    pub(super) fn cut_spans(&mut self, grid: &PixelGrid) {
        self.touched.clear();
        self.touched.resize(grid.rows, [u32::MAX, 0]);
        for solid in &self.solids {
            let [first, last] = solid.rows;
            let touched = &mut self.touched[first..last];
            let spans = &mut self.spans[solid.spans..solid.spans + last - first];
            for (index, (touched, target)) in touched.iter_mut().zip(spans).enumerate() {
                let span = solid.span(first + index);
                *target = span;
                let is_empty = span[0] >= span[1];
                touched[0] = touched[0].min(if is_empty { u32::MAX } else { span[0] });
                touched[1] = touched[1].max(if is_empty { 0 } else { span[1] });
            }
        }
    }

    /// The columns of a solid on one of its rows.
    #[inline(always)]
    pub(super) fn span(&self, solid: &LaneSolid, row: usize) -> [u32; 2] {
        self.spans[solid.spans + row - solid.rows[0]]
    }

    /// Some columns of a row of a band.
    #[inline(always)]
    pub(super) fn row(&self, row: usize, band: &Range<usize>, grid: &PixelGrid, span: [u32; 2]) -> Row<'_> {
        let y = (self.y_line[0] + row as f64 * self.y_line[1]) as f32;
        Row { row, start: (row - band.start) * grid.pitch, y, xs: &self.xs, span }
    }

    /// Ground and winners of one band of rows; with `DOUBTS`, also by how much they have won.
    #[inline(always)]
    pub(super) fn win_band<S: Simd, const DOUBTS: bool>(
        &self,
        simd: S,
        band: &mut Band,
        rows: Range<usize>,
        grid: &PixelGrid,
    ) {
        // Plain loops: what an iterator calls is not compiled for the lanes.
        for row in rows.clone() {
            let here = self.row(row, &rows, grid, self.touched[row]);
            if here.is_touched() {
                band.open_row::<S, DOUBTS>(simd, &here);
            }
        }
        for (index, solid) in self.solids.iter().enumerate() {
            for row in solid.rows_in(&rows) {
                let here = self.row(row, &rows, grid, self.span(solid, row));
                if here.is_touched() {
                    band.challenge::<S, DOUBTS>(simd, solid, index, &here);
                }
            }
        }
    }
}
