//! A camera's footage, whatever it lies in, and how its pictures were made from those that a calibration is for.

use std::fmt;
use std::path::PathBuf;
use std::sync::Arc;

use backlit_tracking::camera::{Camera, CameraError};
use glam::DVec2;
use image::RgbImage;

use super::scan::Sequence;
use crate::video::Video;
use crate::{FileError, Result, images};

/// Where a camera's pictures are.
#[derive(Debug, Clone)]
pub enum Pictures {
    /// A video.
    Video(Video),
    /// Numbered pictures.
    Numbered(Sequence),
}

impl Pictures {
    /// How many there are.
    #[must_use]
    pub fn count(&self) -> usize {
        match self {
            Self::Video(video) => video.frame_count(),
            Self::Numbered(sequence) => sequence.count,
        }
    }

    /// The video, or the first picture.
    #[must_use]
    pub fn path(&self) -> PathBuf {
        self.path_of(0)
    }

    /// The video, or the picture with this place among them.
    pub(super) fn path_of(&self, index: usize) -> PathBuf {
        match self {
            Self::Video(video) => video.path().to_owned(),
            Self::Numbered(sequence) => sequence.path(index).unwrap_or_default(),
        }
    }

    /// One of them, counted from 0.
    pub fn picture(&self, index: usize) -> Result<RgbImage> {
        self.reduced(index, 1)
    }

    /// The same, [reduced](images::reduced).
    pub fn reduced(&self, index: usize, divisor: usize) -> Result<RgbImage> {
        match self {
            Self::Video(video) => video.frame_reduced(index, divisor).map(Arc::unwrap_or_clone),
            Self::Numbered(sequence) => match sequence.path(index) {
                Ok(path) => Ok(images::reduced(images::read(&path)?, divisor)),
                Err(_) => Err(FileError::new(&sequence.folder, crate::FileProblem::Missing)),
            },
        }
    }
}

/// Proportions that differ by less are the same: a pixel or two of rounding.
const SAME_PROPORTIONS: f64 = 0.003;
/// Bars narrower than this cannot be told from a picture's own edge, pixels.
const NARROWEST_BAR_PX: f64 = 1.5;
/// Bars are darker than this, grey levels.
const DARKEST: f64 = 16.0;
/// The picture beside a bar is brighter than the bar by this many grey levels.
const BRIGHTER: f64 = 12.0;

/// How pictures were made from those that the calibration is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PictureSize {
    /// They are of the same size.
    Same,
    /// They were scaled to another size, across and down each by its own factor.
    Scaled,
    /// They were scaled as a whole, and dark bars fill what was left at two sides.
    Letterboxed,
    /// Columns at the right or rows at the bottom were cut off or added.
    CutAtCorner,
    /// As much was cut off or added at the left as at the right, and above as below.
    CutAround,
}

impl PictureSize {
    /// All but [`Same`](Self::Same), which need not be chosen.
    pub const CHOICES: [Self; 4] = [Self::Scaled, Self::Letterboxed, Self::CutAtCorner, Self::CutAround];

    /// The word for it on the command line.
    #[must_use]
    pub fn word(self) -> &'static str {
        ["same", "scaled", "letterboxed", "cut-at-corner", "cut-around"][self as usize]
    }

    /// What a picture tells of how it was made: its proportions, else dark bars at two of its sides, else a cut.
    #[must_use]
    pub fn guess(camera: &Camera, picture: &RgbImage) -> Self {
        let (old, new) =
            (size_of(camera), DVec2::new(f64::from(picture.width()), f64::from(picture.height())));
        if old == new {
            return Self::Same;
        }
        let scale = new / old;
        if (scale.x / scale.y - 1.0).abs() < SAME_PROPORTIONS && !has_bars(picture, bars(old, new)) {
            return Self::Scaled;
        }
        if has_bars(picture, bars(old, new)) {
            return Self::Letterboxed;
        }
        Self::CutAtCorner
    }

    /// The camera of pictures of `size`, width first, that were made so.
    pub fn camera(self, camera: &Camera, size: [usize; 2]) -> Result<Camera, CameraError> {
        let [width, height] = size.map(|side| side as u64);
        let (old, new) = (size_of(camera), DVec2::new(width as f64, height as f64));
        let (scale, offset) = match self {
            Self::Same | Self::CutAtCorner => (DVec2::ONE, DVec2::ZERO),
            Self::Scaled => (new / old, DVec2::ZERO),
            Self::Letterboxed => (DVec2::splat((new / old).min_element()), bars(old, new)),
            Self::CutAround => (DVec2::ONE, (new - old) / 2.0),
        };
        camera.remapped([width, height], scale, offset)
    }
}

