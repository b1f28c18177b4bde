//! One camera's pictures and background, and the frames that all cameras of a take have.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::keypoints::CameraKeypoints;
use super::masks::CameraMasks;
use super::{FramePattern, TakeError};
use crate::video::Video;
use crate::{FileError, FileProblem, Result};

/// Most frames a take may have: hours at any rate.
pub const MAX_FRAMES: usize = 1_000_000;
/// Most pictures a background is made of.
pub const MAX_BACKGROUND_FRAMES: usize = 256;

/// Where one camera's pictures are.
#[derive(Debug, Clone)]
pub struct CameraFootage {
    pub(super) camera: String,
    pub(super) frames: FrameSource,
    /// The number of frame 0.
    pub(super) first: u64,
    pub(super) background: Option<BackgroundSource>,
    pub(super) masks: Option<CameraMasks>,
    pub(super) keypoints: Option<CameraKeypoints>,
}

/// What a camera's frames are taken from.
#[derive(Debug, Clone)]
pub(super) enum FrameSource {
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

    /// How many pictures it is, at least one.
    #[must_use]
    pub fn count(&self) -> usize {
        match self {
            Self::Plate(_) => 1,
            Self::Frames(paths) => paths.len(),
            Self::Video { frames, .. } => frames.len(),
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
            FrameSource::Pictures { .. } => None,
            FrameSource::Video(video) => Some(video),
        }
    }

    /// The last frame, up to this one, that is quickly had: in a video it is decoded by itself.
    #[must_use]
    pub fn quick_frame_before(&self, frame: usize) -> usize {
        let number = self.number(frame) as usize;
        let key = self.video().map_or(number, |video| video.key_before(number));
        frame.saturating_sub(number - key)
    }

    /// Where the background is, if the take has one for this camera.
    #[must_use]
    pub fn background(&self) -> Option<&BackgroundSource> {
        self.background.as_ref()
    }
}

/// Frames that a background is made of where a video of the empty scene is given and no number of them.
pub const USUAL_BACKGROUND_FRAMES: usize = 50;
/// Frame rates that differ by more than this part are told.
const RATE_TOLERANCE: f64 = 0.01;

/// All cameras' footage, from one common frame on.
#[derive(Debug)]
pub(super) struct AlignedFootage {
    pub(super) cameras: Vec<CameraFootage>,
    pub(super) frame_count: usize,
    /// How many frames after frame 0, as offsets have it, the take begins, because a camera has no earlier one.
    pub(super) begins: u64,
    pub(super) notes: Vec<String>,
}

/// One camera before the others are known: its footage, the numbers of its frames that are there, and the number that
/// belongs to the take's frame 0.
#[derive(Debug)]
pub(super) struct CameraRange {
    pub(super) footage: CameraFootage,
    pub(super) there: Range<u64>,
    pub(super) zero: i64,
    /// Pictures behind a gap, in words.
    pub(super) gap: Option<String>,
}

impl CameraRange {
    /// The take's frames that this camera has.
    fn frames(&self) -> Range<i64> {
        let frame = |number: u64| i64::try_from(number).unwrap_or(i64::MAX).saturating_sub(self.zero);
        frame(self.there.start)..frame(self.there.end)
    }
}

/// Where a camera is a video or has an offset, the take has the frames that all have; else all must have equally many.
pub(super) fn align(films: Vec<CameraRange>, is_shifted: bool) -> Result<AlignedFootage, TakeError> {
    let with_videos = is_shifted || films.iter().any(|film| film.footage.video().is_some());
    if !with_videos {
        equally_many(&films)?;
    }
    let ranges: Vec<Range<i64>> = films.iter().map(CameraRange::frames).collect();
    let latest = (0..films.len()).rev().max_by_key(|&camera| ranges[camera].start).unwrap_or(0);
    let shortest = (0..films.len()).rev().min_by_key(|&camera| ranges[camera].end).unwrap_or(0);
    let name = |camera: usize| films.get(camera).map_or("", |film| film.footage.camera()).to_owned();
    let begins = ranges.get(latest).map_or(0, |range| range.start).max(0);
    let ends = ranges.get(shortest).map_or(0, |range| range.end);
    if ends <= begins && !films.is_empty() {
        return Err(TakeError::NoCommonFrame { camera: name(shortest), ends, other: name(latest), begins });
    }
    let mut notes: Vec<String> = films.iter().filter_map(|film| film.gap.clone()).collect();
    if begins > 0 {
        notes.push(format!(
            "the take begins {} later, because camera \"{}\" has no earlier one",
            frames_of(begins),
            name(latest)
        ));
    }
    let longest = (0..films.len()).rev().max_by_key(|&camera| ranges[camera].end).unwrap_or(0);
    if ranges.get(longest).is_some_and(|range| range.end > ends) {
        let left_out = ranges[longest].end - ends;
        notes.push(format!(
            "the take ends with camera \"{}\"; camera \"{}\" goes on for {}",
            name(shortest),
            name(longest),
            frames_of(left_out)
        ));
    }
    let frame_count = usize::try_from(ends - begins).unwrap_or(0);
    let begins = begins.unsigned_abs();
    let cameras = films.into_iter().map(|film| {
        let first = film.zero.saturating_add_unsigned(begins);
        CameraFootage { first: u64::try_from(first).unwrap_or(0), ..film.footage }
    });
    Ok(AlignedFootage { cameras: cameras.collect(), frame_count, begins, notes })
}

