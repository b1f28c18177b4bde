//! The index of MP4 and MOV files (ISO/IEC 14496-12): tables of samples, fragments, edit lists, the track's
//! matrix. Read by ourselves because files may be cut or hostile: every number is checked, nothing is allocated by
//! what a file says alone, and one odd track or box does not spoil the rest.

use super::boxes::{Boxes, Fields, FileIndex, find};
use super::index::{Codec, Index, IndexFrame, Sample};
use super::orientation::Orientation;
use super::samples;
use super::yuv::Colour;
use super::{MAX_VIDEO_FRAMES, VideoProblem};

/// Bytes of a video sample entry before its boxes.
const SAMPLE_ENTRY_BYTES: usize = 78;

/// The index of the file's longest video track.
pub(super) fn index(file: &FileIndex) -> Result<Index, VideoProblem> {
    let Some(movie) = &file.movie else { return Err(VideoProblem::NoIndex) };
    let movie_ticks = find(movie, &[b"mvhd"]).and_then(ticks_per_second);
    let mut best: Option<Index> = None;
    for (kind, body) in Boxes(movie) {
        if kind != *b"trak" {
            continue;
        }
        let Some(track) = track(body, movie, file, movie_ticks)? else { continue };
        if best.as_ref().is_none_or(|best| best.samples.len() < track.samples.len()) {
            best = Some(track);
        }
    }
    match best {
        Some(mut index) => {
            if file.cut {
                index.notes.push("the index is cut off; frames may be missing".to_owned());
            }
            Ok(index)
        }
        None if file.cut => Err(VideoProblem::NoIndex),
        None => Err(VideoProblem::NoVideo),
    }
}

/// A video track; `None` for sound, texts and what has no description.
fn track(
    body: &[u8],
    movie: &[u8],
    file: &FileIndex,
    movie_ticks: Option<u32>,
) -> Result<Option<Index>, VideoProblem> {
    let Some(media) = find(body, &[b"mdia"]) else { return Ok(None) };
    if find(media, &[b"hdlr"]).and_then(|handler| handler.get(8..12)) != Some(b"vide") {
        return Ok(None);
    }
    let Some(table) = find(media, &[b"minf", b"stbl"]) else { return Ok(None) };
    let Some(mut index) = find(table, &[b"stsd"]).and_then(description) else { return Ok(None) };
    let ticks = find(media, &[b"mdhd"]).and_then(ticks_per_second).ok_or(VideoProblem::NoVideo)?;
    index.samples = samples::of_tables(table, MAX_VIDEO_FRAMES + 1);
    let head = find(body, &[b"tkhd"]);
    if let Some(id) = head.and_then(|head| header_after_times(head)?.u32()) {
        samples::append_fragments(&mut index.samples, movie, &file.fragments, id, MAX_VIDEO_FRAMES + 1);
    }
    index.orientation = head.and_then(orientation).unwrap_or_default();
    let edits = find(body, &[b"edts", b"elst"]).map(edits).unwrap_or_default();
    let movie_ticks = f64::from(movie_ticks.unwrap_or(ticks));
    index.frames = shown(&index.samples, &edits, f64::from(ticks), movie_ticks);
    Ok(Some(index))
}

/// Frames in the order in which they are shown: what the edits leave, from 0 s.
fn shown(samples: &[Sample], edits: &[Edit], ticks: f64, movie_ticks: f64) -> Vec<IndexFrame> {
    let mut order: Vec<usize> = (0..samples.len()).collect();
    order.sort_by_key(|&k| (samples[k].shown, k));
    let begin = order.first().map_or(0, |&k| samples[k].shown);
    let whole = [Edit { begins: Some(begin), lasts: 0 }];
    let edits = if edits.iter().any(|edit| edit.begins.is_some()) { edits } else { &whole };
    let mut frames = Vec::new();
    let mut at = 0.0;
    for edit in edits {
        let seconds = edit.lasts as f64 / movie_ticks;
        let Some(begins) = edit.begins else {
            at += seconds;
            continue;
        };
        // An edit that lasts 0 is one whose end was not known: all that follows.
        let lasts = if edit.lasts == 0 { f64::INFINITY } else { (seconds * ticks).round() };
        let first = order.partition_point(|&k| samples[k].shown < begins);
        for &sample in &order[first..] {
            let after = (samples[sample].shown - begins) as f64;
            if after >= lasts || frames.len() > MAX_VIDEO_FRAMES {
                break;
            }
            frames.push(IndexFrame { sample, seconds: at + after / ticks });
        }
        at += seconds;
    }
    frames
}

