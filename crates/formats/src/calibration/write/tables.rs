//! Formats with one table, object or frame a camera.

use std::fmt::Write as _;

use backlit_tracking::camera::{Camera, CameraFromWorld, Distortion, Rig};
use glam::{DMat3, DVec3};

use super::super::lens::vector_from_rotation;
use super::{Refusal, list, matrix, no_lens, no_name, plain, plain_four, quoted, rotation};

pub(super) fn pose2sim(rig: &Rig) -> Result<String, Refusal> {
    let mut out = String::new();
    for camera in rig.cameras() {
        let lens = plain_four(camera, "Pose2Sim")?;
        check_key(camera, "Pose2Sim")?;
        toml_camera(&mut out, &quoted(camera.name()), camera, &lens, false);
    }
    out.push_str("[metadata]\nadjusted = false\nerror = 0.0\n");
    Ok(out)
}

pub(super) fn anipose(rig: &Rig) -> Result<String, Refusal> {
    let mut out = String::new();
    for (index, camera) in rig.cameras().iter().enumerate() {
        check_key(camera, "Anipose")?;
        let key = format!("cam_{index}");
        match *camera.distortion() {
            Distortion::Fisheye { k1, k2, k3, k4 } => {
                toml_camera(&mut out, &key, camera, &[k1, k2, k3, k4], true);
            }
            _ => {
                toml_camera(&mut out, &key, camera, &plain(camera, "Anipose")?, false);
            }
        }
    }
    out.push_str("[metadata]\nadjusted = false\nerror = 0.0\n");
    Ok(out)
}

/// The table `metadata` is no camera's.
fn check_key(camera: &Camera, format: &'static str) -> Result<(), Refusal> {
    if camera.name() == "metadata" {
        return Err(no_name(camera, format, "another than metadata"));
    }
    Ok(())
}

fn toml_camera(out: &mut String, key: &str, camera: &Camera, lens: &[f64], is_fisheye: bool) {
    let place = camera.camera_from_world();
    let _ = writeln!(out, "[{key}]\nname = {}", quoted(camera.name()));
    let _ = writeln!(out, "size = [ {}, {}]", camera.width(), camera.height());
    let _ = writeln!(out, "matrix = [ {}]", rows(&matrix(camera)));
    let _ = writeln!(out, "distortions = [ {}]", list(lens));
    let _ = writeln!(out, "rotation = [ {}]", list(&vector_from_rotation(place.rotation)));
    let _ =
        writeln!(out, "translation = [ {}]\nfisheye = {is_fisheye}\n", list(&place.translation.to_array()));
}

/// Three by three, every row in brackets.
fn rows(numbers: &[f64; 9]) -> String {
    numbers.chunks_exact(3).map(|row| format!("[{}]", list(row))).collect::<Vec<_>>().join(", ")
}

pub(super) fn kalibr(rig: &Rig) -> Result<String, Refusal> {
    let mut out = String::new();
    let mut before: Option<CameraFromWorld> = None;
    for (index, camera) in rig.cameras().iter().enumerate() {
        let key = format!("cam{index}");
        if camera.name() != key {
            return Err(no_name(camera, "Kalibr", &key));
        }
        let (model, lens) = match *camera.distortion() {
            Distortion::None => ("none", Vec::new()),
            Distortion::Fisheye { k1, k2, k3, k4 } => ("equidistant", vec![k1, k2, k3, k4]),
            _ => ("radtan", plain_four(camera, "Kalibr")?.to_vec()),
        };
        let (k, place) = (camera.intrinsics(), *camera.camera_from_world());
        let _ = writeln!(out, "{key}:\n  camera_model: pinhole");
        let _ = writeln!(out, "  intrinsics: [{}]", list(&[k.fx, k.fy, k.cx, k.cy]));
        let _ = writeln!(out, "  distortion_model: {model}\n  distortion_coeffs: [{}]", list(&lens));
        if let Some(before) = before {
            let turn = place.rotation * before.rotation.transpose();
            let shift = place.translation - turn * before.translation;
            out.push_str("  T_cn_cnm1:\n");
            for row in 0..3 {
                let axis = turn.row(row);
                let _ = writeln!(out, "  - [{}]", list(&[axis.x, axis.y, axis.z, shift[row]]));
            }
            out.push_str("  - [0.0, 0.0, 0.0, 1.0]\n");
        } else if place.rotation != DMat3::IDENTITY || place.translation != DVec3::ZERO {
            return Err(Refusal::Place { camera: camera.name().to_owned(), format: "Kalibr" });
        }
        let _ = writeln!(out, "  resolution: [{}, {}]", camera.width(), camera.height());
        before = Some(place);
    }
    Ok(out)
}

pub(super) fn matrices(rig: &Rig) -> Result<String, Refusal> {
    let mut cameras = Vec::with_capacity(rig.count());
    for camera in rig.cameras() {
        let lens = plain(camera, "JSON of matrices")?;
        let place = camera.camera_from_world();
        cameras.push(format!(
            "  {}: {{\"size\": [{}, {}],\n    \"K\": [{}],\n    \"dist\": [{}],\n    \"R\": [{}],\n    \"t\": [{}]}}",
            quoted(camera.name()),
            camera.width(),
            camera.height(),
            rows(&matrix(camera)),
            list(&lens),
            rows(&rotation(camera)),
            list(&place.translation.to_array())
        ));
    }
    Ok(format!("{{\"cameras\": {{\n{}\n}}}}\n", cameras.join(",\n")))
}

pub(super) fn transforms(rig: &Rig) -> Result<String, Refusal> {
    const NAME: &str = "transforms.json";
    let is_fisheye = |camera: &Camera| matches!(camera.distortion(), Distortion::Fisheye { .. });
    let all_fisheye = rig.cameras().iter().all(is_fisheye);
    let mut frames = Vec::with_capacity(rig.count());
    for camera in rig.cameras() {
        let lens: Vec<(&str, f64)> = if all_fisheye {
            camera.distortion().coefficients()
        } else if is_fisheye(camera) {
            return Err(no_lens(camera, NAME, camera.distortion()));
        } else {
            ["k1", "k2", "p1", "p2", "k3"].into_iter().zip(plain(camera, NAME)?).collect()
        };
        let lens: Vec<String> = lens.iter().map(|(key, value)| format!("\"{key}\": {value:?}")).collect();
        let (k, place) = (camera.intrinsics(), camera.camera_from_world());
        let (axes, centre) = (place.rotation.transpose(), place.centre());
        let mut world_from_camera = Vec::with_capacity(4);
        for row in 0..3 {
            let axis = axes.row(row);
            // OpenGL's y goes up, and its z backwards.
            world_from_camera.push(format!("[{}]", list(&[axis.x, -axis.y, -axis.z, centre[row]])));
        }
        world_from_camera.push("[0.0, 0.0, 0.0, 1.0]".to_owned());
        frames.push(format!(
            "    {{\"file_path\": {}, \"w\": {}, \"h\": {},\n      \"fl_x\": {:?}, \"fl_y\": {:?}, \"cx\": {:?}, \"cy\": \
             {:?},\n      {},\n      \"transform_matrix\": [{}]}}",
            quoted(camera.name()),
            camera.width(),
            camera.height(),
            k.fx,
            k.fy,
            k.cx + 0.5,
            k.cy + 0.5,
            lens.join(", "),
            world_from_camera.join(", ")
        ));
    }
    let model = if all_fisheye { "OPENCV_FISHEYE" } else { "OPENCV" };
    Ok(format!("{{\"camera_model\": \"{model}\", \"frames\": [\n{}\n]}}\n", frames.join(",\n")))
}
