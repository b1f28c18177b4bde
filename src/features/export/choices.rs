//! What is chosen for an export, kept from start to start; and what is to be exported: which pictures of what, how large,
//! and where to.

use std::path::PathBuf;

use backlit_document::run::Run;
use backlit_document::runs::StepRef;
use backlit_formats::motion::{Axes, EulerOrder, MotionFormat, Names, Unit};
use backlit_tracking::cancel::CancelToken;
use image::RgbImage;
use serde::{Deserialize, Serialize};

use crate::context::Context;

/// Pixels of an exported picture across, at most; as much as the readers of pictures take.
pub(crate) const MAX_SIDE: u32 = 16_384;
/// Footage pixels, or points of the window, become this many pixels.
pub(crate) const SCALES: std::ops::RangeInclusive<f32> = 0.25..=8.0;
/// Time that a picture of a series stays, in milliseconds.
pub(crate) const DELAYS_MS: std::ops::RangeInclusive<u32> = 10..=10_000;

/// What is painted.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ExportArea {
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
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct MotionChoices {
    /// Kind of file.
    pub format: MotionFormat,
    /// Other kinds that are written beside it.
    pub also: Vec<MotionFormat>,
    /// Which way the file's axes point; `None`: as the format expects.
    pub axes: Option<Axes>,
    /// Unit of lengths; `None`: as the format expects.
    pub unit: Option<Unit>,
    /// What joints are called; `None`: as the format expects.
    pub names: Option<Names>,
    /// Order of angles in BVH.
    pub euler: EulerOrder,
}

impl Default for MotionChoices {
    fn default() -> Self {
        let format = MotionFormat::Bvh;
        Self { format, also: Vec::new(), axes: None, unit: None, names: None, euler: EulerOrder::default() }
    }
}

/// All choices.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
#[expect(clippy::struct_excessive_bools, reason = "boxes that are ticked independently of each other")]
pub struct ExportChoices {
    /// What is painted of every picture of a series.
    pub part: ExportArea,
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
            part: ExportArea::View,
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

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Subject {
    /// The active camera's picture.
    View,
    Window,
    /// All steps of the shown run.
    Steps,
    /// A range of frames with their poses.
    Frames,
}

impl Subject {
    pub(super) const ALL: [(Self, &'static str); 4] =
        [(Self::View, "View"), (Self::Window, "Window"), (Self::Steps, "Steps"), (Self::Frames, "Frames")];

    /// What the pictures of a folder are called, if there is more than one picture.
    pub(super) const fn series(self) -> Option<&'static str> {
        match self {
            Self::View | Self::Window => None,
            Self::Steps => Some("step"),
            Self::Frames => Some("frame"),
        }
    }

    pub(super) const fn is_series(self) -> bool {
        self.series().is_some()
    }
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ExportOrder {
    pub(crate) subject: Subject,
    pub(crate) choices: ExportChoices,
    /// First and last frame.
    pub(crate) frames: [usize; 2],
    pub(crate) path: PathBuf,
}

/// What is to be seen in a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Shot {
    /// What is selected.
    AsShown,
    /// A step of a run.
    Step(StepRef),
    /// A frame with its pose.
    Frame(usize),
}

/// Paints the inspector as it was when the export began.
pub(crate) trait Painter: Send {
    /// The picture of a shot; whatever there is of it so far, if it was cancelled.
    fn paint(&mut self, shot: Shot, cancel: &CancelToken) -> RgbImage;
}

impl ExportOrder {
    pub(crate) fn part(&self) -> ExportArea {
        match self.subject {
            Subject::View => ExportArea::View,
            Subject::Window => ExportArea::Window,
            Subject::Steps | Subject::Frames => self.choices.part,
        }
    }

    /// The pictures, each with the number in its name.
    pub(super) fn shots(&self, context: &Context<'_>) -> Vec<(usize, Shot)> {
        match self.subject {
            Subject::View | Subject::Window => vec![(0, Shot::AsShown)],
            Subject::Steps => shots_of_steps(context, self.choices.accepted_only),
            Subject::Frames => {
                let [first, last] = self.frames;
                let last = last.min(context.session.frame_count().saturating_sub(1));
                (first..=last).map(|frame| (frame, Shot::Frame(frame))).collect()
            }
        }
    }
}

/// The steps of the shown run, from its start on.
fn shots_of_steps(context: &Context<'_>, accepted_only: bool) -> Vec<(usize, Shot)> {
    let Some(Run { number, steps, .. }) = context.run() else { return Vec::new() };
    let is_wanted = |step: usize| step == 0 || steps[step].iteration.accepted || !accepted_only;
    let shot = |step| (step, Shot::Step(StepRef { run: *number, step }));
    (0..steps.len()).filter(|step| is_wanted(*step)).map(shot).collect()
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
