//! PLY: `vertex` with x, y, z and `face` with `vertex_indices`, as text or binary; other elements and properties are passed over.

use std::path::Path;

use glam::DVec3;

use super::{Cursor, MeshProblem, Soup, wrong};
use crate::Result;
use crate::text::{Words, decode};

/// Most corners of a face, and entries of other lists.
const MAX_LIST: f64 = 65_536.0;

/// Most properties of a file.
const MAX_PROPERTIES: usize = 256;

/// A kind of number: how many bytes it has, and what they are, lowest first.
type Kind = (usize, fn([u8; 8]) -> f64);

fn kind(name: &str) -> Option<Kind> {
    Some(match name {
        "char" | "int8" => (1, |[a, ..]| f64::from(a.cast_signed())),
        "uchar" | "uint8" => (1, |[a, ..]| f64::from(a)),
        "short" | "int16" => (2, |[a, b, ..]| f64::from(i16::from_le_bytes([a, b]))),
        "ushort" | "uint16" => (2, |[a, b, ..]| f64::from(u16::from_le_bytes([a, b]))),
        "int" | "int32" => (4, |[a, b, c, d, ..]| f64::from(i32::from_le_bytes([a, b, c, d]))),
        "uint" | "uint32" => (4, |[a, b, c, d, ..]| f64::from(u32::from_le_bytes([a, b, c, d]))),
        "float" | "float32" => (4, |[a, b, c, d, ..]| f64::from(f32::from_le_bytes([a, b, c, d]))),
        "double" | "float64" => (8, f64::from_le_bytes),
        _ => return None,
    })
}

#[derive(Debug)]
struct Property {
    name: String,
    /// Kind of a list's length.
    list: Option<Kind>,
    kind: Kind,
}

