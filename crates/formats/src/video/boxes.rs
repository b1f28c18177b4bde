//! Boxes of an ISO media file (ISO/IEC 14496-12) and big-endian fields, from bytes that may be cut or wrong.

use crate::files::FileParts;

/// Most bytes of an index that are read.
const MAX_INDEX_BYTES: u64 = 256 << 20;

/// Children of a box. Ends where no whole header is; a box that says to be longer than what is there is cut.
#[derive(Debug, Clone, Copy)]
pub(super) struct Boxes<'a>(pub(super) &'a [u8]);

impl<'a> Iterator for Boxes<'a> {
    type Item = ([u8; 4], &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        let mut fields = Fields(self.0);
        let short = fields.u32()?;
        let kind = fields.letters()?;
        let (header, size) = match short {
            0 => (8, self.0.len()),
            1 => (16, usize::try_from(fields.u64()?).ok()?),
            size => (8, size as usize),
        };
        let size = size.min(self.0.len());
        let body = self.0.get(header..size)?;
        self.0 = &self.0[size..];
        Some((kind, body))
    }
}

/// The first box at the end of a path of kinds.
pub(super) fn find<'a>(body: &'a [u8], path: &[&[u8; 4]]) -> Option<&'a [u8]> {
    path.iter()
        .try_fold(body, |body, &kind| Boxes(body).find(|(found, _)| found == kind).map(|(_, body)| body))
}

/// Big-endian numbers, one after the other. `None` where the bytes end.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fields<'a>(pub(super) &'a [u8]);

impl<'a> Fields<'a> {
    pub(super) fn skip(&mut self, bytes: usize) -> Option<()> {
        self.0 = self.0.get(bytes..)?;
        Some(())
    }

    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (first, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*first)
    }

    pub(super) fn letters(&mut self) -> Option<[u8; 4]> {
        self.array()
    }

    pub(super) fn u8(&mut self) -> Option<u8> {
        self.array().map(u8::from_be_bytes)
    }

    pub(super) fn u16(&mut self) -> Option<u16> {
        self.array().map(u16::from_be_bytes)
    }

    pub(super) fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_be_bytes)
    }

    pub(super) fn i32(&mut self) -> Option<i32> {
        self.array().map(i32::from_be_bytes)
    }

    pub(super) fn u64(&mut self) -> Option<u64> {
        self.array().map(u64::from_be_bytes)
    }

    /// 64 bits in version 1 of a box, 32 in version 0.
    pub(super) fn long(&mut self, version: u8) -> Option<u64> {
        if version == 1 { self.u64() } else { self.u32().map(u64::from) }
    }

    /// Version and flags, which begin a full box.
    pub(super) fn version_and_flags(&mut self) -> Option<(u8, u32)> {
        let word = self.u32()?;
        Some(((word >> 24) as u8, word & 0x00FF_FFFF))
    }
}

/// The boxes of a file that make its index, and whether the index is whole.
#[derive(Debug, Default)]
pub(super) struct FileIndex {
    pub(super) movie: Option<Vec<u8>>,
    /// Fragments, with their places in the file.
    pub(super) fragments: Vec<(u64, Vec<u8>)>,
    /// The index is there but ends too early.
    pub(super) cut: bool,
}

/// Finds the index among a file's outermost boxes; pictures are not read.
pub(super) fn read_index(file: &mut FileParts) -> std::io::Result<FileIndex> {
    let mut found = FileIndex::default();
    let (mut at, mut budget) = (0, MAX_INDEX_BYTES);
    while at < file.length() {
        let header = file.read_up_to(at, 16)?;
        let mut fields = Fields(&header);
        let (Some(short), Some(kind)) = (fields.u32(), fields.letters()) else { break };
        let (head, size) = match (short, fields.u64()) {
            (0, _) => (8, file.length() - at),
            (1, Some(size)) => (16, size),
            (1, None) => break,
            (size, _) => (8, u64::from(size)),
        };
        if size < head {
            break;
        }
        if kind == *b"moov" || kind == *b"moof" {
            let there = size.min(file.length() - at);
            if there > budget {
                break;
            }
            budget -= there;
            let body = file.read_up_to(at + head, (there - head) as usize)?;
            found.cut |= there < size;
            if kind == *b"moof" {
                found.fragments.push((at, body));
            } else if found.movie.is_none() {
                found.movie = Some(body);
            }
        }
        let Some(next) = at.checked_add(size) else { break };
        at = next;
    }
    Ok(found)
}