/// A count of frames in words.
fn frames_of(count: i64) -> String {
    if count == 1 { "1 frame".to_owned() } else { format!("{count} frames") }
}

fn equally_many(films: &[CameraRange]) -> Result<(), TakeError> {
    let count = |film: &CameraRange| (film.there.end - film.there.start) as usize;
    let Some(longest) = films.iter().rev().max_by_key(|film| count(film)) else { return Ok(()) };
    match films.iter().find(|film| count(film) != count(longest)) {
        None => Ok(()),
        Some(film) => Err(TakeError::FrameCount {
            camera: film.footage.camera.clone(),
            found: count(film),
            other: longest.footage.camera.clone(),
            expected: count(longest),
            file: film.footage.path(count(film)).display().to_string(),
        }),
    }
}

impl AlignedFootage {
    /// When each frame was taken, seconds from frame 0 on: by the first camera that is a video, else by the rate.
    pub(super) fn seconds(&self, frame_rate: f64) -> Vec<f64> {
        let video = self.cameras.iter().find_map(|footage| Some((footage, footage.video()?)));
        let own = video.and_then(|(footage, video)| {
            let from = footage.number(0) as usize;
            video.seconds().get(from..from.checked_add(self.frame_count)?)
        });
        match own {
            Some(times) => times.iter().map(|time| time - times[0]).collect(),
            None => (0..self.frame_count).map(|frame| frame as f64 / frame_rate).collect(),
        }
    }

    /// Says where videos' times do not fit the take's rate or one another.
    pub(super) fn note_times(&mut self, frame_rate: f64) {
        let seconds = self.seconds(frame_rate);
        let mut notes = Vec::new();
        for footage in &self.cameras {
            let Some(video) = footage.video() else { continue };
            let name = footage.camera();
            if let Some(rate) = video.frame_rate()
                && (rate / frame_rate - 1.0).abs() > RATE_TOLERANCE
            {
                notes.push(format!(
                    "camera \"{name}\" has {rate:.2} frames per second, the take {frame_rate:.2}"
                ));
            }
            let from = footage.number(0) as usize;
            let times = video.seconds().get(from..).unwrap_or_default();
            let off = times.iter().zip(&seconds).map(|(time, second)| (time - times[0] - second).abs());
            let off = off.fold(0.0, f64::max);
            if off > 0.5 / frame_rate {
                notes.push(format!(
                    "camera \"{name}\": frames of one number are up to {off:.3} s apart from those of the first video"
                ));
            }
        }
        self.notes.append(&mut notes);
    }
}

/// The frames of a video of the empty scene: those that are asked for, else some that are spread over it.
pub(super) fn background(video: Video, first: u64, wanted: Option<usize>) -> Result<BackgroundSource> {
    let there = video.frame_count();
    let first = usize::try_from(first).unwrap_or(usize::MAX);
    let Some(left) = there.checked_sub(first).filter(|&left| left > 0) else {
        let problem = crate::video::VideoProblem::NoFrame { frame: first, count: there };
        return Err(FileError::new(video.path(), FileProblem::Video { error: problem }));
    };
    let frames = match wanted {
        Some(count) => (first..first.saturating_add(count).min(there)).collect(),
        None => {
            let count = left.min(USUAL_BACKGROUND_FRAMES.min(MAX_BACKGROUND_FRAMES));
            (0..count).map(|k| first + k * left / count).collect()
        }
    };
    Ok(BackgroundSource::Video { video, frames })
}

/// Where a camera's video is read from: shared by all cameras of a take.
pub(super) type Cache = Arc<crate::video::FrameCache>;

/// What a plate knows of a pixel, by its alpha channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum PlateKnowledge {
    /// Nothing: alpha below 32.
    Nothing,
    /// The subject covers it in every frame: alpha from 32 to 127.
    AlwaysSubject,
    /// What is there without the subject: alpha from 128 on.
    Scene,
}

impl PlateKnowledge {
    /// From this alpha on the scene is known.
    pub(super) const OPAQUE: u8 = 128;
    /// From this alpha on the subject covers the pixel.
    const COVERED: u8 = 32;

    /// The alpha that says so in a file.
    #[must_use]
    pub fn alpha(self) -> u8 {
        match self {
            Self::Nothing => 0,
            Self::AlwaysSubject => 64,
            Self::Scene => 255,
        }
    }

    pub(super) fn of_alpha(alpha: u8) -> Self {
        match alpha {
            0..Self::COVERED => Self::Nothing,
            Self::COVERED..Self::OPAQUE => Self::AlwaysSubject,
            Self::OPAQUE.. => Self::Scene,
        }
    }
}
