//! The tables of a track's samples (`stbl`): sizes, places, times, keys.

use std::iter::repeat_n;

use super::boxes::{Fields, find};
use super::index::Sample;

/// All samples that the tables place, at most `limit`.
pub(super) fn samples(table: &[u8], limit: usize) -> Vec<Sample> {
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
