//! Outlines on the grid: which tiles a part of a solid may touch, and which it darkens altogether.
//!
//! A half of the picture is n·e ≤ 0 with e = (x, y, 1). A ball of radius ρ about p is seen where
//! (e·p)² ≥ |e|² (|p|² − ρ²): on a row, between the two roots of a quadratic in x.

use glam::DVec3;
use pulp::Simd;

use super::grid::{PixelGrid, Tile};
use crate::camera::Intrinsics;

/// Outlines are wider than they are, or narrower where a tile must lie inside, by this much of a pixel.
const SLACK: f64 = 0.02;
/// Lines flatter than this, columns a row, stand for flatter ones.
const FLATTEST: f64 = 1e6;
/// A column that no picture has.
const FAR: f32 = 1e9;
/// About this number f32 are the whole numbers, and their last bits count from it.
const WHOLE: f32 = 12_582_912.0;
const WHOLE_BITS: u32 = 0x3f_ffff;
/// The halves that bound a part at most.
const HALVES: usize = 4;

/// Where the grid's pixels lie on the plane z = 1: x = start + column · step, and likewise y.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Lattice {
    pub start: [f64; 2],
    pub step: [f64; 2],
    /// Columns of the grid less one.
    last_column: f32,
    tile: Tile,
}

impl Lattice {
    pub(super) fn new(pinhole: &Intrinsics, grid: &PixelGrid) -> Self {
        let (offset, stride) = (grid.offset as f64, grid.stride as f64);
        Self {
            start: [(offset - pinhole.cx) / pinhole.fx, (offset - pinhole.cy) / pinhole.fy],
            step: [stride / pinhole.fx, stride / pinhole.fy],
            last_column: grid.columns as f32 - 1.0,
            tile: grid.tile,
        }
    }
}

/// `slope` · tile row + `start`, a column.
#[derive(Debug, Clone, Copy)]
struct RowLine {
    slope: f32,
    start: f32,
}

impl RowLine {
    #[inline(always)]
    fn at<S: Simd>(self, simd: S, tile_rows: S::f32s) -> S::f32s {
        simd.mul_add_e_f32s(simd.splat_f32s(self.slope), tile_rows, simd.splat_f32s(self.start))
    }
}

/// Of a tile row, all rows count or any does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum RowRule {
    Any,
    All,
}

/// A half of the picture as a lowest and a highest column, one of which is beyond all.
#[derive(Debug, Clone, Copy)]
struct Half {
    low: RowLine,
    high: RowLine,
}

impl Half {
    const ALL: Self =
        Self { low: RowLine { slope: 0.0, start: -FAR }, high: RowLine { slope: 0.0, start: FAR } };

    /// Where n·e ≤ 0.
    fn new(n: DVec3, rows: RowRule, lattice: &Lattice) -> Self {
        let tile_rows = lattice.tile.rows as f64;
        let by_row = n.y * lattice.step[1];
        let by_column = {
            let by_column = n.x * lattice.step[0];
            let least = by_row.abs() / FLATTEST + f64::MIN_POSITIVE;
            if by_column.abs() < least { least.copysign(by_column) } else { by_column }
        };
        let first = n.x * lattice.start[0] + n.y * lattice.start[1] + n.z;
        // The worst or the best of a tile row's rows, and a little more.
        let spread = 0.5 * by_row.abs() * (tile_rows - 1.0) + SLACK * (by_row.abs() + by_column.abs());
        let middle = first + 0.5 * by_row * (tile_rows - 1.0);
        let value = if rows == RowRule::Any { middle - spread } else { middle + spread };
        let inverse = -1.0 / by_column;
        let start = (value * inverse).clamp(f64::from(-f32::MAX), f64::from(f32::MAX)) as f32;
        let line = RowLine { slope: (by_row * tile_rows * inverse) as f32, start };
        if by_column > 0.0 { Self { high: line, ..Self::ALL } } else { Self { low: line, ..Self::ALL } }
    }
}

/// Columns in several halves of the picture, row by row.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bounds {
    halves: [Half; HALVES],
    rule: RowRule,
}

