//! A parsed take; its pictures are read on demand.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use backlit_tracking::body::{Model, Pose};
use backlit_tracking::camera::{Camera, Rig};
use backlit_tracking::metrics::MarkerPlacement;
use backlit_tracking::names;
use backlit_tracking::people::FollowedPerson;
use backlit_tracking::segment::SegmentOptions;

use super::reader::TakeReader;
use super::reference::ReferenceOptions;
use super::spec::{BodySizes, FORMAT, TakeSpec};
use super::{CameraFootage, Outside, Reference, TakeError};
use crate::keypoints::joints::KeypointOrder;
use crate::pose_file::{self, Quaternions};
use crate::text::decode;
use crate::trc::Axes;
use crate::video::{FrameCache, Video};
use crate::{
    DiskFiles, FileError, FileProblem, MAX_TEXT_BYTES, Result, TakeFiles, memory, model_file, toml_text,
};

/// The take file in a take's folder.
pub const FILE_NAME: &str = "take.toml";
/// Largest take file that is read, bytes.
pub(super) const MAX_BYTES: u64 = 1 << 20;
/// Frame rates above this are a mistake, frames per second.
const MAX_FRAME_RATE: f64 = 100_000.0;

/// A recording with everything that belongs to it.
///
/// Guaranteed: at least one camera and one frame; every camera has all frames (the files were there when the take
/// was opened) and its first one is of the camera's size; start pose and reference fit the model.
#[derive(Debug, Clone)]
pub struct Take {
    pub(super) files: Arc<dyn TakeFiles>,
    pub(super) path: PathBuf,
    pub(super) name: String,
    pub(super) frame_rate: f64,
    pub(super) model: Arc<Model>,
    pub(super) sizes: BodySizes,
    /// For pictures as they are on the disk.
    pub(super) full_rig: Rig,
    /// For pictures that are reduced.
    pub(super) rig: Rig,
    pub(super) reduction: u32,
    pub(super) footage: Vec<CameraFootage>,
    pub(super) frame_count: usize,
    pub(super) start: Option<Pose>,
    poses: Arc<BTreeMap<usize, Pose>>,
    pub(super) reference: Option<Reference>,
    pub(super) measurement: Vec<SegmentOptions>,
    /// One of several people.
    pub(super) person: Option<Arc<FollowedPerson>>,
    pub(super) seconds: Arc<[f64]>,
    pub(super) notes: Arc<[String]>,
    outside: Option<Outside>,
    cache: Arc<FrameCache>,
    /// Found once keypoints are first needed.
    pub(super) keypoint_order: Arc<OnceLock<Option<KeypointOrder>>>,
}

/// The take file of a folder, or the file itself.
pub(super) fn file_of(path: &Path) -> PathBuf {
    if path.is_dir() { path.join(FILE_NAME) } else { path.to_owned() }
}

impl Take {
    /// Opens a take of the disk: its folder or its take file.
    pub fn open(path: &Path) -> Result<Self, TakeError> {
        Self::read(Arc::new(DiskFiles), &file_of(path), None)
    }

    /// The same with another body in place of the one that the take names: start pose and reference name its limbs.
    pub fn open_with_model(path: &Path, model: Model) -> Result<Self, TakeError> {
        Self::read(Arc::new(DiskFiles), &file_of(path), Some(model))
    }

    /// Opens a take whose files come from anywhere.
    pub fn from_files(files: Arc<dyn TakeFiles>, path: &Path) -> Result<Self, TakeError> {
        Self::read(files, path, None)
    }

    /// The same with another body in place of the take's.
    pub fn from_files_with_model(
        files: Arc<dyn TakeFiles>,
        path: &Path,
        model: Model,
    ) -> Result<Self, TakeError> {
        Self::read(files, path, Some(model))
    }

