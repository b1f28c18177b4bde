//! From what a take file says to what it means: paths, cameras, frames, keypoints, options.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use backlit_tracking::body::Model;
use backlit_tracking::camera::Rig;
use backlit_tracking::segment::SegmentOptions;
use toml::{Spanned, Table};

use super::footage::{self, AlignedFootage, Cache, CameraRange, FrameSource};
use super::paths::{expand_variables, variable};
use super::reference::ReferenceOptions;
use super::spec::{ReferenceSpec, TakeSpec, ViewSpec};
use super::{
    BackgroundSource, CameraFootage, FramePattern, Joint, MAX_BACKGROUND_FRAMES, MAX_FRAMES, PatternError,
    Reference, TakeError, measurement,
};
use crate::calibration::{self, Calibration, CalibrationOptions};
use crate::text::line_at;
use crate::toml_text::{self, TomlStep};
use crate::trc::Axes;
use crate::video::{Video, VideoProblem};
use crate::{FileError, FileProblem, MAX_TEXT_BYTES, Result, TakeFiles, placement_file};

/// Pictures are reduced by no more than this.
const MAX_REDUCTION: u32 = 64;
/// Most markers that are mapped to joints: a body has 257 joints, and few have several markers.
const MAX_MARKERS: usize = 1000;
/// Offsets beyond this are a mistake, seconds.
const MAX_OFFSET_SECONDS: f64 = 1e6;

/// How far behind the last picture others are looked for.
const LOOKED_AHEAD: u64 = 1000;

/// A take file's text and where its paths lead.
pub(super) struct TakeReader<'a> {
    pub(super) files: &'a dyn TakeFiles,
    pub(super) path: &'a Path,
    text: &'a str,
    /// The take's folder: model and start pose are looked for here.
    pub(super) folder: PathBuf,
    /// All else is looked for here.
    pub(super) footage: PathBuf,
}

impl<'a> TakeReader<'a> {
    pub(super) fn new(
        files: &'a dyn TakeFiles,
        path: &'a Path,
        text: &'a str,
        spec: &TakeSpec,
    ) -> Result<Self> {
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        let mut reader = Self { files, path, text, footage: folder.clone(), folder };
        if let Some(footage) = &spec.footage {
            reader.footage = reader.folder.join(reader.expand(footage, "footage")?);
        }
        Ok(reader)
    }

    pub(super) fn problem(&self, span: Range<usize>, problem: FileProblem) -> FileError {
        FileError::new(self.path, problem).at_line(Some(line_at(self.text, span.start)))
    }

    pub(super) fn field<T: std::fmt::Debug>(
        &self,
        value: &Spanned<T>,
        field: &str,
        expected: String,
    ) -> FileError {
        let found = format!("{:?}", value.get_ref());
        self.problem(value.span(), FileProblem::field(field, found, expected))
    }

    pub(super) fn expand(&self, value: &Spanned<String>, field: &str) -> Result<String> {
        expand_variables(value.get_ref(), &variable).map_err(|variable| {
            self.problem(value.span(), FileProblem::Variable { field: field.to_owned(), variable })
        })
    }

    pub(super) fn rig(&self, spec: &TakeSpec) -> Result<Rig> {
        let path = self.footage.join(self.expand(&spec.cameras.calibration, "cameras.calibration")?);
        let options = CalibrationOptions { size: spec.cameras.size, metres_per_unit: spec.units.metres() };
        let all =
            calibration::load_from(self.files, &path, options).map_err(|error| match &spec.footage {
                // Where even the cameras are missing, it is the footage that lies elsewhere.
                Some(footage) if error.is_missing() => self.field(
                    footage,
                    "footage",
                    format!("the folder of the footage, but there is no {}", path.display()),
                ),
                _ => error,
            })?;
        let Calibration { rig: all, left_out } = all;
        let mut cameras = Vec::with_capacity(spec.views.len());
        for view in &spec.views {
            if let Some(left) = left_out.iter().find(|left| left.name == *view.name.get_ref()) {
                let expected = format!("a camera that can be used ({}: {})", path.display(), left.reason);
                return Err(self.field(&view.name, "camera.name", expected));
            }
            let index = all
                .index(view.name.get_ref())
                .map_err(|error| self.problem(view.name.span(), FileProblem::Rig { error }))?;
            cameras.push(all.cameras()[index].clone());
        }
        Rig::new(cameras).map_err(|error| FileError::new(self.path, FileProblem::Rig { error }))
    }

