//! A band of tile rows: what is known of its pixels, and the tiles that each part of each solid may touch.
//!
//! What a band's winners cost, and where each part pulls: one look at every tile that is not dark.

use std::ops::Range;

use pulp::Simd;

use super::grid::PixelGrid;
use super::ground::{Ground, MOST_PIECES, SolidPart};
use super::masks::{lane_bits, on_ramp, put_u32s};
use crate::render::ramp::BACKGROUND;

/// Tiles that are written at once.
const TILES_AT_ONCE: usize = 8;
/// The owner where no solid is near; set only where doubts are asked for.
pub(super) const NO_SOLID: u32 = u32::MAX;
/// A solid's owners.
const PLACES: usize = 4;
/// A level of dark pixels of which nobody asks how dark they are.
const DARK: f32 = -1.0;

/// What some tiles of a band have to do with a part of a solid.
#[derive(Debug, Clone)]
pub(super) struct Work {
    /// Index of the solid.
    pub solid: usize,
    pub part: SolidPart,
    /// What the part's pixels are marked with in [`Band::owners`].
    pub owner: u32,
    /// Of [`Band::tiles`].
    pub tiles: Range<usize>,
}

/// A band of tile rows: what is known of its pixels, tile by tile.
#[derive(Debug, Clone, Default)]
pub(super) struct Band {
    /// λ/255 before clipping.
    pub levels: Vec<f32>,
    /// The darkest part; see [`solid_of`].
    pub owners: Vec<u32>,
    /// t of its point nearest to the ray, or the mark of a flat cap; of whole solids only.
    pub fractions: Vec<f32>,
    /// λ/255 of the darkest of the others, background and solids, before clipping; minus infinity where that of
    /// some solid cannot be trusted. Only where doubts are asked for.
    pub runners_up: Vec<f32>,
    /// Tiles that parts may touch: the tile row within the band times 2¹⁶, and the tile.
    pub tiles: Vec<u32>,
    pub works: Vec<Work>,
    /// By owner, where the next tile is listed in which it pulls.
    pub next: Vec<u32>,
}

/// The solid of an owner.
#[inline(always)]
pub(super) fn solid_of(owner: u32) -> usize {
    owner as usize / PLACES
}

impl Band {
    /// Makes room for so many pixels, and for doubts about them.
    pub(super) fn resize(&mut self, pixels: usize, doubts: bool) {
        if self.levels.len() < pixels {
            self.levels.resize(pixels, 1.0);
            self.owners.resize(pixels, 0);
            self.fractions.resize(pixels, 0.0);
        }
        if doubts && self.runners_up.len() < pixels {
            self.runners_up.resize(pixels, f32::INFINITY);
        }
    }

    /// Empties the tiles of a band that any solid may touch, and darkens those that are dark.
    #[inline(always)]
    pub(super) fn open<const DOUBTS: bool>(
        &mut self,
        ground: &Ground,
        rows: &Range<usize>,
        grid: &PixelGrid,
    ) {
        let lanes = grid.tile.lanes();
        for (index, row) in rows.clone().enumerate() {
            let entries = |[from, to]: [u32; 2]| {
                let start = index * grid.entries();
                start + from as usize * lanes..start + to as usize * lanes
            };
            let touched = ground.touched[row];
            if touched[0] < touched[1] {
                self.levels[entries(touched)].fill(1.0);
                for dark in ground.dark[row].runs() {
                    self.levels[entries(dark)].fill(DARK);
                }
                if DOUBTS {
                    self.owners[entries(touched)].fill(NO_SOLID);
                    self.runners_up[entries(touched)].fill(f32::INFINITY);
                }
            }
        }
    }