impl Bounds {
    /// Where all of some halves n·e ≤ 0 are.
    pub(super) fn new<const N: usize>(normals: [DVec3; N], rule: RowRule, lattice: &Lattice) -> Self {
        let mut halves = [Half::ALL; HALVES];
        for (half, normal) in halves.iter_mut().zip(normals) {
            *half = Half::new(normal, rule, lattice);
        }
        Self { halves, rule }
    }

    /// The same from a first column to a last; there must be a half to spare.
    pub(super) fn and_columns(mut self, [first, last]: [f64; 2]) -> Self {
        let line = |column: f64| RowLine { slope: 0.0, start: column as f32 };
        self.halves[HALVES - 1] = Half { low: line(first - SLACK), high: line(last + SLACK) };
        self
    }

    #[inline(always)]
    fn columns<S: Simd>(&self, simd: S, tile_rows: S::f32s) -> [S::f32s; 2] {
        let [first, others @ ..] = &self.halves;
        let [mut low, mut high] = [first.low.at(simd, tile_rows), first.high.at(simd, tile_rows)];
        for half in others {
            low = simd.max_f32s(half.low.at(simd, tile_rows), low);
            high = simd.min_f32s(half.high.at(simd, tile_rows), high);
        }
        [low, high]
    }

    /// Tiles of some tile rows, from `first` on, of which any pixel or all of them lie between the lines.
    #[inline(always)]
    pub(super) fn tiles<S: Simd>(&self, simd: S, lattice: &Lattice, first: usize, spans: SpansMut<'_>) {
        let [from, to] = spans.map(|side| S::as_mut_simd_u32s(side).0);
        let mut tile_rows = first_rows(simd, first);
        for (from, to) in from.iter_mut().zip(to) {
            [*from, *to] = lattice.tiles(simd, self.columns(simd, tile_rows), self.rule);
            tile_rows = simd.add_f32s(tile_rows, simd.splat_f32s(S::F32_LANES as f32));
        }
    }
}

/// Tiles on some tile rows, the first and one past the last: whole vectors of tile rows. None where the first is not
/// before the last.
pub(super) type SpansMut<'a> = [&'a mut [u32]; 2];

/// As many tile rows as there are lanes.
#[inline(always)]
fn first_rows<S: Simd>(simd: S, first: usize) -> S::f32s {
    const COUNT: [f32; 16] = [0., 1., 2., 3., 4., 5., 6., 7., 8., 9., 10., 11., 12., 13., 14., 15.];
    simd.add_f32s(simd.splat_f32s(first as f32), S::as_simd_f32s(&COUNT).0[0])
}

impl Lattice {
    /// Whole numbers nearest to (`column` + `shift`) over a tile's columns, less a half.
    #[inline(always)]
    fn nearest<S: Simd>(&self, simd: S, column: S::f32s, (shift, less): (f32, f32)) -> S::u32s {
        let scale = 1.0 / self.tile.columns as f32;
        let (scale, shift) = (simd.splat_f32s(scale), simd.splat_f32s(shift * scale - less));
        // What is far outside is of no use, but must stay a small number.
        let column = simd.min_f32s(simd.max_f32s(column, simd.splat_f32s(-1.0)), simd.splat_f32s(1e6));
        let shifted = simd.add_f32s(simd.mul_add_e_f32s(column, scale, shift), simd.splat_f32s(WHOLE));
        simd.and_u32s(simd.transmute_u32s_f32s(shifted), simd.splat_u32s(WHOLE_BITS))
    }

    /// First tile and one past the last of which any column is from `low` to `high`, or all are; none where low is above high.
    #[inline(always)]
    fn tiles<S: Simd>(&self, simd: S, [low, high]: [S::f32s; 2], rule: RowRule) -> [S::u32s; 2] {
        let low = simd.max_f32s(low, simd.splat_f32s(0.0));
        let high = simd.min_f32s(high, simd.splat_f32s(self.last_column));
        let [first, last] = match rule {
            // The tile of the first column not before `low`, and the next after that of the last not after `high`.
            RowRule::Any => [(1.0 - SLACK as f32, 0.499), (self.tile.columns as f32, 0.499)],
            RowRule::All => [(0.0, -0.5), (1.0, 0.4999)],
        };
        let (from, to) = (self.nearest(simd, low, first), self.nearest(simd, high, last));
        let is_any = simd.less_than_or_equal_f32s(low, high);
        [from, simd.select_u32s(is_any, to, simd.splat_u32s(0))]
    }
}

