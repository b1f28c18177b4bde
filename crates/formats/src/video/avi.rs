//! The index of AVI files (RIFF), made from the chunks themselves: a lost or wrong `idx1` does no harm.

use super::index::{Codec, Index, IndexFrame, Sample};
use super::{MAX_VIDEO_FRAMES, VideoProblem};
use crate::files::FileParts;

/// Most bytes of headers that are read.
const MAX_HEADER_BYTES: u64 = 1 << 20;

/// Little-endian 32 bits at a place.
fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    bytes.get(at..)?.first_chunk().map(|bytes| u32::from_le_bytes(*bytes))
}

/// Chunks of a list in memory: letters and content, cut where the bytes end.
fn chunks(mut rest: &[u8]) -> impl Iterator<Item = ([u8; 4], &[u8])> {
    std::iter::from_fn(move || {
        let kind = *rest.first_chunk()?;
        let size = u32_at(rest, 4)? as usize;
        let body = rest.get(8..)?;
        let body = &body[..size.min(body.len())];
        rest = rest.get(8 + size + size % 2..).unwrap_or_default();
        Some((kind, body))
    })
}

/// What the headers say of the first video stream.
#[derive(Debug, Default)]
struct Header {
    stream: usize,
    index: Index,
    seconds_per_frame: f64,
    begins: f64,
}

/// The index of a file that begins with `RIFF` and `AVI `.
pub(super) fn index(file: &mut FileParts) -> Result<Index, VideoProblem> {
    let read = |error| VideoProblem::Read { error };
    let mut header: Option<Header> = None;
    let mut frame = 0_u64;
    let mut at = 0;
    let mut cut = false;
    let mut ends = Vec::new();
    while at < file.length() {
        let head = file.read_up_to(at, 12).map_err(read)?;
        let (Some(kind), Some(size)) = (head.first_chunk::<4>(), u32_at(&head, 4).map(u64::from)) else {
            break;
        };
        let letters = head.get(8..12).unwrap_or_default();
        let next = at + 8 + size + size % 2;
        match (kind, letters) {
            // What is inside follows at once.
            (b"RIFF", b"AVI " | b"AVIX") | (b"LIST", b"movi" | b"rec ") => {
                if letters != b"rec " {
                    ends.push(at + 8 + size);
                }
                at += 12;
                continue;
            }
            (b"LIST", b"hdrl") => {
                let body = file.read_up_to(at + 12, size.min(MAX_HEADER_BYTES) as usize).map_err(read)?;
                header = Some(video_stream(&body).ok_or(VideoProblem::NoVideo)?);
            }
            _ => {
                if let Some(header) = header.as_mut().filter(|header| header.owns(*kind)) {
                    header.push(at + 8, size, frame);
                    frame += 1;
                }
            }
        }
        if header.as_ref().is_some_and(|header| header.index.frames.len() > MAX_VIDEO_FRAMES) {
            break;
        }
        at = next;
    }
    // Files without a size were never finished.
    cut |= ends.iter().any(|&end| end > file.length());
    let mut index = header.ok_or(VideoProblem::NoIndex)?.index;
    if cut && index.samples.last().is_some_and(|last| last.offset + last.size <= file.length()) {
        index.notes.push(format!("the file ends too early, after {} frames", index.samples.len()));
    }
    Ok(index)
}

impl Header {
    /// Whether a chunk is a picture of this stream: its number, then `dc` or `db`.
    fn owns(&self, kind: [u8; 4]) -> bool {
        let [tens, ones, rest @ ..] = kind;
        let number = [tens, ones].map(|digit| digit.wrapping_sub(b'0'));
        number.iter().all(|&digit| digit < 10)
            && usize::from(number[0]) * 10 + usize::from(number[1]) == self.stream
            && (&rest == b"dc" || &rest == b"db")
    }

    /// A picture; an empty one means that the one before it stays.
    fn push(&mut self, offset: u64, size: u64, frame: u64) {
        if size == 0 {
            return;
        }
        let seconds = self.begins + frame as f64 * self.seconds_per_frame;
        self.index.frames.push(IndexFrame { sample: self.index.samples.len(), seconds });
        self.index.samples.push(Sample { offset, size, key: true, shown: frame as i64 });
    }
}

fn video_stream(headers: &[u8]) -> Option<Header> {
    let streams = chunks(headers).filter(|(kind, body)| kind == b"LIST" && body.starts_with(b"strl"));
    for (stream, (_, list)) in streams.enumerate() {
        let part =
            |request: &[u8; 4]| chunks(&list[4..]).find(|(kind, _)| kind == request).map(|(_, body)| body);
        let (Some(head), Some(format)) = (part(b"strh"), part(b"strf")) else { continue };
        if !head.starts_with(b"vids") {
            continue;
        }
        let (scale, rate, start) = (u32_at(head, 20)?, u32_at(head, 24)?, u32_at(head, 28)?);
        let seconds_per_frame =
            if scale > 0 && rate > 0 { f64::from(scale) / f64::from(rate) } else { 1.0 / 25.0 };
        let size = [u32_at(format, 4)?, u32_at(format, 8)?.cast_signed().unsigned_abs()];
        let index = Index {
            codec: Codec::of_letters(*format.get(16..)?.first_chunk()?),
            size: size.map(|side| side as usize),
            ..Index::default()
        };
        return Some(Header {
            stream,
            index,
            seconds_per_frame,
            begins: f64::from(start) * seconds_per_frame,
        });
    }
    None
}
