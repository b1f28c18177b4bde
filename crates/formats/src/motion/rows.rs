//! CSV: `frame,seconds,joint,x,y,z`. Numbers read back to the bit.

use std::fmt::Write;

use super::names;
use super::scene::Scene;

pub(super) fn to_bytes(scene: &Scene<'_>) -> Vec<u8> {
    let names: Vec<String> =
        names::joints(scene.model, scene.names, false).iter().map(|name| quoted(name)).collect();
    let mut out = "frame,seconds,joint,x,y,z\n".to_owned();
    let mut joints = scene.joints();
    for (frame, pose) in &scene.frames {
        let seconds = scene.seconds(*frame);
        for (name, point) in names.iter().zip(joints.of(pose)) {
            // Writing to a string cannot fail.
            let _ = writeln!(out, "{frame},{seconds},{name},{},{},{}", point.x, point.y, point.z);
        }
    }
    out.into_bytes()
}

fn quoted(name: &str) -> String {
    if name.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", name.replace('"', "\"\""))
    } else {
        name.to_owned()
    }
}
