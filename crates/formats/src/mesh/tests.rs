//! The same solid in every format, and what is wrong with each in words.

use std::fmt::Write;

use backlit_sphere_tree::isosurface;

use super::*;

fn solid() -> ClosedMesh {
    isosurface([DVec3::splat(-1.0), DVec3::splat(1.0)], 0.4, |p| p.length() - 0.8).unwrap()
}

fn obj(mesh: &ClosedMesh) -> String {
    let mut text = "# made by a test\no ball\n".to_owned();
    for v in mesh.vertices() {
        writeln!(text, "v {} {} {}", v.x, v.y, v.z).unwrap();
    }
    for (index, [a, b, c]) in mesh.triangles().iter().enumerate() {
        let back = |vertex: &u32| i64::from(*vertex) - mesh.vertices().len() as i64;
        match index % 3 {
            0 => writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1).unwrap(),
            1 => writeln!(text, "f {}/1/1 {}//2 {}/3", a + 1, b + 1, c + 1).unwrap(),
            _ => writeln!(text, "f {} {} {}", back(a), back(b), back(c)).unwrap(),
        }
    }
    text
}

fn stl_text(mesh: &ClosedMesh) -> String {
    let mut text = "solid ball\n".to_owned();
    for triangle in 0..mesh.triangles().len() {
        text += "facet normal 0 0 0\n outer loop\n";
        for v in mesh.corners(triangle) {
            writeln!(text, "  vertex {:e} {} {}", v.x, v.y, v.z).unwrap();
        }
        text += " endloop\nendfacet\n";
    }
    text + "endsolid ball\n"
}

fn stl_binary(mesh: &ClosedMesh) -> Vec<u8> {
    let mut bytes = b"solid to deceive".to_vec();
    bytes.resize(80, b' ');
    bytes.extend((mesh.triangles().len() as u32).to_le_bytes());
    for triangle in 0..mesh.triangles().len() {
        bytes.extend([0; 12]);
        for v in mesh.corners(triangle) {
            v.to_array().iter().for_each(|x| bytes.extend((*x as f32).to_le_bytes()));
        }
        bytes.extend([0; 2]);
    }
    bytes
}

fn ply_text(mesh: &ClosedMesh) -> String {
    let (vertices, faces) = (mesh.vertices().len(), mesh.triangles().len());
    let mut text = format!(
        "ply\nformat ascii 1.0\ncomment of a test\nelement vertex {vertices}\nproperty float nx\nproperty double x\n\
         property double y\nproperty double z\nelement face {faces}\nproperty uchar flag\n\
         property list uchar int vertex_indices\nend_header\n"
    );
    for v in mesh.vertices() {
        writeln!(text, "7 {} {} {}", v.x, v.y, v.z).unwrap();
    }
    for [a, b, c] in mesh.triangles() {
        writeln!(text, "1 3 {a} {b} {c}").unwrap();
    }
    text
}

fn ply_binary(mesh: &ClosedMesh, is_big: bool) -> Vec<u8> {
    let (vertices, faces) = (mesh.vertices().len(), mesh.triangles().len());
    let order = if is_big { "big" } else { "little" };
    let mut bytes = format!(
        "ply\r\nformat binary_{order}_endian 1.0\r\nelement vertex {vertices}\r\nproperty double x\r\n\
         property double y\r\nproperty double z\r\nelement face {faces}\r\n\
         property list uint8 uint32 vertex_index\r\nend_header\r\n"
    )
    .into_bytes();
    for v in mesh.vertices() {
        for x in v.to_array() {
            bytes.extend(if is_big { x.to_be_bytes() } else { x.to_le_bytes() });
        }
    }
    for triangle in mesh.triangles() {
        bytes.push(3);
        for v in triangle {
            bytes.extend(if is_big { v.to_be_bytes() } else { v.to_le_bytes() });
        }
    }
    bytes
}

