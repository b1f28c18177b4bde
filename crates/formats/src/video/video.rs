//! An open video.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use backlit_tracking::camera::{MAX_PIXELS, MAX_SIDE};
use image::RgbImage;

use super::cache::{FrameCache, Key};
use super::coded::Coded;
use super::decoder::FasterOfTwo;
use super::ffmpeg::{Piped, Programs, Raw};
use super::index::{Codec, Container, Index};
use super::probe::Probed;
use super::{FrameRequest, Sink, VideoProblem, avi, boxes, mp4};
use crate::files::FileParts;
use crate::{DiskFiles, FileError, FileProblem, Result, TakeFiles};

/// Bytes at a file's head that tell what it is.
const HEAD_BYTES: usize = 256;
/// Frames that are decoded ahead while a video is read in order.
const AHEAD: usize = 2;
/// Most frames before the request one that are kept when they are decoded on the way.
const MAX_KEPT_BEFORE: usize = 64;
/// A gap between frames that differs by more than this part from the usual one does not count for the frame rate.
const USUAL_GAP: f64 = 0.2;

/// An open video. Clones share the decoder and the cache; all methods may be called from several threads.
///
/// Guaranteed: at least one frame; times never fall; every picture is of [`size`](Self::size).
#[derive(Clone)]
pub struct Video(Arc<Inner>);

impl std::fmt::Debug for Video {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut out = f.debug_struct("Video");
        out.field("path", &self.0.path).field("size", &self.0.size).field("codec", &self.0.codec);
        out.field("frames", &self.0.seconds.len()).finish_non_exhaustive()
    }
}

struct Inner {
    path: PathBuf,
    size: [usize; 2],
    seconds: Vec<f64>,
    codec: String,
    notes: Vec<String>,
    source: Mutex<VideoDecoder>,
    cache: Arc<FrameCache>,
    id: u64,
    /// The frame that was asked for last.
    last: AtomicUsize,
    /// A thread is decoding ahead.
    ahead: AtomicBool,
}

#[derive(Debug)]
enum VideoDecoder {
    Coded(Box<FasterOfTwo>),
    Piped(Box<Piped>),
}

impl Drop for Inner {
    fn drop(&mut self) {
        self.cache.forget(self.id);
    }
}

impl Video {
    /// Opens a video of the disk, with a cache of its own.
    pub fn open(path: &Path) -> Result<Self> {
        Self::from_files(&DiskFiles, path, Arc::default())
    }

    /// Opens a video whose frames are kept in a cache that it may share with others.
    pub fn from_files(files: &dyn TakeFiles, path: &Path, cache: Arc<FrameCache>) -> Result<Self> {
        let parts = files.parts(path)?;
        Self::with_programs(parts, path, cache, Some(&Programs::default()))
            .map_err(|error| FileError::new(path, FileProblem::Video { error }))
    }

    /// Opens a video that is decoded here, without any other program.
    pub fn decoded_here(parts: FileParts, path: &Path) -> Result<Self> {
        Self::with_programs(parts, path, Arc::default(), None)
            .map_err(|error| FileError::new(path, FileProblem::Video { error }))
    }

    /// Whether a file's content is that of a video; its name does not matter.
    pub fn is_video(files: &dyn TakeFiles, path: &Path) -> Result<bool> {
        let head = files.parts(path)?.read_up_to(0, HEAD_BYTES);
        let head = head.map_err(|error| FileError::new(path, FileProblem::Read { error }))?;
        Ok(Container::of(&head).is_some())
    }

    pub(super) fn with_programs(
        mut parts: FileParts,
        path: &Path,
        cache: Arc<FrameCache>,
        programs: Option<&Programs>,
    ) -> Result<Self, VideoProblem> {
        let head = parts.read_up_to(0, HEAD_BYTES).map_err(|error| VideoProblem::Read { error })?;
        let container = Container::of(&head).ok_or(VideoProblem::Unknown)?;
        let index = own_index(&mut parts, container)?;
        let mut why = None;
        if let Some(index) = &index
            && !matches!(index.codec, Codec::Other(_))
        {
            match Coded::new(parts, path.to_owned(), index.clone()) {
                Ok(coded) => {
                    let coded = FasterOfTwo::new(coded, programs);
                    return Self::of(path, VideoDecoder::Coded(Box::new(coded)), cache);
                }
                Err((file, reason)) => {
                    parts = file;
                    why = Some(format!("{} ({reason})", index.codec.name()));
                }
            }
        }
        let codec = why.or_else(|| index.as_ref().map(|index| index.codec.name().to_owned()));
        let Some(programs) = programs else {
            let codec = codec.unwrap_or_else(|| "in a format that Backlit does not decode".to_owned());
            return Err(VideoProblem::NeedsProgram { codec, program: "ffmpeg".to_owned() });
        };
        let piped = Piped::open(parts, path, codec, index.as_ref(), Raw::Rgb, programs)?;
        Self::of(path, VideoDecoder::Piped(Box::new(piped)), cache)
    }

