//! A parsed take; its pictures are read on demand.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use backlit_tracking::body::{Model, Pose};
use backlit_tracking::camera::{Camera, Rig};
use backlit_tracking::segment::SegmentOptions;
use image::RgbImage;

use super::known::Known;
use super::reader::Reader;
use super::reference::ReferenceOptions;
use super::spec::{BodySizes, FORMAT, TakeSpec};
use super::{BackgroundSource, CameraFootage, Reference, TakeError};
use crate::images::{self, MAX_PICTURE_BYTES};
use crate::pose_file::{self, Quaternions};
use crate::text::decode;
use crate::trc::Axes;
use crate::video::{FrameCache, Video};
use crate::{DiskFiles, FileError, FileProblem, MAX_TEXT_BYTES, TakeFiles, model_file, toml_text};

/// The take file in a take's folder.
pub const FILE_NAME: &str = "take.toml";
/// Largest take file that is read, bytes.
const MAX_BYTES: u64 = 1 << 20;
/// Frame rates above this are a mistake, frames per second.
const MAX_FRAME_RATE: f64 = 100_000.0;

/// A recording with everything that belongs to it.
///
/// Guaranteed: at least one camera and one frame; every camera has all frames (the files were there when the take
/// was opened) and its first one is of the camera's size; start pose and reference fit the model.
#[derive(Debug, Clone)]
pub struct Take {
    files: Arc<dyn TakeFiles>,
    path: PathBuf,
    name: String,
    frame_rate: f64,
    model: Arc<Model>,
    sizes: BodySizes,
    /// For pictures as they are on the disk.
    full_rig: Rig,
    /// For pictures that are reduced.
    rig: Rig,
    reduction: u32,
    footage: Vec<CameraFootage>,
    frame_count: usize,
    start: Option<Pose>,
    reference: Option<Reference>,
    measurement: Vec<SegmentOptions>,
    seconds: Arc<[f64]>,
    notes: Arc<[String]>,
    cache: Arc<FrameCache>,
}

/// The take file of a folder, or the file itself.
fn file_of(path: &Path) -> PathBuf {
    if path.is_dir() { path.join(FILE_NAME) } else { path.to_owned() }
}

impl Take {
    /// Opens a take of the disk: its folder or its take file.
    ///
    /// # Errors
    /// A file is missing or wrong; the error names it, and the camera and frame where it is a picture.
    pub fn open(path: &Path) -> Result<Self, TakeError> {
        Self::read(Arc::new(DiskFiles), &file_of(path), None)
    }