/// A GLB whose node turns and moves the mesh back to where it was.
fn glb(mesh: &ClosedMesh) -> Vec<u8> {
    let mut binary = Vec::new();
    for v in mesh.vertices() {
        // A quarter turn about z, half the size, one metre to x.
        for x in [-v.y / 2.0 + 1.0, v.x / 2.0, v.z / 2.0] {
            binary.extend((x as f32).to_le_bytes());
        }
    }
    let places = binary.len();
    mesh.triangles().iter().flatten().for_each(|&vertex| binary.extend((vertex as u16).to_le_bytes()));
    let indices = binary.len() - places;
    binary.resize(binary.len().next_multiple_of(4), 0);
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let json = serde_json::json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"children": [1], "rotation": [0.0, 0.0, -half, half], "scale": [2.0, 2.0, 2.0]},
                  {"mesh": 0, "translation": [-1.0, 0.0, 0.0]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": mesh.vertices().len(), "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 3 * mesh.triangles().len(), "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteLength": places},
                        {"buffer": 0, "byteOffset": places, "byteLength": indices}],
        "buffers": [{"byteLength": binary.len()}],
    });
    let mut json = json.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut bytes = b"glTF".to_vec();
    bytes.extend(2_u32.to_le_bytes());
    bytes.extend((28 + json.len() as u32 + binary.len() as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", json), (b"BIN\0", binary)] {
        bytes.extend((chunk.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    bytes
}

fn files() -> Vec<(&'static str, Vec<u8>)> {
    let mesh = solid();
    vec![
        ("a.obj", obj(&mesh).into_bytes()),
        ("a.stl", stl_text(&mesh).into_bytes()),
        ("b.STL", stl_binary(&mesh)),
        ("a.ply", ply_text(&mesh).into_bytes()),
        ("b.ply", ply_binary(&mesh, false)),
        ("c.ply", ply_binary(&mesh, true)),
        ("a.glb", glb(&mesh)),
    ]
}

#[test]
fn every_format_gives_the_same_solid() {
    let mesh = solid();
    for (name, bytes) in files() {
        let found = parse(Path::new(name), &bytes).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(found.vertices().len(), mesh.vertices().len(), "{name}");
        assert_eq!(found.triangles().len(), mesh.triangles().len(), "{name}");
        assert!((found.volume() / mesh.volume() - 1.0).abs() < 1e-5, "{name}");
        let [[low, high], [other_low, other_high]] = [found.bounds(), mesh.bounds()];
        assert!(low.distance(other_low) < 1e-5 && high.distance(other_high) < 1e-5, "{name}: {low} {high}");
    }
}

#[test]
fn gltf_reads_buffers_beside_it_and_within_it() {
    let folder = tempfile::tempdir().unwrap();
    let corners: [[f32; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let triangles = [0_usize, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3];
    let bytes: Vec<u8> =
        triangles.iter().flat_map(|&corner| corners[corner]).flat_map(f32::to_le_bytes).collect();
    let document = |uri: &str| {
        format!(
            r#"{{"meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}], "buffers": [{{"uri": "{uri}"}}],
            "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 12, "type": "VEC3"}}],
            "bufferViews": [{{"buffer": 0, "byteLength": 144}}]}}"#
        )
    };
    let path = folder.path().join("a.gltf");
    std::fs::write(folder.path().join("a.bin"), &bytes).unwrap();
    std::fs::write(&path, document("a.bin")).unwrap();
    assert!((read(&path).unwrap().volume() - 1.0 / 6.0).abs() < 1e-9);
    for uri in ["../a.bin", "/etc/passwd", "no.bin"] {
        std::fs::write(&path, document(uri)).unwrap();
        let message = read(&path).unwrap_err().to_string();
        assert!(message.contains(if uri == "no.bin" { "no.bin" } else { "another folder" }), "{message}");
    }
}

#[test]
fn files_that_are_cut_are_told_and_never_panic() {
    for (name, bytes) in files() {
        for length in (0..bytes.len()).step_by(bytes.len() / 60 + 1) {
            let message = match parse(Path::new(name), &bytes[..length]) {
                Ok(_) => panic!("{name} cut at {length} was read"),
                Err(error) => error.to_string(),
            };
            assert!(message.contains(name), "{message}");
        }
    }
}

#[test]
fn what_is_wrong_is_told_with_line_or_byte() {
    let message = |name: &str, bytes: &[u8]| parse(Path::new(name), bytes).unwrap_err().to_string();
    let cases: [(&str, &str, &str); 10] = [
        ("a.txt", "", "cannot be recognised as a mesh"),
        ("a.obj", "v 0 0 0\nv 1 x 0\n", "a.obj, line 2: y of a vertex is \"x\""),
        ("a.obj", "v 0 0 0\nf 1 2 3\n", "line 2: a corner of a face is \"2\""),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "the surface is not closed: 3 edges"),
        ("a.obj", "v 0 0 0\nf 1 1\n", "line 2: a face is \"of 2 corners\"; expected 3 to 4096"),
        ("a.stl", "solid a\nvertex 0 0 0\nendloop\n", "line 3: a facet is \"of 1 corners\""),
        (
            "a.ply",
            "ply\nformat ascii 1.0\nelement vertex 1\nend_header\n",
            "has no element vertex with x, y and z",
        ),
        ("a.ply", "ply\nelement vertex many\nend_header\n", "line 2: an element is \"element vertex many\""),
        ("a.ply", "ply\nformat ascii 1.0\n", "has no end_header"),
        ("a.gltf", "{\"scenes\": [{\"nodes\": [3]}]}", "the number of a node is \"3\""),
    ];
    for (name, text, expected) in cases {
        let message = message(name, text.as_bytes());
        assert!(message.contains(expected), "{message:?} should contain {expected:?}");
    }
    let head = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n\
                element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    let told = message("a.ply", format!("{head}0 0 0\n0 zero 0\n").as_bytes());
    assert!(told.contains("line 11: `y` of vertex 1 is \"zero\""), "{told}");
    // Counts that no file of this length can have take no memory.
    let mut bytes = stl_binary(&solid());
    bytes[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    bytes[..5].copy_from_slice(b"notxt");
    assert!(message("a.stl", &bytes).contains("within triangle"), "{}", message("a.stl", &bytes));
    let many = head.replace("vertex 2", "vertex 4000000000");
    assert!(message("a.ply", many.as_bytes()).contains("`x` of vertex 0"));
    let endless = r#"{"scenes": [{"nodes": [0]}], "nodes": [{"children": [0, 0]}]}"#;
    assert!(message("a.gltf", endless.as_bytes()).contains("a tree of nodes is not read"));
}
