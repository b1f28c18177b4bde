//! One camera's masks that were made elsewhere: where they are, and what their numbers mean.

use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

use toml::Spanned;

use super::footage::FrameSource;
use super::pictures::{SizeCheck, sized};
use super::reader::TakeReader;
use super::spec::ViewSpec;
use super::{CameraFootage, FramePattern, TakeError};
use crate::masks::{MaskValues, Numbers};
use crate::video::VideoProblem;
use crate::{FileError, FileProblem, Result, TakeFiles};

/// Where one camera's masks are.
#[derive(Debug, Clone)]
pub(super) struct CameraMasks {
    pub(super) source: FrameSource,
    /// A frame of the camera's own number, and the number of its mask.
    first: [u64; 2],
    /// What the take says.
    pub(super) given: Option<MaskValues>,
    /// What that means for these masks, once it is known. Shared by clones of a take.
    pub(super) told: Arc<OnceLock<MaskValues>>,
    /// There is no footage beside them.
    pub(super) is_alone: bool,
}

/// Opens the video or the numbered pictures that a field of a take file names.
type OpenFrames<'a> = dyn Fn(&Spanned<String>, &str) -> Result<FrameSource> + 'a;

impl CameraMasks {
    /// The number of the mask that belongs to a frame of the camera's own number.
    fn number(&self, frame: u64) -> u64 {
        frame.saturating_sub(self.first[0]).saturating_add(self.first[1])
    }

    pub(super) fn path(&self, frame: u64) -> PathBuf {
        self.source.path(self.number(frame))
    }

    /// The mask of a frame of the camera's own number; its size is checked before it is decoded.
    pub(super) fn read(&self, files: &dyn TakeFiles, frame: u64, check: &SizeCheck<'_>) -> Result<Numbers> {
        match &self.source {
            FrameSource::Video(video) => {
                check(video.path(), video.size())?;
                Ok(Numbers::of_picture(&*video.frame(self.number(frame) as usize)?))
            }
            FrameSource::Pictures { .. } => {
                let path = self.path(frame);
                Numbers::decode(&path, &sized(files, &path, check)?)
            }
        }
    }

    /// Only checks the size of that mask.
    pub(super) fn check_size(&self, files: &dyn TakeFiles, frame: u64, check: &SizeCheck<'_>) -> Result<()> {
        match &self.source {
            FrameSource::Video(video) => check(video.path(), video.size()),
            FrameSource::Pictures { .. } => sized(files, &self.path(frame), check).map(drop),
        }
    }

    /// Whether the mask of a frame of the camera's own number is there.
    fn check_there(&self, files: &dyn TakeFiles, frame: u64) -> Result<()> {
        let path = self.path(frame);
        let problem = match &self.source {
            FrameSource::Pictures { .. } if files.exists(&path) => return Ok(()),
            FrameSource::Pictures { .. } => FileProblem::Missing,
            FrameSource::Video(video) => {
                let (frame, count) = (self.number(frame) as usize, video.frame_count());
                if frame < count {
                    return Ok(());
                }
                FileProblem::Video { error: VideoProblem::NoFrame { frame, count } }
            }
        };
        Err(FileError::new(&path, problem))
    }
}

impl CameraFootage {
    /// Whether the camera has masks that were made elsewhere: then its silhouettes are not segmented.
    #[must_use]
    pub fn has_masks(&self) -> bool {
        self.masks.is_some()
    }

    /// Whether it has nothing but those masks: its pictures are the masks, drawn.
    #[must_use]
    pub fn is_masks_alone(&self) -> bool {
        self.masks.as_ref().is_some_and(|masks| masks.is_alone)
    }

    /// The file of a frame's mask, counted from 0 at the take's start, if there are masks. Of a video it is the same for all.
    #[must_use]
    pub fn mask_path(&self, frame: usize) -> Option<PathBuf> {
        Some(self.masks.as_ref()?.path(self.number(frame)))
    }

    /// Looks whether all frames of the take have their masks.
    pub(super) fn check_masks(&self, files: &dyn TakeFiles, frame_count: usize) -> Result<(), TakeError> {
        let Some(masks) = self.masks.as_ref().filter(|masks| !masks.is_alone) else { return Ok(()) };
        (0..frame_count).try_for_each(|frame| {
            masks.check_there(files, self.number(frame)).map_err(|error| self.mask_error(frame, error))
        })
    }

    pub(super) fn mask_error(&self, frame: usize, error: FileError) -> TakeError {
        TakeError::Mask { camera: self.camera.clone(), frame, error }
    }
}

impl TakeReader<'_> {
    /// The masks that a take file names for a camera.
    pub(super) fn masks(
        &self,
        view: &ViewSpec,
        open: &OpenFrames<'_>,
    ) -> Result<Option<CameraMasks>, TakeError> {
        let Some(masks) = &view.masks else {
            if let Some(first) = &view.masks_first {
                return Err(self.field(first, "masks_first", "`masks` beside it".to_owned()).into());
            }
            if let Some(values) = &view.mask_values {
                return Err(self.mask_values(values, "`masks` beside it").into());
            }
            return Ok(None);
        };
        let is_alone = view.frames.is_none();
        let first = match &view.masks_first {
            Some(first) if is_alone => {
                let expected = "`first`, where there are no `frames` beside the masks".to_owned();
                return Err(self.field(first, "masks_first", expected).into());
            }
            Some(first) => *first.get_ref(),
            None => view.first,
        };
        let given = match &view.mask_values {
            None => None,
            Some(values) => MaskValues::parse(values.get_ref())
                .ok_or_else(|| self.mask_values(values, MaskValues::EXPECTED))?,
        };
        let camera = view.name.get_ref();
        let failed = |error: FileError| match error.path == self.path {
            true => TakeError::File(error),
            false => TakeError::Mask { camera: camera.clone(), frame: 0, error },
        };
        let source = open(masks, "camera.masks").map_err(failed)?;
        Ok(Some(CameraMasks { source, first: [view.first, first], given, told: Arc::default(), is_alone }))
    }

    fn mask_values(&self, values: &Spanned<toml::Value>, expected: &str) -> FileError {
        let problem = FileProblem::field("mask_values", values.get_ref().to_string(), expected);
        self.problem(values.span(), problem)
    }
}

impl FrameSource {
    /// The file with this number.
    pub(super) fn path(&self, number: u64) -> PathBuf {
        match self {
            Self::Pictures { folder, pattern } => FramePattern::path(pattern, folder, number),
            Self::Video(video) => video.path().to_owned(),
        }
    }
}
