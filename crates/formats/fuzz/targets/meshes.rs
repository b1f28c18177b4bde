//! Closed meshes: OBJ, STL, PLY and glTF of a tetrahedron.

use std::collections::BTreeMap;
use std::path::Path;

use backlit_formats::motion::{Motion, MotionFormat, MotionOptions};
use backlit_formats::{mesh, motion};
use backlit_tracking::body::{Pose, builtin};

use crate::engine::{Outcome, Target};
use crate::mutate::Syntax;

const CORNERS: [[f32; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
const TRIANGLES: [[usize; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

fn soup() -> impl Iterator<Item = [f32; 3]> {
    TRIANGLES.into_iter().flatten().map(|corner| CORNERS[corner])
}

fn objs() -> Vec<Vec<u8>> {
    vec![b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1/1 2/2 4//1\nf -4 -1 -2\nf 2 3 4\n".to_vec()]
}

fn stls() -> Vec<Vec<u8>> {
    let mut binary = vec![b' '; 80];
    binary.extend(4_u32.to_le_bytes());
    let mut text = "solid a\n".to_owned();
    for triangle in TRIANGLES {
        binary.extend([0; 12]);
        text += "facet normal 0 0 0\nouter loop\n";
        for corner in triangle {
            CORNERS[corner].iter().for_each(|x| binary.extend(x.to_le_bytes()));
            let [x, y, z] = CORNERS[corner];
            text += &format!("vertex {x} {y} {z}\n");
        }
        text += "endloop\nendfacet\n";
        binary.extend([0; 2]);
    }
    vec![binary, (text + "endsolid a\n").into_bytes()]
}

fn plys() -> Vec<Vec<u8>> {
    let head = |format: &str| {
        format!(
            "ply\nformat {format} 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
             element face 4\nproperty list uchar int vertex_indices\nend_header\n"
        )
    };
    let mut text = head("ascii");
    let [mut little, mut big] =
        ["binary_little_endian", "binary_big_endian"].map(|format| head(format).into_bytes());
    for [x, y, z] in CORNERS {
        text += &format!("{x} {y} {z}\n");
        [x, y, z].iter().for_each(|x| little.extend(x.to_le_bytes()));
        [x, y, z].iter().for_each(|x| big.extend(x.to_be_bytes()));
    }
    for [a, b, c] in TRIANGLES {
        text += &format!("3 {a} {b} {c}\n");
        little.push(3);
        big.push(3);
        [a, b, c].iter().for_each(|&corner| little.extend((corner as u32).to_le_bytes()));
        [a, b, c].iter().for_each(|&corner| big.extend((corner as u32).to_be_bytes()));
    }
    vec![text.into_bytes(), little, big]
}

fn document(buffer: &str) -> String {
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}],
        "nodes": [{{"mesh": 0, "translation": [1, 0, 0], "scale": [2, 2, 2]}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}], "buffers": [{buffer}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 12, "type": "VEC3"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 144}}]}}"#
    )
}

fn glbs() -> Vec<Vec<u8>> {
    let binary: Vec<u8> = soup().flatten().flat_map(f32::to_le_bytes).collect();
    let mut json = document(r#"{"byteLength": 144}"#).into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut bytes = b"glTF".to_vec();
    bytes.extend(2_u32.to_le_bytes());
    bytes.extend(((28 + json.len() + binary.len()) as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", json), (b"BIN\0", binary)] {
        bytes.extend((chunk.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    vec![bytes]
}

fn gltfs() -> Vec<Vec<u8>> {
    // 144 bytes are a multiple of three: no letters to fill up.
    const LETTERS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let binary: Vec<u8> = soup().flatten().flat_map(f32::to_le_bytes).collect();
    let (threes, _) = binary.as_chunks::<3>();
    let text: String = threes
        .iter()
        .flat_map(|&[a, b, c]| {
            let bits = u32::from_be_bytes([0, a, b, c]);
            [18, 12, 6, 0].map(|shift| char::from(LETTERS[(bits >> shift & 63) as usize]))
        })
        .collect();
    vec![document(&format!(r#"{{"uri": "data:application/octet-stream;base64,{text}"}}"#)).into_bytes()]
}

/// A body of one limb as Backlit writes it, skinned.
fn skins() -> Vec<Vec<u8>> {
    let model = builtin::single_limb();
    let poses = BTreeMap::from([(0, Pose::rest(&model))]);
    let motion = Motion { name: "limb".to_owned(), model, frame_rate: 30.0, poses };
    motion::to_bytes(MotionFormat::Glb, &motion, &MotionOptions::default()).into_iter().collect()
}

fn read(name: &str, bytes: &[u8]) -> Outcome {
    mesh::parse(Path::new(name), bytes).into()
}

fn target(
    name: &'static str,
    syntax: Syntax,
    seeds: fn() -> Vec<Vec<u8>>,
    words: &'static [&'static str],
    read: fn(&[u8]) -> Outcome,
) -> Target {
    Target { name, syntax, seeds, words, read, short: 500 }
}

pub(super) fn targets() -> Vec<Target> {
    const PLY: &[&str] =
        &["element face 4000000000\n", "property list double double a\n", "ascii", "comment\n"];
    const GLTF: &[&str] = &["\"children\": [0]", "\"byteStride\": 0", "4294967295", "\"indices\": 0", "5125"];
    vec![
        target("mesh_obj", Syntax::Text, objs, &["f 1 2 3 4 1\n", "v 1 1 1\n", "-5"], |b| read("a.obj", b)),
        target("mesh_stl", Syntax::Binary, stls, &["solid", "vertex 0 0 0\n", "endloop\n"], |b| {
            read("a.stl", b)
        }),
        target("mesh_ply", Syntax::Binary, plys, PLY, |b| read("a.ply", b)),
        target("mesh_glb", Syntax::Binary, glbs, GLTF, |b| read("a.glb", b)),
        target("mesh_gltf", Syntax::Text, gltfs, GLTF, |b| read("a.gltf", b)),
        target("mesh_skin", Syntax::Binary, skins, GLTF, |b| mesh::parse_skin(Path::new("a.glb"), b).into()),
    ]
}
