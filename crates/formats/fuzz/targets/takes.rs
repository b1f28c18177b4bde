//! Takes, of which one file changes, with all that is read of them; pictures by themselves.

use std::path::Path;
use std::sync::Arc;

use backlit_formats::{Footage, MemoryFiles, Take, images};

use crate::engine::Outcome;
use crate::seeds;

/// Opens a take of which one file is replaced, and reads all of it.
pub(super) fn take(file: &'static str, bytes: &[u8]) -> Outcome {
    let mut files = vec![
        ("take.toml", seeds::file(if file.starts_with('m') { "take/masks.toml" } else { "take/take.toml" })),
        ("start.json", seeds::file("start/rest.json")),
        ("cameras.json", seeds::file("beside/cameras.json")),
        ("keypoints.csv", seeds::file("reference/keypoints.csv")),
    ];
    files.extend(["00.png", "01.png", "bg0.png"].map(|name| (name, seeds::file("png/0-colour.png"))));
    files.extend(["m0.png", "m1.png"].map(|name| (name, seeds::file("masks/0-grey.png"))));
    files.extend(["k0.json", "k1.json"].map(|name| (name, seeds::file("keypoints/openpose.json"))));
    for (path, content) in &mut files {
        if *path == file {
            *content = bytes.to_vec();
        }
    }
    read_all(files).map_or_else(Outcome::Refused, |()| Outcome::Read)
}

fn read_all(files: Vec<(&'static str, Vec<u8>)>) -> Result<(), String> {
    let take = Take::from_files(Arc::new(MemoryFiles::new(files)), Path::new("take.toml"))
        .map_err(|error| error.to_string())?;
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
        note(
            take.background(camera)
                .and_then(|mut plates| plates.try_for_each(|plate| plate.map(drop)))
                .map_err(|error| error.to_string()),
        );
        note(take.plate_knowledge(camera).map(drop).map_err(|error| error.to_string()));
    }
    note(take.keypoint_order().map(drop).map_err(|error| error.to_string()));
    first
}

/// A picture's size from its head is that of the picture.
pub(super) fn picture(bytes: &[u8]) -> Outcome {
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
