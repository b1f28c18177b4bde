//! One camera's data, packed for lanes.
//!
//! A picture is cut into tiles, each the pixels of one vector: four columns wide, so that a thin limb fills a vector
//! too, and as many rows high as there are lanes for. Tiles side by side are a tile row; its entries follow one
//! another, tile by tile, row by row within a tile.

use std::ops::Range;

use pulp::Simd;

use crate::processor::f32_lanes;
use crate::render::primitive::PixelBox;

/// Columns of a tile, where there are as many lanes.
const TILE_COLUMNS: usize = 4;
/// Entries of a tile row are a multiple of this.
const PADDING: usize = 16;

/// Columns and rows of a tile: powers of two whose product is the number of lanes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Tile {
    pub columns: usize,
    pub rows: usize,
}

impl Tile {
    /// A tile that fills a vector.
    #[inline(always)]
    pub(super) const fn of<S: Simd>() -> Self {
        Self::of_lanes(S::F32_LANES)
    }

    /// A tile that fills a vector of `lanes` f32.
    const fn of_lanes(lanes: usize) -> Self {
        let columns = if lanes < TILE_COLUMNS { lanes } else { TILE_COLUMNS };
        Self { columns, rows: lanes / columns }
    }

    /// The tile rows that rows of pixels lie in, ends excluded.
    #[inline(always)]
    pub(super) fn rows_touched(self, [first, past]: [usize; 2]) -> [usize; 2] {
        // Sides of tiles are powers of two: shifts are quicker than divisions.
        [first >> self.rows.trailing_zeros(), (past + self.rows - 1) >> self.rows.trailing_zeros()]
    }

    /// Its pixels.
    #[inline(always)]
    pub(super) fn lanes(self) -> usize {
        self.columns * self.rows
    }
}

impl Default for Tile {
    fn default() -> Self {
        Self::of_lanes(f32_lanes())
    }
}

/// Every `stride`-th pixel of a picture, packed, with its data.
#[derive(Debug, Clone, Default)]
pub(crate) struct PixelGrid {
    /// Sampled pixels across.
    pub columns: usize,
    /// Sampled pixels down.
    pub rows: usize,
    /// Pixels between samples.
    pub stride: usize,
    /// First sampled pixel, across and down: the middle of the first block.
    pub offset: usize,
    /// Pixels of a vector.
    pub tile: Tile,
    /// Tiles of a tile row.
    pub pitch: usize,
    /// D, tile rows × pitch × lanes.
    values: Vec<f32>,
    /// Weights, like D or one tile row for all; zero in the padding.
    weights: Vec<f32>,
}

impl PixelGrid {
    /// Every `stride`-th pixel of row-major pictures D and its weights, `width` pixels across, from the middle
    /// of the first block on.
    pub(crate) fn new(width: usize, values: &[f32], weights: &[f32], stride: usize) -> Self {
        let size = [width, values.len() / width.max(1)];
        Self::of_rows(size, stride, |pixels, row_values, row_weights| {
            row_values.copy_from_slice(&values[pixels.clone()]);
            row_weights.copy_from_slice(&weights[pixels]);
        })
    }

    /// The same of a picture of a width and a height whose rows are worked out: `fill` hears which pixels a row has, and
    /// writes their D and their weights. Rows without samples are never asked for.
    pub(crate) fn of_rows(
        size: [usize; 2],
        stride: usize,
        fill: impl Fn(Range<usize>, &mut [f32], &mut [f32]),
    ) -> Self {
        let stride = stride.max(1);
        let offset = stride / 2;
        let [columns, rows] = size.map(|side| side.saturating_sub(offset).div_ceil(stride));
        let mut grid = Self { stride, offset, ..Self::without_data([columns, rows]) };
        let entries = grid.tile_rows() * grid.entries();
        let (mut values, mut weights) = (vec![0.0; entries], vec![0.0; entries]);
        let (mut row_values, mut row_weights) = (vec![0.0; size[0]], vec![0.0; size[0]]);
        let mut all_weigh_one = true;
        // A picture narrower than half a stride has rows without any sample.
        for row in (0..rows).filter(|_| columns > 0) {
            let first = grid.pixel(row) * size[0];
            fill(first..first + size[0], &mut row_values, &mut row_weights);
            grid.put_row(row, &row_values, &mut values);
            grid.put_row(row, &row_weights, &mut weights);
            let weighs_one = |weight: &f32| weight.to_bits() == 1.0f32.to_bits();
            all_weigh_one &= row_weights.iter().fold(true, |all, weight| all & weighs_one(weight));
        }
        // Pictures without unknown pixels spare the memory's bandwidth.
        if all_weigh_one && rows.is_multiple_of(grid.tile.rows) {
            weights.truncate(grid.entries());
        }
        (grid.values, grid.weights) = (values, weights);
        grid
    }

