//! Files that a take reads outside its own folder are known once it is open.

use std::fs;
use std::path::{Path, PathBuf};

use backlit_formats::Take;
use image::RgbImage;

use crate::small_videos::cameras;

/// A folder with a take in `take`, its pictures and plate also in `elsewhere`.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for place in ["take", "elsewhere"] {
        let place = folder.path().join(place);
        fs::create_dir_all(place.join("a")).unwrap();
        fs::write(place.join("cameras.json"), cameras(&["a"], [8, 6], 9, "")).unwrap();
        for name in ["3.png", "4.png", "plate.png"] {
            RgbImage::new(8, 6).save(place.join("a").join(name)).unwrap();
        }
    }
    folder
}

/// Opens the take with these paths: of the folder of the footage, calibration, frames and plate.
fn open(folder: &Path, [footage, calibration, frames, plate]: [&str; 4]) -> Take {
    let text = format!(
        "format = \"backlit-take 1\"\nname = \"t\"\nframe_rate = 30\nmodel = \"full_body\"\nfootage = \"{footage}\"\n\
         [cameras]\ncalibration = \"{calibration}\"\n\
         [[camera]]\nname = \"a\"\nframes = \"{frames}\"\nfirst = 3\nbackground = \"{plate}\"\n"
    );
    fs::write(folder.join("take/take.toml"), text).unwrap();
    Take::open(&folder.join("take")).unwrap()
}

/// The first path outside, behind links, and how many there are.
fn outside(take: &Take) -> Option<(PathBuf, usize)> {
    take.outside().map(|outside| (outside.first.canonicalize().unwrap(), outside.count))
}

#[test]
fn a_take_of_its_own_folder_reads_nothing_outside() {
    let folder = folder();
    for footage in ["", ".", "a/../../take", folder.path().join("take").to_str().unwrap()] {
        let take = open(folder.path(), [footage, "cameras.json", "a/%d.png", "a/plate.png"]);
        assert_eq!(take.outside(), None, "{footage}");
    }
}

#[test]
fn what_lies_outside_is_counted_and_the_first_is_named() {
    let folder = folder();
    let elsewhere = folder.path().join("elsewhere").canonicalize().unwrap();
    let all = open(folder.path(), ["../elsewhere", "cameras.json", "a/%d.png", "a/plate.png"]);
    assert_eq!(outside(&all), Some((elsewhere.join("cameras.json"), 3)));
    let said = all.outside().unwrap().to_string();
    assert!(said.starts_with("the take reads outside its own folder: "), "{said}");
    assert!(said.ends_with("elsewhere/cameras.json, and 2 more paths that it names"), "{said}");

    let frames = elsewhere.join("a/%d.png");
    let one = open(folder.path(), [".", "cameras.json", frames.to_str().unwrap(), "a/plate.png"]);
    assert_eq!(outside(&one), Some((elsewhere.join("a/3.png"), 1)), "the first picture stands for all");
    assert!(one.outside().unwrap().to_string().ends_with("elsewhere/a/3.png"));

    // A folder whose name only begins as the take's does is another one.
    fs::rename(folder.path().join("elsewhere"), folder.path().join("take2")).unwrap();
    let two = open(folder.path(), [".", "cameras.json", "../take2/a/%d.png", "../take2/a/plate.png"]);
    assert_eq!(outside(&two).unwrap().1, 2);
}

#[cfg(unix)]
#[test]
fn a_link_that_leads_outside_is_seen() {
    let folder = folder();
    let link = folder.path().join("take/a/plate.png");
    fs::remove_file(&link).unwrap();
    std::os::unix::fs::symlink(folder.path().join("elsewhere/a/plate.png"), &link).unwrap();
    let take = open(folder.path(), [".", "cameras.json", "a/%d.png", "a/plate.png"]);
    assert_eq!(
        take.outside().map(|outside| (outside.first.clone(), outside.count)),
        Some((folder.path().join("take/./a/plate.png"), 1))
    );

    // A take that is reached by a link lies where the link leads.
    fs::remove_file(&link).unwrap();
    fs::copy(folder.path().join("elsewhere/a/plate.png"), &link).unwrap();
    let other = folder.path().join("other");
    std::os::unix::fs::symlink(folder.path().join("take"), &other).unwrap();
    assert_eq!(Take::open(&other).unwrap().outside(), None);
}
