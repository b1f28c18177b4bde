//! Closed triangle meshes from files: Wavefront OBJ, PLY and STL (text and binary), glTF and GLB.
//!
//! Only places of vertices and faces are read; polygons become fans of triangles. Sizes are checked against the file's own length
//! before memory is taken for them.

mod gltf;
mod obj;
mod ply;
mod stl;

use std::path::{Path, PathBuf};

use backlit_sphere_tree::{ClosedMesh, MeshError};
use backlit_tracking::body_spheres::Skin;
use glam::DVec3;
use thiserror::Error;

use crate::{DiskFiles, FileError, FileProblem, Result, TakeFiles};

/// Largest mesh file that is read, bytes.
pub const MAX_BYTES: u64 = 512 << 20;

/// Most vertices and triangles before vertices at one place become one: STL has three a triangle.
const MAX_SOUP: usize = 3 * backlit_sphere_tree::MAX_ELEMENTS;

/// What is wrong with a mesh file.
#[derive(Debug, Clone, PartialEq, Error)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum MeshProblem {
    #[error("cannot be recognised as a mesh; expected .obj, .ply, .stl, .gltf or .glb")]
    Unknown,
    #[error("{what} is \"{}\"; expected {expected}", crate::text::cut(found))]
    Word { what: String, found: String, expected: &'static str },
    #[error("ends at byte {byte}, within {what}")]
    Short { byte: usize, what: String },
    #[error("at byte {byte}, {what} is {}; expected {expected}", crate::text::cut(found))]
    Value { byte: usize, what: String, found: String, expected: String },
    #[error("has no {what}")]
    Lacks { what: &'static str },
    #[error("{what} is not read: {}", crate::text::cut(found))]
    Unsupported { what: &'static str, found: String },
    #[error("the surface {0}")]
    Surface(MeshError),
}

impl MeshProblem {
    fn word(what: impl Into<String>, found: impl Into<String>, expected: &'static str) -> Self {
        Self::Word { what: what.into(), found: found.into(), expected }
    }

    fn unsupported(what: &'static str, found: impl Into<String>) -> Self {
        Self::Unsupported { what, found: found.into() }
    }
}

/// Vertices and triangles that name them, as a file has them.
#[derive(Debug, Default, Clone, PartialEq)]
struct Soup {
    vertices: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
}

impl Soup {
    fn push_vertex(&mut self, place: DVec3) -> Result<(), MeshProblem> {
        room("vertices", self.vertices.len(), 1)?;
        self.vertices.push(place);
        Ok(())
    }

    /// A polygon as a fan about its first corner.
    fn push_polygon(&mut self, corners: &[u32]) -> Result<(), MeshProblem> {
        room("triangles", self.triangles.len(), corners.len())?;
        let fan = corners.windows(2).skip(1).map(|pair| [corners[0], pair[0], pair[1]]);
        self.triangles.extend(fan);
        Ok(())
    }

    /// A triangle with corners of its own.
    fn push_triangle(&mut self, corners: [DVec3; 3]) -> Result<(), MeshProblem> {
        let first = self.vertices.len() as u32;
        corners.into_iter().try_for_each(|corner| self.push_vertex(corner))?;
        self.push_polygon(&[first, first + 1, first + 2])
    }
}

/// An error if `more` elements are too many beside those that are there.
fn room(what: &'static str, there: usize, more: usize) -> Result<(), MeshProblem> {
    let found = there.saturating_add(more);
    if found <= MAX_SOUP { Ok(()) } else { Err(MeshProblem::Surface(MeshError::TooLarge { what, found })) }
}

fn wrong(path: &Path, error: MeshProblem) -> FileError {
    FileError::new(path, FileProblem::Mesh { error })
}

/// Reads a mesh by its content, or by its name's ending where the content does not tell.
pub fn read(path: &Path) -> Result<ClosedMesh> {
    let beside = |name: &str| DiskFiles.read(&path.with_file_name(name), MAX_BYTES);
    parse_with(path, &DiskFiles.read(path, MAX_BYTES)?, &beside)
}

/// The same from bytes; `path` is for the error's message and the ending. Files beside it are not read.
pub fn parse(path: &Path, bytes: &[u8]) -> Result<ClosedMesh> {
    parse_with(path, bytes, &nothing_beside)
}

/// Reads the first skinned mesh of a .gltf or .glb file, with its skeleton, in the pose in which the file has it.
pub fn read_skin(path: &Path) -> Result<Skin> {
    let beside = |name: &str| DiskFiles.read(&path.with_file_name(name), MAX_BYTES);
    gltf::parse_skin(path, &DiskFiles.read(path, MAX_BYTES)?, &beside)
}

/// The same from bytes; files beside it are not read.
pub fn parse_skin(path: &Path, bytes: &[u8]) -> Result<Skin> {
    gltf::parse_skin(path, bytes, &nothing_beside)
}

fn nothing_beside(name: &str) -> Result<Vec<u8>> {
    Err(FileError::new(&PathBuf::from(name), FileProblem::Missing))
}

fn parse_with(path: &Path, bytes: &[u8], beside: &dyn Fn(&str) -> Result<Vec<u8>>) -> Result<ClosedMesh> {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
    let soup = if bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r") {
        ply::parse(path, bytes)?
    } else if bytes.starts_with(gltf::MAGIC) {
        gltf::parse(path, bytes, beside)?
    } else {
        match ending.as_str() {
            "gltf" => gltf::parse(path, bytes, beside)?,
            "obj" => obj::parse(path, bytes)?,
            "stl" => stl::parse(path, bytes)?,
            _ => return Err(wrong(path, MeshProblem::Unknown)),
        }
    };
    ClosedMesh::new(&soup.vertices, &soup.triangles).map_err(|error| wrong(path, MeshProblem::Surface(error)))
}

/// Numbers of a binary file, one after the other.
#[derive(Debug)]
struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Cursor<'a> {
    fn take(&mut self, count: usize, what: impl FnOnce() -> String) -> Result<&'a [u8], MeshProblem> {
        let end = self.at.checked_add(count).filter(|end| *end <= self.bytes.len());
        let Some(end) = end else {
            return Err(MeshProblem::Short { byte: self.bytes.len(), what: what() });
        };
        let found = &self.bytes[self.at..end];
        self.at = end;
        Ok(found)
    }

    fn array<const N: usize>(&mut self, what: impl FnOnce() -> String) -> Result<[u8; N], MeshProblem> {
        let mut out = [0; N];
        out.copy_from_slice(self.take(N, what)?);
        Ok(out)
    }
}

#[cfg(test)]
mod tests;
