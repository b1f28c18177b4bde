//! What a window has left: the copy in words, the note beside it, and a small picture of what a camera showed.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

use backlit_document::project::ProjectError;
use backlit_document::{Document, Origin};
use backlit_formats::{DiskFiles, FileError, TakeFiles, atomic, images};
use backlit_take::source::TakeSource;
use backlit_ui::drawing::{PictureInput, ViewMode, compose};
use backlit_ui::style::format;
use egui::{Color32, ColorImage};
use image::{DynamicImage, RgbImage, imageops};
use serde::{Deserialize, Serialize};

use crate::context::clock::Clock;
use crate::session::prediction::Predicted;

/// Unsaved work that a window has left.
#[derive(Debug, Clone, PartialEq)]
pub struct UnsavedCopy {
    /// The copy.
    pub path: PathBuf,
    /// When it was written last.
    pub(crate) saved: Option<SystemTime>,
    /// Where the user was.
    pub(crate) about: CopyNote,
    /// The take: "balancing", "Built-in take".
    pub(crate) take: String,
    /// Frames whose pose was set by hand.
    pub(crate) by_hand: usize,
    /// Frames whose pose was fitted.
    pub(crate) fitted: usize,
    /// Frames whose pose was tracked.
    pub(crate) tracked: usize,
    /// What the camera on the screen showed, if that was kept.
    pub(crate) picture: Option<Arc<ColorImage>>,
}

impl UnsavedCopy {
    /// What a document holds, and when it was written.
    pub(crate) fn new(
        path: PathBuf,
        document: &Document,
        about: CopyNote,
        saved: Option<SystemTime>,
        picture: Option<ColorImage>,
    ) -> Self {
        let found = |origin| document.estimates.values().filter(|estimate| estimate.origin == origin).count();
        Self {
            take: take_of(document, &about),
            by_hand: document.keys.len(),
            fitted: found(Origin::Fit),
            tracked: found(Origin::Track),
            picture: picture.map(Arc::new),
            path,
            saved,
            about,
        }
    }

    /// When it was written: "today 14:32, 12 minutes ago".
    pub(crate) fn when(&self, clock: &Clock) -> String {
        let when = self.saved.and_then(|saved| clock.when(saved));
        let ago = self.saved.and_then(|saved| clock.ago(saved));
        let parts: Vec<String> = [when, ago].into_iter().flatten().collect();
        if parts.is_empty() { "some time ago".to_owned() } else { parts.join(", ") }
    }

    /// Where the user was: "At frame 30 of 70".
    pub(crate) fn place(&self) -> String {
        match self.about.frames {
            Some(frames @ 2..) => format!("At frame {} of {frames}", self.about.frame),
            _ => format!("At frame {}", self.about.frame),
        }
    }

    /// What has been done: "3 poses by hand, 1 fitted, 31 tracked".
    pub(crate) fn work(&self) -> String {
        let kinds = [(self.by_hand, "set by hand"), (self.fitted, "fitted"), (self.tracked, "tracked")];
        let mut parts = kinds.iter().filter(|(count, _)| *count > 0);
        let first = parts.next().map(|(count, how)| format!("{} {how}", format::counted(*count, "pose")));
        let rest = parts.map(|(count, how)| format!("{count} {how}"));
        let all: Vec<String> = first.into_iter().chain(rest).collect();
        if all.is_empty() { "No poses yet, only settings".to_owned() } else { all.join(", ") }
    }

    /// The file that it belongs to: "Unsaved changes of work.backlit".
    pub(crate) fn belongs(&self) -> String {
        let name = self.about.project.as_deref().and_then(|path| path.file_name());
        match name {
            Some(name) => format!("Unsaved changes of {}", name.to_string_lossy()),
            None => "Never saved to a file".to_owned(),
        }
    }
}

