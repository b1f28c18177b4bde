//! Videos of several makings against what ffmpeg and OpenCV find in them.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Arc;

use backlit_formats::MemoryFiles;
use backlit_formats::video::Video;
use image::RgbImage;
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use serde_json::Value;

use crate::calibration_files::formats;

/// Grey levels that two decoders and colour conversions may differ by.
const TOLERANCE: f64 = 3.0;
/// Grey levels by which the mean of a frame may differ.
const MEAN_TOLERANCE: f64 = 0.2;

/// Says that something is not tested.
pub(crate) fn skipped(what: &str, why: &str) {
    // Not by a macro: what those print of a test that passes is not shown.
    let mut screen = std::io::stderr();
    writeln!(screen, "SKIPPED {what}: {why}").unwrap();
}

/// Whether `ffmpeg` can be started; without it the test is to be skipped.
pub(crate) fn has_ffmpeg() -> bool {
    let silent = |program: &str| {
        let mut command = Command::new(program);
        command
            .arg("-version")
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .status()
            .is_ok()
    };
    let there = silent("ffmpeg") && silent("ffprobe");
    if !there {
        let test = std::thread::current();
        skipped(test.name().unwrap_or("a test"), "ffmpeg and ffprobe are not installed");
    }
    there
}

fn expected(folder: &Path, file: &str) -> Value {
    serde_json::from_slice(&std::fs::read(folder.join("expected").join(file)).unwrap()).unwrap()
}

fn mean_grey(picture: &RgbImage) -> f64 {
    let weights = [0.299, 0.587, 0.114];
    let grey =
        |pixel: &image::Rgb<u8>| -> f64 { pixel.0.iter().zip(weights).map(|(&v, w)| f64::from(v) * w).sum() };
    picture.pixels().map(grey).sum::<f64>() / f64::from(picture.width() * picture.height())
}

/// Everything that `expected` says of a video, in order and then at random.
fn check(path: &Path, expected: &Value) {
    let name = path.display();
    let video = Video::open(path).unwrap_or_else(|error| panic!("{error}"));
    let size = ["width", "height"].map(|side| expected[side].as_u64().unwrap() as usize);
    assert_eq!(video.size(), size, "{name}");
    let greys = expected["mean_grey"].as_array().unwrap();
    if let Some(times) = expected["pts_seconds"].as_array() {
        assert_eq!(video.frame_count(), times.len(), "{name}");
        for (found, time) in video.seconds().iter().zip(times) {
            assert!((found - time.as_f64().unwrap()).abs() < 1e-5, "{name}: {found} {time}");
        }
    } else {
        assert_eq!(video.frame_count(), greys.len(), "{name}");
    }
    for (frame, grey) in greys.iter().enumerate() {
        let picture = video.frame(frame).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!([picture.width() as usize, picture.height() as usize], size);
        let difference = (mean_grey(&picture) - grey.as_f64().unwrap()).abs();
        assert!(difference < MEAN_TOLERANCE, "{name}, frame {frame}: off by {difference}");
    }
    // Where ffmpeg takes over, it decodes again what waits to be shown.
    let twice = if has_ffmpeg() { 4 } else { 0 };
    let decoded = video.decoded_count();
    assert!(
        decoded <= video.frame_count() + twice,
        "{name}: read in order, a frame costs one decode, not {decoded}"
    );
    let none = serde_json::Map::new();
    for (frame, pixels) in expected["pixels_bgr_frames_0_10_39"].as_object().unwrap_or(&none) {
        let picture = video.frame(frame.parse().unwrap()).unwrap();
        for (place, bgr) in expected["pixels_xy"].as_array().unwrap().iter().zip(pixels.as_array().unwrap()) {
            let [x, y] = [0, 1].map(|k| place[k].as_u64().unwrap() as u32);
            for channel in 0..3 {
                let found = i64::from(picture.get_pixel(x, y).0[2 - channel]);
                let difference = (found - bgr[channel].as_i64().unwrap()).abs();
                assert!(difference as f64 <= TOLERANCE, "{name}, frame {frame}, ({x}, {y}): {found} {bgr}");
            }
        }
    }
    // A leap passes pictures of which no others are made, and shows the same.
    let leaping = Video::open(path).unwrap();
    let last = greys.len() - 1;
    assert_eq!(leaping.frame(last).unwrap(), video.frame(last).unwrap(), "{name}, the last frame");
    if name.to_string().ends_with("h264_bframes.mp4") && !has_ffmpeg() {
        assert!(leaping.decoded_count() < last, "{name}: {} of {last}", leaping.decoded_count());
    }
    // Any frame after any other is the same as in order.
    let fresh = Video::open(path).unwrap();
    for k in 0..24 {
        let frame = k * 17 % greys.len();
        assert_eq!(fresh.frame(frame).unwrap(), video.frame(frame).unwrap(), "{name}, frame {frame}");
    }
}