    fn read(files: Arc<dyn TakeFiles>, path: &Path, model: Option<Model>) -> Result<Self, TakeError> {
        let bytes = files.read(path, MAX_BYTES)?;
        let text = decode(path, &bytes)?;
        let spec: TakeSpec = toml_text::parse_versioned(path, text, FORMAT)?;
        let reader = TakeReader::new(files.as_ref(), path, text, &spec)?;
        let name = spec.name.get_ref();
        if !name.is_empty() && !names::is_name(name) {
            return Err(reader.field(&spec.name, "name", names::EXPECTED.to_owned()).into());
        }
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
        memory::afford_take(path, &full_rig, &rig)?;
        let cache = Arc::default();
        let films = reader.footage(&spec, &cache)?;
        let reference = match &spec.reference {
            Some(reference) => Some(reader.reference(reference, &model, &films, &spec)?),
            None => None,
        };
        let measurement = reader.measurement(&spec)?;
        let outside = reader.outside(&spec)?;
        let (name, sizes, model) = (spec.name.into_inner(), spec.sizes, Arc::new(model));
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
            outside,
            footage: films.cameras,
            frame_count: films.frame_count,
            start,
            poses: Arc::default(),
            reference,
            measurement,
            person: None,
            cache,
            keypoint_order: Arc::default(),
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

    /// Poses of frames that came with the take: those of a motion or a simulation.
    #[must_use]
    pub const fn poses(&self) -> &Arc<BTreeMap<usize, Pose>> {
        &self.poses
    }

    /// The same take with these poses.
    #[must_use]
    pub fn with_poses(self, poses: Arc<BTreeMap<usize, Pose>>) -> Self {
        Self { poses, ..self }
    }

    /// The same take that begins with this pose.
    #[must_use]
    pub fn with_start(self, start: Pose) -> Self {
        Self { start: Some(start), ..self }
    }

    /// The same take with a body of the same limbs in other sizes; `None` for other limbs, which start and reference do not name.
    #[must_use]
    pub fn with_body(&self, model: Arc<Model>) -> Option<Self> {
        let names = |model: &Model| model.limbs().iter().map(|limb| limb.name.clone()).collect::<Vec<_>>();
        (names(&model) == names(&self.model)).then(|| Self { model, ..self.clone() })
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

    /// Who is followed of several people; `None` where everybody in view is the subject.
    #[must_use]
    pub fn person(&self) -> Option<&Arc<FollowedPerson>> {
        self.person.as_ref()
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

    /// What the take reads outside its own folder, if it does.
    #[must_use]
    pub fn outside(&self) -> Option<&Outside> {
        self.outside.as_ref()
    }

    /// What keeps the videos' decoded frames, for all of them together; its limit may be set at any time.
    #[must_use]
    pub fn frame_cache(&self) -> &FrameCache {
        &self.cache
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

    /// The same take segmented by other options, made of each camera's own and of whether its background is one plate.
    #[must_use]
    pub fn with_measurement(&self, other: impl Fn(&SegmentOptions, bool) -> SegmentOptions) -> Self {
        let is_plate =
            |footage: &CameraFootage| footage.background().is_some_and(|background| background.count() == 1);
        let cameras = self.measurement.iter().zip(&self.footage);
        let measurement = cameras.map(|(own, footage)| other(own, is_plate(footage))).collect();
        Self { measurement, ..self.clone() }
    }

    /// The same take segmented by these options, one a camera; those of cameras that none are for stay.
    #[must_use]
    pub fn measured_by(&self, options: Vec<SegmentOptions>) -> Self {
        let left = self.measurement.iter().skip(options.len()).cloned();
        let measurement = options.into_iter().chain(left).take(self.measurement.len()).collect();
        Self { measurement, ..self.clone() }
    }

    /// The same take of one of several people: pixels of others are unknown, and their keypoints do not count.
    #[must_use]
    pub fn with_person(&self, person: Option<Arc<FollowedPerson>>) -> Self {
        Self { person, ..self.clone() }
    }

    /// The same take whose keypoints are of a tool that puts its markers there; as it is where it has no keypoints.
    #[must_use]
    pub fn with_placement(&self, placement: MarkerPlacement) -> Self {
        let reference = self.reference.clone().map(|reference| reference.with_placement(placement));
        Self { reference, ..self.clone() }
    }

    /// The same take with other keypoints to compare with: a TRC, or a table whose markers have joints' names. Where no `axes`
    /// are given, those are taken that put most markers into the cameras' pictures: the file's own, or those of a file for
    /// `OpenSim`, Y up. The first row belongs to the first frame unless `first_frame` gives its number.
    pub fn with_reference(&self, path: &Path, axes: Option<Axes>, first_frame: Option<u64>) -> Result<Self> {
        let bytes = self.files.read(path, MAX_TEXT_BYTES)?;
        let read = |axes: Axes| {
            let first_frame = match first_frame {
                Some(first) => first,
                None => Reference::first_frame(path, &bytes)?,
            };
            let (model, frame_count, markers) = (&*self.model, self.frame_count, None);
            let options =
                ReferenceOptions { model, markers, first_frame, frame_count, metres_per_unit: 1.0, axes };
            Reference::parse(path, &bytes, &options)
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