    /// The same with another body in place of the one that the take names: start pose and reference name its limbs.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub fn open_with_model(path: &Path, model: Model) -> Result<Self, TakeError> {
        Self::read(Arc::new(DiskFiles), &file_of(path), Some(model))
    }

    /// Opens a take whose files come from anywhere.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub fn from_files(files: Arc<dyn TakeFiles>, path: &Path) -> Result<Self, TakeError> {
        Self::read(files, path, None)
    }

    fn read(files: Arc<dyn TakeFiles>, path: &Path, model: Option<Model>) -> Result<Self, TakeError> {
        let bytes = files.read(path, MAX_BYTES)?;
        let text = decode(path, &bytes)?;
        let spec: TakeSpec = toml_text::parse_versioned(path, text, FORMAT)?;
        let reader = Reader::new(files.as_ref(), path, text, &spec)?;
        let frame_rate = *spec.frame_rate.get_ref();
        if !(frame_rate > 0.0 && frame_rate <= MAX_FRAME_RATE) {
            let expected = format!("frames per second, above 0 and at most {MAX_FRAME_RATE}");
            return Err(reader.field(&spec.frame_rate, "frame_rate", expected).into());
        }
        let model = match model {
            Some(model) => model,
            None => {
                model_file::resolve_in(reader.files, &reader.folder, &reader.expand(&spec.model, "model")?)?
            }
        };
        let start = match &spec.start {
            Some(start) => {
                let path = reader.folder.join(reader.expand(start, "start")?);
                let bytes = reader.files.read(&path, MAX_TEXT_BYTES)?;
                Some(pose_file::parse(&path, &bytes, &model, Quaternions::Normalised)?)
            }
            None => None,
        };
        let full_rig = reader.rig(&spec)?;
        let reduction = reader.reduction(&spec)?;
        let rig = reduced_rig(&full_rig, reduction).map_err(|problem| FileError::new(path, problem))?;
        let cache = Arc::default();
        let films = reader.footage(&spec, &cache)?;
        let reference = match &spec.reference {
            Some(reference) => Some(reader.reference(reference, &model, &films, &spec)?),
            None => None,
        };
        let measurement = reader.measurement(&spec)?;
        let (name, sizes, model) = (spec.name, spec.sizes, Arc::new(model));
        let path = path.to_owned();
        let take = Self {
            files,
            path,
            name,
            frame_rate,
            model,
            sizes,
            full_rig,
            rig,
            reduction,
            seconds: films.seconds(frame_rate).into(),
            notes: films.notes.into(),
            footage: films.cameras,
            frame_count: films.frame_count,
            start,
            reference,
            measurement,
            cache,
        };
        for camera in 0..take.rig.count() {
            take.check_first_picture(camera)?;
        }
        Ok(take)
    }

    /// The take file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What the take is called.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Frames per second.
    #[must_use]
    pub fn frame_rate(&self) -> f64 {
        self.frame_rate
    }

    /// The body.
    #[must_use]
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }

    /// What is known of the body's sizes.
    #[must_use]
    pub fn sizes(&self) -> BodySizes {
        self.sizes
    }

    /// By how much pictures are reduced before anything is done with them; 1 for pictures as they are.
    #[must_use]
    pub fn reduction(&self) -> u32 {
        self.reduction
    }

    /// The cameras for pictures as they are on the disk, in the order of the take file.
    #[must_use]
    pub fn full_rig(&self) -> &Rig {
        &self.full_rig
    }

    /// The cameras for the [reduced](Self::reduction) pictures, in the order of the take file.
    #[must_use]
    pub fn rig(&self) -> &Rig {
        &self.rig
    }

    /// Where each camera's pictures are, in the rig's order.
    #[must_use]
    pub fn footage(&self) -> &[CameraFootage] {
        &self.footage
    }

    /// Number of frames, at least one.
    #[must_use]
    pub fn frame_count(&self) -> usize {
        self.frame_count
    }

    /// The pose to start from, if the take has one.
    #[must_use]
    pub fn start(&self) -> Option<&Pose> {
        self.start.as_ref()
    }

    /// Keypoints to compare with, if the take has any.
    #[must_use]
    pub fn reference(&self) -> Option<&Reference> {
        self.reference.as_ref()
    }

    /// How each camera's frames are segmented, in the rig's order.
    #[must_use]
    pub fn measurement(&self) -> &[SegmentOptions] {
        &self.measurement
    }

    /// When each frame was taken, seconds from frame 0 on: by the first camera that is a video, else by the frame rate.
    #[must_use]
    pub fn seconds(&self) -> &[f64] {
        &self.seconds
    }

    /// What is missing in the footage, or does not fit together, in words: videos that are cut or damaged, of different
    /// lengths or rates. Damage within a video is known only once its frames were asked for.
    #[must_use]
    pub fn notes(&self) -> Vec<String> {
        let of_videos = self.footage.iter().flat_map(|footage| {
            let notes = footage.video().map(Video::notes).unwrap_or_default();
            notes.into_iter().map(|note| format!("camera \"{}\": {note}", footage.camera))
        });
        of_videos.chain(self.notes.iter().cloned()).collect()
    }

    /// What keeps the videos' decoded frames, for all of them together; its limit may be set at any time.
    #[must_use]
    pub fn frame_cache(&self) -> &FrameCache {
        &self.cache
    }

    /// A camera's picture of a frame (counted from 0), [reduced](Self::reduction) and not rectified.
    ///
    /// # Errors
    /// As [`full_frame`](Self::full_frame).
    pub fn frame(&self, camera: usize, frame: usize) -> Result<RgbImage, TakeError> {
        self.frame_reduced(camera, frame, self.reduction as usize)
    }

    /// A camera's picture of a frame (counted from 0), as it is on the disk: not reduced and not rectified.
    ///
    /// # Errors
    /// No such camera or frame, no file, not a whole picture, or not of the camera's size.
    pub fn full_frame(&self, camera: usize, frame: usize) -> Result<RgbImage, TakeError> {
        self.frame_reduced(camera, frame, 1)
    }

    /// The same at a part of its size: each square of `divisor`² pixels is averaged to one. Columns at the right and
    /// rows at the bottom that fill no square are left out.
    ///
    /// # Errors
    /// As [`full_frame`](Self::full_frame).
    pub fn frame_reduced(&self, camera: usize, frame: usize, divisor: usize) -> Result<RgbImage, TakeError> {
        let footage = self.footage_of(camera)?;
        if frame >= self.frame_count {
            return Err(TakeError::NoFrame { frame, count: self.frame_count });
        }
        let picture = match footage.video() {
            Some(video) => self.video_frame(camera, video, footage.number(frame) as usize, divisor),
            None => {
                self.picture(camera, &footage.path(frame)).map(|picture| images::reduced(picture, divisor))
            }
        };
        picture.map_err(|error| TakeError::Frame { camera: footage.camera.clone(), frame, error })
    }

    /// The same take seen by other cameras: as many, for pictures of the same sizes as those on the disk, in the same order. `None` if they
    /// are not.
    #[must_use]
    pub fn with_rig(&self, rig: Rig) -> Option<Self> {
        let sizes = |rig: &Rig| -> Vec<[usize; 2]> {
            rig.cameras().iter().map(|camera| [camera.width(), camera.height()]).collect()
        };
        if sizes(&rig) == sizes(&self.full_rig) {
            let reduced = reduced_rig(&rig, self.reduction).ok()?;
            return Some(Self { rig: reduced, full_rig: rig, ..self.clone() });
        }
        None
    }

    /// The same take with other keypoints to compare with: a TRC, or a table whose markers have joints' names. Where no `axes`
    /// are given, those are taken that put most markers into the cameras' pictures: the file's own, or those of a file for
    /// `OpenSim`, Y up. The first row belongs to the first frame unless `first_frame` gives its number.
    ///
    /// # Errors
    /// No such file, or not a table of keypoints of this body.
    pub fn with_reference(
        &self,
        path: &Path,
        axes: Option<Axes>,
        first_frame: Option<u64>,
    ) -> Result<Self, FileError> {
        let bytes = self.files.read(path, MAX_TEXT_BYTES)?;
        let read = |axes: Axes| {
            let first_frame = match first_frame {
                Some(first) => first,
                None => Reference::first_frame(path, &bytes)?,
            };
            let (frame_count, markers) = (self.frame_count, None);
            let options = ReferenceOptions { markers, first_frame, frame_count, metres_per_unit: 1.0, axes };
            Reference::parse(path, &bytes, &self.model, &options)
        };
        let reference = match axes {
            Some(axes) => read(axes)?,
            None => {
                let (own, y_up) = (read(Axes::default())?, read(Axes::Y_UP)?);
                if y_up.count_seen(&self.rig) > own.count_seen(&self.rig) { y_up } else { own }
            }
        };
        Ok(Self { reference: Some(reference), ..self.clone() })
    }

    /// The same take with other plates, by the cameras' indices.
    #[must_use]
    pub fn with_plates(&self, plates: impl IntoIterator<Item = (usize, PathBuf)>) -> Self {
        let mut take = self.clone();
        for (camera, path) in plates {
            if let Some(footage) = take.footage.get_mut(camera) {
                footage.background = Some(BackgroundSource::Plate(path));
            }
        }
        take
    }

    /// A camera's pictures without the subject: one plate or several frames, none if the take has none. Reduced and
    /// not rectified.
    ///
    /// # Errors
    /// No such camera, no file, not a whole picture, or not of the camera's size.
    pub fn background(&self, camera: usize) -> Result<Vec<RgbImage>, TakeError> {
        let footage = self.footage_of(camera)?;
        let divisor = self.reduction as usize;
        let pictures: Result<Vec<RgbImage>, FileError> = match &footage.background {
            None => return Ok(Vec::new()),
            Some(BackgroundSource::Video { video, frames }) => {
                frames.iter().map(|&frame| self.video_frame(camera, video, frame, divisor)).collect()
            }
            Some(pictures) => pictures.paths().into_iter().map(|path| self.plate(camera, path)).collect(),
        };
        pictures.map_err(|error| TakeError::Background { camera: footage.camera.clone(), error })
    }

    /// What a camera's reduced plate knows of each pixel, row by row. `None` where it knows all.
    ///
    /// # Errors
    /// As [`background`](Self::background).
    pub fn plate_knowledge(&self, camera: usize) -> Result<Option<Vec<Known>>, TakeError> {
        let footage = self.footage_of(camera)?;
        let Some(BackgroundSource::Plate(path)) = &footage.background else { return Ok(None) };
        let alpha = self.files.read(path, MAX_PICTURE_BYTES).and_then(|bytes| images::alpha(path, &bytes));
        let alpha = alpha.map_err(|error| TakeError::Background { camera: footage.camera.clone(), error })?;
        let Some(alpha) = alpha.filter(|alpha| alpha.iter().any(|&alpha| alpha < Known::OPAQUE)) else {
            return Ok(None);
        };
        let (full, small) = (&self.full_rig.cameras()[camera], &self.rig.cameras()[camera]);
        if alpha.len() == small.width() * small.height() {
            return Ok(Some(alpha.into_iter().map(Known::of_alpha).collect()));
        }
        // Of the pixels that are averaged to one, the least known counts.
        let (side, width) = (self.reduction as usize, small.width());
        let mut out = vec![Known::Scene; width * small.height()];
        for (index, &alpha) in alpha.iter().enumerate() {
            let (x, y) = (index % full.width() / side, index / full.width() / side);
            if x < width && y < small.height() {
                let worst = &mut out[y * width + x];
                *worst = (*worst).min(Known::of_alpha(alpha));
            }
        }
        Ok(Some(out))
    }

    fn footage_of(&self, camera: usize) -> Result<&CameraFootage, TakeError> {
        self.footage.get(camera).ok_or(TakeError::NoCamera { camera, count: self.footage.len() })
    }

    fn picture(&self, camera: usize, path: &Path) -> Result<RgbImage, FileError> {
        let bytes = self.files.read(path, MAX_PICTURE_BYTES)?;
        // The size first: a wrong picture need not be decoded.
        check_size(path, images::size(path, &bytes)?, &self.full_rig.cameras()[camera])?;
        images::decode(path, &bytes)
    }

    /// A picture of a background, of the full size or of the reduced one already, reduced.
    fn plate(&self, camera: usize, path: &Path) -> Result<RgbImage, FileError> {
        let bytes = self.files.read(path, MAX_PICTURE_BYTES)?;
        let found = images::size(path, &bytes)?;
        if check_size(path, found, &self.rig.cameras()[camera]).is_ok() {
            return images::decode(path, &bytes);
        }
        check_size(path, found, &self.full_rig.cameras()[camera])?;
        Ok(images::reduced(images::decode(path, &bytes)?, self.reduction as usize))
    }

    fn video_frame(
        &self,
        camera: usize,
        video: &Video,
        frame: usize,
        divisor: usize,
    ) -> Result<RgbImage, FileError> {
        check_size(video.path(), video.size(), &self.full_rig.cameras()[camera])?;
        video.frame_reduced(frame, divisor).map(Arc::unwrap_or_clone)
    }

    fn check_first_picture(&self, camera: usize) -> Result<(), TakeError> {
        let path = self.footage[camera].path(0);
        let check = || {
            if let Some(video) = self.footage[camera].video() {
                return check_size(&path, video.size(), &self.full_rig.cameras()[camera]);
            }
            let bytes = self.files.read(&path, MAX_PICTURE_BYTES)?;
            check_size(&path, images::size(&path, &bytes)?, &self.full_rig.cameras()[camera])
        };
        let name = || self.footage[camera].camera.clone();
        check().map_err(|error| TakeError::Frame { camera: name(), frame: 0, error })
    }
}

/// The cameras of pictures that are reduced.
fn reduced_rig(rig: &Rig, reduction: u32) -> Result<Rig, FileProblem> {
    let reduced = |camera: &Camera| {
        camera
            .reduced(reduction)
            .map_err(|error| FileProblem::Camera { camera: camera.name().to_owned(), error })
    };
    let cameras = rig.cameras().iter().map(reduced).collect::<Result<_, _>>()?;
    Rig::new(cameras).map_err(|error| FileProblem::Rig { error })
}

fn check_size(path: &Path, found: [usize; 2], camera: &Camera) -> Result<(), FileError> {
    let expected = [camera.width(), camera.height()];
    if found == expected {
        return Ok(());
    }
    Err(FileError::new(path, FileProblem::PictureSize { found, expected }))
}
