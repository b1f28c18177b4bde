//! Edit lists (`elst`): which part of a track is shown, and when.

use super::boxes::Fields;

/// Most edits that are read.
const MAX_EDITS: u32 = 1024;

/// One edit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Edit {
    /// The track's tick at which it begins; `None` is a pause.
    pub(super) begins: Option<i64>,
    /// How long it lasts, in ticks of the movie.
    pub(super) lasts: u64,
}

/// The edits of an `elst` box, as far as it goes.
pub(super) fn read(body: &[u8]) -> Vec<Edit> {
    let mut fields = Fields(body);
    let mut edits = Vec::new();
    let Some(((version, _), count)) = fields.version_and_flags().zip(fields.u32()) else { return edits };
    for _ in 0..count.min(MAX_EDITS) {
        let Some(edit) = one(&mut fields, version) else { break };
        edits.push(edit);
    }
    edits
}

fn one(fields: &mut Fields<'_>, version: u8) -> Option<Edit> {
    let lasts = fields.long(version)?;
    let begins = if version == 1 { fields.u64()?.cast_signed() } else { i64::from(fields.i32()?) };
    fields.skip(4)?;
    Some(Edit { begins: (begins >= 0).then_some(begins), lasts })
}
