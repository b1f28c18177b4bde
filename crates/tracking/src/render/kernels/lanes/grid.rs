//! One camera's data, packed for lanes.

/// Rows are padded by at least this many entries, so that lanes may begin at any column.
const PADDING: usize = 16;

/// Every `stride`-th pixel of a picture, packed, with its data.
#[derive(Debug, Clone, Default)]
pub(crate) struct PixelGrid {
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
pub(crate) struct RowData<'a> {
    /// D.
    pub values: &'a [f32],
    /// Weights.
    pub weights: &'a [f32],
}

impl PixelGrid {
    /// Every `stride`-th pixel of row-major pictures D and its weights, `width` pixels across, from the middle
    /// of the first block on.
    #[must_use]
    pub(crate) fn new(width: usize, values: &[f32], weights: &[f32], stride: usize) -> Self {
        let size = [width, values.len() / width.max(1)];
        Self::of_pixels(size, stride, |pixel| (values[pixel], weights[pixel]))
    }

    /// The same of a picture of a width and a height whose D and weight are worked out, pixel by pixel.
    #[must_use]
    #[inline]
    pub(crate) fn of_pixels(size: [usize; 2], stride: usize, data: impl Fn(usize) -> (f32, f32)) -> Self {
        let stride = stride.max(1);
        let offset = stride / 2;
        let [columns, rows] = size.map(|side| side.saturating_sub(offset).div_ceil(stride));
        let pitch = (columns + PADDING).next_multiple_of(PADDING);
        let (mut values, mut weights) = (vec![0.0; rows * pitch], vec![0.0; rows * pitch]);
        let mut all_weigh_one = true;
        for row in 0..rows {
            let first = (offset + row * stride) * size[0] + offset;
            let pixels = (first..).step_by(stride).take(columns);
            let entries = values[row * pitch..].iter_mut().zip(&mut weights[row * pitch..]);
            for (pixel, (value, weight)) in pixels.zip(entries) {
                (*value, *weight) = data(pixel);
                all_weigh_one &= weight.to_bits() == 1.0f32.to_bits();
            }
        }
        // Pictures without unknown pixels spare the memory's bandwidth.
        if all_weigh_one {
            weights.truncate(pitch);
        }
        Self { columns, rows, pitch, stride, offset, values, weights }
    }

    /// Every pixel of a picture of a width and a height, without data: for looking at the winners alone.
    #[must_use]
    pub(super) fn without_data([columns, rows]: [usize; 2]) -> Self {
        let pitch = (columns + PADDING).next_multiple_of(PADDING);
        Self { columns, rows, pitch, stride: 1, ..Self::default() }
    }

    /// The same data with other weights: of every sampled pixel's column and row in the picture, its D and its
    /// weight so far.
    #[must_use]
    pub(crate) fn reweighted(&self, mut weight_of: impl FnMut(usize, usize, f32, f32) -> f32) -> Self {
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

    /// The data of a row.
    #[inline(always)]
    #[must_use]
    pub(crate) fn row(&self, row: usize) -> RowData<'_> {
        let entries = row * self.pitch..(row + 1) * self.pitch;
        let weights =
            if self.weights.len() == self.pitch { &self.weights[..] } else { &self.weights[entries.clone()] };
        RowData { values: &self.values[entries], weights }
    }

    /// Pixel coordinate of a sampled column or row.
    #[inline]
    #[must_use]
    pub(crate) fn pixel(&self, index: usize) -> usize {
        self.offset + index * self.stride
    }

    /// First sampled column or row at or after a pixel, at most `limit`.
    #[must_use]
    pub(crate) fn index_from(&self, pixel: usize, limit: usize) -> usize {
        pixel.saturating_sub(self.offset).div_ceil(self.stride).min(limit)
    }
}
