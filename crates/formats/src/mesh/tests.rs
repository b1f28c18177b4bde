//! The same solid in every format, and what is wrong with each in words.

use super::*;

/// The same ball in every format, in the folder `tests/meshes`: text with references of all kinds and exponents, properties that are
/// passed over, both orders of bytes, an STL whose title deceives, a GLB whose nodes turn, scale and move it.
fn files() -> Vec<(&'static str, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes");
    let names = ["a.obj", "a.stl", "b.STL", "a.ply", "b.ply", "c.ply", "a.glb"];
    names.map(|name| (name, std::fs::read(folder.join(name)).unwrap())).to_vec()
}

#[test]
fn every_format_gives_the_same_solid() {
    let mesh = parse(Path::new("a.obj"), &files()[0].1).unwrap();
    let ball = 4.0 / 3.0 * std::f64::consts::PI * 0.8_f64.powi(3);
    assert!((0.8..1.0).contains(&(mesh.volume() / ball)), "{}", mesh.volume() / ball);
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
    let mut bytes = files()[2].1.clone();
    bytes[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    bytes[..5].copy_from_slice(b"notxt");
    assert!(message("a.stl", &bytes).contains("within triangle"), "{}", message("a.stl", &bytes));
    let many = head.replace("vertex 2", "vertex 4000000000");
    assert!(message("a.ply", many.as_bytes()).contains("`x` of vertex 0"));
    let endless = r#"{"scenes": [{"nodes": [0]}], "nodes": [{"children": [0, 0]}]}"#;
    assert!(message("a.gltf", endless.as_bytes()).contains("a tree of nodes is not read"));
}
