//! H.264 pictures of an index, decoded in pure Rust.

use std::panic::{AssertUnwindSafe, catch_unwind};

use rust_h264::decoder::{ChromaFormat, Decoder, Frame};
use rust_h264::nal::{NalUnit, NalUnitType, SpsInfo, parse_avcc, parse_avcc_config, parse_sps_info};

use super::yuv::{Colour, Planes};

/// Most pixels of a picture: level 6.2.
const MAX_PIXELS: u64 = 139_264 * 256;
/// Most pixels of all pictures that a decoder may have to keep: level 6.2.
const MAX_KEPT_PIXELS: u64 = 696_320 * 256;

/// What a stream's head says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct StreamHeader {
    pub(super) size: [usize; 2],
    pub(super) colour: Colour,
    length_size: usize,
}

impl StreamHeader {
    /// From the container's configuration, or the first sample if the configuration has no parameter sets (`avc3`).
    pub(super) fn new(config: &[u8], first: &[u8], said: Option<Colour>) -> Result<Self, String> {
        let parsed = parse_avcc_config(config).map_err(str::to_owned)?;
        let inside = parse_avcc(first, parsed.length_size);
        let sets: Vec<&NalUnit<'_>> =
            parsed.sps_nals.iter().chain(&inside).filter(|nal| is_sps(nal)).collect();
        let Some(set) = sets.first() else { return Err("no sequence parameter set".to_owned()) };
        let info = supported(set)?;
        let said = said.unwrap_or_default();
        let matrix = if info.matrix == 2 { said.matrix } else { info.matrix };
        let colour = Colour { matrix, full_range: info.full_range || said.full_range };
        let head = Self {
            size: [info.width as usize, info.height as usize],
            colour,
            length_size: parsed.length_size,
        };
        // Parameter sets that the decoder does not know how to read are told now.
        Stream::new(config, head)?;
        Ok(head)
    }
}

/// Whether all that is shown from this sample on can be decoded without what comes before: it has an IDR picture, or
/// says that recovery is immediate.
pub(super) fn can_begin(sample: &[u8], head: StreamHeader) -> bool {
    parse_avcc(sample, head.length_size).iter().any(|nal| match nal.nal_unit_type {
        NalUnitType::SliceIdr => true,
        NalUnitType::Sei => recovers_at_once(&nal.rbsp),
        _ => false,
    })
}

/// Whether no other picture is made from this one: `nal_ref_idc` of all its slices is 0 (7.4.1). Parameter sets are kept.
fn is_disposable(sample: &[u8], length_size: usize) -> bool {
    let (mut rest, mut has_slice) = (sample, false);
    while let Some((length, after)) = rest.split_at_checked(length_size).filter(|_| !rest.is_empty()) {
        let length = length.iter().fold(0, |length, byte| length << 8 | usize::from(*byte));
        let Some((nal, following)) = after.split_at_checked(length) else { return false };
        let Some(head) = nal.first() else { return false };
        match (head & 0x1F, head & 0x60) {
            (1..=5, 0) => has_slice = true,
            (1..=5 | 7 | 8, _) => return false,
            _ => {}
        }
        rest = following;
    }
    has_slice && rest.is_empty()
}

/// Looks for a recovery point among SEI messages (H.264, 7.3.2.3.1 and D.1.8) whose `recovery_frame_cnt` is 0.
fn recovers_at_once(mut rest: &[u8]) -> bool {
    const RECOVERY_POINT: usize = 6;
    let number = |rest: &mut &[u8]| {
        let mut sum = 0;
        while let Some((&byte, after)) = rest.split_first() {
            *rest = after;
            sum += usize::from(byte);
            if byte < 255 {
                return Some(sum);
            }
        }
        None
    };
    while let (Some(kind), Some(size)) = (number(&mut rest), number(&mut rest)) {
        if kind == RECOVERY_POINT {
            return rest.first().is_some_and(|byte| byte & 0x80 != 0);
        }
        let Some(after) = rest.get(size..) else { return false };
        rest = after;
    }
    false
}

fn is_sps(nal: &NalUnit<'_>) -> bool {
    nal.nal_unit_type == NalUnitType::Sps
}

/// What a parameter set says, if the decoder can decode it and it asks for no more memory than any level allows.
fn supported(set: &NalUnit<'_>) -> Result<SpsInfo, String> {
    let info = quietly(|| parse_sps_info(set))?.map_err(|error| error.to_string())?;
    let depths = (info.bit_depth_luma, info.bit_depth_chroma);
    let same_depth = info.chroma_format == 0 || depths.0 == depths.1;
    if info.chroma_format > 2 || !matches!(depths.0, 8 | 10) || !same_depth {
        return Err(format!("chroma format {} with {} bits", info.chroma_format, depths.0));
    }
    let pixels = u64::from(info.coded_width) * u64::from(info.coded_height);
    let kept = pixels.saturating_mul(u64::from(info.reference_frames.max(1)));
    if info.width == 0 || info.height == 0 || pixels > MAX_PIXELS || kept > MAX_KEPT_PIXELS {
        return Err(format!(
            "{}×{} pixels with {} reference pictures",
            info.coded_width, info.coded_height, info.reference_frames
        ));
    }
    Ok(info)
}

