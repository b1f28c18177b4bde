//! glTF 2.0: all triangles of the scene's meshes, moved as their nodes say; or the first skinned mesh with its skeleton ([`skin`]).
//! Morphs, sparse accessors and compressed meshes are not read; triangle strips and fans, lines and points are told or passed over.

mod skin;

use std::borrow::Cow;
use std::path::Path;

use backlit_tracking::body_spheres::Skin;
use glam::{DAffine3, DMat4, DQuat, DVec3};
use serde::Deserialize;

use skin::SkinJson;

use super::{Cursor, MeshProblem, Soup, room, wrong};
use crate::json_text::parse_bytes;
use crate::{Result, base64};

/// What a GLB begins with.
pub(super) const MAGIC: &[u8] = b"glTF";

/// How deep nodes may lie.
const MAX_DEPTH: usize = 64;

/// Most times that nodes may be visited; a node may be named by many.
const MAX_VISITS: usize = 4096;

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct Gltf {
    scene: Option<usize>,
    scenes: Vec<GltfScene>,
    nodes: Vec<GltfNode>,
    meshes: Vec<MeshJson>,
    skins: Vec<SkinJson>,
    accessors: Vec<Accessor>,
    buffer_views: Vec<BufferView>,
    buffers: Vec<Buffer>,
    extensions_required: Vec<String>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct GltfScene {
    nodes: Vec<usize>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct GltfNode {
    name: Option<String>,
    mesh: Option<usize>,
    skin: Option<usize>,
    children: Vec<usize>,
    matrix: Option<[f64; 16]>,
    translation: Option<[f64; 3]>,
    rotation: Option<[f64; 4]>,
    scale: Option<[f64; 3]>,
}

#[derive(Debug, Deserialize)]
struct MeshJson {
    primitives: Vec<Primitive>,
}

#[derive(Debug, Deserialize)]
struct Primitive {
    attributes: Attributes,
    indices: Option<usize>,
    mode: Option<u32>,
}

#[derive(Debug, Deserialize)]
struct Attributes {
    #[serde(rename = "POSITION")]
    position: Option<usize>,
    #[serde(rename = "JOINTS_0")]
    joints: Option<usize>,
    #[serde(rename = "WEIGHTS_0")]
    weights: Option<usize>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
struct Accessor {
    buffer_view: Option<usize>,
    #[serde(default)]
    byte_offset: usize,
    component_type: u32,
    count: usize,
    #[serde(rename = "type")]
    kind: String,
    sparse: Option<serde::de::IgnoredAny>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
struct BufferView {
    buffer: usize,
    #[serde(default)]
    byte_offset: usize,
    byte_length: usize,
    byte_stride: Option<usize>,
}

#[derive(Debug, Deserialize)]
struct Buffer {
    uri: Option<String>,
}

type ReadSibling<'a> = &'a dyn Fn(&str) -> Result<Vec<u8>>;

/// All triangles of a document or a GLB.
pub(super) fn parse(path: &Path, bytes: &[u8], beside: ReadSibling<'_>) -> Result<Soup> {
    read(path, bytes, beside, |reader| {
        reader.scene()?;
        Ok(std::mem::take(&mut reader.soup))
    })
}

/// The first skinned mesh of a document or a GLB.
pub(super) fn parse_skin(path: &Path, bytes: &[u8], beside: ReadSibling<'_>) -> Result<Skin> {
    read(path, bytes, beside, |reader| reader.skin())
}

fn read<T>(
    path: &Path,
    bytes: &[u8],
    beside: ReadSibling<'_>,
    what: impl FnOnce(&mut GltfReader<'_>) -> Result<T, MeshProblem>,
) -> Result<T> {
    if !bytes.starts_with(MAGIC) {
        return read_document(path, bytes, &[], beside, what);
    }
    let chunks = chunks(bytes).map_err(|error| wrong(path, error))?;
    let [Some(json), binary] = chunks else {
        return Err(wrong(path, MeshProblem::Lacks { what: "JSON chunk" }));
    };
    read_document(path, json, binary.unwrap_or_default(), beside, what)
}

fn chunks(bytes: &[u8]) -> Result<[Option<&[u8]>; 2], MeshProblem> {
    let mut cursor = Cursor { bytes, at: 4 };
    let version = u32::from_le_bytes(cursor.array(|| "its head".to_owned())?);
    if version != 2 {
        return Err(MeshProblem::unsupported("this version of glTF", version.to_string()));
    }
    cursor.take(4, || "its head".to_owned())?;
    let mut found = [None, None];
    while cursor.at < bytes.len() {
        let what = || "the head of a chunk".to_owned();
        let length = u32::from_le_bytes(cursor.array(what)?) as usize;
        let kind: [u8; 4] = cursor.array(what)?;
        let content = cursor.take(length, || format!("a chunk of {length} bytes"))?;
        match &kind {
            b"JSON" if found[0].is_none() => found[0] = Some(content),
            b"BIN\0" if found[1].is_none() => found[1] = Some(content),
            _ => {}
        }
    }
    Ok(found)
}

fn read_document<T>(
    path: &Path,
    json: &[u8],
    binary: &[u8],
    beside: ReadSibling<'_>,
    what: impl FnOnce(&mut GltfReader<'_>) -> Result<T, MeshProblem>,
) -> Result<T> {
    let document: Gltf = parse_bytes(path, json)?;
    if let Some(first) = document.extensions_required.first() {
        return Err(wrong(path, MeshProblem::unsupported("a required extension", first)));
    }
    let mut buffers = Vec::new();
    for (index, buffer) in document.buffers.iter().enumerate() {
        buffers.push(match &buffer.uri {
            None => Cow::Borrowed(if index == 0 { binary } else { &[] }),
            Some(uri) => match uri.strip_prefix("data:") {
                Some(data) => Cow::Owned(inline(data).map_err(|error| wrong(path, error))?),
                None => {
                    let is_plain = !uri.contains(['/', '\\', ':', '%']) && !uri.starts_with('.');
                    if !is_plain {
                        return Err(wrong(path, MeshProblem::unsupported("a buffer in another folder", uri)));
                    }
                    Cow::Owned(beside(uri)?)
                }
            },
        });
    }
    let mut reader = GltfReader { document: &document, buffers, soup: Soup::default(), visits: 0 };
    what(&mut reader).map_err(|error| wrong(path, error))
}

/// The bytes of a data URI.
fn inline(data: &str) -> Result<Vec<u8>, MeshProblem> {
    let Some((_, text)) = data.split_once(";base64,") else {
        return Err(MeshProblem::unsupported("a data URI that is not base64", data));
    };
    Ok(base64::bytes(text))
}

struct GltfReader<'a> {
    document: &'a Gltf,
    buffers: Vec<Cow<'a, [u8]>>,
    soup: Soup,
    visits: usize,
}

/// An entry of a list that the file names by its number.
fn entry<'a, T>(list: &'a [T], index: usize, what: &str) -> Result<&'a T, MeshProblem> {
    let what = || format!("the number of {what}");
    list.get(index).ok_or_else(|| MeshProblem::word(what(), index.to_string(), "one that the file has"))
}

impl GltfNode {
    fn parent_from_node(&self) -> DAffine3 {
        match self.matrix {
            Some(matrix) => DAffine3::from_mat4(DMat4::from_cols_array(&matrix)),
            None => DAffine3::from_scale_rotation_translation(
                self.scale.map_or(DVec3::ONE, DVec3::from),
                self.rotation.map_or(DQuat::IDENTITY, DQuat::from_array),
                self.translation.map_or(DVec3::ZERO, DVec3::from),
            ),
        }
    }
}

impl GltfReader<'_> {
    fn scene(&mut self) -> Result<(), MeshProblem> {
        let document = self.document;
        if document.scenes.is_empty() {
            // No scene: all meshes as they are.
            for mesh in &document.meshes {
                self.mesh(mesh, DAffine3::IDENTITY)?;
            }
            return Ok(());
        }
        for &root in &entry(&document.scenes, document.scene.unwrap_or(0), "a scene")?.nodes {
            self.node(root, DAffine3::IDENTITY, 0)?;
        }
        Ok(())
    }

    fn node(&mut self, index: usize, world_from_parent: DAffine3, depth: usize) -> Result<(), MeshProblem> {
        let document = self.document;
        let node = entry(&document.nodes, index, "a node")?;
        self.visits += 1;
        if depth > MAX_DEPTH || self.visits > MAX_VISITS {
            let found = format!("deeper than {MAX_DEPTH} or more than {MAX_VISITS}");
            return Err(MeshProblem::unsupported("a tree of nodes", found));
        }
        let world_from_node = world_from_parent * node.parent_from_node();
        if let Some(mesh) = node.mesh {
            self.mesh(entry(&document.meshes, mesh, "a mesh")?, world_from_node)?;
        }
        node.children.iter().try_for_each(|&child| self.node(child, world_from_node, depth + 1))
    }

    fn mesh(&mut self, mesh: &MeshJson, world_from_mesh: DAffine3) -> Result<(), MeshProblem> {
        for primitive in &mesh.primitives {
            match primitive.mode.unwrap_or(4) {
                4 => self.primitive(primitive, world_from_mesh)?,
                5 | 6 => {
                    return Err(MeshProblem::unsupported("a primitive", "strips or fans of triangles"));
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn primitive(&mut self, primitive: &Primitive, world_from_mesh: DAffine3) -> Result<(), MeshProblem> {
        let Some(position) = primitive.attributes.position else { return Ok(()) };
        let accessor = entry(&self.document.accessors, position, "an accessor")?;
        if accessor.kind != "VEC3" || accessor.component_type != 5126 {
            let found = format!("{} of {}", accessor.kind, accessor.component_type);
            return Err(MeshProblem::unsupported("a POSITION that is not a VEC3 of floats", found));
        }
        let first = self.soup.vertices.len();
        room("vertices", first, accessor.count)?;
        let mut places = Vec::new();
        self.rows(accessor, 12, |row| {
            let place = DVec3::from_array(std::array::from_fn(|axis| float(row, axis)));
            places.push(world_from_mesh.transform_point3(place));
        })?;
        let count = places.len() as u32;
        self.soup.vertices.extend(places);
        let mut corners: Vec<u32> = Vec::new();
        match primitive.indices {
            None => corners.extend(0..count),
            Some(indices) => {
                let accessor = entry(&self.document.accessors, indices, "an accessor")?;
                let size = match (accessor.component_type, accessor.kind.as_str()) {
                    (5121, "SCALAR") => 1,
                    (5123, "SCALAR") => 2,
                    (5125, "SCALAR") => 4,
                    (found, kind) => {
                        let found = format!("{kind} of {found}");
                        return Err(MeshProblem::unsupported("indices of another kind", found));
                    }
                };
                room("triangles", self.soup.triangles.len(), accessor.count / 3)?;
                self.rows(accessor, size, |row| {
                    let mut bytes = [0; 4];
                    bytes[..size].copy_from_slice(row);
                    corners.push(u32::from_le_bytes(bytes));
                })?;
            }
        }
        if let Some(bad) = corners.iter().find(|&&corner| corner >= count) {
            let (what, expected) = ("a corner of a triangle", "a vertex of its primitive");
            return Err(MeshProblem::word(what, bad.to_string(), expected));
        }
        let (triangles, _) = corners.as_chunks::<3>();
        self.soup
            .triangles
            .extend(triangles.iter().map(|corners| corners.map(|corner| corner + first as u32)));
        Ok(())
    }

    /// The rows of an accessor, `size` bytes each.
    fn rows(&self, accessor: &Accessor, size: usize, mut take: impl FnMut(&[u8])) -> Result<(), MeshProblem> {
        let (Some(view), None) = (accessor.buffer_view, &accessor.sparse) else {
            return Err(MeshProblem::unsupported("an accessor", "sparse, or without a buffer view"));
        };
        let view = entry(&self.document.buffer_views, view, "a buffer view")?;
        let buffer = entry(&self.buffers, view.buffer, "a buffer")?;
        let short = || MeshProblem::Short { byte: buffer.len(), what: "a buffer view".to_owned() };
        let end = view.byte_offset.checked_add(view.byte_length).ok_or_else(short)?;
        let bytes = buffer.get(view.byte_offset..end).ok_or_else(short)?;
        let stride = view.byte_stride.unwrap_or(size).max(size);
        for row in 0..accessor.count {
            let start = row.checked_mul(stride).and_then(|start| start.checked_add(accessor.byte_offset));
            let range = start.and_then(|start| Some(start..start.checked_add(size)?));
            take(range.and_then(|range| bytes.get(range)).ok_or_else(short)?);
        }
        Ok(())
    }
}

/// The number at a place of a row of floats.
fn float(row: &[u8], place: usize) -> f64 {
    let at = 4 * place;
    f64::from(f32::from_le_bytes([row[at], row[at + 1], row[at + 2], row[at + 3]]))
}
