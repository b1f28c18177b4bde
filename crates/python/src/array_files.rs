//! Arrays as the files of a take: its take file, cameras, body, a PNG each mask and a JSON each frame's keypoints, made when they
//! are read. Whatever reads a take reads arrays so, and finds the same in them as in files.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::Context;
use backlit_cli::output::{check_file_stem, make_folder};
use backlit_formats::calibration::backlit;
use backlit_formats::keypoints::{self, Keypoint, Person};
use backlit_formats::{FileError, FileProblem, TakeFiles, atomic, model_file, pose_file};
use backlit_tracking::body::{Model, Pose, builtin};
use backlit_tracking::camera::Rig;
use glam::DVec2;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use serde_json::json;

use crate::arrays::CameraMasks;

/// The folder that they seem to lie in.
const FOLDER: &str = "arrays";
/// The take file.
const TAKE: &str = "take.toml";
const CAMERAS: &str = "cameras.json";
const BODY: &str = "body.toml";
const START: &str = "start.json";
const MASKS: &str = "masks";
const KEYPOINTS: &str = "keypoints";

/// What a take of arrays is made of.
#[derive(Debug)]
pub(crate) struct ArrayFiles {
    /// The cameras, for pictures of the size of the masks.
    pub(crate) rig: Rig,
    /// The masks of each.
    pub(crate) masks: Vec<CameraMasks>,
    /// What their numbers mean, as a take file says it: `"auto"`.
    pub(crate) mask_values: String,
    /// The keypoints of each camera, if there are any.
    pub(crate) keypoints: Option<Vec<CameraKeypoints>>,
    /// The body.
    pub(crate) body: Arc<Model>,
    /// Where the first frame begins, if that is known.
    pub(crate) start: Option<Pose>,
    /// What the take is called.
    pub(crate) name: String,
    /// Frames a second.
    pub(crate) frame_rate: f64,
    /// Whether the person's own sizes are to be found.
    pub(crate) fits_sizes: bool,
}

/// Keypoints of one camera: x, y and score of each, frame after frame.
#[derive(Debug)]
pub(crate) struct CameraKeypoints {
    /// Keypoints of a frame.
    pub(crate) count: usize,
    /// Three numbers each; not finite where one was not found.
    pub(crate) numbers: Vec<f64>,
}

impl CameraKeypoints {
    fn frame(&self, frame: usize) -> Option<String> {
        let length = 3 * self.count;
        let numbers = self.numbers.get(frame * length..(frame + 1) * length)?;
        let keypoint = |&[x, y, score]: &[f64; 3]| {
            let is_found = x.is_finite() && y.is_finite() && score.is_finite();
            is_found.then_some(Keypoint { place: DVec2::new(x, y), score })
        };
        let person: Person = numbers.as_chunks().0.iter().map(keypoint).collect();
        let people = if person.iter().any(Option::is_some) { vec![person] } else { Vec::new() };
        Some(keypoints::to_text(&people))
    }
}

/// One of the files.
#[derive(Debug, Clone, Copy)]
enum Content {
    Take,
    Cameras,
    Body,
    Start,
    Mask { camera: usize, frame: usize },
    Keypoints { camera: usize, frame: usize },
}

impl ArrayFiles {
    /// The path of the take file.
    pub(crate) fn take_path() -> PathBuf {
        Path::new(FOLDER).join(TAKE)
    }

    /// Number of frames.
    pub(crate) fn frame_count(&self) -> usize {
        self.masks.first().map_or(0, |masks| masks.shape[0])
    }

    /// Writes them as a take into a folder; the take file last.
    pub(crate) fn write(
        &self,
        folder: &Path,
        mut is_cancelled: impl FnMut(usize) -> bool,
    ) -> anyhow::Result<()> {
        make_folder(folder)?;
        for camera in self.rig.cameras() {
            check_file_stem(camera.name())?;
        }
        for frame in 0..self.frame_count() {
            for camera in 0..self.rig.count() {
                self.write_one(folder, Content::Mask { camera, frame })?;
                if self.keypoints.is_some() {
                    self.write_one(folder, Content::Keypoints { camera, frame })?;
                }
            }
            if is_cancelled(frame) {
                return Ok(());
            }
        }
        self.write_one(folder, Content::Cameras)?;
        if self.built_in_body().is_none() {
            self.write_one(folder, Content::Body)?;
        }
        if self.start.is_some() {
            self.write_one(folder, Content::Start)?;
        }
        let bytes = self.bytes(Content::Take).context("the take file cannot be made")?;
        Ok(atomic::write(&folder.join(TAKE), &bytes)?)
    }

    fn write_one(&self, folder: &Path, content: Content) -> anyhow::Result<()> {
        let path = folder.join(self.path(content));
        let bytes =
            self.bytes(content).with_context(|| format!("{}: there is no such array", path.display()))?;
        path.parent().map_or(Ok(()), make_folder)?;
        fs::write(&path, bytes).with_context(|| format!("{}: cannot be written", path.display()))
    }