    /// Lists the tiles of a band that each part of each solid may touch and that are not dark.
    #[inline(always)]
    pub(super) fn list(&mut self, ground: &Ground, rows: &Range<usize>, grid: &PixelGrid) {
        let Self { tiles, works, next, .. } = self;
        works.clear();
        next.resize(ground.solids.len() * PLACES, 0);
        let mut count = 0;
        for (index, solid) in ground.solids.iter().enumerate() {
            for (place, &part) in solid.outline.parts().iter().enumerate() {
                let first = count;
                let (row, [from, to]) = ground.spans(solid, place, rows);
                if from.is_empty() {
                    continue;
                }
                // As many as there may be, each piece written whole.
                let most = count + from.len() * (grid.pitch + MOST_PIECES * TILES_AT_ONCE);
                if tiles.len() < most {
                    tiles.resize(most.next_power_of_two(), 0);
                }
                let dark = &ground.dark[row..row + from.len()];
                for ((row, dark), (&from, &to)) in (row - rows.start..).zip(dark).zip(from.iter().zip(to)) {
                    let (row, mut from) = ((row as u32) << 16, from);
                    if from >= to {
                        continue;
                    }
                    for [dark, light] in dark.runs() {
                        if dark >= to {
                            break;
                        }
                        count = put_tiles(tiles, count, row, from, dark);
                        from = from.max(light);
                    }
                    count = put_tiles(tiles, count, row, from, to);
                }
                if first < count {
                    let owner = (index * PLACES + place) as u32;
                    next[owner as usize] = first as u32;
                    works.push(Work { solid: index, part, owner, tiles: first..count });
                }
            }
        }
    }
}

/// Writes tiles `from` to `to` after `count` others; returns how many there are then.
#[inline(always)]
fn put_tiles(tiles: &mut [u32], count: usize, row: u32, from: u32, to: u32) -> usize {
    let mut at = count;
    for first in (from..to).step_by(TILES_AT_ONCE) {
        // More are written than are counted: what a branch would cost is more.
        if let Some(target) = tiles[at..].first_chunk_mut::<TILES_AT_ONCE>() {
            for (offset, tile) in (row + first..).zip(target) {
                *tile = offset;
            }
        }
        at += TILES_AT_ONCE;
    }
    count + to.saturating_sub(from) as usize
}

/// Where the tiles of a band are: on the plane z = 1, and among its vectors.
#[derive(Clone, Copy)]
pub(super) struct Places<'a, S: Simd> {
    xs: &'a [S::f32s],
    ys: &'a [S::f32s],
    pitch: usize,
}

impl<'a, S: Simd> Places<'a, S> {
    #[inline(always)]
    pub(super) fn new(ground: &'a Ground, rows: &Range<usize>, grid: &PixelGrid) -> Self {
        let (xs, ys) = (S::as_simd_f32s(&ground.xs).0, S::as_simd_f32s(&ground.ys).0);
        Self { xs, ys: &ys[rows.clone()], pitch: grid.pitch }
    }

    /// Index of a tile's vector, and where its rays meet the plane.
    #[inline(always)]
    pub(super) fn at(&self, tile: u32) -> (usize, [S::f32s; 2]) {
        let (row, column) = ((tile >> 16) as usize, (tile & 0xffff) as usize);
        (row * self.pitch + column, [self.xs[column], self.ys[row]])
    }
}

/// What solids compete for.
pub(super) struct Cells<'a, S: Simd, const DOUBTS: bool> {
    pub levels: &'a mut [S::f32s],
    pub owners: &'a mut [S::u32s],
    pub runners_up: &'a mut [S::f32s],
}

impl<S: Simd, const DOUBTS: bool> Cells<'_, S, DOUBTS> {
    /// Lets a part have the pixels in which it is darker than those before it; returns which.
    #[inline(always)]
    pub(super) fn offer(&mut self, simd: S, at: usize, level: S::f32s, owner: S::u32s) -> S::m32s {
        let before = self.levels[at];
        let darker = simd.less_than_f32s(level, before);
        if DOUBTS {
            self.runners_up[at] = simd.min_f32s(simd.max_f32s(level, before), self.runners_up[at]);
        }
        self.levels[at] = simd.min_f32s(level, before);
        put_u32s(simd, &mut self.owners[at], darker, owner);
        darker
    }
}

/// One tile row of a band.
struct RowOfTiles<'a, S: Simd> {
    levels: &'a [S::f32s],
    owners: &'a [u32],
    values: &'a [S::f32s],
    weights: &'a [S::f32s],
}

