//! What is to be exported: which pictures of what, how large, and where to.

use std::path::PathBuf;

use backlit_document::run::Run;
use backlit_document::runs::StepRef;
use backlit_tracking::cancel::CancelToken;
use egui::Vec2;
use image::RgbImage;

use super::{ExportChoices, Part, SeriesOptions};
use crate::context::Context;
use crate::context::picture_alone::PictureAlone;

/// What is exported.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Subject {
    /// The active camera's picture.
    View,
    /// The window.
    Window,
    /// All steps of the shown run.
    Steps,
    /// A range of frames with their poses.
    Frames,
}

impl Subject {
    pub(super) const ALL: [(Self, &'static str); 4] =
        [(Self::View, "View"), (Self::Window, "Window"), (Self::Steps, "Steps"), (Self::Frames, "Frames")];

    pub(super) const fn is_series(self) -> bool {
        matches!(self, Self::Steps | Self::Frames)
    }
}

/// What is to be exported.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ExportOrder {
    pub(crate) subject: Subject,
    pub(crate) choices: ExportChoices,
    /// First and last frame.
    pub(crate) frames: [usize; 2],
    pub(crate) path: PathBuf,
}

/// What is painted, and how large.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum PictureOf {
    /// The window, of its own size in points.
    Window {
        /// Points.
        size: Vec2,
        /// Pixels for a point.
        scale: f32,
    },
    /// A camera's picture.
    View {
        /// Which camera, and with what.
        picture: PictureAlone,
        /// Pixels for a pixel of the footage.
        scale: f32,
        /// The whole frame, not what is framed in the tile.
        whole_frame: bool,
    },
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
    /// What is painted, and how large.
    pub(crate) fn picture(&self, context: &Context<'_>) -> PictureOf {
        let choices = &self.choices;
        let part = match self.subject {
            Subject::View => Part::View,
            Subject::Window => Part::Window,
            Subject::Steps | Subject::Frames => choices.part,
        };
        let camera = context.selection.camera;
        match part {
            Part::Window => {
                PictureOf::Window { size: context.egui.viewport_rect().size(), scale: choices.window_scale }
            }
            Part::View => PictureOf::View {
                picture: PictureAlone { camera, marks: choices.marks, legend: choices.legend },
                scale: choices.view_pixels_per_px(context.session.camera_size(camera).unwrap_or([1, 1])),
                whole_frame: choices.whole_frame,
            },
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

    /// How a series is written, and what the pictures of a folder are called; one picture has neither.
    pub(super) fn series(&self) -> Option<(SeriesOptions, &'static str)> {
        let ExportChoices { format, delay_ms, repeats, .. } = self.choices;
        let name = match self.subject {
            Subject::View | Subject::Window => return None,
            Subject::Steps => "step",
            Subject::Frames => "frame",
        };
        Some((SeriesOptions { format, delay_ms, repeats }, name))
    }
}

/// The steps of the shown run, from its start on.
fn shots_of_steps(context: &Context<'_>, accepted_only: bool) -> Vec<(usize, Shot)> {
    let Some(Run { number, steps, .. }) = context.run() else { return Vec::new() };
    let is_wanted = |step: usize| step == 0 || steps[step].iteration.accepted || !accepted_only;
    let shot = |step| (step, Shot::Step(StepRef { run: *number, step }));
    (0..steps.len()).filter(|step| is_wanted(*step)).map(shot).collect()
}
