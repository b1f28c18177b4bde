//! Grey pictures: levels between pixels, and the same picture at half, a quarter … of its size.
//!
//! A pixel i of a coarser picture lies where pixel 2 i of the finer one does; before every second pixel is left out the
//! picture is smoothed by (1, 4, 6, 4, 1)/16 in both directions (P. Burt and E. Adelson, "The Laplacian pyramid", 1983).

use std::sync::OnceLock;

use glam::DVec2;
use image::GrayImage;
use thiserror::Error;

use crate::silhouette::MAX_PIXELS;

/// Pictures narrower than this have no coarser one.
const LEAST_PX: usize = 16;
const BINOMIAL: [f32; 5] = [1.0 / 16.0, 4.0 / 16.0, 6.0 / 16.0, 4.0 / 16.0, 1.0 / 16.0];

/// A grey picture: 0 black … 255 white, rows from the top.
#[derive(Debug, Clone)]
pub struct GreyPicture {
    width: usize,
    height: usize,
    levels: Vec<f32>,
    coarser: OnceLock<Option<Box<Self>>>,
}

impl PartialEq for GreyPicture {
    fn eq(&self, other: &Self) -> bool {
        (self.width, self.height, &self.levels) == (other.width, other.height, &other.levels)
    }
}

/// Why levels are no picture.
#[derive(Debug, Error, Clone, PartialEq, Eq)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum GreyPictureError {
    #[error("a picture of {width} × {height} pixels; expected 1 to {MAX_PIXELS} of them")]
    Size { width: usize, height: usize },
    #[error("{found} grey levels for a picture of {width} × {height} pixels")]
    Length { width: usize, height: usize, found: usize },
    #[error("pixel {index} has a grey level that is not finite")]
    NotFinite { index: usize },
}

impl GreyPicture {
    /// A picture of levels, row by row.
    ///
    /// # Errors
    /// No or too many pixels, not as many levels as pixels, a level that is not finite.
    pub fn new(width: usize, height: usize, levels: Vec<f32>) -> Result<Self, GreyPictureError> {
        match width.checked_mul(height) {
            None | Some(0) => return Err(GreyPictureError::Size { width, height }),
            Some(pixels) if pixels > MAX_PIXELS => return Err(GreyPictureError::Size { width, height }),
            Some(pixels) if pixels != levels.len() => {
                return Err(GreyPictureError::Length { width, height, found: levels.len() });
            }
            Some(_) => {}
        }
        match levels.iter().position(|level| !level.is_finite()) {
            Some(index) => Err(GreyPictureError::NotFinite { index }),
            None => Ok(Self::of(width, height, levels)),
        }
    }

    fn of(width: usize, height: usize, levels: Vec<f32>) -> Self {
        Self { width, height, levels, coarser: OnceLock::new() }
    }

    /// An image's levels.
    ///
    /// # Errors
    /// No pixel, or too many.
    pub fn of_image(image: &GrayImage) -> Result<Self, GreyPictureError> {
        let levels = image.as_raw().iter().map(|&level| f32::from(level)).collect();
        Self::new(image.width() as usize, image.height() as usize, levels)
    }

