//! Frames of an index by our own decoders: any of them, exactly, and one after the other at one decode a frame.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use image::RgbImage;

use super::h264::{self, Stream, StreamHeader};
use super::index::{Codec, Index, Sample};
use super::jpeg;
use super::yuv::{Colour, Planes};
use super::{FrameRequest, Sink, VideoProblem};
use crate::files::FileParts;
use crate::images::{self, reduced};

/// Most pictures that wait to be shown; B-frames let at most 16 wait.
const MAX_WAITING: usize = 32;

/// Most pictures at a beginning that are looked at for one that says its size.
const MAX_DAMAGED_FIRST: usize = 16;

/// A video whose pictures we decode.
#[derive(Debug)]
pub(super) struct Coded {
    file: FileParts,
    path: PathBuf,
    pub(super) index: Index,
    /// The frame that shows a sample.
    frame_of: Vec<Option<usize>>,
    decoder: Decoder,
    /// Frames whose pictures are damaged, and the first reason.
    damaged: BTreeSet<usize>,
    reason: Option<String>,
    /// Samples decoded so far, to tell what reading costs.
    pub(super) decoded: usize,
}

#[derive(Debug)]
enum Decoder {
    Jpeg,
    H264 { head: StreamHeader, state: Option<Box<DecoderState>> },
}

/// A running decoder.
#[derive(Debug)]
struct DecoderState {
    stream: Stream,
    /// The sample that comes next.
    next: usize,
    /// Pictures shown before this time may lack what they are made from.
    sound_from: i64,
    /// Decoded pictures that are shown later, by frame.
    waiting: BTreeMap<usize, Planes>,
}

impl Coded {
    /// Prepares an index whose samples all lie in the file. The size is that of the pictures themselves.
    pub(super) fn new(
        mut file: FileParts,
        path: PathBuf,
        mut index: Index,
    ) -> Result<Self, (FileParts, String)> {
        let decoder = match decoder(&mut file, &path, &mut index) {
            Ok(decoder) => decoder,
            Err(reason) => return Err((file, reason)),
        };
        let mut frame_of = vec![None; index.samples.len()];
        for (frame, shown) in index.frames.iter().enumerate().rev() {
            frame_of[shown.sample] = Some(frame);
        }
        let (damaged, reason) = (BTreeSet::new(), None);
        Ok(Self { file, path, index, frame_of, decoder, damaged, reason, decoded: 0 })
    }

    /// The file on the disk.
    pub(super) fn path(&self) -> Option<&Path> {
        self.file.memory().is_none().then_some(&self.path)
    }

    /// What an H.264 stream says of its colours.
    pub(super) fn colour(&self) -> Option<Colour> {
        match self.decoder {
            Decoder::H264 { head, .. } => Some(head.colour),
            Decoder::Jpeg => None,
        }
    }

    /// How many pictures have to be decoded for a frame, as far as the container knows.
    pub(super) fn decodes_for(&self, frame: usize) -> usize {
        let target = self.index.frames[frame].sample;
        let Decoder::H264 { state, .. } = &self.decoder else { return 1 };
        let key = self.index.key_before(target);
        let next = state.as_ref().filter(|state| state.next <= target && key <= state.next);
        let is_waiting = state.as_ref().is_some_and(|state| state.waiting.contains_key(&frame));
        if is_waiting { 0 } else { target + 1 - next.map_or(key, |state| state.next) }
    }

    /// The frame that is shown `count` after the key that a frame is decoded from, or the frame where that is earlier.
    pub(super) fn frame_after_key(&self, frame: usize, count: usize) -> usize {
        let key = self.index.key_before(self.index.frames[frame].sample);
        self.frame_of[key].map_or(frame, |key| frame.min(key + count))
    }

    /// What was found to be damaged so far.
    pub(super) fn note(&self) -> Option<String> {
        let (first, last) = (self.damaged.first()?, self.damaged.last()?);
        let reason = self.reason.as_deref().unwrap_or_default();
        Some(match self.damaged.len() {
            1 => format!("frame {first} is damaged ({reason})"),
            count => format!("{count} frames from {first} to {last} are damaged ({reason})"),
        })
    }

    /// A frame's picture. Others that are decoded on the way go to `sink` where they are request.
    pub(super) fn frame(
        &mut self,
        request: FrameRequest,
        sink: &mut Sink<'_>,
    ) -> Result<RgbImage, VideoProblem> {
        let found = match self.decoder {
            Decoder::Jpeg => self.jpeg(request),
            Decoder::H264 { .. } => self.h264(request, sink),
        };
        found.map_err(|reason| VideoProblem::Frame { frame: request.frame, reason })
    }

    fn sample(&mut self, sample: usize) -> Result<Vec<u8>, String> {
        let sample = self.index.samples[sample];
        let bytes = self.file.read_up_to(sample.offset, sample.size as usize);
        let bytes = bytes.map_err(|error| crate::reason(&error))?;
        if (bytes.len() as u64) < sample.size {
            return Err("the file ends too early".to_owned());
        }
        Ok(bytes)
    }

    fn jpeg(&mut self, request: FrameRequest) -> Result<RgbImage, String> {
        let bytes = self.sample(self.index.frames[request.frame].sample)?;
        self.decoded += 1;
        let (orientation, size) = (self.index.orientation, self.index.size);
        let planes = match images::whole_size(&self.path, &bytes) {
            Ok(found) if found != size => Err("its size differs".to_owned()),
            Ok(_) => jpeg::planes(&bytes, size),
            Err(error) => Err(error.problem.to_string()),
        };
        let picture = match planes {
            Ok(Some(planes)) => return Ok(planes.picture(orientation, request.divisor)),
            Ok(None) => images::decode(&self.path, &bytes).map_err(|error| error.problem.to_string()),
            Err(reason) => Err(reason),
        };
        let picture = picture.map_err(|reason| self.damage(request.frame, reason))?;
        let [width, height] = orientation.size(size);
        let turned = orientation.turn(picture.as_raw().as_chunks::<3>().0, size).into_flattened();
        let turned = RgbImage::from_raw(width as u32, height as u32, turned).unwrap_or_default();
        Ok(reduced(turned, request.divisor))
    }

