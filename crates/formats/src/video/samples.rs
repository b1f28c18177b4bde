//! The samples of a track: the tables of `stbl` (sizes, places, times, keys), and those of movie fragments (`moof`), which
//! are not in these tables.

use std::iter::repeat_n;

use super::boxes::{Boxes, Fields, find};
use super::index::Sample;

/// All samples that the tables place, at most `limit`.
pub(super) fn of_tables(table: &[u8], limit: usize) -> Vec<Sample> {
    let sizes = sizes(table, limit);
    let offsets = offsets(table, &sizes);
    let keys = find(table, &[b"stss"]).map(|body| column(body).collect::<Vec<u32>>());
    let mut decoded = runs(table, b"stts").scan(0_i64, |at, step| {
        let now = *at;
        *at = at.saturating_add(i64::from(step));
        Some(now)
    });
    let mut later = runs(table, b"ctts").map(|offset| i64::from(offset.cast_signed()));
    let mut next_key = 0;
    let mut last = 0;
    let mut samples = Vec::with_capacity(offsets.len());
    for (k, (&offset, &size)) in offsets.iter().zip(&sizes).enumerate() {
        // Where the times end too early the order stays at least.
        last = decoded.next().unwrap_or(last + 1);
        let key = keys.as_ref().is_none_or(|keys| {
            while keys.get(next_key).is_some_and(|&key| (key as usize) < k + 1) {
                next_key += 1;
            }
            keys.get(next_key).is_some_and(|&key| key as usize == k + 1)
        });
        samples.push(Sample { offset, size, key, shown: last.saturating_add(later.next().unwrap_or(0)) });
    }
    samples
}

/// Numbers of a full box that has a count and one column of 32 bits, as many as there are.
fn column(body: &[u8]) -> impl Iterator<Item = u32> + use<'_> {
    let rest = body.get(8..).unwrap_or_default();
    let count = Fields(body.get(4..).unwrap_or_default()).u32().unwrap_or(0) as usize;
    rest.as_chunks().0.iter().take(count).map(|bytes| u32::from_be_bytes(*bytes))
}

/// Values of a table of runs (`stts`, `ctts`): count and value.
fn runs<'a>(table: &'a [u8], kind: &[u8; 4]) -> impl Iterator<Item = u32> + use<'a> {
    let body = find(table, &[kind]).unwrap_or_default();
    let mut fields = Fields(body.get(8..).unwrap_or_default());
    std::iter::from_fn(move || Some((fields.u32()?, fields.u32()?)))
        .flat_map(|(count, value)| repeat_n(value, count as usize))
}

/// The samples' sizes, bytes.
fn sizes(table: &[u8], limit: usize) -> Vec<u64> {
    let Some(body) = find(table, &[b"stsz"]) else { return Vec::new() };
    let mut fields = Fields(body.get(4..).unwrap_or_default());
    let (Some(all), Some(count)) = (fields.u32(), fields.u32()) else { return Vec::new() };
    let count = limit.min(count as usize);
    if all > 0 {
        return vec![u64::from(all); count];
    }
    std::iter::from_fn(|| fields.u32().map(u64::from)).take(count).collect()
}

/// The samples' places: chunks (`stco`, `co64`) hold as many samples as `stsc` says, one after the other.
fn offsets(table: &[u8], sizes: &[u64]) -> Vec<u64> {
    let chunks: Box<dyn Iterator<Item = u64>> = match find(table, &[b"stco"]) {
        Some(body) => Box::new(column(body).map(u64::from)),
        None => {
            let body = find(table, &[b"co64"]).and_then(|body| body.get(8..)).unwrap_or_default();
            Box::new(body.as_chunks().0.iter().map(|bytes| u64::from_be_bytes(*bytes)))
        }
    };
    let mut fields = Fields(find(table, &[b"stsc"]).and_then(|body| body.get(8..)).unwrap_or_default());
    let mut runs = std::iter::from_fn(|| {
        let run = (fields.u32()?, fields.u32()?);
        fields.skip(4)?;
        Some(run)
    })
    .peekable();
    let mut offsets = Vec::with_capacity(sizes.len());
    let mut per_chunk = 0;
    for (chunk, mut offset) in (1_u32..).zip(chunks) {
        while let Some((_, count)) = runs.next_if(|&(first, _)| first <= chunk) {
            per_chunk = count as usize;
        }
        let left = sizes.len() - offsets.len();
        if left == 0 {
            break;
        }
        for _ in 0..per_chunk.min(left) {
            offsets.push(offset);
            offset = offset.saturating_add(sizes[offsets.len() - 1]);
        }
    }
    offsets
}

