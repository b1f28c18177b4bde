//! A zip archive whose files are stored as they are, as `numpy.savez` makes it.

use crate::FileProblem;

/// Table of the cyclic redundancy check with the polynomial 0xEDB88320.
const TABLE: [u32; 256] = table();

const fn table() -> [u32; 256] {
    let mut table = [0; 256];
    let mut byte = 0;
    while byte < 256 {
        let mut value = byte as u32;
        let mut bit = 0;
        while bit < 8 {
            value = if value & 1 == 1 { 0xedb8_8320 ^ (value >> 1) } else { value >> 1 };
            bit += 1;
        }
        table[byte] = value;
        byte += 1;
    }
    table
}

fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |sum, &byte| TABLE[((sum ^ u32::from(byte)) & 0xff) as usize] ^ (sum >> 8))
}

fn u32_of(bytes: usize) -> Result<u32, FileProblem> {
    u32::try_from(bytes).ok().ok_or_else(|| FileProblem::Field {
        field: "frames".to_owned(),
        found: format!("so many that they fill {bytes} bytes"),
        expected: "less than 4 GiB".to_owned(),
    })
}

/// An archive of these files.
///
/// # Errors
/// More than 4 GiB.
pub(super) fn store(files: &[(&str, Vec<u8>)]) -> Result<Vec<u8>, FileProblem> {
    let (mut out, mut directory) = (Vec::new(), Vec::new());
    for (name, content) in files {
        let (size, offset) = (u32_of(content.len())?, u32_of(out.len())?);
        // Version 2.0, no flags, stored, and the first day that a zip can name.
        let mut about = Vec::new();
        for value in [20_u16, 0, 0, 0, 0x21] {
            about.extend(value.to_le_bytes());
        }
        for value in [crc32(content), size, size] {
            about.extend(value.to_le_bytes());
        }
        about.extend((name.len() as u16).to_le_bytes());
        about.extend([0, 0]);
        out.extend(b"PK\x03\x04");
        out.extend(&about);
        out.extend(name.as_bytes());
        out.extend(content);
        directory.extend(b"PK\x01\x02\x14\x00");
        directory.extend(&about);
        directory.extend([0; 10]); // no comment, first disk, no attributes
        directory.extend(offset.to_le_bytes());
        directory.extend(name.as_bytes());
    }
    let (offset, size, count) = (u32_of(out.len())?, u32_of(directory.len())?, files.len() as u16);
    out.extend(directory);
    out.extend(b"PK\x05\x06\x00\x00\x00\x00");
    out.extend(count.to_le_bytes());
    out.extend(count.to_le_bytes());
    out.extend(size.to_le_bytes());
    out.extend(offset.to_le_bytes());
    out.extend([0, 0]);
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_check_is_the_known_one() {
        assert_eq!(crc32(b"123456789"), 0xcbf4_3926);
    }
}
