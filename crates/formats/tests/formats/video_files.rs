//! Videos made here: times, edits, turns, what is cut or wrong, reading in order, the cache.

use std::path::Path;
use std::sync::Arc;

use backlit_formats::video::{FrameCache, Video};
use backlit_formats::{FileError, MemoryFiles};

use crate::small_videos::{Mp4, avi, avi_of, jpeg, number_of};

fn open(bytes: &[u8]) -> Result<Video, FileError> {
    let files = MemoryFiles::new([("v", bytes.to_vec())]);
    Video::from_files(&files, Path::new("v"), Arc::default())
}

fn numbers(video: &Video) -> Vec<usize> {
    (0..video.frame_count()).map(|frame| number_of(&video.frame(frame).unwrap())).collect()
}

fn milliseconds(video: &Video) -> Vec<i64> {
    video.seconds().iter().map(|seconds| (seconds * 1000.0).round() as i64).collect()
}

#[test]
fn frames_come_in_the_order_in_which_they_are_shown() {
    for index_first in [false, true] {
        // Decoded as I P B B, as encoders write them, and shown two frames late.
        let mp4 = Mp4 {
            numbers: vec![0, 3, 1, 2, 4],
            later: vec![80, 160, 40, 40, 80],
            lasts: vec![40; 5],
            index_first,
            ..Mp4::new(0)
        };
        let video = open(&mp4.bytes()).unwrap();
        assert_eq!(numbers(&video), [0, 1, 2, 3, 4]);
        assert_eq!(milliseconds(&video), [0, 40, 80, 120, 160]);
        assert!((video.frame_rate().unwrap() - 25.0).abs() < 1e-9);
        assert_eq!((video.size(), video.codec()), ([32, 16], "Motion JPEG"));
        assert!(video.notes().is_empty());
        let message = video.frame(5).unwrap_err().to_string();
        assert_eq!(message, "v: there is no frame 5; the video has 5, counted from 0");
    }
}

#[test]
fn times_are_those_of_the_file() {
    let mp4 = Mp4 { lasts: vec![40, 10, 70, 40], ..Mp4::new(4) };
    assert_eq!(milliseconds(&open(&mp4.bytes()).unwrap()), [0, 40, 50, 120]);
    // Gaps of one frame's length where a camera left frames out do not count for the rate.
    let lasts = (0..20).map(|k| if k == 9 { 120 } else { 40 }).collect();
    let video = open(&Mp4 { lasts, ..Mp4::new(20) }.bytes()).unwrap();
    assert!((video.frame_rate().unwrap() - 25.0).abs() < 1e-9);
}

#[test]
fn edits_cut_pause_and_repeat() {
    let edited = |edits: &[(u32, i32)]| open(&Mp4 { edits: edits.to_vec(), ..Mp4::new(6) }.bytes()).unwrap();
    // From 80 ms on, for 120 ms.
    let cut = edited(&[(12, 80)]);
    assert_eq!((numbers(&cut), milliseconds(&cut)), (vec![2, 3, 4], vec![0, 40, 80]));
    // A pause of 0.5 s first, and no end said.
    let late = edited(&[(50, -1), (0, 0)]);
    assert_eq!((numbers(&late).len(), milliseconds(&late)[..2].to_vec()), (6, vec![500, 540]));
    let twice = edited(&[(8, 0), (8, 0)]);
    assert_eq!((numbers(&twice), milliseconds(&twice)), (vec![0, 1, 0, 1], vec![0, 40, 80, 120]));
}

#[test]
fn pictures_are_turned_as_the_file_says() {
    // Where the dark corner, lower right in the stored picture, is to be seen.
    let cases = [
        ([1, 0, 0, 1], [32, 16], [31, 15]),
        ([0, 1, -1, 0], [16, 32], [0, 31]),
        ([-1, 0, 0, -1], [32, 16], [0, 0]),
        ([0, -1, 1, 0], [16, 32], [15, 0]),
        ([-1, 0, 0, 1], [32, 16], [0, 15]),
    ];
    for (matrix, size, [x, y]) in cases {
        let video = open(&Mp4 { matrix, ..Mp4::new(2) }.bytes()).unwrap();
        assert_eq!(video.size(), size, "{matrix:?}");
        let picture = video.frame(1).unwrap();
        let dark = picture.enumerate_pixels().filter(|(_, _, pixel)| pixel.0[0] < 8).count();
        assert_eq!(dark, 32 * 16 / 4, "{matrix:?}");
        assert!(picture.get_pixel(x, y).0[0] < 8, "{matrix:?}");
        let quarter = video.frame_reduced(1, 4).unwrap();
        assert_eq!([quarter.width() as usize, quarter.height() as usize], size.map(|side| side / 4));
        assert!(quarter.get_pixel(x / 4, y / 4).0[0] < 8, "{matrix:?}");
    }
}

#[test]
fn an_avi_needs_no_index() {
    let video = open(&avi(7, [24, 16])).unwrap();
    assert_eq!((video.size(), numbers(&video)), ([24, 16], (0..7).collect()));
    assert_eq!(milliseconds(&video), [0, 40, 80, 120, 160, 200, 240]);
}