    /// Where one of the files lies in the take's folder.
    fn path(&self, content: Content) -> PathBuf {
        let of = |kind: &str, camera: usize, frame: usize, ending: &str| {
            Path::new(kind).join(self.folder_of(camera)).join(format!("{frame:06}.{ending}"))
        };
        match content {
            Content::Take => PathBuf::from(TAKE),
            Content::Cameras => PathBuf::from(CAMERAS),
            Content::Body => PathBuf::from(BODY),
            Content::Start => PathBuf::from(START),
            Content::Mask { camera, frame } => of(MASKS, camera, frame, "png"),
            Content::Keypoints { camera, frame } => of(KEYPOINTS, camera, frame, "json"),
        }
    }

    /// A camera's name where that is plain, else its number.
    fn folder_of(&self, camera: usize) -> String {
        let name = self.rig.cameras().get(camera).map_or("", |camera| camera.name());
        let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_".contains(c);
        if name.chars().all(is_plain) { name.to_owned() } else { format!("camera {}", camera + 1) }
    }

    /// The file of a path; `None` where there is none.
    fn content(&self, path: &Path) -> Option<Content> {
        let inside = path.strip_prefix(FOLDER).ok()?;
        let parts: Vec<&str> = inside.iter().map(|part| part.to_str().unwrap_or_default()).collect();
        match parts[..] {
            [TAKE] => Some(Content::Take),
            [CAMERAS] => Some(Content::Cameras),
            [BODY] => Some(Content::Body),
            [START] => self.start.as_ref().map(|_| Content::Start),
            [kind, camera, file] => {
                let camera = (0..self.rig.count()).find(|&index| self.folder_of(index) == camera)?;
                let (frame, ending) = file.split_once('.')?;
                let frame = frame.parse().ok().filter(|frame| *frame < self.frame_count())?;
                match (kind, ending) {
                    (MASKS, "png") => Some(Content::Mask { camera, frame }),
                    (KEYPOINTS, "json") if self.keypoints.is_some() => {
                        Some(Content::Keypoints { camera, frame })
                    }
                    _ => None,
                }
            }
            _ => None,
        }
    }

    fn bytes(&self, content: Content) -> Option<Vec<u8>> {
        match content {
            Content::Take => Some(self.take_text().into_bytes()),
            Content::Cameras => Some(backlit::to_text(&self.rig).into_bytes()),
            Content::Body => Some(model_file::to_text(&self.body).into_bytes()),
            Content::Start => Some(pose_file::to_text(&self.body, self.start.as_ref()?).into_bytes()),
            Content::Mask { camera, frame } => self.png(camera, frame),
            Content::Keypoints { camera, frame } => {
                Some(self.keypoints.as_ref()?.get(camera)?.frame(frame)?.into_bytes())
            }
        }
    }

    fn png(&self, camera: usize, frame: usize) -> Option<Vec<u8>> {
        let masks = self.masks.get(camera)?;
        let [_, height, width] = masks.shape.map(|side| side as u32);
        let mut bytes = Vec::new();
        let encoder = PngEncoder::new_with_quality(&mut bytes, CompressionType::Fast, FilterType::NoFilter);
        encoder.write_image(&masks.frame(frame)?, width, height, ExtendedColorType::L8).ok()?;
        Some(bytes)
    }

    /// The name of the body, if it is a built-in one.
    fn built_in_body(&self) -> Option<&'static str> {
        let bodies = [builtin::single_limb(), builtin::upper_body(), builtin::full_body()];
        builtin::NAMES.into_iter().zip(bodies).find(|(_, body)| *body == *self.body).map(|(name, _)| name)
    }

    /// What the numbers of a camera's masks mean: of True and False there is no question.
    fn values_of(&self, camera: usize) -> &str {
        let is_boolean = self.masks.get(camera).is_some_and(|masks| masks.is_boolean);
        if is_boolean { "\"nonzero\"" } else { &self.mask_values }
    }

    fn take_text(&self) -> String {
        let sizes = if self.fits_sizes { "fit" } else { "known" };
        let mut text = format!(
            "format = \"backlit-take 1\"\nname = {}\nframe_rate = {:?}\nmodel = {}\nsizes = \"{sizes}\"\n",
            json!(self.name),
            self.frame_rate,
            json!(self.built_in_body().unwrap_or(BODY)),
        );
        if self.start.is_some() {
            text += &format!("start = {}\n", json!(START));
        }
        text += &format!("\n[cameras]\ncalibration = {}\n", json!(CAMERAS));
        for (index, camera) in self.rig.cameras().iter().enumerate() {
            let folder = self.folder_of(index);
            text += &format!(
                "\n[[camera]]\nname = {}\nmasks = {}\nmask_values = {}\ncount = {}\n",
                json!(camera.name()),
                json!(format!("{MASKS}/{folder}/%06d.png")),
                self.values_of(index),
                self.frame_count(),
            );
            if self.keypoints.is_some() {
                text += &format!("keypoints = {}\n", json!(format!("{KEYPOINTS}/{folder}/%06d.json")));
            }
        }
        text
    }
}

impl TakeFiles for ArrayFiles {
    fn read(&self, path: &Path, _limit: u64) -> Result<Vec<u8>, FileError> {
        let content = self.content(path).and_then(|content| self.bytes(content));
        content.ok_or_else(|| FileError::new(path, FileProblem::Missing))
    }

    fn exists(&self, path: &Path) -> bool {
        self.content(path).is_some()
    }
}