impl Band {
    /// Σ w ((D − Λ)² − (D − 255)²) over the touched pixels of a band whose winners are known. With `PULLS`, of every part's
    /// tiles those stay in which it has won a pixel that is not clipped.
    #[inline(always)]
    pub(super) fn settle<S: Simd, const PULLS: bool>(
        &mut self,
        simd: S,
        ground: &Ground,
        rows: &Range<usize>,
        grid: &PixelGrid,
    ) -> f64 {
        let Self { levels, owners, tiles, works, next, .. } = self;
        let entries = grid.entries();
        let mut cost = 0.0;
        for (index, row) in rows.clone().enumerate() {
            let [from, to] = ground.touched[row];
            if from >= to {
                continue;
            }
            let here = index * entries..(index + 1) * entries;
            let [values, weights] = grid.tile_row(row);
            let row_of_tiles = RowOfTiles::<S> {
                levels: S::as_simd_f32s(&levels[here.clone()]).0,
                owners: &owners[here],
                values: S::as_simd_f32s(values).0,
                weights: S::as_simd_f32s(weights).0,
            };
            let mut sum = simd.splat_f32s(0.0);
            let mut first = from;
            for [dark, light] in ground.dark[row].runs() {
                sum = row_of_tiles.settle::<PULLS>(simd, first..dark, index, (tiles, next), sum);
                sum = row_of_tiles.darken(simd, dark..light, sum);
                first = light;
            }
            sum = row_of_tiles.settle::<PULLS>(simd, first..to, index, (tiles, next), sum);
            cost += f64::from(simd.reduce_sum_f32s(sum));
        }
        if PULLS {
            for work in works {
                work.tiles.end = next[work.owner as usize] as usize;
            }
        }
        cost
    }
}

impl<S: Simd> RowOfTiles<'_, S> {
    /// Adds what some tiles cost, and lists them with the parts that pull in them.
    #[inline(always)]
    fn settle<const PULLS: bool>(
        &self,
        simd: S,
        range: Range<u32>,
        row: usize,
        (tiles, next): (&mut [u32], &mut [u32]),
        mut sum: S::f32s,
    ) -> S::f32s {
        let (zero, one) = (simd.splat_f32s(0.0), simd.splat_f32s(1.0));
        let white = simd.splat_f32s(BACKGROUND as f32);
        let places = range.start as usize..range.end as usize;
        let data = self.levels[places.clone()].iter().zip(&self.values[places.clone()]);
        for (tile, ((&level, &value), &weight)) in range.zip(data.zip(&self.weights[places])) {
            let lambda = simd.min_f32s(simd.max_f32s(level, zero), one);
            let residual = simd.negate_mul_add_e_f32s(lambda, white, value);
            let empty = simd.sub_f32s(value, white);
            let squares = simd.negate_mul_add_e_f32s(empty, empty, simd.mul_f32s(residual, residual));
            sum = simd.mul_add_e_f32s(weight, squares, sum);
            if PULLS {
                let mut pulls = lane_bits(simd, on_ramp(simd, level));
                if pulls != 0 {
                    let owners = &self.owners[tile as usize * S::F32_LANES..][..S::F32_LANES];
                    let owner_lanes = S::as_simd_u32s(owners).0[0];
                    // Nearly always of one part.
                    while pulls != 0 {
                        let owner = owners[pulls.trailing_zeros() as usize];
                        let place = &mut next[owner as usize];
                        tiles[*place as usize] = (row as u32) << 16 | tile;
                        *place += 1;
                        pulls &= !lane_bits(simd, simd.equal_u32s(owner_lanes, simd.splat_u32s(owner)));
                    }
                }
            }
        }
        sum
    }

    /// Adds what tiles cost that are dark altogether.
    #[inline(always)]
    fn darken(&self, simd: S, range: Range<u32>, mut sum: S::f32s) -> S::f32s {
        let white = simd.splat_f32s(BACKGROUND as f32);
        let places = range.start as usize..range.end as usize;
        for (&value, &weight) in self.values[places.clone()].iter().zip(&self.weights[places]) {
            let empty = simd.sub_f32s(value, white);
            let squares = simd.negate_mul_add_e_f32s(empty, empty, simd.mul_f32s(value, value));
            sum = simd.mul_add_e_f32s(weight, squares, sum);
        }
        sum
    }
}