fn take_of(document: &Document, about: &CopyNote) -> String {
    match (&document.take, &about.take) {
        (Some(TakeSource::Demonstration(which)), _) => format!("Demonstration “{}”", which.name()),
        (Some(TakeSource::Path(_)), Some(name)) => name.clone(),
        (Some(TakeSource::Path(path)), None) => {
            path.file_name().map_or_else(|| "Take".into(), |name| name.to_string_lossy().into_owned())
        }
        _ => "Built-in take".to_owned(),
    }
}

/// No more is ever written.
const MAX_BYTES: u64 = 1 << 20;

/// What a copy's project does not say.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct CopyNote {
    /// The frame on the screen.
    pub(crate) frame: usize,
    /// Frames of the take.
    pub(crate) frames: Option<usize>,
    pub(crate) take: Option<String>,
    /// The project file that the work belongs to.
    pub(crate) project: Option<PathBuf>,
}

impl CopyNote {
    /// The file beside a copy.
    pub(crate) fn path_of(copy: &Path) -> PathBuf {
        copy.with_extension("about.json")
    }

    /// Writes it beside a copy. Errors: the file system says no.
    pub(crate) fn write(&self, copy: &Path) -> Result<(), ProjectError> {
        let path = Self::path_of(copy);
        let json =
            serde_json::to_vec(self).map_err(|error| ProjectError::Json { path: path.clone(), error })?;
        Ok(atomic::write(&path, &json)?)
    }

    /// What was written beside a copy; nothing is known if that cannot be read.
    pub(crate) fn read(copy: &Path) -> Self {
        let text = DiskFiles.read(&Self::path_of(copy), MAX_BYTES).unwrap_or_default();
        serde_json::from_slice(&text).unwrap_or_default()
    }
}

/// Longest side, pixels: two a point of the card.
const SIDE: u32 = 224;
/// What is kept around subject and body, of the larger side of both.
const MARGIN: f64 = 0.12;
/// Darker is body.
const HALF: f32 = 127.5;

/// What a camera shows of a pose. It holds what is on the screen by reference: it is painted where there is time.
#[derive(Debug, Clone)]
pub(crate) struct Thumbnail {
    /// What the pose predicts.
    pub(crate) predicted: Arc<Predicted>,
    pub(crate) camera: usize,
}

impl Thumbnail {
    /// The file beside a copy.
    pub(crate) fn path_of(copy: &Path) -> PathBuf {
        copy.with_extension("png")
    }

    /// Paints it and writes it beside a copy. Errors: the file system says no.
    pub(crate) fn write(&self, copy: &Path) -> Result<(), FileError> {
        match self.paint() {
            Some(picture) => images::write_png(&Self::path_of(copy), &DynamicImage::ImageRgb8(picture)),
            None => Ok(()),
        }
    }

    /// What was written beside a copy, if it is there and can be read.
    pub(crate) fn read(copy: &Path) -> Option<ColorImage> {
        let picture = images::read(&Self::path_of(copy)).ok()?;
        let (width, height) = picture.dimensions();
        let is_ours = width > 0 && height > 0 && width.max(height) <= SIDE;
        is_ours.then(|| ColorImage::from_rgb([width as usize, height as usize], picture.as_raw()))
    }