    /// Every pixel of a picture of a width and a height, without data: for looking at the winners alone.
    pub(super) fn without_data([columns, rows]: [usize; 2]) -> Self {
        let tile = Tile::default();
        let pitch = (columns * tile.rows).next_multiple_of(PADDING.max(tile.lanes())) / tile.lanes();
        Self { columns, rows, stride: 1, tile, pitch, ..Self::default() }
    }

    /// Puts the samples of a row of the picture where they belong among the tiles.
    #[inline(always)]
    fn put_row(&self, row: usize, pixels: &[f32], entries: &mut [f32]) {
        let Tile { columns, .. } = self.tile;
        let start = self.entry(row, 0);
        let tiles = entries[start..].chunks_mut(self.tile.lanes());
        if (self.stride, columns) == (1, TILE_COLUMNS) {
            let (whole, rest) = pixels.as_chunks::<TILE_COLUMNS>();
            let mut tiles = tiles;
            for (pixels, tile) in whole.iter().zip(&mut tiles) {
                tile[..TILE_COLUMNS].copy_from_slice(pixels);
            }
            tiles.next().into_iter().for_each(|tile| tile[..rest.len()].copy_from_slice(rest));
            return;
        }
        let mut samples = pixels[self.offset..].iter().step_by(self.stride);
        for tile in tiles.take(self.columns.div_ceil(columns)) {
            for (entry, &sample) in tile[..columns].iter_mut().zip(&mut samples) {
                *entry = sample;
            }
        }
    }

    /// The same data with other weights: of every sampled pixel's column and row in the picture, its D and its
    /// weight so far.
    pub(crate) fn reweighted(&self, mut weight_of: impl FnMut(usize, usize, f32, f32) -> f32) -> Self {
        let mut weights = vec![0.0; self.tile_rows() * self.entries()];
        for row in 0..self.rows {
            for column in 0..self.columns {
                let (value, weight) = self.at(row, column);
                weights[self.entry(row, column)] =
                    weight_of(self.pixel(column), self.pixel(row), value, weight);
            }
        }
        Self { weights, ..self.clone() }
    }

    /// Tile rows of the picture.
    #[inline]
    pub(crate) fn tile_rows(&self) -> usize {
        self.rows.div_ceil(self.tile.rows)
    }

    /// Entries of a tile row.
    #[inline]
    pub(crate) fn entries(&self) -> usize {
        self.pitch * self.tile.lanes()
    }

    /// Where a sampled pixel's datum is among all.
    #[inline(always)]
    fn entry(&self, row: usize, column: usize) -> usize {
        // Sides of tiles are powers of two: shifts are quicker than divisions.
        let Tile { columns, rows } = self.tile;
        let tile = (row >> rows.trailing_zeros()) * self.pitch + (column >> columns.trailing_zeros());
        tile * self.tile.lanes() + (row & (rows - 1)) * columns + (column & (columns - 1))
    }

    /// D and weight of a sampled pixel.
    #[inline]
    pub(crate) fn at(&self, row: usize, column: usize) -> (f32, f32) {
        let entry = self.entry(row, column);
        (self.values[entry], self.weights[if self.weighs_one() { entry % self.entries() } else { entry }])
    }