    /// By how much pictures are reduced before anything is done with them.
    pub(super) fn reduction(&self, spec: &TakeSpec) -> Result<u32> {
        let Some(value) = &spec.reduction else { return Ok(1) };
        let reduction = u32::try_from(*value.get_ref()).ok().filter(|by| (1..=MAX_REDUCTION).contains(by));
        let expected = || format!("a whole number from 1 to {MAX_REDUCTION}");
        reduction.ok_or_else(|| self.field(value, "reduction", expected()))
    }

    /// All cameras' footage and how many frames it has.
    pub(super) fn footage(&self, spec: &TakeSpec, cache: &Cache) -> Result<AlignedFootage, TakeError> {
        let film = |view| self.film(view, *spec.frame_rate.get_ref(), cache);
        let films: Vec<CameraRange> = spec.views.iter().map(film).collect::<Result<_, _>>()?;
        let is_shifted = spec.views.iter().any(|view| view.offset.is_some() || view.offset_seconds.is_some());
        let mut films = footage::align(films, is_shifted)?;
        films.cameras.iter().try_for_each(|camera| camera.check_masks(self.files, films.frame_count))?;
        films.note_times(*spec.frame_rate.get_ref());
        Ok(films)
    }

    fn film(&self, view: &ViewSpec, frame_rate: f64, cache: &Cache) -> Result<CameraRange, TakeError> {
        let camera = view.name.get_ref().clone();
        let background = self.background(view, cache)?;
        let masks = self.masks(view, &|value, field| self.frames(value, field, cache))?;
        let failed = |error: FileError| match error.path == self.path {
            true => TakeError::File(error),
            false => TakeError::Frame { camera: camera.clone(), frame: 0, error },
        };
        let frames = match (&view.frames, &masks) {
            (Some(frames), _) => self.frames(frames, "camera.frames", cache).map_err(failed)?,
            (None, Some(masks)) => masks.source.clone(),
            (None, None) => {
                let expected = "a camera with `frames`, `masks` or both".to_owned();
                return Err(self.field(&view.name, "camera", expected).into());
            }
        };
        let keypoints = self.keypoints(view)?;
        let (camera, first) = (camera.clone(), view.first);
        let footage = CameraFootage { camera, frames, first, background, masks, keypoints };
        let count = self.count_frames(view, &footage)? as u64;
        let zero = self.offset(view, &footage, frame_rate)?;
        let there = view.first..view.first.saturating_add(count);
        let is_open = view.count.is_none() && view.last.is_none();
        let gap = if is_open { self.gap(&footage, there.end) } else { None };
        Ok(CameraRange { footage, there, zero, gap })
    }

    /// Says that pictures lie behind a gap, where no number of frames is given: such pictures are not used. `end` is the number of the
    /// first one that is missing.
    fn gap(&self, footage: &CameraFootage, end: u64) -> Option<String> {
        let FrameSource::Pictures { .. } = footage.frames else { return None };
        let behind = end.saturating_add(1)..end.saturating_add(LOOKED_AHEAD);
        let there: Vec<u64> =
            behind.filter(|&number| self.files.exists(&footage.frames.path(number))).collect();
        let (next, count) = (there.first()?, there.len());
        Some(format!(
            "camera \"{}\": pictures {end} to {} are missing, so that its frames end there; at least {count} later ones are not used",
            footage.camera,
            next - 1
        ))
    }

    /// How many files of a pattern there are without a gap, at most `limit`.
    fn count_files(&self, pattern: &FramePattern, first: u64, limit: usize) -> usize {
        let exists =
            |&k: &usize| self.files.exists(&pattern.path(&self.footage, first.saturating_add(k as u64)));
        (0..limit).take_while(exists).count()
    }

    /// A video, or numbered pictures.
    fn frames(&self, value: &Spanned<String>, field: &str, cache: &Cache) -> Result<FrameSource> {
        let text = self.expand(value, field)?;
        Ok(match self.video(&text, cache)? {
            Some(video) => FrameSource::Video(video),
            None => {
                FrameSource::Pictures { folder: self.footage.clone(), pattern: self.pattern(value, field)? }
            }
        })
    }

    /// The video of a path, if the file there is one by its content.
    fn video(&self, text: &str, cache: &Cache) -> Result<Option<Video>> {
        let path = self.footage.join(text);
        if !self.files.exists(&path) {
            // A name without a number can be nothing else than a file that is not there.
            let is_pattern = FramePattern::new(text) != Err(PatternError::NoNumber);
            return if is_pattern { Ok(None) } else { Err(FileError::new(&path, FileProblem::Missing)) };
        }
        if !Video::is_video(self.files, &path)? {
            return Ok(None);
        }
        Video::from_files(self.files, &path, Arc::clone(cache)).map(Some)
    }

