//! One camera's pictures and background.

use std::path::{Path, PathBuf};

use super::FramePattern;
use super::keypoints::CameraKeypoints;
use super::masks::CameraMasks;
use crate::video::Video;

/// Most frames a take may have: hours at any rate.
pub const MAX_FRAMES: usize = 1_000_000;
/// Most pictures a background is made of.
pub const MAX_BACKGROUND_FRAMES: usize = 256;

/// Where one camera's pictures are.
#[derive(Debug, Clone)]
pub struct CameraFootage {
    pub(super) camera: String,
    pub(super) frames: Frames,
    /// The number of frame 0.
    pub(super) first: u64,
    pub(super) background: Option<BackgroundSource>,
    pub(super) masks: Option<CameraMasks>,
    pub(super) keypoints: Option<CameraKeypoints>,
}

/// What a camera's frames are taken from.
#[derive(Debug, Clone)]
pub(super) enum Frames {
    Pictures { folder: PathBuf, pattern: FramePattern },
    Video(Video),
}

/// Where a camera's view without the subject is.
#[derive(Debug, Clone)]
#[expect(missing_docs, reason = "the variants say what their fields are")]
pub enum BackgroundSource {
    /// One picture.
    Plate(PathBuf),
    /// Several pictures, whose mean and deviation are the background.
    Frames(Vec<PathBuf>),
    /// Frames of a video, which are taken as several pictures are.
    Video { video: Video, frames: Vec<usize> },
}

impl BackgroundSource {
    /// The files, at least one.
    #[must_use]
    pub fn paths(&self) -> Vec<&Path> {
        match self {
            Self::Plate(path) => vec![path],
            Self::Frames(paths) => paths.iter().map(PathBuf::as_path).collect(),
            Self::Video { video, .. } => vec![video.path()],
        }
    }
}

impl CameraFootage {
    /// The camera's name.
    #[must_use]
    pub fn camera(&self) -> &str {
        &self.camera
    }

    /// The file of a frame, counted from 0 at the take's start. Of a video it is the same for all.
    #[must_use]
    pub fn path(&self, frame: usize) -> PathBuf {
        self.frames.path(self.number(frame))
    }

    /// The camera's own number of a frame that is counted from 0 at the take's start: of its file, or in its video.
    #[must_use]
    pub fn number(&self, frame: usize) -> u64 {
        self.first.saturating_add(frame as u64)
    }

    /// The video, if the camera's frames are one.
    #[must_use]
    pub fn video(&self) -> Option<&Video> {
        match &self.frames {
            Frames::Pictures { .. } => None,
            Frames::Video(video) => Some(video),
        }
    }

    /// Where the background is, if the take has one for this camera.
    #[must_use]
    pub fn background(&self) -> Option<&BackgroundSource> {
        self.background.as_ref()
    }
}

/// How far behind the last picture others are looked for.
const LOOKED_AHEAD: u64 = 1000;

/// Says that pictures lie behind a gap, where no number of frames is given: such pictures are not used. `end` is the number of
/// the first one that is missing.
pub(super) fn gap(footage: &CameraFootage, exists: &dyn Fn(&Path) -> bool, end: u64) -> Option<String> {
    if !matches!(footage.frames, Frames::Pictures { .. }) {
        return None;
    }
    let behind = end.saturating_add(1)..end.saturating_add(LOOKED_AHEAD);
    let there: Vec<u64> = behind.filter(|&number| exists(&footage.frames.path(number))).collect();
    let (next, count) = (there.first()?, there.len());
    Some(format!(
        "camera \"{}\": pictures {end} to {} are missing, so that its frames end there; at least {count} later ones are not used",
        footage.camera,
        next - 1
    ))
}

/// How many files of a pattern there are without a gap, at most `limit`.
pub(super) fn count_files(
    exists: &dyn Fn(&Path) -> bool,
    pattern: &FramePattern,
    folder: &Path,
    first: u64,
    limit: usize,
) -> usize {
    (0..limit).take_while(|&k| exists(&pattern.path(folder, first.saturating_add(k as u64)))).count()
}