    /// Pixels across.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Pixels down.
    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }

    /// All levels, row by row.
    #[must_use]
    pub fn levels(&self) -> &[f32] {
        &self.levels
    }

    /// Whether a place lies between pixels of the picture, at least this many from its border.
    #[must_use]
    pub fn holds(&self, place: DVec2, border_px: f64) -> bool {
        let last = DVec2::new(self.width as f64 - 1.0, self.height as f64 - 1.0);
        place.cmpge(DVec2::splat(border_px)).all() && place.cmplt(last - border_px).all()
    }

    /// The level at a place, between its four pixels; outside that of the nearest place inside, and no
    /// number outside the picture.
    #[inline]
    #[must_use]
    pub fn at(&self, place: DVec2) -> f32 {
        let x = place.x.clamp(0.0, self.width as f64 - 1.0) as f32;
        let y = place.y.clamp(0.0, self.height as f64 - 1.0) as f32;
        let (column, row) = (x as usize, y as usize);
        let (u, v) = (x - column as f32, y - row as f32);
        let below = if row + 1 < self.height { self.width } else { 0 };
        let right = usize::from(column + 1 < self.width);
        let first = row * self.width + column;
        let [a, b] = [self.levels[first], self.levels[first + right]];
        let [c, d] = [self.levels[first + below], self.levels[first + below + right]];
        let (top, bottom) = (a + u * (b - a), c + u * (d - c));
        top + v * (bottom - top)
    }

    /// The levels of a square of `side` × `side` places a pixel apart, the first of them at `first`: each what
    /// [`at`](Self::at) says. The square must lie within the picture ([`holds`](Self::holds) its corners with a border of 1).
    pub(super) fn square(&self, first: DVec2, side: usize, levels: &mut [f32]) {
        let (column, row) = (first.x as usize, first.y as usize);
        let (u, v) = ((first.x - column as f64) as f32, (first.y - row as f64) as f32);
        for (y, levels) in levels.chunks_exact_mut(side).enumerate() {
            let start = (row + y) * self.width + column;
            let (above, below) = (&self.levels[start..], &self.levels[start + self.width..]);
            for (x, level) in levels.iter_mut().enumerate() {
                let top = above[x] + u * (above[x + 1] - above[x]);
                let bottom = below[x] + u * (below[x + 1] - below[x]);
                *level = top + v * (bottom - top);
            }
        }
    }

    /// The same picture at half its size, made once; `None` for one that is too small.
    #[must_use]
    pub fn coarser(&self) -> Option<&Self> {
        let made = || {
            let is_large = self.width.min(self.height) >= 2 * LEAST_PX;
            is_large.then(|| Box::new(self.halved()))
        };
        self.coarser.get_or_init(made).as_deref()
    }

    fn halved(&self) -> Self {
        let (width, height) = (self.width.div_ceil(2), self.height.div_ceil(2));
        let clamped = |at: usize, tap: usize, last: usize| (at + tap).saturating_sub(2).min(last);
        let mut across = vec![0.0; width * self.height];
        for (row, smooth) in self.levels.chunks_exact(self.width).zip(across.chunks_exact_mut(width)) {
            for (x, level) in smooth.iter_mut().enumerate() {
                let tap = |(tap, weight): (usize, &f32)| weight * row[clamped(2 * x, tap, self.width - 1)];
                *level = BINOMIAL.iter().enumerate().map(tap).sum();
            }
        }
        let mut levels = vec![0.0; width * height];
        for (y, row) in levels.chunks_exact_mut(width).enumerate() {
            for (tap, weight) in BINOMIAL.iter().enumerate() {
                let from = clamped(2 * y, tap, self.height - 1) * width;
                for (level, smooth) in row.iter_mut().zip(&across[from..from + width]) {
                    *level += weight * smooth;
                }
            }
        }
        Self::of(width, height, levels)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_that_are_no_picture_are_errors() {
        assert!(GreyPicture::new(2, 1, vec![0.0, 1.0]).is_ok());
        assert_eq!(GreyPicture::new(0, 3, vec![]), Err(GreyPictureError::Size { width: 0, height: 3 }));
        let huge = usize::MAX / 2;
        assert!(matches!(GreyPicture::new(huge, 4, vec![]), Err(GreyPictureError::Size { .. })));
        let found = GreyPicture::new(2, 2, vec![0.0; 3]);
        assert_eq!(found, Err(GreyPictureError::Length { width: 2, height: 2, found: 3 }));
        let found = GreyPicture::new(2, 1, vec![0.0, f32::NAN]);
        assert_eq!(found, Err(GreyPictureError::NotFinite { index: 1 }));
    }

    /// A plane is itself between pixels and at half its size, but for the border.
    #[test]
    fn a_plane_stays_one() {
        let plane = |x: f64, y: f64| 3.0 + 0.5 * x + 0.25 * y;
        let picture = crate::fixtures::grey_picture([41, 37], |x, y| plane(x as f64, y as f64));
        let place = DVec2::new(12.3, 7.8);
        assert!((f64::from(picture.at(place)) - plane(12.3, 7.8)).abs() < 1e-4);
        let mut square = [0.0; 9];
        picture.square(place, 3, &mut square);
        for (index, level) in square.iter().enumerate() {
            let there = place + DVec2::new((index % 3) as f64, (index / 3) as f64);
            assert!((level - picture.at(there)).abs() < 1e-4);
        }
        let half = picture.coarser().unwrap();
        assert_eq!((half.width(), half.height()), (21, 19));
        assert!((f64::from(half.at(place)) - plane(24.6, 15.6)).abs() < 1e-3);
        assert!(half.coarser().is_none());
        // Outside, the border goes on, whatever is asked.
        assert_eq!(picture.at(DVec2::new(-5.0, f64::NEG_INFINITY)), picture.at(DVec2::ZERO));
        assert!(picture.holds(DVec2::new(1.0, 1.0), 1.0) && !picture.holds(DVec2::new(39.5, 1.0), 1.0));
        assert!(!picture.holds(DVec2::NAN, 0.0));
    }
}
