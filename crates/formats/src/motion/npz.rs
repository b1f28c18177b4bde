//! `NumPy` arrays in one file: a zip archive whose files are stored as they are, as `numpy.savez` makes it.

use glam::{DQuat, DVec3};

use super::frames::{JointTrust, MotionFrames, too_large};
use super::names;
use crate::FileProblem;

pub(super) fn to_bytes(scene: &MotionFrames<'_>) -> Result<Vec<u8>, FileProblem> {
    let model = scene.model;
    let names = names::joints(model, scene.names, false);
    let (n, r, j) = (scene.frames.len(), model.rotation_count(), names.len());
    let owners = model.rotation_owners().iter().map(|&limb| names[limb + 1].clone());
    let numbers = |frame: &(usize, _)| frame.0 as i64;
    let roots = scene.frames.iter().flat_map(|(_, pose)| scene.point(pose.root).to_array());
    let mut joints = scene.joints();
    let mut points = Vec::with_capacity(n * j * 3);
    for (_, pose) in &scene.frames {
        points.extend(joints.of(pose).flat_map(|point| point.to_array()));
    }
    let turns = scene.frames.iter().flat_map(|(_, pose)| {
        pose.rotations.iter().zip(model.rotation_parents()).flat_map(|(&q, parent)| {
            // Only what is relative to the world turns with it.
            let q = if parent.is_some() { q } else { scene.file_from_world * q };
            let DQuat { x, y, z, w } = q;
            [w, x, y, z]
        })
    });
    let limbs = model.limbs();
    let offsets = std::iter::once(DVec3::ZERO)
        .chain(limbs.iter().map(|limb| limb.direction * limb.length * scene.unit.per_metre()));
    let parents = std::iter::once(-1).chain(limbs.iter().map(|limb| limb.parent.map_or(0, |l| l as i64 + 1)));
    let rotation_of = std::iter::once(-1).chain(limbs.iter().map(|limb| limb.rotation as i64));
    let rotation_parents = model.rotation_parents().iter().map(|parent| parent.map_or(-1, |p| p as i64));
    let mut files = vec![
        ("frames.npy", integers(scene.frames.iter().map(numbers))),
        ("seconds.npy", doubles(&[n], scene.frames.iter().map(|frame| scene.seconds(frame.0)))),
        ("root.npy", doubles(&[n, 3], roots)),
        ("rotations.npy", doubles(&[n, r, 4], turns)),
        ("joints.npy", doubles(&[n, j, 3], points.into_iter())),
        ("joint_names.npy", texts(&names)),
        ("parents.npy", integers(parents)),
        ("rotation_names.npy", texts(&owners.collect::<Vec<_>>())),
        ("rotation_parents.npy", integers(rotation_parents)),
        ("rotation_of.npy", integers(rotation_of)),
        ("offsets.npy", doubles(&[j, 3], offsets.flat_map(|offset| offset.to_array()))),
    ];
    if scene.is_judged() {
        let trust: Vec<JointTrust> =
            scene.frames.iter().flat_map(|(frame, _)| scene.joint_trust(*frame)).collect();
        let errors = trust.iter().map(|joint| joint.error_95_m * scene.unit.per_metre());
        files.push(("wrong.npy", doubles(&[n, j], trust.iter().map(|joint| joint.wrong))));
        files.push(("error.npy", doubles(&[n, j], errors)));
    }
    store(&files)
}

/// A `.npy` file of version 1.0, row-major, its data at a multiple of 64 bytes.
fn array(kind: &str, shape: &[usize], data: &[u8]) -> Vec<u8> {
    let sides: String = shape.iter().map(|side| format!("{side},")).collect();
    let mut about = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({sides}), }}");
    let before = 10; // magic, version, length
    while (before + about.len() + 1) % 64 != 0 {
        about.push(' ');
    }
    about.push('\n');
    let mut out = b"\x93NUMPY\x01\x00".to_vec();
    out.extend((about.len() as u16).to_le_bytes());
    out.extend(about.as_bytes());
    out.extend(data);
    out
}

fn integers(values: impl Iterator<Item = i64>) -> Vec<u8> {
    let data: Vec<u8> = values.flat_map(i64::to_le_bytes).collect();
    array("<i8", &[data.len() / 8], &data)
}

fn doubles(shape: &[usize], values: impl Iterator<Item = f64>) -> Vec<u8> {
    let mut data = Vec::with_capacity(shape.iter().product::<usize>() * 8);
    for value in values {
        data.extend(value.to_le_bytes());
    }
    array("<f8", shape, &data)
}

fn texts(texts: &[String]) -> Vec<u8> {
    let width = texts.iter().map(|text| text.chars().count()).max().unwrap_or(0).max(1);
    let mut data = Vec::new();
    for text in texts {
        let letters = text.chars().map(u32::from).chain(std::iter::repeat(0)).take(width);
        data.extend(letters.flat_map(u32::to_le_bytes));
    }
    array(&format!("<U{width}"), &[texts.len()], &data)
}

fn length(bytes: usize) -> Result<u32, FileProblem> {
    u32::try_from(bytes).map_err(|_error| too_large(bytes))
}

/// An archive of these files.
fn store(files: &[(&str, Vec<u8>)]) -> Result<Vec<u8>, FileProblem> {
    let (mut out, mut directory) = (Vec::new(), Vec::new());
    for (name, content) in files {
        let (size, offset) = (length(content.len())?, length(out.len())?);
        // Version 2.0, no flags, stored, and the first day that a zip can name.
        let mut about = Vec::new();
        for value in [20_u16, 0, 0, 0, 0x21] {
            about.extend(value.to_le_bytes());
        }
        for value in [crc32fast::hash(content), size, size] {
            about.extend(value.to_le_bytes());
        }
        about.extend((name.len() as u16).to_le_bytes());
        about.extend([0, 0]);
        out.extend(b"PK\x03\x04");
        out.extend(&about);
        out.extend(name.as_bytes());
        out.extend(content);
        directory.extend(b"PK\x01\x02\x14\x00");
        directory.extend(&about);
        directory.extend([0; 10]); // no comment, first disk, no attributes
        directory.extend(offset.to_le_bytes());
        directory.extend(name.as_bytes());
    }
    let (offset, size, count) = (length(out.len())?, length(directory.len())?, files.len() as u16);
    out.extend(directory);
    out.extend(b"PK\x05\x06\x00\x00\x00\x00");
    out.extend(count.to_le_bytes());
    out.extend(count.to_le_bytes());
    out.extend(size.to_le_bytes());
    out.extend(offset.to_le_bytes());
    out.extend([0, 0]);
    Ok(out)
}
