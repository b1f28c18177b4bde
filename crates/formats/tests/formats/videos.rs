//! Videos of several makings against what ffmpeg and OpenCV find in them.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use backlit_formats::video::Video;
use image::RgbImage;
use serde_json::Value;

use crate::calibration_files::formats;

/// Grey levels that two decoders and colour conversions may differ by.
const TOLERANCE: f64 = 3.0;

/// Whether `ffmpeg` can be started; without it the test is to be skipped.
fn has_ffmpeg() -> bool {
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
        let mut screen = std::io::stderr();
        let name = test.name().unwrap_or("a test");
        writeln!(screen, "SKIPPED {name}: ffmpeg and ffprobe are not installed").unwrap();
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
    let mut worst: f64 = 0.0;
    for (frame, grey) in greys.iter().enumerate() {
        let picture = video.frame(frame).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!([picture.width() as usize, picture.height() as usize], size);
        let difference = (mean_grey(&picture) - grey.as_f64().unwrap()).abs();
        worst = worst.max(difference);
        // A neighbouring frame's mean differs by a tenth: that it is this very one is what the pixels tell.
        assert!(difference < TOLERANCE, "{name}, frame {frame}: off by {difference}");
    }
    let mut pixel_worst = 0;
    let none = serde_json::Map::new();
    for (frame, pixels) in expected["pixels_bgr_frames_0_10_39"].as_object().unwrap_or(&none) {
        let picture = video.frame(frame.parse().unwrap()).unwrap();
        for (place, bgr) in expected["pixels_xy"].as_array().unwrap().iter().zip(pixels.as_array().unwrap()) {
            let [x, y] = [0, 1].map(|k| place[k].as_u64().unwrap() as u32);
            for channel in 0..3 {
                let found = i64::from(picture.get_pixel(x, y).0[2 - channel]);
                let difference = (found - bgr[channel].as_i64().unwrap()).abs();
                pixel_worst = pixel_worst.max(difference);
                assert!(difference as f64 <= TOLERANCE, "{name}, frame {frame}, ({x}, {y}): {found} {bgr}");
            }
        }
    }
    println!(
        "{name}: {} {:?} mean {worst:.3} pixel {pixel_worst} {:?}",
        video.codec(),
        video.frame_rate(),
        video.notes()
    );
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
        if name.ends_with(".mp4") && (name != "cam02.mp4" || has_ffmpeg()) {
            check(&folder.join("project_pose2sim_single/videos").join(name), expected);
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
