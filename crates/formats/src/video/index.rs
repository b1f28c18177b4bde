//! What a container says of its video: where each coded picture lies and when it is shown.

use super::orientation::Orientation;
use super::yuv::Colour;
use super::{MAX_VIDEO_FRAMES, VideoProblem};

/// Largest coded picture, bytes.
pub(super) const MAX_SAMPLE_BYTES: u64 = 64 << 20;

/// A video's index. Frames are in the order in which they are shown; each names its sample.
#[derive(Debug, Clone, Default)]
pub(super) struct Index {
    pub(super) codec: Codec,
    /// The decoder's configuration, as the container has it (`avcC`).
    pub(super) config: Vec<u8>,
    /// Width and height that the container says, before it is turned.
    pub(super) size: [usize; 2],
    pub(super) orientation: Orientation,
    /// Colours, where the container says them.
    pub(super) colour: Option<Colour>,
    pub(super) samples: Vec<Sample>,
    pub(super) frames: Vec<IndexFrame>,
    /// What is missing.
    pub(super) notes: Vec<String>,
}

/// A coded picture, in the order of decoding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Sample {
    pub(super) offset: u64,
    pub(super) size: u64,
    /// Decoding can begin here.
    pub(super) key: bool,
    /// When it is shown, in the container's ticks.
    pub(super) shown: i64,
}

/// A frame: which sample, and when it is shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct IndexFrame {
    pub(super) sample: usize,
    pub(super) seconds: f64,
}

/// How pictures are coded.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Codec {
    H264,
    Jpeg,
    /// Another one, by its name.
    Other(String),
}

impl Default for Codec {
    fn default() -> Self {
        Self::Other("unknown".to_owned())
    }
}

impl Codec {
    /// From the four letters of a container.
    pub(super) fn of_letters(letters: [u8; 4]) -> Self {
        let name = match &letters {
            b"avc1" | b"avc3" | b"AVC1" | b"H264" | b"h264" | b"X264" | b"x264" => return Self::H264,
            b"jpeg" | b"mjpa" | b"MJPG" | b"mjpg" | b"JPEG" => return Self::Jpeg,
            b"hvc1" | b"hev1" | b"HEVC" => "HEVC",
            b"vp08" | b"VP80" => "VP8",
            b"vp09" | b"VP90" => "VP9",
            b"av01" | b"AV01" => "AV1",
            b"mp4v" | b"MP4V" | b"XVID" | b"xvid" | b"DIVX" | b"DX50" | b"FMP4" => "MPEG-4",
            b"apch" | b"apcn" | b"apcs" | b"apco" | b"ap4h" | b"ap4x" => "ProRes",
            b"encv" => "encrypted",
            _ => return Self::Other(format!("\"{}\"", letters.escape_ascii())),
        };
        Self::Other(name.to_owned())
    }

    pub(super) fn name(&self) -> &str {
        match self {
            Self::H264 => "H.264",
            Self::Jpeg => "Motion JPEG",
            Self::Other(name) => name,
        }
    }
}

impl Index {
    /// Leaves out what lies beyond the file's end, `length` bytes: the frames from the first missing one on.
    pub(super) fn cut_to(&mut self, length: u64) -> Result<(), VideoProblem> {
        let there = |sample: &Sample| {
            let end = sample.offset.checked_add(sample.size);
            sample.size <= MAX_SAMPLE_BYTES && end.is_some_and(|end| end <= length)
        };
        let whole = self.frames.len();
        // In the order of decoding nothing after the first missing sample can be trusted either.
        let first_missing = self.samples.iter().position(|sample| !there(sample));
        if let Some(missing) = first_missing {
            self.samples.truncate(missing);
            let count = self.frames.iter().take_while(|frame| frame.sample < missing).count();
            self.frames.truncate(count);
            self.notes.push(format!(
                "the file ends too early: of {whole} frames, those from {count} on are missing"
            ));
        }
        if self.frames.is_empty() {
            return Err(VideoProblem::NoFrames { whole });
        }
        if self.frames.len() > MAX_VIDEO_FRAMES {
            return Err(VideoProblem::TooManyFrames { limit: MAX_VIDEO_FRAMES });
        }
        Ok(())
    }

    /// The sample at which decoding must begin to get `sample`: no later one is a key that is shown no later.
    pub(super) fn key_before(&self, sample: usize) -> usize {
        let shown = self.samples[sample].shown;
        let key = |k: &usize| self.samples[*k].key && self.samples[*k].shown <= shown;
        (0..=sample).rev().find(key).unwrap_or(0)
    }
}

/// Kinds of files that hold videos.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Container {
    /// MP4, MOV.
    IsoMedia,
    Avi,
    /// One that we do not read ourselves.
    Foreign,
}

impl Container {
    /// Told by the file's first bytes.
    pub(super) fn of(head: &[u8]) -> Option<Self> {
        let at = |from: usize, letters: &[u8]| head.get(from..from + letters.len()) == Some(letters);
        let brands = [&b"ftyp"[..], b"moov", b"mdat", b"wide", b"free", b"skip", b"pnot", b"moof", b"styp"];
        let foreign = at(0, &[0x1A, 0x45, 0xDF, 0xA3]) // Matroska, WebM
            || at(0, b"OggS")
            || at(0, b"FLV\x01")
            || at(0, &[0x30, 0x26, 0xB2, 0x75, 0x8E, 0x66, 0xCF, 0x11]) // ASF, WMV
            || at(0, &[0, 0, 1, 0xBA]) // MPEG program stream
            || (at(0, &[0x47]) && at(188, &[0x47])) // MPEG transport stream
            || (at(4, &[0x47]) && at(196, &[0x47])); // the same with time codes (AVCHD)
        if brands.iter().any(|letters| at(4, letters)) {
            Some(Self::IsoMedia)
        } else if at(0, b"RIFF") && at(8, b"AVI ") {
            Some(Self::Avi)
        } else {
            foreign.then_some(Self::Foreign)
        }
    }
}