    /// The number of the camera's frame that belongs to the take's frame 0.
    fn offset(&self, view: &ViewSpec, footage: &CameraFootage, frame_rate: f64) -> Result<i64> {
        match (&view.offset, &view.offset_seconds) {
            (Some(_), Some(seconds)) => {
                let expected = "either `offset` or `offset_seconds`".to_owned();
                Err(self.field(seconds, "offset_seconds", expected))
            }
            (Some(frames), None) => Ok(*frames.get_ref()),
            (None, Some(seconds)) => {
                let given = *seconds.get_ref();
                if !given.is_finite() || given.abs() > MAX_OFFSET_SECONDS {
                    let expected = format!("seconds, at most {MAX_OFFSET_SECONDS} either way");
                    return Err(self.field(seconds, "offset_seconds", expected));
                }
                Ok(frame_at(footage, given, frame_rate))
            }
            (None, None) => Ok(view.first.cast_signed()),
        }
    }

    pub(super) fn pattern(&self, value: &Spanned<String>, field: &str) -> Result<FramePattern> {
        let text = self.expand(value, field)?;
        FramePattern::new(&text).map_err(|error| {
            let (found, expected) = (format!("{text:?}"), format!("a pattern of file names: it has {error}"));
            self.problem(value.span(), FileProblem::field(field, found, expected))
        })
    }

    /// How many frames a camera has: as many as it says, and they are all there; else as many as are found.
    fn count_frames(&self, view: &ViewSpec, footage: &CameraFootage) -> Result<usize, TakeError> {
        let declared = match (&view.count, &view.last) {
            (Some(_), Some(last)) => {
                return Err(self.field(last, "last", "either `count` or `last`".to_owned()).into());
            }
            (Some(count), None) => Some((count, "count", Some(*count.get_ref()))),
            (None, Some(last)) => {
                Some((last, "last", last.get_ref().checked_sub(view.first).and_then(|n| n.checked_add(1))))
            }
            (None, None) => None,
        };
        let wanted = match declared {
            Some((value, field, count)) => {
                let count = count.and_then(|count| usize::try_from(count).ok());
                let count = count.filter(|count| (1..=MAX_FRAMES).contains(count));
                let expected = || format!("1 to {MAX_FRAMES} frames from `first` = {}", view.first);
                Some(count.ok_or_else(|| self.field(value, field, expected()))?)
            }
            None => None,
        };
        let limit = wanted.unwrap_or(MAX_FRAMES);
        let pattern = match &footage.frames {
            FrameSource::Pictures { pattern, .. } => pattern,
            FrameSource::Video(video) => return video_frames(video, view, limit),
        };
        let found = self.count_files(pattern, footage.first, limit);
        if found < wanted.unwrap_or(1) {
            let error = FileError::new(&footage.path(found), FileProblem::Missing);
            return Err(TakeError::Frame { camera: footage.camera.clone(), frame: found, error });
        }
        Ok(found)
    }

    fn background(&self, view: &ViewSpec, cache: &Cache) -> Result<Option<BackgroundSource>, TakeError> {
        let Some(background) = &view.background else { return Ok(None) };
        let text = self.expand(background, "camera.background")?;
        let wanted = match &view.background_count {
            None => None,
            Some(count) => {
                let expected = || format!("1 to {MAX_BACKGROUND_FRAMES} pictures");
                let given = usize::try_from(*count.get_ref()).ok();
                let given = given.filter(|n| (1..=MAX_BACKGROUND_FRAMES).contains(n));
                Some(given.ok_or_else(|| self.field(count, "background_count", expected()))?)
            }
        };
        let failed = |error| TakeError::Background { camera: view.name.get_ref().clone(), error };
        let missing = |path: &Path| failed(FileError::new(path, FileProblem::Missing));
        if self.files.exists(&self.footage.join(&text))
            && let Some(video) = self.video(&text, cache).map_err(failed)?
        {
            return footage::background(video, view.background_first, wanted).map(Some).map_err(failed);
        }
        if FramePattern::new(&text) == Err(PatternError::NoNumber) {
            let path = self.footage.join(text.replace("%%", "%"));
            return if self.files.exists(&path) {
                Ok(Some(BackgroundSource::Plate(path)))
            } else {
                Err(missing(&path))
            };
        }
        let pattern = self.pattern(background, "camera.background")?;
        let limit = wanted.unwrap_or(MAX_BACKGROUND_FRAMES);
        let found = self.count_files(&pattern, view.background_first, limit);
        let path = |k: usize| pattern.path(&self.footage, view.background_first.saturating_add(k as u64));
        if found < wanted.unwrap_or(1) {
            return Err(missing(&path(found)));
        }
        Ok(Some(BackgroundSource::Frames((0..found).map(path).collect())))
    }