/// The decoder is young: should it panic on damaged data, that is this picture's failure.
fn quietly<T>(run: impl FnOnce() -> T) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(run)).map_err(|_panic| "the decoder gave up".to_owned())
}

/// A decoder with its state.
pub(super) struct Stream {
    decoder: Decoder,
    head: StreamHeader,
}

impl std::fmt::Debug for Stream {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Stream").field("head", &self.head).finish_non_exhaustive()
    }
}

impl Stream {
    /// A decoder that knows the container's parameter sets and no picture yet.
    pub(super) fn new(config: &[u8], head: StreamHeader) -> Result<Self, String> {
        let mut stream = Self { decoder: Decoder::new(), head };
        let config = parse_avcc_config(config).map_err(str::to_owned)?;
        for nal in config.sps_nals.iter().chain(&config.pps_nals) {
            stream.feed(nal)?;
        }
        Ok(stream)
    }

    fn feed(&mut self, nal: &NalUnit<'_>) -> Result<Option<Frame>, String> {
        if is_sps(nal) {
            let info = supported(nal)?;
            if [info.width as usize, info.height as usize] != self.head.size {
                return Err("the size of the picture changes".to_owned());
            }
        }
        quietly(|| self.decoder.decode_nal(nal))?.map_err(|error| error.to_string())
    }

    /// Whether the next sample need not be decoded where nobody wants its picture.
    pub(super) fn can_skip(&self, sample: &[u8]) -> bool {
        is_disposable(sample, self.head.length_size)
    }

    /// Decodes the next sample, in the order of decoding. Beside a picture may stand what is wrong with it.
    pub(super) fn decode(&mut self, sample: &[u8]) -> Result<(Planes, Option<String>), String> {
        let mut problem = None;
        let mut frame = None;
        let nals = parse_avcc(sample, self.head.length_size);
        for nal in &nals {
            match self.feed(nal) {
                Ok(found) => frame = frame.or(found),
                Err(error) => problem = problem.or(Some(error)),
            }
        }
        // A sample is one picture, so nothing is waited for.
        frame = quietly(|| self.decoder.flush())?.or(frame);
        match (frame, problem) {
            (Some(frame), problem) => Ok((planes(frame, self.head)?, problem)),
            (None, Some(problem)) => Err(problem),
            (None, None) => Err("it holds no picture".to_owned()),
        }
    }
}

fn planes(frame: Frame, head: StreamHeader) -> Result<Planes, String> {
    let depth = frame.bit_depth;
    let bytes = |plane: Vec<u8>| {
        if depth == 8 {
            return plane;
        }
        // 10 bits, two bytes each.
        let level = |pair: &[u8; 2]| (u16::from_le_bytes(*pair).saturating_add(2) >> 2).min(255) as u8;
        plane.as_chunks().0.iter().map(level).collect()
    };
    let planes = Planes {
        size: [frame.width as usize, frame.height as usize],
        shift: [1, u32::from(frame.chroma_format == ChromaFormat::Yuv420)],
        planes: [bytes(frame.y), bytes(frame.u), bytes(frame.v)],
        colour: head.colour,
    };
    if planes.size != head.size || !planes.is_sound() {
        return Err(format!("its picture has {}×{} pixels", planes.size[0], planes.size[1]));
    }
    Ok(planes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_of_which_others_are_made_are_kept() {
        let sample = |nals: &[&[u8]]| -> Vec<u8> {
            nals.iter().flat_map(|nal| [&[0, 0, 0, nal.len() as u8], *nal].concat()).collect()
        };
        let (slice, reference, message, set) = ([0x01, 9], [0x41, 9], [0x06, 1], [0x67, 2]);
        assert!(is_disposable(&sample(&[&message, &slice, &slice]), 4));
        for kept in [&[&slice[..], &reference][..], &[&reference], &[&set, &slice], &[&message], &[]] {
            assert!(!is_disposable(&sample(kept), 4), "{kept:?}");
        }
        let whole = sample(&[&slice]);
        (0..whole.len()).for_each(|end| assert!(!is_disposable(&whole[..end], 4), "cut at {end}"));
        assert!(!is_disposable(&[0, 0, 0, 0], 4) && !is_disposable(&whole, 9));
    }
}
