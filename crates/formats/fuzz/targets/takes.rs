//! Takes, of which one file changes, with all that is read of them; pictures by themselves.

use std::path::Path;

use backlit_formats::{Footage, Take, calibration, images, pose_file};
use backlit_tracking::body::{Pose, builtin};
use backlit_tracking::camera::{Distortion, Rig};
use image::ImageFormat;

use super::texts::memory;
use crate::engine::{Outcome, Target};
use crate::mutate::Syntax;
use crate::seeds;

fn one_camera() -> Vec<u8> {
    let camera =
        seeds::rig(Distortion::OpenCv { k1: 0.1, k2: 0.0, p1: 0.0, p2: 0.0, k3: 0.0 }).cameras()[1].clone();
    let renamed = calibration::backlit::to_text(&Rig::new(vec![camera]).unwrap()).replace("cam1", "c");
    renamed.into_bytes()
}

fn start() -> Vec<u8> {
    let model = builtin::single_limb();
    pose_file::to_text(&model, &Pose::rest(&model)).into_bytes()
}

/// Opens a take of which one file is replaced, and reads all of it.
fn take(file: &'static str, bytes: &[u8]) -> Outcome {
    let mut files = vec![
        (
            "take.toml",
            seeds::kept("take", false).remove(usize::from(file == "take.toml" || !file.starts_with('m'))),
        ),
        ("start.json", start()),
        ("cameras.json", one_camera()),
        ("keypoints.csv", seeds::kept("reference", false).remove(0)),
    ];
    files.extend(["00.png", "01.png", "bg0.png"].map(|name| (name, seeds::picture(ImageFormat::Png))));
    files.extend(["m0.png", "m1.png"].map(|name| (name, seeds::masks().remove(0))));
    files.extend(["k0.json", "k1.json"].map(|name| (name, seeds::kept("keypoints", false).remove(0))));
    for (path, content) in &mut files {
        if *path == file {
            *content = bytes.to_vec();
        }
    }
    read_all(files).map_or_else(Outcome::Refused, |()| Outcome::Read)
}

fn read_all(files: Vec<(&'static str, Vec<u8>)>) -> Result<(), String> {
    let take = Take::from_files(memory(files), Path::new("take.toml")).map_err(|error| error.to_string())?;
    let mut first = Ok(());
    let mut note = |result: Result<(), String>| {
        if first.is_ok() {
            first = result;
        }
    };
    let footage = Footage::new(take.clone());
    for camera in 0..take.rig().count() {
        for frame in 0..take.frame_count().min(3) {
            note(take.frame(camera, frame).map(drop).map_err(|error| error.to_string()));
            note(take.people(camera, frame).map(drop).map_err(|error| error.to_string()));
            note(footage.given_mask(camera, frame).map(drop).map_err(|error| error.to_string()));
        }
        note(take.background(camera).map(drop).map_err(|error| error.to_string()));
        note(take.plate_knowledge(camera).map(drop).map_err(|error| error.to_string()));
    }
    note(take.keypoint_order().map(drop).map_err(|error| error.to_string()));
    first
}

/// A picture's size from its head is that of the picture.
fn picture(bytes: &[u8]) -> Outcome {
    let path = Path::new("picture");
    let found = images::decode(path, bytes);
    if let Ok(picture) = &found {
        let size = images::size(path, bytes).unwrap();
        assert_eq!([picture.width() as usize, picture.height() as usize], size);
        assert_eq!(images::decode_grey(path, bytes).unwrap().dimensions(), picture.dimensions());
        let alpha = images::alpha(path, bytes).unwrap();
        assert!(alpha.is_none_or(|alpha| alpha.len() == size[0] * size[1]));
    }
    found.into()
}

fn of_take(
    name: &'static str,
    seeds: fn() -> Vec<Vec<u8>>,
    words: &'static [&'static str],
    read: fn(&[u8]) -> Outcome,
) -> Target {
    Target { name, syntax: Syntax::Text, seeds, words, read, short: 400 }
}

pub(super) fn targets() -> Vec<Target> {
    const TAKE: &[&str] = &[
        "[[camera]]\n",
        "${HOME}",
        "${X:-a}",
        "../",
        "%02d.png",
        "{}",
        "{:03}.png",
        "shadow = [1]",
        "region = false",
        "closing_px",
        "opening_px",
        "last",
        "offset_seconds",
        "\"mm\"",
        "\"alpha\"",
        "1979-05-27",
    ];
    const CHUNKS: &[&str] =
        &["IHDR", "IDAT", "IEND", "PLTE", "tRNS", "acTL", "RIFF", "VP8L", "VP8X", "II*\0", "BM"];
    let picture_of = |name, seeds| Target {
        name,
        syntax: Syntax::Binary,
        seeds,
        words: CHUNKS,
        read: picture as fn(&[u8]) -> Outcome,
        short: 1000,
    };
    vec![
        of_take("take", || seeds::kept("take", false), TAKE, |bytes| take("take.toml", bytes)),
        of_take(
            "reference",
            || seeds::kept("reference", false),
            &["root", "limb", "\"\"", "\r\n"],
            |bytes| take("keypoints.csv", bytes),
        ),
        of_take("start", || vec![start()], &[], |bytes| take("start.json", bytes)),
        Target {
            syntax: Syntax::Binary,
            ..of_take("masks", || seeds::masks().drain(..2).collect(), CHUNKS, |bytes| take("m1.png", bytes))
        },
        picture_of("png", seeds::png),
        picture_of("jpeg", seeds::jpeg),
        picture_of("tiff", seeds::tiff),
        picture_of("webp", seeds::webp),
        picture_of("bmp", seeds::bmp),
    ]
}
