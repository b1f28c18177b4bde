//! What a band's winners cost, and where each part pulls: one look at every tile that is not dark.

use std::ops::Range;

use pulp::Simd;

use super::band::Band;
use super::grid::{PixelGrid, TileData};
use super::ground::Ground;
use super::masks::{lane_bits, on_ramp};
use crate::render::ramp::BACKGROUND;

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
            let TileData { values, weights } = grid.tile_row(row);
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