    pub(super) fn reference(
        &self,
        spec: &ReferenceSpec,
        model: &Model,
        films: &AlignedFootage,
        take: &TakeSpec,
    ) -> Result<Reference> {
        let path = self.footage.join(self.expand(&spec.keypoints, "reference.keypoints")?);
        if let Some(count) = spec.markers.as_ref().map(BTreeMap::len).filter(|&count| count > MAX_MARKERS) {
            let (found, expected) = (format!("a table of {count}"), format!("at most {MAX_MARKERS} markers"));
            let problem = FileProblem::field("reference.markers", found, expected);
            return Err(self.problem(spec.keypoints.span(), problem));
        }
        let mut markers = Vec::new();
        for (marker, limb) in spec.markers.iter().flatten() {
            let joint = Joint::named(model, limb.get_ref()).ok_or_else(|| {
                let field = format!("reference.markers.{marker}");
                self.problem(limb.span(), FileProblem::UnknownLimb { field, limb: limb.get_ref().clone() })
            })?;
            markers.push((marker.clone(), joint));
        }
        let axes = match &spec.axes {
            Some(text) => Axes::parse(text.get_ref()).ok_or_else(|| {
                let expected =
                    "three letters that turn the table's axes to the world's, as \"zxy\" or \"x-zy\"";
                self.field(text, "reference.axes", expected.to_owned())
            })?,
            None => Axes::default(),
        };
        let options = ReferenceOptions {
            model,
            axes,
            markers: spec.markers.is_some().then_some(&markers),
            first_frame: spec.first_frame.saturating_add(films.begins),
            frame_count: films.frame_count,
            metres_per_unit: take.units.metres(),
        };
        let reference = Reference::parse(&path, &self.files.read(&path, MAX_TEXT_BYTES)?, &options)?;
        let Some(placement) = &spec.placement else { return Ok(reference) };
        let path = self.folder.join(self.expand(placement, "reference.placement")?);
        let bytes = self.files.read(&path, placement_file::MAX_BYTES)?;
        Ok(reference.with_placement(placement_file::parse(&path, &bytes, model)?))
    }

    pub(super) fn measurement(&self, spec: &TakeSpec) -> Result<Vec<SegmentOptions>> {
        let options = |table: &Table, steps: &[TomlStep<'_>]| {
            measurement::options(table).map_err(|problem| {
                let steps: Vec<TomlStep<'_>> = steps
                    .iter()
                    .copied()
                    .chain([TomlStep::Key("measurement"), TomlStep::Key(&problem.key)])
                    .collect();
                let field = format!("measurement.{}", problem.key);
                let problem = FileProblem::Option { field, message: problem.message };
                FileError::new(self.path, problem).at_line(toml_text::line_of(self.text, &steps))
            })
        };
        options(&spec.measurement, &[])?;
        let camera = |view: &ViewSpec| {
            let steps = [TomlStep::Key("camera"), TomlStep::Named(view.name.get_ref())];
            options(&view.measurement, &steps)?;
            options(&measurement::merged(&spec.measurement, &view.measurement), &steps)
        };
        spec.views.iter().map(camera).collect()
    }
}

/// How many frames a video has from `first` on, at most `limit`; fewer than are asked for are told by a note.
fn video_frames(video: &Video, view: &ViewSpec, limit: usize) -> Result<usize, TakeError> {
    let there = video.frame_count();
    let left = there.saturating_sub(usize::try_from(view.first).unwrap_or(usize::MAX));
    if left == 0 {
        let error = VideoProblem::NoFrame { frame: view.first as usize, count: there };
        let error = FileError::new(video.path(), FileProblem::Video { error });
        return Err(TakeError::Frame { camera: view.name.get_ref().clone(), frame: 0, error });
    }
    Ok(left.min(limit))
}

/// The number of the frame nearest to a time: by a video's own times, else by the rate.
fn frame_at(footage: &CameraFootage, seconds: f64, frame_rate: f64) -> i64 {
    let times = footage.video().map(Video::seconds).unwrap_or_default();
    match times.iter().position(|&time| time >= seconds) {
        Some(after) if seconds >= 0.0 => {
            let before = after.saturating_sub(1);
            let nearer = seconds - times[before] < times[after] - seconds;
            (if nearer { before } else { after }) as i64
        }
        _ => (seconds * frame_rate).round() as i64,
    }
}