    /// Subject and body, and a little around them; `None` if the camera has no picture.
    fn paint(&self) -> Option<RgbImage> {
        let shown = self.predicted.cameras.get(self.camera)?;
        let data = self.predicted.scene.frame.as_ref()?.cameras.get(self.camera)?;
        let frame = data.image.as_deref()?;
        let input = PictureInput {
            frame: Some(frame),
            mask: data.mask.as_deref(),
            data: shown.data.as_ref().map(|data| data.measurement()),
            prediction: Some(&shown.prediction),
            ..PictureInput::empty([frame.width() as usize, frame.height() as usize])
        };
        let image = compose(ViewMode::Tinted, &input);
        let [width, height] = image.size;
        let [left, top, right, bottom] = around_body(&input);
        let mut part = RgbImage::new((right - left) as u32, (bottom - top) as u32);
        for (x, y, pixel) in part.enumerate_pixels_mut() {
            let at = (top + y as usize).min(height - 1) * width + (left + x as usize).min(width - 1);
            let [r, g, b, _] = image.pixels.get(at).unwrap_or(&Color32::BLACK).to_array();
            pixel.0 = [r, g, b];
        }
        let scale = f64::from(SIDE) / f64::from(part.width().max(part.height()));
        if scale >= 1.0 {
            return Some(part);
        }
        let side = |length: u32| ((f64::from(length) * scale).round() as u32).clamp(1, SIDE);
        Some(imageops::thumbnail(&part, side(part.width()), side(part.height())))
    }
}

/// Left, top, right, bottom of subject and body with a margin; the whole picture if there is neither.
fn around_body(input: &PictureInput<'_>) -> [usize; 4] {
    let [width, height] = input.size;
    let mut rect: Option<[usize; 4]> = None;
    for y in 0..height {
        for x in 0..width {
            let Some(sample) = input.sample(x, y) else { continue };
            let is_dark = |level: Option<f32>| level.is_some_and(|level| level < HALF);
            if is_dark(sample.prediction) || (!sample.is_unknown && is_dark(sample.data)) {
                let [left, top, right, bottom] = rect.unwrap_or([x, y, x, y]);
                rect = Some([left.min(x), top.min(y), right.max(x + 1), bottom.max(y + 1)]);
            }
        }
    }
    let Some([left, top, right, bottom]) = rect else { return [0, 0, width, height] };
    let margin = (MARGIN * (right - left).max(bottom - top) as f64).ceil() as usize;
    [
        left.saturating_sub(margin),
        top.saturating_sub(margin),
        (right + margin).min(width),
        (bottom + margin).min(height),
    ]
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::time::Duration;

    use backlit_tracking::body::{Pose, builtin};

    use super::*;

    #[test]
    fn what_was_left_is_said_so_that_one_can_decide() {
        let saved = SystemTime::UNIX_EPOCH + Duration::from_secs(1_795_271_520);
        let clock = Clock::fixed(saved + Duration::from_secs(720), 0).unwrap();
        let mut document = Document::new(builtin::single_limb());
        document.take = Some(TakeSource::Path(PathBuf::from("/takes/b")));
        let about = CopyNote {
            frame: 30,
            frames: Some(70),
            take: Some("balancing".to_owned()),
            project: Some(PathBuf::from("/work/arm.backlit")),
        };
        let left = |document: &Document, about: &CopyNote| {
            UnsavedCopy::new(PathBuf::from("unsaved.backlit"), document, about.clone(), Some(saved), None)
        };
        let nothing = left(&document, &CopyNote::default());
        assert_eq!((nothing.take.as_str(), nothing.place()), ("b", "At frame 0".to_owned()));
        assert_eq!(
            (nothing.work(), nothing.belongs()),
            ("No poses yet, only settings".into(), "Never saved to a file".into())
        );
        let pose = Pose::rest(&document.model);
        document.keys = Arc::new(BTreeMap::from([(3, pose.clone()), (4, pose)]));
        let some = left(&document, &about);
        assert_eq!(some.take, "balancing");
        assert_eq!(some.when(&clock), "today 14:32, 12 minutes ago");
        assert_eq!(some.place(), "At frame 30 of 70");
        assert_eq!(some.belongs(), "Unsaved changes of arm.backlit");
        assert_eq!(some.work(), "2 poses set by hand");
        let both = UnsavedCopy { by_hand: 1, tracked: 31, ..some.clone() };
        assert_eq!(both.work(), "1 pose set by hand, 31 tracked");
        assert_eq!(UnsavedCopy { saved: None, ..some }.when(&clock), "some time ago");
    }
}
