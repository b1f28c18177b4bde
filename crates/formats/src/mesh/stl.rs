//! STL: triangles with corners of their own, as text or binary.

use std::path::Path;

use glam::DVec3;

use super::{Cursor, MeshProblem, Soup, obj, wrong};
use crate::Result;
use crate::text::decode;

/// Title and count of a binary file, bytes; and a triangle.
const HEAD: usize = 84;
const TRIANGLE: usize = 50;

/// Triangles of the file. It is binary if its length is that of the count that it says.
pub(super) fn parse(path: &Path, bytes: &[u8]) -> Result<Soup> {
    let said = bytes.get(80..HEAD).and_then(|count| count.try_into().ok()).map(u32::from_le_bytes);
    let length = said.map(|count| HEAD as u64 + TRIANGLE as u64 * u64::from(count));
    let is_text = bytes.trim_ascii_start().starts_with(b"solid") && length != Some(bytes.len() as u64);
    if is_text { text(path, bytes) } else { binary(bytes).map_err(|error| wrong(path, error)) }
}

fn binary(bytes: &[u8]) -> Result<Soup, MeshProblem> {
    let mut cursor = Cursor { bytes, at: 80 };
    let count = u32::from_le_bytes(cursor.array(|| "the head of a binary STL".to_owned())?);
    let mut soup = Soup::default();
    for triangle in 0..count {
        let what = || format!("triangle {triangle} of {count}");
        let record: [u8; TRIANGLE] = cursor.array(what)?;
        let number = |index: usize| {
            let bytes = &record[4 * index..4 * index + 4];
            f64::from(f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]))
        };
        let corners = [3, 6, 9].map(|first| DVec3::new(number(first), number(first + 1), number(first + 2)));
        if let Some(corner) = corners.iter().find(|corner| !corner.is_finite()) {
            let byte = cursor.at - TRIANGLE;
            let found = format!("({}, {}, {})", corner.x, corner.y, corner.z);
            let what = format!("a corner of triangle {triangle}");
            return Err(MeshProblem::Value { byte, what, found, expected: "finite numbers".to_owned() });
        }
        soup.push_triangle(corners)?;
    }
    Ok(soup)
}

fn text(path: &Path, bytes: &[u8]) -> Result<Soup> {
    let mut soup = Soup::default();
    let mut corners = Vec::new();
    for (index, line) in decode(path, bytes)?.lines().enumerate() {
        let at = |error| wrong(path, error).at_line(Some(index + 1));
        let mut words = line.split_ascii_whitespace();
        match words.next() {
            Some("vertex") => corners.push(obj::place(&mut words).map_err(at)?),
            Some("endloop" | "endfacet") if !corners.is_empty() => match corners[..] {
                [a, b, c] => {
                    soup.push_triangle([a, b, c]).map_err(at)?;
                    corners.clear();
                }
                _ => {
                    let found = format!("of {} corners", corners.len());
                    return Err(at(MeshProblem::word("a facet", found, "3 corners")));
                }
            },
            Some("solid" | "facet" | "outer" | "endloop" | "endfacet" | "endsolid") | None => {}
            Some(word) => {
                let expected = "solid, facet, outer, vertex, endloop, endfacet or endsolid";
                return Err(at(MeshProblem::word("a line's first word", word, expected)));
            }
        }
    }
    if !corners.is_empty() {
        return Err(wrong(path, MeshProblem::Short { byte: bytes.len(), what: "a facet".to_owned() }));
    }
    Ok(soup)
}