fn file(folder: &Path, name: &str) -> PathBuf {
    folder.join("videos").join(name)
}

#[test]
fn videos_of_several_makings_are_as_expected() {
    let Some(folder) = formats() else { return };
    let expected = expected(&folder, "videos/expected.json");
    for (name, expected) in expected.as_object().unwrap() {
        if expected["pts_seconds"].as_array().unwrap().is_empty() || (name == "hevc.mp4" && !has_ffmpeg()) {
            continue;
        }
        check(&file(&folder, name), expected);
    }
}

#[test]
fn videos_of_the_project_are_as_expected() {
    let Some(folder) = formats() else { return };
    let expected = expected(&folder, "project/videos.json");
    for (name, expected) in expected.as_object().unwrap() {
        if !name.ends_with(".mp4") || (name == "cam02.mp4" && !has_ffmpeg()) {
            continue;
        }
        let video = Video::open(&folder.join("project_pose2sim_single/videos").join(name)).unwrap();
        let size = ["width", "height"].map(|side| expected[side].as_u64().unwrap() as usize);
        let frames = expected["frames"].as_u64().unwrap() as usize;
        assert_eq!((video.size(), video.frame_count()), (size, frames), "{name}");
        // A second's worth of decoding; all of them were compared by hand.
        for frame in 0..6 {
            let grey = expected["mean_grey"][frame].as_f64().unwrap();
            assert!(
                (mean_grey(&video.frame(frame).unwrap()) - grey).abs() < MEAN_TOLERANCE,
                "{name}, frame {frame}"
            );
        }
    }
}

#[test]
fn a_video_without_its_index_says_so() {
    let Some(folder) = formats() else { return };
    let message = Video::open(&file(&folder, "truncated_no_index.mp4")).unwrap_err().to_string();
    assert!(message.contains("truncated_no_index.mp4: has no index"), "{message}");
    let cut = Video::open(&file(&folder, "truncated_index_first.mp4")).unwrap();
    assert_eq!((cut.frame_count(), cut.notes().len()), (20, 1));
    assert!(cut.notes()[0].contains("of 40 frames, those from 20 on are missing"), "{:?}", cut.notes());
}

/// Opens a video from memory and asks for its first frames; how many could be had.
fn frames_of(bytes: Vec<u8>) -> Option<usize> {
    let files = MemoryFiles::new([("v.mov", bytes)]);
    let video = Video::from_files(&files, Path::new("v.mov"), Arc::default()).ok()?;
    Some((0..video.frame_count().min(6)).filter(|&frame| video.frame(frame).is_ok()).count())
}

#[test]
fn h264_that_is_cut_or_changed_never_panics() {
    let Some(folder) = formats() else { return };
    let whole = std::fs::read(file(&folder, "h264.mov")).unwrap();
    assert_eq!(frames_of(whole.clone()), Some(6));
    let mut runner = TestRunner::new(Config { failure_persistence: None, ..Config::with_cases(30) });
    let changes = prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..30);
    let result = runner.run(&changes, |changes| {
        let mut bytes = whole.clone();
        for (at, value) in changes {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        frames_of(bytes);
        Ok(())
    });
    result.unwrap();
    let cut = std::fs::read(file(&folder, "truncated_index_first.mp4")).unwrap();
    let mut most = 0;
    for length in (0..cut.len()).step_by(1777) {
        let there = frames_of(cut[..length].to_vec()).unwrap_or(0);
        assert!(there >= most, "{length}: {there}");
        most = there;
    }
    assert_eq!(most, 6);
}