    /// Whether all pixels weigh one, so that one tile row of weights serves all.
    #[inline]
    fn weighs_one(&self) -> bool {
        self.weights.len() == self.entries()
    }

    /// D and the weights of a tile row, in the order of tiles.
    #[inline(always)]
    pub(crate) fn tile_row(&self, tile_row: usize) -> [&[f32]; 2] {
        let entries = tile_row * self.entries()..(tile_row + 1) * self.entries();
        let weights = if self.weighs_one() { &self.weights[..] } else { &self.weights[entries.clone()] };
        [&self.values[entries], weights]
    }

    /// D and all weights from a tile row on, and by how many tiles weights advance from tile row to tile row.
    #[inline(always)]
    pub(super) fn band_data(&self, tile_row: usize) -> ([&[f32]; 2], usize) {
        let start = tile_row * self.entries();
        let (weights, pitch) =
            if self.weighs_one() { (&self.weights[..], 0) } else { (&self.weights[start..], self.pitch) };
        ([&self.values[start..], weights], pitch)
    }

    /// Some columns of a sampled row of a band's tiles, one after the other; `tile_row` is its tile row in the band.
    #[inline(always)]
    pub(super) fn untile<T: Copy>(
        &self,
        tiles: &[T],
        (tile_row, row): (usize, usize),
        columns: Range<usize>,
        line: &mut Vec<T>,
    ) {
        line.clear();
        let (side, lanes) = (self.tile.columns, self.tile.lanes());
        let in_tile = (row & (self.tile.rows - 1)) * side;
        for tile in columns.start / side..columns.end.div_ceil(side) {
            line.extend_from_slice(&tiles[(tile_row * self.pitch + tile) * lanes + in_tile..][..side]);
        }
        line.drain(..columns.start % side);
        line.truncate(columns.len());
    }

    /// The rows and columns of a tile: tile row, tile.
    #[inline(always)]
    pub(super) fn covers(&self, [tile_row, tile]: [usize; 2]) -> PixelBox {
        let span = |index: usize, side: usize| [index * side, (index + 1) * side];
        PixelBox { columns: span(tile, self.tile.columns), rows: span(tile_row, self.tile.rows) }
    }

    /// Pixel coordinate of a sampled column or row.
    #[inline]
    pub(crate) fn pixel(&self, index: usize) -> usize {
        self.offset + index * self.stride
    }

    /// The samples in a box of pixels, by column and row of the grid.
    pub(super) fn sampled(&self, pixels: &PixelBox) -> PixelBox {
        PixelBox {
            columns: pixels.columns.map(|column| self.index_from(column, self.columns)),
            rows: pixels.rows.map(|row| self.index_from(row, self.rows)),
        }
    }

    /// First sampled column or row at or after a pixel, at most `limit`.
    fn index_from(&self, pixel: usize, limit: usize) -> usize {
        let past = pixel.saturating_sub(self.offset);
        // A division takes as long as a dozen other steps.
        if self.stride == 1 { past.min(limit) } else { past.div_ceil(self.stride).min(limit) }
    }
}

#[cfg(test)]
mod tests {
    use super::PixelGrid;

    #[test]
    fn every_sample_is_in_its_place() {
        for (width, height, stride) in
            (1..20).flat_map(|width| (1..10).flat_map(move |h| (1..10).map(move |s| (width, h, s))))
        {
            let values: Vec<f32> = (0..width * height).map(|pixel| pixel as f32).collect();
            for least in [1.0, 0.5] {
                let weights: Vec<f32> =
                    (0..values.len()).map(|pixel| if pixel % 3 == 0 { least } else { 1.0 }).collect();
                let grid = PixelGrid::new(width, &values, &weights, stride);
                for (row, column) in (0..grid.rows).flat_map(|row| (0..grid.columns).map(move |c| (row, c))) {
                    let pixel = grid.pixel(row) * width + grid.pixel(column);
                    let found = grid.at(row, column);
                    assert_eq!(found, (values[pixel], weights[pixel]), "{width} × {height}, every {stride}");
                }
            }
        }
    }
}
