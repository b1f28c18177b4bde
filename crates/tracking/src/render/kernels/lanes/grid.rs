//! One camera's data, packed for lanes.

/// Rows are padded by at least this many entries, so that lanes may begin at any column.
const PADDING: usize = 16;

/// Every `stride`-th pixel of a picture, packed, with its data.
#[derive(Debug, Clone, Default)]
pub struct Grid {
    /// Sampled pixels across.
    pub columns: usize,
    /// Sampled pixels down.
    pub rows: usize,
    /// Entries from one row to the next: more than `columns`.
    pub pitch: usize,
    /// Pixels between samples.
    pub stride: usize,
    /// First sampled pixel, across and down: the middle of the first block.
    pub offset: usize,
    /// D, rows × pitch.
    values: Vec<f32>,
    /// Weights, rows × pitch or one row for all; zero in the padding.
    weights: Vec<f32>,
}

/// Data of one row, from its first column on.
#[derive(Debug, Clone, Copy)]
pub struct RowData<'a> {
    /// D.
    pub values: &'a [f32],
    /// Weights.
    pub weights: &'a [f32],
}

impl Grid {
    /// Every `stride`-th pixel of row-major pictures D and its weights, `width` pixels across, from the middle
    /// of the first block on.
    #[must_use]
    pub fn new(width: usize, values: &[f32], weights: &[f32], stride: usize) -> Self {
        let height = values.len() / width.max(1);
        let stride = stride.max(1);
        let offset = stride / 2;
        let count = |side: usize| side.saturating_sub(offset).div_ceil(stride);
        let (columns, rows) = (count(width), count(height));
        let pitch = (columns + PADDING).next_multiple_of(PADDING);
        let mut grid = Self { columns, rows, pitch, stride, offset, values: Vec::new(), weights: Vec::new() };
        grid.values = grid.sampled(width, values);
        // Pictures without unknown pixels spare the memory's bandwidth.
        if weights.iter().all(|&weight| weight.to_bits() == 1.0f32.to_bits()) {
            grid.weights = vec![0.0; pitch];
            grid.weights[..columns].fill(1.0);
        } else {
            grid.weights = grid.sampled(width, weights);
        }
        grid
    }

    /// The same data with other weights: of every sampled pixel's column and row in the picture, its D and its
    /// weight so far.
    #[must_use]
    pub fn reweighted(&self, mut weight_of: impl FnMut(usize, usize, f32, f32) -> f32) -> Self {
        let mut weights = vec![0.0; self.rows * self.pitch];
        for (row, target) in weights.chunks_exact_mut(self.pitch).enumerate() {
            let data = self.row(row);
            let entries = target.iter_mut().zip(data.values.iter().zip(data.weights)).take(self.columns);
            for (column, (target, (&value, &weight))) in entries.enumerate() {
                *target = weight_of(self.pixel(column), self.pixel(row), value, weight);
            }
        }
        Self { weights, ..self.clone() }
    }

    fn sampled(&self, width: usize, picture: &[f32]) -> Vec<f32> {
        let mut sampled = vec![0.0; self.rows * self.pitch];
        for (row, target) in sampled.chunks_exact_mut(self.pitch).enumerate() {
            let source = &picture[self.pixel(row) * width..][..width];
            let source = source.iter().skip(self.offset).step_by(self.stride);
            target.iter_mut().zip(source).for_each(|(target, &value)| *target = value);
        }
        sampled
    }

    /// The data of a row.
    #[inline(always)]
    #[must_use]
    pub fn row(&self, row: usize) -> RowData<'_> {
        let entries = row * self.pitch..(row + 1) * self.pitch;
        let weights =
            if self.weights.len() == self.pitch { &self.weights[..] } else { &self.weights[entries.clone()] };
        RowData { values: &self.values[entries], weights }
    }

    /// Pixel coordinate of a sampled column or row.
    #[inline]
    #[must_use]
    pub fn pixel(&self, index: usize) -> usize {
        self.offset + index * self.stride
    }

    /// First sampled column or row at or after a pixel, at most `limit`.
    #[must_use]
    pub fn index_from(&self, pixel: usize, limit: usize) -> usize {
        pixel.saturating_sub(self.offset).div_ceil(self.stride).min(limit)
    }
}
