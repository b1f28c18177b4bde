//! Movie fragments (`moof`): samples that are not in the tables of the `moov` box.

use super::boxes::{Boxes, Fields, find};
use super::index::Sample;

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
pub(super) fn append(
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
