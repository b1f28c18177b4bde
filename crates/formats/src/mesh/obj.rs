//! Wavefront OBJ: `v` and `f`; everything else is passed over.

use std::path::Path;

use glam::DVec3;

use super::{MeshProblem, Soup, wrong};
use crate::Result;
use crate::text::decode;

/// Most corners of a face.
const MAX_CORNERS: usize = 4096;

/// Vertices and faces of the text.
pub(super) fn parse(path: &Path, bytes: &[u8]) -> Result<Soup> {
    let mut soup = Soup::default();
    let mut corners = Vec::new();
    for (index, line) in decode(path, bytes)?.lines().enumerate() {
        let at = |error| wrong(path, error).at_line(Some(index + 1));
        let mut words = line.split_ascii_whitespace();
        match words.next() {
            Some("v") => place(&mut words).and_then(|place| soup.push_vertex(place)).map_err(at)?,
            Some("f") => {
                corners.clear();
                for word in words {
                    corners.push(corner(word, soup.vertices.len()).map_err(at)?);
                }
                if corners.len() < 3 || corners.len() > MAX_CORNERS {
                    let found = format!("of {} corners", corners.len());
                    return Err(at(MeshProblem::word("a face", found, "3 to 4096 corners")));
                }
                soup.push_polygon(&corners).map_err(at)?;
            }
            _ => {}
        }
    }
    Ok(soup)
}

/// Three numbers.
pub(super) fn place<'a>(words: &mut impl Iterator<Item = &'a str>) -> Result<DVec3, MeshProblem> {
    let mut number = |what: &str| {
        let word = words.next().unwrap_or("missing");
        let number = word.parse::<f64>().ok().filter(|number| number.is_finite());
        number.ok_or_else(|| MeshProblem::word(format!("{what} of a vertex"), word, "a finite number"))
    };
    Ok(DVec3::new(number("x")?, number("y")?, number("z")?))
}

/// The vertex of `7`, `7/1`, `7//3`, or of `-1`, the last one so far.
fn corner(word: &str, count: usize) -> Result<u32, MeshProblem> {
    let number = word.split('/').next().unwrap_or_default();
    let index = number.parse::<i64>().ok().and_then(|number| match number {
        1.. => number.checked_sub(1),
        0 => None,
        _ => number.checked_add(count as i64),
    });
    let index = index.and_then(|index| usize::try_from(index).ok()).filter(|index| *index < count);
    index.and_then(|index| u32::try_from(index).ok()).ok_or_else(|| {
        let expected = "a vertex of a line before it, counted from 1, or from the last one by -1";
        MeshProblem::word("a corner of a face", word, expected)
    })
}