    fn of(path: &Path, source: VideoDecoder, cache: Arc<FrameCache>) -> Result<Self, VideoProblem> {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        let (size, seconds, codec, notes) = match &source {
            VideoDecoder::Coded(coded) => {
                let index = &coded.coded.index;
                let seconds = index.frames.iter().map(|frame| frame.seconds).collect();
                let size = index.orientation.size(index.size);
                (size, seconds, index.codec.name().to_owned(), index.notes.clone())
            }
            VideoDecoder::Piped(piped) => {
                let Probed { size, seconds, codec, .. } = &piped.probed;
                (*size, seconds.clone(), codec.clone(), piped.notes.clone())
            }
        };
        let limit = MAX_SIDE as usize;
        let pixels = (size[0] as u64).saturating_mul(size[1] as u64);
        if size.iter().any(|&side| side == 0 || side > limit) || pixels > MAX_PIXELS {
            return Err(VideoProblem::Size { size, limit });
        }
        let inner = Inner {
            path: path.to_owned(),
            size,
            seconds,
            codec,
            notes,
            source: Mutex::new(source),
            cache,
            id: NEXT.fetch_add(1, Ordering::Relaxed),
            last: AtomicUsize::new(usize::MAX),
            ahead: AtomicBool::new(false),
        };
        Ok(Self(Arc::new(inner)))
    }

    /// The file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.0.path
    }

    /// Width and height of a frame, pixels, turned as the file says.
    #[must_use]
    pub fn size(&self) -> [usize; 2] {
        self.0.size
    }

    /// Number of frames that can be had, at least one.
    #[must_use]
    pub fn frame_count(&self) -> usize {
        self.0.seconds.len()
    }

    /// When each frame is shown, seconds.
    #[must_use]
    pub fn seconds(&self) -> &[f64] {
        &self.0.seconds
    }

    /// Frames per second: the mean over the gaps of the usual length, or over all where there is no usual length. `None`
    /// for a single frame.
    #[must_use]
    pub fn frame_rate(&self) -> Option<f64> {
        let mut gaps: Vec<f64> = self.0.seconds.windows(2).map(|pair| pair[1] - pair[0]).collect();
        gaps.sort_by(f64::total_cmp);
        let median = *gaps.get(gaps.len() / 2)?;
        let usual: Vec<f64> =
            gaps.iter().copied().filter(|gap| (gap - median).abs() <= USUAL_GAP * median).collect();
        let counted = if usual.len() * 5 >= gaps.len() * 4 { usual } else { gaps };
        let mean = counted.iter().sum::<f64>() / counted.len() as f64;
        (mean > 0.0).then(|| 1.0 / mean)
    }

    /// How the pictures are coded, as "H.264".
    #[must_use]
    pub fn codec(&self) -> &str {
        &self.0.codec
    }

    /// What is missing or damaged, in words; damage only as far as frames were asked for.
    #[must_use]
    pub fn notes(&self) -> Vec<String> {
        let found = match &*self.0.source() {
            VideoDecoder::Coded(coded) => coded.coded.note(),
            VideoDecoder::Piped(_) => None,
        };
        self.0.notes.iter().cloned().chain(found).collect()
    }

    /// How many pictures were decoded so far. Read in order, a frame costs one; a leap costs the pictures, from the last that is
    /// decoded by itself, of which others are made.
    #[must_use]
    pub fn decoded_count(&self) -> usize {
        match &*self.0.source() {
            VideoDecoder::Coded(coded) => coded.decoded(),
            VideoDecoder::Piped(piped) => piped.decoded,
        }
    }

    /// The last frame, up to this one, that is decoded by itself; the frame itself where nobody knows.
    #[must_use]
    pub fn key_before(&self, frame: usize) -> usize {
        match &*self.0.source() {
            VideoDecoder::Coded(coded) if frame < self.frame_count() => coded.coded.frame_after_key(frame, 0),
            _ => frame,
        }
    }

    /// A frame, counted from 0 in the order in which they are shown.
    pub fn frame(&self, frame: usize) -> Result<Arc<RgbImage>> {
        self.frame_reduced(frame, 1)
    }

    /// The same at a part of its size: each square of `divisor`² pixels is averaged to one. Columns at the right and
    /// rows at the bottom that fill no square are left out; a divisor larger than a side counts as that side.
    pub fn frame_reduced(&self, frame: usize, divisor: usize) -> Result<Arc<RgbImage>> {
        let divisor = divisor.clamp(1, self.0.size[0].min(self.0.size[1]));
        let picture = self.0.frame(frame, divisor);
        let before = self.0.last.swap(frame, Ordering::Relaxed);
        if frame.checked_sub(1) == Some(before) && picture.is_ok() {
            self.read_ahead(frame, divisor);
        }
        picture.map_err(|error| FileError::new(&self.0.path, FileProblem::Video { error }))
    }

    /// Decodes the next frames into the cache, by a thread of the pool.
    fn read_ahead(&self, frame: usize, divisor: usize) {
        let last = (frame + AHEAD).min(self.frame_count() - 1);
        let inner = Arc::clone(&self.0);
        let lacking = move |inner: &Inner, frame| !inner.cache.contains(inner.key(frame, divisor));
        let room = inner.bytes(divisor).saturating_mul(4 * (AHEAD + 1)) <= inner.cache.limit_bytes();
        if !room
            || !(frame + 1..=last).any(|frame| lacking(&inner, frame))
            || inner.ahead.swap(true, Ordering::Relaxed)
        {
            return;
        }
        rayon::spawn(move || {
            for frame in frame + 1..=last {
                // What fails here is told to the one who asks for it.
                if lacking(&inner, frame) && inner.frame(frame, divisor).is_err() {
                    break;
                }
            }
            inner.ahead.store(false, Ordering::Relaxed);
        });
    }
}

