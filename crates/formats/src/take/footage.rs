//! One camera's pictures and background.

use std::path::{Path, PathBuf};

use super::FramePattern;

/// Most frames a take may have: hours at any rate.
pub const MAX_FRAMES: usize = 1_000_000;
/// Most pictures a background is made of.
pub const MAX_BACKGROUND_FRAMES: usize = 256;

/// Where one camera's pictures are.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CameraFootage {
    pub(super) camera: String,
    pub(super) folder: PathBuf,
    pub(super) frames: FramePattern,
    pub(super) first: u64,
    pub(super) background: Option<BackgroundSource>,
}

/// Where a camera's view without the subject is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum BackgroundSource {
    /// One picture.
    Plate(PathBuf),
    /// Several pictures, whose mean and deviation are the background.
    Frames(Vec<PathBuf>),
}

impl BackgroundSource {
    /// The files, at least one.
    #[must_use]
    pub fn paths(&self) -> &[PathBuf] {
        match self {
            Self::Plate(path) => std::slice::from_ref(path),
            Self::Frames(paths) => paths,
        }
    }
}

impl CameraFootage {
    /// The camera's name.
    #[must_use]
    pub fn camera(&self) -> &str {
        &self.camera
    }

    /// The file of a frame, counted from 0 at the take's start.
    #[must_use]
    pub fn path(&self, frame: usize) -> PathBuf {
        self.frames.path(&self.folder, self.first.saturating_add(frame as u64))
    }

    /// Where the background is, if the take has one for this camera.
    #[must_use]
    pub fn background(&self) -> Option<&BackgroundSource> {
        self.background.as_ref()
    }
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