/// `sample_is_non_sync_sample`.
const NOT_KEY: u32 = 0x0001_0000;

/// What a fragment's runs take where they say nothing themselves.
#[derive(Debug, Clone, Copy, Default)]
struct Defaults {
    duration: u32,
    size: u32,
    flags: u32,
}

/// Appends the samples of a track's fragments; at most `limit` in all.
pub(super) fn append_fragments(
    samples: &mut Vec<Sample>,
    movie: &[u8],
    fragments: &[(u64, Vec<u8>)],
    track: u32,
    limit: usize,
) {
    let extends = find(movie, &[b"mvex"]).unwrap_or_default();
    let of_track =
        Boxes(extends).filter(|(kind, _)| kind == b"trex").find_map(|(_, body)| defaults(body, track));
    let defaults = of_track.unwrap_or_default();
    let mut time = 0;
    for (at, fragment) in fragments {
        let mut data = *at;
        for (_, body) in Boxes(fragment).filter(|(kind, _)| kind == b"traf") {
            let mut traf = Traf { at: *at, data, time, defaults };
            if traf.read(body, track, samples, limit).is_some() {
                time = traf.time;
            }
            data = traf.data;
        }
    }
}

fn defaults(body: &[u8], track: u32) -> Option<Defaults> {
    let mut fields = Fields(body);
    fields.version_and_flags()?;
    if fields.u32()? != track {
        return None;
    }
    fields.skip(4)?;
    Some(Defaults { duration: fields.u32()?, size: fields.u32()?, flags: fields.u32()? })
}

/// One track's part of a fragment.
#[derive(Debug)]
struct Traf {
    /// Where the fragment begins in the file.
    at: u64,
    /// Where the next sample lies.
    data: u64,
    /// When it is decoded, ticks.
    time: i64,
    defaults: Defaults,
}

impl Traf {
    /// Reads the runs; `None` if it is another track's.
    fn read(&mut self, body: &[u8], track: u32, samples: &mut Vec<Sample>, limit: usize) -> Option<()> {
        let mut head = Fields(find(body, &[b"tfhd"])?);
        let (_, flags) = head.version_and_flags()?;
        if head.u32()? != track {
            return None;
        }
        if flags & 0x1 != 0 {
            self.data = head.u64()?;
            self.at = self.data;
        } else if flags & 0x2_0000 != 0 {
            self.data = self.at;
        }
        if flags & 0x2 != 0 {
            head.skip(4)?;
        }
        for (flag, value) in [
            (0x8, &mut self.defaults.duration),
            (0x10, &mut self.defaults.size),
            (0x20, &mut self.defaults.flags),
        ] {
            if flags & flag != 0 {
                *value = head.u32()?;
            }
        }
        if let Some(body) = find(body, &[b"tfdt"]) {
            let mut fields = Fields(body);
            let (version, _) = fields.version_and_flags()?;
            self.time = fields.long(version)?.cast_signed();
        }
        for (_, run) in Boxes(body).filter(|(kind, _)| kind == b"trun") {
            self.run(run, samples, limit)?;
        }
        Some(())
    }

    fn run(&mut self, body: &[u8], samples: &mut Vec<Sample>, limit: usize) -> Option<()> {
        let mut fields = Fields(body);
        let (_, flags) = fields.version_and_flags()?;
        let count = fields.u32()?;
        if flags & 0x1 != 0 {
            self.data = self.at.saturating_add_signed(i64::from(fields.i32()?));
        }
        let first_flags = if flags & 0x4 != 0 { Some(fields.u32()?) } else { None };
        for k in 0..count {
            if samples.len() >= limit {
                break;
            }
            let mut value =
                |flag: u32, default: u32| if flags & flag != 0 { fields.u32() } else { Some(default) };
            let duration = value(0x100, self.defaults.duration)?;
            let size = u64::from(value(0x200, self.defaults.size)?);
            let own = value(0x400, self.defaults.flags)?;
            let later = i64::from(value(0x800, 0)?.cast_signed());
            let key = if k == 0 { first_flags.unwrap_or(own) } else { own } & NOT_KEY == 0;
            samples.push(Sample { offset: self.data, size, key, shown: self.time.saturating_add(later) });
            self.data = self.data.saturating_add(size);
            self.time = self.time.saturating_add(i64::from(duration));
        }
        Some(())
    }
}