impl Inner {
    fn source(&self) -> std::sync::MutexGuard<'_, VideoDecoder> {
        // Decoders that panic are caught where they are called.
        self.source.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn key(&self, frame: usize, divisor: usize) -> Key {
        Key { video: self.id, divisor, frame }
    }

    /// Bytes of a picture.
    fn bytes(&self, divisor: usize) -> usize {
        self.size.iter().map(|side| side / divisor).product::<usize>() * 3
    }

    fn frame(&self, frame: usize, divisor: usize) -> Result<Arc<RgbImage>, VideoProblem> {
        let count = self.seconds.len();
        if frame >= count {
            return Err(VideoProblem::NoFrame { frame, count });
        }
        let key = self.key(frame, divisor);
        if let Some(picture) = self.cache.get(key) {
            return Ok(picture);
        }
        let mut source = self.source();
        // Another thread may have decoded it while this one waited.
        if let Some(picture) = self.cache.get(key) {
            return Ok(picture);
        }
        // Whoever is about here may go back; a leap is to be quick, and passes what it does not need.
        let is_near = frame.abs_diff(self.last.load(Ordering::Relaxed)) <= MAX_KEPT_BEFORE;
        let room = self.cache.limit_bytes() / 4 / self.bytes(divisor).max(1);
        let kept = if is_near { room.min(MAX_KEPT_BEFORE) } else { 0 };
        let request = FrameRequest { frame, divisor, keep_from: frame.saturating_sub(kept) };
        let mut keep = |frame: usize, picture: RgbImage| {
            self.cache.insert(self.key(frame, divisor), Arc::new(picture));
        };
        let sink: &mut Sink<'_> = &mut keep;
        let picture = match &mut *source {
            VideoDecoder::Coded(coded) => coded.frame(request, sink)?,
            VideoDecoder::Piped(piped) => piped.frame(request, sink)?,
        };
        let picture = Arc::new(picture);
        self.cache.insert(key, Arc::clone(&picture));
        Ok(picture)
    }
}

/// The index of a container that we know; `None` for others.
fn own_index(parts: &mut FileParts, container: Container) -> Result<Option<Index>, VideoProblem> {
    let mut index = match container {
        Container::Avi => avi::index(parts)?,
        Container::IsoMedia => {
            mp4::index(&boxes::read_index(parts).map_err(|error| VideoProblem::Read { error })?)?
        }
        Container::Foreign => return Ok(None),
    };
    index.cut_to(parts.length())?;
    Ok(Some(index))
}