    fn damage(&mut self, frame: usize, reason: String) -> String {
        self.damaged.insert(frame);
        self.reason.get_or_insert_with(|| reason.clone());
        reason
    }

    fn h264(&mut self, request: FrameRequest, sink: &mut Sink<'_>) -> Result<RgbImage, String> {
        let target = self.index.frames[request.frame].sample;
        let mut state = self.state_for(request.frame, target)?;
        let finish = |planes: Planes, index: &Index| planes.picture(index.orientation, request.divisor);
        if let Some(planes) = state.waiting.remove(&request.frame) {
            self.keep(state, request.frame);
            return Ok(finish(planes, &self.index));
        }
        let mut found = Err("it was not decoded".to_owned());
        while state.next <= target {
            let (sample, frame) = (state.next, self.frame_of[state.next]);
            state.next += 1;
            let bytes = self.sample(sample);
            let is_wanted = sample == target || frame.is_some_and(|frame| frame >= request.keep_from);
            if !is_wanted && bytes.as_ref().is_ok_and(|bytes| state.stream.can_skip(bytes)) {
                continue;
            }
            self.decoded += 1;
            let result = bytes.and_then(|bytes| state.stream.decode(&bytes));
            let result = match (result, frame) {
                (Ok((planes, problem)), frame) => {
                    if let Some((problem, frame)) = problem.zip(frame) {
                        self.damage(frame, problem);
                    }
                    Ok(planes)
                }
                (Err(problem), Some(frame)) => Err(self.damage(frame, problem)),
                (Err(problem), None) => Err(problem),
            };
            if sample == target {
                found = result;
                continue;
            }
            let (Ok(planes), Some(frame)) = (result, frame) else { continue };
            if self.index.samples[sample].shown < state.sound_from {
                continue;
            }
            if frame > request.frame {
                state.waiting.insert(frame, planes);
                if state.waiting.len() > MAX_WAITING {
                    state.waiting.pop_last();
                }
            } else if frame >= request.keep_from {
                sink(frame, finish(planes, &self.index));
            }
        }
        self.keep(state, request.frame);
        found.map(|planes| finish(planes, &self.index))
    }

    /// A running decoder that has not gone past `target` yet, or still has its frame: the one that runs, or a new one
    /// at the key before.
    fn state_for(&mut self, frame: usize, target: usize) -> Result<DecoderState, String> {
        let Decoder::H264 { head, state } = &mut self.decoder else { return Err("not H.264".to_owned()) };
        let (head, running) = (*head, state.take().map(|state| *state));
        if let Some(state) = running {
            if state.waiting.contains_key(&frame) {
                return Ok(state);
            }
            // Reading on is shorter than going to a key that lies no further ahead.
            let goes_on = |key: usize| state.next <= target && key <= state.next;
            if goes_on(self.index.key_before(target)) || goes_on(self.key(target, head)?) {
                return Ok(state);
            }
        }
        let key = self.key(target, head)?;
        self.state_at(key, head)
    }

    fn state_at(&self, key: usize, head: StreamHeader) -> Result<DecoderState, String> {
        let stream = Stream::new(&self.index.config, head)?;
        let sound_from = if key == 0 { i64::MIN } else { self.index.samples[key].shown };
        Ok(DecoderState { stream, next: key, sound_from, waiting: BTreeMap::new() })
    }

    /// The key at which to begin for `target`: what the container calls one is looked at first.
    fn key(&mut self, target: usize, head: StreamHeader) -> Result<usize, String> {
        let mut key = self.index.key_before(target);
        while key > 0 && !h264::can_begin(&self.sample(key)?, head) {
            self.index.samples[key].key = false;
            key = self.index.key_before(target);
        }
        Ok(key)
    }

    /// Keeps the decoder for the frames that follow.
    fn keep(&mut self, mut running: DecoderState, frame: usize) {
        running.waiting = running.waiting.split_off(&frame);
        if let Decoder::H264 { state, .. } = &mut self.decoder {
            *state = Some(Box::new(running));
        }
    }
}

/// The decoder for an index; puts the pictures' own size into it.
fn decoder(file: &mut FileParts, path: &Path, index: &mut Index) -> Result<Decoder, String> {
    let mut read = |sample: &Sample| {
        file.read_up_to(sample.offset, sample.size as usize).map_err(|error| crate::reason(&error))
    };
    let Some(first) = index.samples.first() else { return Err("no pictures".to_owned()) };
    match index.codec {
        Codec::H264 => {
            let head = StreamHeader::new(&index.config, &read(first)?, index.colour)?;
            index.size = head.size;
            Ok(Decoder::H264 { head, state: None })
        }
        Codec::Jpeg => {
            // The first one may be damaged.
            let mut sizes =
                index.samples.iter().take(MAX_DAMAGED_FIRST).map(|sample| {
                    images::size(path, &read(sample)?).map_err(|error| error.problem.to_string())
                });
            let first = sizes.next().unwrap_or_else(|| Err(String::new()));
            index.size = first.or_else(|error| sizes.find_map(Result::ok).ok_or(error))?;
            Ok(Decoder::Jpeg)
        }
        Codec::Other(_) => Err(String::new()),
    }
}