#[test]
fn jpegs_of_every_kind_are_read() {
    // What the decoder of planes does not know goes to that of pictures: odd sides, other sizes of a block.
    for size in [[17, 9], [33, 31], [1, 1], [64, 48]] {
        let video = open(&avi(3, size)).unwrap();
        let expected = |number| {
            let bytes = jpeg(number, size);
            backlit_formats::images::decode(Path::new("j"), &bytes).unwrap()
        };
        for number in 0..3 {
            let (found, expected) = (video.frame(number).unwrap(), expected(number));
            assert_eq!(found.dimensions(), expected.dimensions());
            for (a, b) in found.as_raw().iter().zip(expected.as_raw()) {
                assert!(a.abs_diff(*b) <= 3, "{size:?}: {a} {b}");
            }
        }
    }
}

#[test]
fn every_truncation_gives_the_frames_that_are_there_or_says_why_not() {
    for (whole, count) in [
        (avi(5, [24, 16]), 5),
        (Mp4 { index_first: true, ..Mp4::new(5) }.bytes(), 5),
        (Mp4::new(5).bytes(), 5),
    ] {
        let mut most = 0;
        for length in 0..whole.len() {
            match open(&whole[..length]) {
                Ok(video) => {
                    let there = video.frame_count();
                    assert!((most..=count).contains(&there), "{length}: {there}");
                    most = there;
                    assert!(!video.notes().is_empty(), "{length} of {}: no note", whole.len());
                    assert_eq!(numbers(&video), (0..there).collect::<Vec<_>>(), "{length}");
                }
                Err(error) => {
                    assert_eq!(most, 0, "{length}: {error}");
                    assert!(error.to_string().starts_with("v: "), "{error}");
                }
            }
        }
        assert!(open(&whole).unwrap().notes().is_empty());
    }
    // With its index at the end nothing is left of a video that is cut.
    let mp4 = Mp4::new(5).bytes();
    let message = open(&mp4[..600]).unwrap_err().to_string();
    assert!(message.contains("has no index: the recording was cut off"), "{message}");
    let message = open(&avi(3, [24, 16])[..400]).unwrap_err().to_string();
    assert!(message.contains("ends before its first whole frame"), "{message}");
}

#[test]
fn a_damaged_frame_fails_alone_and_is_noted() {
    let mut pictures: Vec<Vec<u8>> = (0..4).map(|number| jpeg(number, [24, 16])).collect();
    pictures[2].truncate(40);
    let video = open(&avi_of(&pictures, [24, 16], b"MJPG")).unwrap();
    let message = video.frame(2).unwrap_err().to_string();
    assert!(message.contains("v: frame 2 cannot be decoded: "), "{message}");
    assert_eq!(number_of(&video.frame(3).unwrap()), 3);
    assert!(video.notes()[0].contains("frame 2 is damaged"), "{:?}", video.notes());
}

#[test]
fn sizes_that_a_file_makes_up_take_no_memory() {
    // Tables that promise four thousand million samples in a few bytes.
    let mut mp4 = Mp4 { index_first: true, ..Mp4::new(3) }.bytes();
    let at = |bytes: &[u8], kind: &[u8]| bytes.windows(4).position(|four| four == kind).unwrap();
    let stsz = at(&mp4, b"stsz");
    mp4[stsz + 8..stsz + 16].copy_from_slice(&[0, 0, 0, 1, 0xFF, 0xFF, 0xFF, 0xFF]);
    for kind in [b"stts", b"stsc"] {
        let at = at(&mp4, kind);
        mp4[at + 12..at + 20].copy_from_slice(&[0xFF; 8]);
    }
    let stsc = at(&mp4, b"stsc");
    mp4[stsc + 12..stsc + 16].copy_from_slice(&[0, 0, 0, 1]);
    let result = open(&mp4).and_then(|video| video.frame(0).map(drop));
    assert!(result.is_err());
}

#[test]
fn other_files_are_no_videos() {
    for bytes in
        [&b""[..], b"RIFF", b"RIFF\0\0\0\0WAVEfmt ", b"\0\0\0\x08ftyp", b"#EXTM3U\nhttp://a/b", &[0; 512]]
    {
        let message = open(bytes).unwrap_err().to_string();
        assert!(message.starts_with("v: "), "{message}");
    }
    let message = open(b"#EXTM3U\nhttp://a/b").unwrap_err().to_string();
    assert!(message.contains("is not a video that is known; expected MP4"), "{message}");
}

#[test]
fn frames_that_are_kept_are_not_decoded_again() {
    let files = MemoryFiles::new([("v", Mp4::new(12).bytes())]);
    let cache = Arc::new(FrameCache::new(1));
    let video = Video::from_files(&files, Path::new("v"), Arc::clone(&cache)).unwrap();
    for _ in 0..3 {
        assert_eq!(numbers(&video), (0..12).collect::<Vec<_>>());
    }
    assert_eq!(video.decoded_count(), 12);
    // Another size is another picture.
    video.frame_reduced(3, 2).unwrap();
    assert_eq!(video.decoded_count(), 13);
    cache.set_limit_mb(0);
    assert_eq!(cache.used_mb(), 0);
    video.frame(3).unwrap();
    assert_eq!(video.decoded_count(), 14);
}

#[test]
fn several_threads_get_the_same_pictures() {
    let video = open(&Mp4::new(30).bytes()).unwrap();
    std::thread::scope(|scope| {
        for thread in 0..4 {
            let video = &video;
            scope.spawn(move || {
                for k in 0..90 {
                    let frame = (k * (7 + thread)) % 30;
                    assert_eq!(number_of(&video.frame(frame).unwrap()), frame);
                }
            });
        }
    });
    assert!(video.decoded_count() <= 30);
}
