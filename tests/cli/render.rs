//! `backlit render`.

use std::fs;
use std::path::Path;

use backlit_formats::images;

use crate::scene::{RENDER, Scene};

/// Shape and values of an array of doubles.
pub(crate) fn read_npy(path: &Path) -> (String, Vec<f64>) {
    let bytes = fs::read(path).unwrap();
    assert_eq!(&bytes[..6], b"\x93NUMPY");
    let end = bytes.iter().position(|&byte| byte == b'\n').unwrap() + 1;
    let header = String::from_utf8_lossy(&bytes[10..end]);
    assert!(header.contains("<f8") && header.contains("False"), "{header}");
    let shape = header.split_once('(').unwrap().1.split_once(')').unwrap().0.to_owned();
    let values = bytes[end..].chunks_exact(8).map(|chunk| f64::from_le_bytes(chunk.try_into().unwrap()));
    (shape.trim_end_matches([',', ' ']).to_owned(), values.collect())
}

#[test]
fn render_writes_pictures_and_arrays() {
    let scene = Scene::new();
    for (renderer, columns, jacobian) in
        [("capsule", 27, "tangent"), ("cylinder", 35, "raw"), ("sphere-tree --spheres 5", 35, "raw")]
    {
        scene.ok(&format!("{RENDER} --renderer {renderer} --ramp thesis --npy --jacobian {jacobian}"));
        for name in ["front", "side"] {
            let picture = images::read_grey(&scene.path("out").join(format!("{name}.png"))).unwrap();
            let (shape, levels) = read_npy(&scene.path("out").join(format!("{name}.prediction.npy")));
            assert_eq!(shape, "96, 128");
            assert!(levels.iter().any(|&level| level < 10.0), "{renderer}: nobody is seen by {name}");
            let rounded: Vec<u8> = levels.iter().map(|level| level.round() as u8).collect();
            assert_eq!(picture.as_raw(), &rounded);
            let (shape, slopes) = read_npy(&scene.path("out").join(format!("{name}.jacobian.npy")));
            assert_eq!(shape, format!("12288, {columns}"));
            // Row-major: a pixel that no ramp touches has a row of zeros, a grey one has not.
            for (level, row) in levels.iter().zip(slopes.chunks_exact(columns)) {
                let pulls = row.iter().any(|&slope| slope != 0.0);
                assert_eq!(pulls, *level > 0.0 && *level < 255.0, "{renderer}, {name}: λ = {level}");
            }
        }
    }
}

#[test]
fn render_takes_quaternions_as_they_are() {
    let scene = Scene::new();
    let text = r#"{"format": "backlit-pose 1", "root": [0, 0, 0], "rotations": {"torso": [Q, 0, 0, 0]}}"#;
    let dark = |q: &str| {
        scene.write("pose.json", &text.replace('Q', q));
        scene.ok(&format!("{RENDER} --npy"));
        let (_, levels) = read_npy(&scene.path("out").join("front.prediction.npy"));
        levels.iter().map(|level| 255.0 - level).sum::<f64>()
    };
    let (one, longer) = (dark("1"), dark("1.2"));
    assert!(longer > 1.05 * one, "a longer quaternion makes longer limbs: {one} {longer}");
}

#[test]
fn a_jacobian_of_absurd_size_is_refused_before_anything_is_written() {
    let scene = Scene::new();
    let text = fs::read_to_string(scene.path("cameras.json")).unwrap();
    let large = text.replacen("128", "8192", 1).replacen("96", "8192", 1);
    assert_ne!(text, large);
    scene.write("cameras.json", &large);
    scene.fails(&format!("{RENDER} --jacobian raw"), 1, &["camera \"front\"", "35 columns", "MiB"]);
    assert!(!scene.path("out").exists());
}
