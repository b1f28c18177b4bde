//! `OpenCV`'s `FileStorage`: a map a camera, whose keys are `camera_0` and so on, since not every name can be a key.

use std::fmt::Write as _;

use backlit_tracking::camera::{Camera, Distortion, Rig};

use super::{Refusal, list, matrix, no_name, plain, quoted, rotation};

/// A matrix under its key.
struct Matrix {
    key: &'static str,
    rows: usize,
    data: Vec<f64>,
}

fn matrices(camera: &Camera) -> [Matrix; 4] {
    let mut lens: Vec<f64> = camera.distortion().coefficients().iter().map(|(_, value)| *value).collect();
    if lens.is_empty() {
        lens = vec![0.0; 5];
    }
    [
        Matrix { key: "camera_matrix", rows: 3, data: matrix(camera).to_vec() },
        Matrix { key: "distortion_coefficients", rows: 1, data: lens },
        Matrix { key: "R", rows: 3, data: rotation(camera).to_vec() },
        Matrix { key: "T", rows: 3, data: camera.camera_from_world().translation.to_array().to_vec() },
    ]
}

/// Whole numbers under their keys.
fn scalars(camera: &Camera) -> [(&'static str, usize); 3] {
    let is_fisheye = matches!(camera.distortion(), Distortion::Fisheye { .. });
    [
        ("image_width", camera.width()),
        ("image_height", camera.height()),
        ("fisheye_model", usize::from(is_fisheye)),
    ]
}

pub(super) fn yaml(rig: &Rig) -> String {
    let mut out = "%YAML:1.0\n---\n".to_owned();
    for (index, camera) in rig.cameras().iter().enumerate() {
        let _ = writeln!(out, "camera_{index}:\n   name: {}", quoted(camera.name()));
        for (key, value) in scalars(camera) {
            let _ = writeln!(out, "   {key}: {value}");
        }
        for matrix in matrices(camera) {
            yaml_matrix(&mut out, "   ", matrix.key, matrix.rows, &matrix.data);
        }
    }
    out
}

fn yaml_matrix(out: &mut String, indent: &str, key: &str, rows: usize, data: &[f64]) {
    let columns = data.len() / rows;
    let _ =
        writeln!(out, "{indent}{key}: !!opencv-matrix\n{indent}   rows: {rows}\n{indent}   cols: {columns}");
    let _ = writeln!(out, "{indent}   dt: d\n{indent}   data: [ {} ]", list(data));
}

pub(super) fn xml(rig: &Rig) -> Result<String, Refusal> {
    let mut out = "<?xml version=\"1.0\"?>\n<opencv_storage>\n".to_owned();
    for (index, camera) in rig.cameras().iter().enumerate() {
        if camera.name().contains(|letter: char| letter == '"' || letter.is_control()) {
            return Err(no_name(camera, "XML of OpenCV", "no quotation mark"));
        }
        let name = camera.name().replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
        let _ = writeln!(out, "<camera_{index}>\n  <name>\"{name}\"</name>");
        for (key, value) in scalars(camera) {
            let _ = writeln!(out, "  <{key}>{value}</{key}>");
        }
        for Matrix { key, rows, data } in matrices(camera) {
            let (columns, numbers) = (data.len() / rows, list(&data).replace(',', ""));
            let _ = writeln!(out, "  <{key} type_id=\"opencv-matrix\">\n    <rows>{rows}</rows>");
            let _ = writeln!(
                out,
                "    <cols>{columns}</cols>\n    <dt>d</dt>\n    <data>{numbers}</data></{key}>"
            );
        }
        let _ = writeln!(out, "</camera_{index}>");
    }
    out.push_str("</opencv_storage>\n");
    Ok(out)
}

pub(super) fn json(rig: &Rig) -> String {
    let cameras = rig.cameras().iter().enumerate().map(|(index, camera)| {
        let mut entries = vec![format!("\"name\": {}", quoted(camera.name()))];
        entries.extend(scalars(camera).map(|(key, value)| format!("\"{key}\": {value}")));
        entries.extend(matrices(camera).map(|Matrix { key, rows, data }| {
            let (columns, numbers) = (data.len() / rows, list(&data));
            format!(
                "\"{key}\": {{\"type_id\": \"opencv-matrix\", \"rows\": {rows}, \"cols\": {columns}, \"dt\": \"d\", \
                 \"data\": [{numbers}]}}"
            )
        }));
        format!("    \"camera_{index}\": {{\n        {}\n    }}", entries.join(",\n        "))
    });
    format!("{{\n{}\n}}\n", cameras.collect::<Vec<_>>().join(",\n"))
}

pub(super) fn easymocap(rig: &Rig) -> Result<[String; 2], Refusal> {
    let mut texts = ["%YAML:1.0\n---\nnames:\n", "%YAML:1.0\n---\nnames:\n"].map(str::to_owned);
    for camera in rig.cameras() {
        let name = camera.name();
        let is_key = |letter: char| letter.is_ascii_alphanumeric() || matches!(letter, '_' | '-' | ' ');
        if !name.chars().all(is_key) || name.trim() != name {
            return Err(no_name(camera, "EasyMocap", "letters, digits, - and _"));
        }
        texts.iter_mut().for_each(|text| text.push_str(&format!("   - {}\n", quoted(name))));
    }
    let [mut intri, mut extri] = texts;
    for camera in rig.cameras() {
        let name = camera.name();
        let place = camera.camera_from_world();
        yaml_matrix(&mut intri, "", &format!("K_{name}"), 3, &matrix(camera));
        yaml_matrix(&mut intri, "", &format!("dist_{name}"), 1, &plain(camera, "EasyMocap")?);
        let _ = writeln!(intri, "H_{name}: {}\nW_{name}: {}", camera.height(), camera.width());
        let vector = super::super::lens::vector_from_rotation(place.rotation);
        yaml_matrix(&mut extri, "", &format!("R_{name}"), 3, &vector);
        yaml_matrix(&mut extri, "", &format!("Rot_{name}"), 3, &rotation(camera));
        yaml_matrix(&mut extri, "", &format!("T_{name}"), 3, &place.translation.to_array());
    }
    Ok([intri, extri])
}