/// The outline of a ball in front of the camera, cut by a half of the picture.
///
/// With r the rows from its middle, the ends on a row are m₀ r + m₁ ± √(s₀ r² + s₁).
#[derive(Debug, Clone, Copy)]
pub(super) struct BallOutline {
    row: f64,
    middle: [f32; 2],
    square: [f32; 2],
    cut: Half,
}

impl BallOutline {
    /// Of a ball about `p`, and of it the half `cut`·e ≤ 0 alone if there is one.
    pub(super) fn new(p: DVec3, radius: f64, cut: Option<DVec3>, lattice: &Lattice) -> Self {
        // m₀ x² + 2 (m₁ y + m₂) x + m₃ y² + 2 m₄ y + m₅ ≤ 0, in columns and rows after that.
        let k = p.length_squared() - radius * radius;
        let [m0, m1, m2] = [k - p.x * p.x, -p.x * p.y, -p.x * p.z];
        let [m3, m4, m5] = [k - p.y * p.y, -p.y * p.z, k - p.z * p.z];
        let inverse = 1.0 / m0;
        // Half the width squared, a y² + 2 b y + c, is greatest at y = −b/a.
        let a = (m1 * m1 * inverse - m3) * inverse;
        let b = (m1 * m2 * inverse - m4) * inverse;
        let c = (m2 * m2 * inverse - m5) * inverse;
        let y = -b / a;
        let ([x0, y0], [dx, dy]) = (lattice.start, lattice.step);
        let (column, slope) = (1.0 / dx, -m1 * inverse);
        let (bend, top) = (a * (dy * column).powi(2), (c + b * y) * column * column);
        // As high as it is, and a little more.
        let top = top + 2.0 * SLACK * (-bend * top.max(0.0)).sqrt() + SLACK * SLACK * -bend;
        Self {
            row: (y - y0) / dy,
            middle: [(slope * dy * column) as f32, ((slope * y - m2 * inverse - x0) * column) as f32],
            square: [bend as f32, top as f32],
            cut: cut.map_or(Half::ALL, |normal| Half::new(normal, RowRule::Any, lattice)),
        }
    }

    /// Tiles of some tile rows, from `first` on, that any of its pixels is in.
    #[inline(always)]
    pub(super) fn touched<S: Simd>(&self, simd: S, lattice: &Lattice, first: usize, spans: SpansMut<'_>) {
        let splat = |value: f32| simd.splat_f32s(value);
        let [from, to] = spans.map(|side| S::as_mut_simd_u32s(side).0);
        let [slope, middle] = self.middle;
        let [bend, top] = self.square;
        let tile = const { Tile::of::<S>() };
        let mut tile_rows = first_rows(simd, first);
        for (from, to) in from.iter_mut().zip(to) {
            let (mut low, mut high) = (splat(FAR), splat(-FAR));
            for row in 0..tile.rows {
                let start = (row as f64 - self.row) as f32;
                let row = simd.mul_add_e_f32s(tile_rows, splat(tile.rows as f32), splat(start));
                let middle = simd.mul_add_e_f32s(splat(slope), row, splat(middle));
                let square = simd.mul_add_e_f32s(simd.mul_f32s(row, row), splat(bend), splat(top));
                let half =
                    simd.add_f32s(simd.sqrt_f32s(simd.max_f32s(square, splat(0.0))), splat(SLACK as f32));
                // No pixel where there is no root.
                let is_any = simd.less_than_or_equal_f32s(splat(0.0), square);
                let half = simd.select_f32s(is_any, half, splat(-FAR));
                low = simd.min_f32s(low, simd.sub_f32s(middle, half));
                high = simd.max_f32s(high, simd.add_f32s(middle, half));
            }
            low = simd.max_f32s(low, self.cut.low.at(simd, tile_rows));
            high = simd.min_f32s(high, self.cut.high.at(simd, tile_rows));
            [*from, *to] = lattice.tiles(simd, [low, high], RowRule::Any);
            tile_rows = simd.add_f32s(tile_rows, splat(S::F32_LANES as f32));
        }
    }
}