/// Ticks per second of `mvhd` and `mdhd`.
fn ticks_per_second(body: &[u8]) -> Option<u32> {
    header_after_times(body)?.u32().filter(|&ticks| ticks > 0)
}

/// Behind the two times with which `mvhd`, `mdhd` and `tkhd` begin.
fn header_after_times(body: &[u8]) -> Option<Fields<'_>> {
    let mut fields = Fields(body);
    let (version, _) = fields.version_and_flags()?;
    fields.long(version)?;
    fields.long(version)?;
    Some(fields)
}

/// How `tkhd` turns the picture.
fn orientation(body: &[u8]) -> Option<Orientation> {
    let version = *body.first()?;
    let mut fields = header_after_times(body)?;
    fields.skip(8)?;
    fields.long(version)?;
    fields.skip(16)?;
    let (a, b) = (fields.i32()?, fields.i32()?);
    fields.skip(4)?;
    let (c, d) = (fields.i32()?, fields.i32()?);
    Some(Orientation::of_matrix(a, b, c, d))
}

/// Codec, size and colours of a track's first description. `None` where there is none.
fn description(body: &[u8]) -> Option<Index> {
    let mut fields = Fields(body);
    fields.version_and_flags()?;
    let count = fields.u32()?;
    let (letters, entry) = Boxes(fields.0).next()?;
    let mut head = Fields(entry);
    head.skip(24)?;
    let size = [usize::from(head.u16()?), usize::from(head.u16()?)];
    let inner = entry.get(SAMPLE_ENTRY_BYTES..).unwrap_or_default();
    let codec = match Codec::of_letters(letters) {
        // Pictures may change their making on the way: not for us.
        codec if count > 1 => Codec::Other(format!("{} in several descriptions", codec.name())),
        codec => codec,
    };
    let config = find(inner, &[b"avcC"]).unwrap_or_default().to_vec();
    let colour = find(inner, &[b"colr"]).and_then(colour);
    Some(Index { codec, config, size, colour, ..Index::default() })
}

/// Matrix and range of a `colr` box.
fn colour(body: &[u8]) -> Option<Colour> {
    let mut fields = Fields(body);
    let kind = fields.letters()?;
    if kind != *b"nclx" && kind != *b"nclc" {
        return None;
    }
    fields.skip(4)?;
    let matrix = fields.u16()?;
    let full_range = kind == *b"nclx" && fields.u8()? & 0x80 != 0;
    Some(Colour { matrix: u8::try_from(matrix).unwrap_or(2), full_range })
}

/// Most edits that are read.
const MAX_EDITS: u32 = 1024;

/// One edit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Edit {
    /// The track's tick at which it begins; `None` is a pause.
    begins: Option<i64>,
    /// How long it lasts, in ticks of the movie.
    lasts: u64,
}

/// The edits of an `elst` box, as far as it goes.
fn edits(body: &[u8]) -> Vec<Edit> {
    let mut fields = Fields(body);
    let mut edits = Vec::new();
    let Some(((version, _), count)) = fields.version_and_flags().zip(fields.u32()) else { return edits };
    for _ in 0..count.min(MAX_EDITS) {
        let Some(edit) = edit(&mut fields, version) else { break };
        edits.push(edit);
    }
    edits
}

fn edit(fields: &mut Fields<'_>, version: u8) -> Option<Edit> {
    let lasts = fields.long(version)?;
    let begins = if version == 1 { fields.u64()?.cast_signed() } else { i64::from(fields.i32()?) };
    fields.skip(4)?;
    Some(Edit { begins: (begins >= 0).then_some(begins), lasts })
}