#[derive(Debug)]
struct Element {
    name: String,
    count: u64,
    properties: Vec<Property>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Encoding {
    Text,
    Little,
    Big,
}

/// Vertices and faces of the file.
pub(super) fn parse(path: &Path, bytes: &[u8]) -> Result<Soup> {
    const END: &[u8] = b"end_header";
    let end = bytes.windows(END.len()).position(|window| window == END);
    let Some(end) = end else { return Err(wrong(path, MeshProblem::Lacks { what: "end_header" })) };
    let head = decode(path, &bytes[..end])?;
    let (encoding, elements) = header(path, head)?;
    let after = &bytes[end + END.len()..];
    let skip = if after.starts_with(b"\r\n") { 2 } else { 1 };
    let start = (end + END.len() + skip).min(bytes.len());
    let lines = head.lines().count().max(1);
    if encoding == Encoding::Text {
        let text = decode(path, &bytes[start..])?;
        let mut words = Words::new(text, |letter| letter.is_ascii_whitespace());
        body(&elements, |_kind, what| number(&mut words, what))
            .map_err(|error| wrong(path, error).at_line(Some(lines + 1 + words.line.max(1))))
    } else {
        let mut cursor = Cursor { bytes, at: start };
        body(&elements, |kind, what| binary(&mut cursor, kind, encoding, what))
            .map_err(|error| wrong(path, error))
    }
}

fn header(path: &Path, head: &str) -> Result<(Encoding, Vec<Element>)> {
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    let mut properties = 0;
    for (index, line) in head.lines().enumerate() {
        let words: Vec<&str> = line.split_ascii_whitespace().take(8).collect();
        let bad = |what: &str, expected| {
            wrong(path, MeshProblem::word(what, line, expected)).at_line(Some(index + 1))
        };
        match words[..] {
            [] | ["ply" | "comment" | "obj_info", ..] => {}
            ["format", name, ..] => {
                encoding = Some(match name {
                    "ascii" => Encoding::Text,
                    "binary_little_endian" => Encoding::Little,
                    "binary_big_endian" => Encoding::Big,
                    _ => return Err(bad("the format", "ascii, binary_little_endian or binary_big_endian")),
                });
            }
            ["element", name, count] => {
                let count = count.parse().map_err(|_error| bad("an element", "a name and a whole number"))?;
                elements.push(Element { name: name.to_owned(), count, properties: Vec::new() });
            }
            ["property", .., name] => {
                let kinds: Option<Vec<Kind>> = match words[1..words.len() - 1] {
                    ["list", length, of] => [length, of].into_iter().map(kind).collect(),
                    [of] => kind(of).map(|kind| vec![kind]),
                    _ => None,
                };
                properties += 1;
                let element = elements.last_mut().filter(|_| properties <= MAX_PROPERTIES);
                let (Some(kinds), Some(element)) = (kinds, element) else {
                    return Err(bad("a property", "a kind of number and a name below an element"));
                };
                let (list, kind) =
                    if kinds.len() == 2 { (Some(kinds[0]), kinds[1]) } else { (None, kinds[0]) };
                element.properties.push(Property { name: name.to_owned(), list, kind });
            }
            _ => return Err(bad("a line of the head", "format, element, property or comment")),
        }
    }
    let encoding = encoding.ok_or_else(|| wrong(path, MeshProblem::Lacks { what: "format in its head" }))?;
    let has = |element: &str, names: &[&str]| {
        elements.iter().any(|other| {
            let has = |name: &&str| other.properties.iter().any(|property| property.name == **name);
            other.name == element && names.iter().all(has)
        })
    };
    if !has("vertex", &["x", "y", "z"]) {
        return Err(wrong(path, MeshProblem::Lacks { what: "element vertex with x, y and z" }));
    }
    if !has("face", &["vertex_indices"]) && !has("face", &["vertex_index"]) {
        return Err(wrong(path, MeshProblem::Lacks { what: "element face with a list vertex_indices" }));
    }
    Ok((encoding, elements))
}

fn body(
    elements: &[Element],
    mut number: impl FnMut(Kind, &dyn Fn() -> String) -> Result<f64, MeshProblem>,
) -> Result<Soup, MeshProblem> {
    let mut soup = Soup::default();
    let mut corners = Vec::new();
    for element in elements {
        // Rows without properties take no byte, so their count says nothing.
        let count = if element.properties.is_empty() { 0 } else { element.count };
        for row in 0..count {
            let mut place = DVec3::ZERO;
            for property in &element.properties {
                let what = || format!("`{}` of {} {row}", property.name, element.name);
                let Some(length_kind) = property.list else {
                    let value = number(property.kind, &what)?;
                    match property.name.as_str() {
                        "x" => place.x = value,
                        "y" => place.y = value,
                        "z" => place.z = value,
                        _ => {}
                    }
                    continue;
                };
                let length = number(length_kind, &what)?;
                if !(0.0..=MAX_LIST).contains(&length) || length.fract() != 0.0 {
                    let what = format!("the length of {}", what());
                    return Err(MeshProblem::word(what, length.to_string(), "0 to 65536"));
                }
                let is_face =
                    element.name == "face" && ["vertex_indices", "vertex_index"].contains(&&*property.name);
                corners.clear();
                for _ in 0..length as u32 {
                    let value = number(property.kind, &what)?;
                    if is_face {
                        corners.push(corner(value, &what)?);
                    }
                }
                soup.push_polygon(&corners)?;
            }
            if element.name == "vertex" {
                soup.push_vertex(place)?;
            }
        }
    }
    Ok(soup)
}

fn corner(value: f64, what: &dyn Fn() -> String) -> Result<u32, MeshProblem> {
    let is_index = (0.0..=f64::from(u32::MAX)).contains(&value) && value.fract() == 0.0;
    if is_index {
        return Ok(value as u32);
    }
    Err(MeshProblem::word(what(), value.to_string(), "the number of a vertex"))
}

fn number(words: &mut Words<'_>, what: &dyn Fn() -> String) -> Result<f64, MeshProblem> {
    let Some(word) = words.after() else {
        return Err(MeshProblem::word(what(), "missing", "a number; the file ends before it"));
    };
    word.parse().map_err(|_error| MeshProblem::word(what(), word, "a number"))
}

fn binary(
    cursor: &mut Cursor<'_>,
    (size, number): Kind,
    encoding: Encoding,
    what: &dyn Fn() -> String,
) -> Result<f64, MeshProblem> {
    let mut bytes = [0; 8];
    bytes[..size].copy_from_slice(cursor.take(size, what)?);
    if encoding == Encoding::Big {
        bytes[..size].reverse();
    }
    Ok(number(bytes))
}
