//! What is chosen for an export. It is kept from start to start.

use std::path::PathBuf;

use backlit_formats::motion::{Axes, EulerOrder, MotionFormat, Names, Unit};
use serde::{Deserialize, Serialize};

/// Pixels of an exported picture across, at most; as much as the readers of pictures take.
pub(crate) const MAX_SIDE: u32 = 16_384;
/// Footage pixels, or points of the window, become this many pixels.
pub(crate) const SCALES: std::ops::RangeInclusive<f32> = 0.25..=8.0;
/// Time that a picture of a series stays, in milliseconds.
pub(crate) const DELAYS_MS: std::ops::RangeInclusive<u32> = 10..=10_000;

/// What is painted.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Part {
    /// One camera's picture with its marks.
    #[default]
    View,
    /// The whole window.
    Window,
}

/// What a series of pictures becomes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SeriesFormat {
    /// A folder of PNGs with numbers in their names.
    #[default]
    Pngs,
    /// One PNG that moves: all colours.
    AnimatedPng,
    /// One GIF: 256 colours a picture, but shown everywhere.
    Gif,
}

impl SeriesFormat {
    /// The formats with their names.
    pub(crate) const ALL: [(Self, &'static str); 3] =
        [(Self::Pngs, "PNGs"), (Self::AnimatedPng, "Animated PNG"), (Self::Gif, "GIF")];

    /// The format that a path asks for by its ending: a folder where there is none.
    pub(crate) fn of_path(path: &std::path::Path) -> Option<Self> {
        match path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).as_deref() {
            None => Some(Self::Pngs),
            Some("png" | "apng") => Some(Self::AnimatedPng),
            Some("gif") => Some(Self::Gif),
            Some(_) => path.is_dir().then_some(Self::Pngs),
        }
    }

    /// The ending of its file, with the dot; a folder has none.
    pub(crate) const fn ending(self) -> &'static str {
        match self {
            Self::Pngs => "",
            Self::AnimatedPng => ".png",
            Self::Gif => ".gif",
        }
    }
}

/// How a motion is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct MotionChoices {
    /// Kind of file.
    pub format: MotionFormat,
    /// Which way the file's axes point; `None`: as the format expects.
    pub axes: Option<Axes>,
    /// Unit of lengths; `None`: as the format expects.
    pub unit: Option<Unit>,
    /// What joints are called.
    pub names: Names,
    /// Order of angles in BVH.
    pub euler: EulerOrder,
}

impl Default for MotionChoices {
    fn default() -> Self {
        let format = MotionFormat::Bvh;
        Self { format, axes: None, unit: None, names: Names::default(), euler: EulerOrder::default() }
    }
}

/// All choices.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
#[expect(clippy::struct_excessive_bools, reason = "boxes that are ticked independently of each other")]
pub struct ExportChoices {
    /// What is painted of every picture of a series.
    pub part: Part,
    /// Pixels of a view's picture for one pixel of the footage.
    pub view_scale: f32,
    /// Pixels across instead, if that is chosen.
    pub view_width: Option<u32>,
    /// The whole frame, not what is framed in the tile.
    pub whole_frame: bool,
    /// With joints, limbs and rays.
    pub marks: bool,
    /// With the strip that explains the colours.
    pub legend: bool,
    /// Pixels of the window's picture for one point.
    pub window_scale: f32,
    /// What a series becomes.
    pub format: SeriesFormat,
    /// Time that a picture of a series stays, in milliseconds.
    pub delay_ms: u32,
    /// Begin again at the end.
    pub repeats: bool,
    /// Without the steps that were rejected.
    pub accepted_only: bool,
    /// How a motion is written.
    pub motion: MotionChoices,
    /// Where the last export went.
    pub folder: Option<PathBuf>,
}

impl Default for ExportChoices {
    fn default() -> Self {
        Self {
            part: Part::View,
            view_scale: 2.0,
            view_width: None,
            whole_frame: true,
            marks: true,
            legend: true,
            window_scale: 1.0,
            format: SeriesFormat::Pngs,
            delay_ms: 120,
            repeats: true,
            accepted_only: false,
            motion: MotionChoices::default(),
            folder: None,
        }
    }
}

impl ExportChoices {
    /// Pixels of a view's picture for one pixel of a footage `width` pixels wide, within all limits.
    pub(crate) fn view_pixels_per_px(&self, [width, height]: [usize; 2]) -> f32 {
        let wanted = match self.view_width {
            Some(pixels) => pixels as f32 / width.max(1) as f32,
            None => self.view_scale,
        };
        let most = MAX_SIDE as f32 / width.max(height).max(1) as f32;
        if wanted.is_finite() { wanted.clamp(16.0 / width.max(1) as f32, most) } else { 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn a_path_says_what_it_wants_to_be() {
        for (path, format) in [
            ("out", Some(SeriesFormat::Pngs)),
            ("a/b.gif", Some(SeriesFormat::Gif)),
            ("a.PNG", Some(SeriesFormat::AnimatedPng)),
            ("a.mp4", None),
        ] {
            assert_eq!(SeriesFormat::of_path(Path::new(path)), format, "{path}");
        }
    }

    #[test]
    fn no_picture_is_wider_than_can_be_read() {
        let choices = ExportChoices { view_width: Some(u32::MAX), ..ExportChoices::default() };
        assert_eq!(choices.view_pixels_per_px([4096, 2048]), 4.0);
        let choices = ExportChoices { view_width: Some(544), ..ExportChoices::default() };
        assert_eq!(choices.view_pixels_per_px([272, 480]), 2.0);
        let choices = ExportChoices { view_scale: f32::NAN, ..ExportChoices::default() };
        assert_eq!(choices.view_pixels_per_px([272, 480]), 1.0);
    }
}