impl fmt::Display for PictureSize {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Same => "of the calibration's size",
            Self::Scaled => "scaled",
            Self::Letterboxed => "scaled, with dark bars at two sides",
            Self::CutAtCorner => "cut at the right and at the bottom",
            Self::CutAround => "cut on all sides alike",
        })
    }
}

fn size_of(camera: &Camera) -> DVec2 {
    DVec2::new(camera.width() as f64, camera.height() as f64)
}

/// The bars that fill a picture of size `new` where one of size `old` was scaled into it, pixels on either side.
fn bars(old: DVec2, new: DVec2) -> DVec2 {
    let scale = (new / old).min_element();
    ((new - old * scale) / 2.0).max(DVec2::ZERO)
}

/// Whether there are dark bars of this width at both sides where they are wide enough to be seen.
fn has_bars(picture: &RgbImage, bars: DVec2) -> bool {
    let (width, height) = (picture.width(), picture.height());
    let is_across = bars.y >= bars.x;
    let (bar, length) = if is_across { (bars.y, height) } else { (bars.x, width) };
    if bar < NARROWEST_BAR_PX {
        return false;
    }
    let mean = |line: u32| {
        let other = if is_across { width } else { height };
        let grey = |at: u32| {
            let pixel = if is_across { picture.get_pixel(at, line) } else { picture.get_pixel(line, at) };
            pixel.0.iter().map(|&level| f64::from(level)).sum::<f64>() / 3.0
        };
        (0..other).map(grey).sum::<f64>() / f64::from(other.max(1))
    };
    // The bar's own edge may be mixed with the picture's.
    let inner = (bar - 0.5).floor() as u32;
    let beside = bar.ceil() as u32 + 2;
    [true, false].into_iter().all(|is_first| {
        let line = |at: u32| if is_first { at } else { length.saturating_sub(1 + at) };
        let darkest = (0..inner).map(|at| mean(line(at))).fold(0.0, f64::max);
        darkest < DARKEST && mean(line(beside)) > darkest + BRIGHTER
    })
}

#[cfg(test)]
mod tests {
    use backlit_tracking::camera::{CameraFromWorld, Distortion, Intrinsics};
    use glam::DVec3;
    use image::Rgb;

    use super::*;

    fn camera() -> Camera {
        let place = CameraFromWorld::looking_at(DVec3::new(0.0, -3.0, 1.0), DVec3::Z, DVec3::Z);
        let intrinsics = Intrinsics { fx: 1680.0, fy: 1681.0, cx: 533.0, cy: 948.0 };
        Camera::new("c", [1088, 1920], intrinsics, Distortion::None, place).unwrap()
    }

    fn picture(width: u32, height: u32, bar: u32) -> RgbImage {
        RgbImage::from_fn(width, height, |x, y| match y {
            y if y < bar || y >= height - bar => Rgb([2, 3, 4]),
            _ => Rgb([(40 + x % 50) as u8, 90, 120]),
        })
    }

    #[test]
    fn a_picture_tells_how_it_was_made() {
        let camera = camera();
        for (picture, expected) in [
            (picture(1088, 1920, 0), PictureSize::Same),
            (picture(544, 960, 0), PictureSize::Scaled),
            (picture(1080, 1920, 7), PictureSize::Letterboxed),
            (picture(1080, 1920, 0), PictureSize::CutAtCorner),
            (picture(1080, 1080, 0), PictureSize::CutAtCorner),
        ] {
            assert_eq!(PictureSize::guess(&camera, &picture), expected, "{:?}", picture.dimensions());
        }
    }

    #[test]
    fn the_camera_follows_the_pixels() {
        let (camera, point) = (camera(), DVec3::new(0.3, 0.2, 1.4));
        let pixel = camera.project(point).unwrap();
        let in_size =
            |how: PictureSize, size: [usize; 2]| how.camera(&camera, size).unwrap().project(point).unwrap();
        let close = |a: DVec2, b: DVec2| assert!(a.distance(b) < 1e-9, "{a} {b}");
        close(in_size(PictureSize::CutAtCorner, [1080, 1920]), pixel);
        close(in_size(PictureSize::CutAround, [1080, 1900]), pixel - DVec2::new(4.0, 10.0));
        close(in_size(PictureSize::Scaled, [544, 960]), (pixel - 0.5) / 2.0);
        // 1906 rows are left of 1920: bars of seven.
        let scale = 1080.0 / 1088.0;
        let bars = DVec2::new(0.0, (1920.0 - 1920.0 * scale) / 2.0);
        close(in_size(PictureSize::Letterboxed, [1080, 1920]), (pixel + 0.5) * scale - 0.5 + bars);
    }
}
