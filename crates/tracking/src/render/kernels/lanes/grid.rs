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
    pub values: Vec<f32>,
    /// Weights, rows × pitch; zero in the padding.
    pub weights: Vec<f32>,
}

impl Grid {
    /// A grid of background without weight over a picture of this size.
    #[must_use]
    pub fn new(width: usize, height: usize, stride: usize, background: f32) -> Self {
        let stride = stride.max(1);
        let offset = stride / 2;
        let count = |side: usize| side.saturating_sub(offset).div_ceil(stride);
        let (columns, rows) = (count(width), count(height));
        let pitch = (columns + PADDING).next_multiple_of(PADDING);
        Self {
            columns,
            rows,
            pitch,
            stride,
            offset,
            values: vec![background; rows * pitch],
            weights: vec![0.0; rows * pitch],
        }
    }

    /// Pixel coordinate of a sampled column or row.
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
