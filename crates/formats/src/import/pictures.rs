//! A camera's footage, whatever it lies in.

use std::path::PathBuf;
use std::sync::Arc;

use image::RgbImage;

use crate::take::{FramePattern, PatternError};
use crate::video::Video;
use crate::{FileError, images};

/// Where a camera's pictures are.
#[derive(Debug, Clone)]
pub enum Pictures {
    /// A video.
    Video(Video),
    /// Numbered pictures.
    Numbered {
        /// Their folder.
        folder: PathBuf,
        /// The file's name with `%03d` in the place of its number.
        pattern: String,
        /// The first number.
        first: u64,
        /// How many there are.
        count: usize,
    },
}

impl Pictures {
    /// How many there are.
    #[must_use]
    pub fn count(&self) -> usize {
        match self {
            Self::Video(video) => video.frame_count(),
            Self::Numbered { count, .. } => *count,
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
            Self::Numbered { .. } => self.numbered(index).unwrap_or_default(),
        }
    }

    fn numbered(&self, index: usize) -> Result<PathBuf, PatternError> {
        match self {
            Self::Video(_) => Err(PatternError::NoNumber),
            Self::Numbered { folder, pattern, first, .. } => {
                Ok(FramePattern::new(pattern)?.path(folder, first.saturating_add(index as u64)))
            }
        }
    }

    /// One of them, counted from 0.
    ///
    /// # Errors
    /// It cannot be read or decoded.
    pub fn picture(&self, index: usize) -> Result<RgbImage, FileError> {
        self.reduced(index, 1)
    }

    /// The same, [reduced](images::reduced).
    ///
    /// # Errors
    /// As [`picture`](Self::picture).
    pub fn reduced(&self, index: usize, divisor: usize) -> Result<RgbImage, FileError> {
        match self {
            Self::Video(video) => video.frame_reduced(index, divisor).map(Arc::unwrap_or_clone),
            Self::Numbered { folder, .. } => match self.numbered(index) {
                Ok(path) => Ok(images::reduced(images::read(&path)?, divisor)),
                Err(_) => Err(FileError::new(folder, crate::FileProblem::Missing)),
            },
        }
    }
}
