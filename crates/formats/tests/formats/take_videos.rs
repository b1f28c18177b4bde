//! Takes whose cameras are videos: offsets, lengths that differ, backgrounds, times, notes.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use backlit_formats::{MemoryFiles, Take, TakeError};

use crate::small_videos::{MP4_SIZE, Mp4, avi, cameras, jpeg, number_of};

const TAKE: &str = r#"format = "backlit-take 1"
name = "videos"
frame_rate = 25
model = "single_limb"

[cameras]
calibration = "cameras.json"

[[camera]]
name = "a"
frames = "a.avi"
# a

[[camera]]
name = "b"
frames = "b.mp4"
# b
"#;

fn files() -> BTreeMap<PathBuf, Vec<u8>> {
    [("take.toml", TAKE.as_bytes().to_vec()), ("cameras.json", cameras(&["a", "b"], MP4_SIZE, 9, ""))]
        .into_iter()
        .chain([("a.avi", avi(8, MP4_SIZE)), ("b.mp4", Mp4::new(10).bytes())])
        .map(|(path, bytes)| (path.into(), bytes))
        .collect()
}

/// The take with lines added to its cameras.
fn with(a: &str, b: &str, change: impl FnOnce(&mut BTreeMap<PathBuf, Vec<u8>>)) -> Result<Take, TakeError> {
    let mut files = files();
    files.insert("take.toml".into(), TAKE.replace("# a", a).replace("# b", b).into_bytes());
    change(&mut files);
    Take::from_files(Arc::new(MemoryFiles::new(files)), Path::new("take.toml"))
}

/// What each camera shows, frame by frame.
fn shown(take: &Take) -> Vec<(usize, usize)> {
    let number = |camera, frame| number_of(&take.frame(camera, frame).unwrap());
    (0..take.frame_count()).map(|frame| (number(0, frame), number(1, frame))).collect()
}

#[test]
fn the_take_has_the_frames_that_all_cameras_have() {
    let take = with("", "", |_| {}).unwrap();
    assert_eq!(shown(&take), (0..8).map(|k| (k, k)).collect::<Vec<_>>());
    assert_eq!(take.notes(), ["the take ends with camera \"a\"; camera \"b\" goes on for 2 frames"]);
    assert!(take.seconds().iter().zip(0..).all(|(seconds, k)| (seconds - f64::from(k) * 0.04).abs() < 1e-9));
    assert_eq!(take.footage()[1].path(3), Path::new("b.mp4"));
    assert!(take.frame(0, 8).unwrap_err().to_string().contains("no frame 8; the take has 8"));
    let half = take.frame_reduced(1, 4, 2).unwrap();
    assert_eq!((half.dimensions(), number_of(&half)), ((16, 8), 4));
    take.frame_cache().set_limit_mb(0);
    assert_eq!(shown(&take.clone()).len(), 8);
    fn shared<T: Clone + std::fmt::Debug + Send + Sync>(_: &T) {}
    shared(&take);
    assert!(!format!("{take:?}").contains("Sample"), "a long index is not written out");
}

#[test]
fn offsets_and_ranges_name_the_videos_own_frames() {
    let cases = [
        ("first = 2", "first = 5\ncount = 3", vec![(2, 5), (3, 6), (4, 7)]),
        ("first = 1\nlast = 2", "", vec![(1, 0), (2, 1)]),
        ("", "offset = 3", (0..7).map(|k| (k, k + 3)).collect()),
        ("", "offset_seconds = 0.13", (0..7).map(|k| (k, k + 3)).collect()),
        // A camera that was started later has no first frames.
        ("", "offset = -3", (3..8).map(|k| (k, k - 3)).collect()),
        ("", "offset_seconds = -0.12", (3..8).map(|k| (k, k - 3)).collect()),
        ("first = 3", "offset = 1\nlast = 6", (0..5).map(|k| (k + 3, k + 1)).filter(|p| p.1 <= 6).collect()),
    ];
    for (a, b, expected) in cases {
        let take = with(a, b, |_| {}).unwrap();
        assert_eq!(shown(&take), expected, "{a} | {b}");
        assert_eq!(take.seconds().len(), expected.len());
        assert!(take.seconds()[0].abs() < 1e-12);
    }
    let take = with("", "offset = -3", |_| {}).unwrap();
    assert!(take.notes()[0].contains("begins 3 frames later, because camera \"b\" has no earlier one"));
    // Pictures can be shifted too.
    let pictures = |files: &mut BTreeMap<PathBuf, Vec<u8>>| {
        files.extend((0..6).map(|k| (format!("p{k}.jpg").into(), jpeg(k, MP4_SIZE))));
        let text = TAKE.replace("a.avi", "p%d.jpg").replace("# b", "offset = 2");
        files.insert("take.toml".into(), text.into_bytes());
    };
    assert_eq!(shown(&with("", "", pictures).unwrap()), (0..6).map(|k| (k, k + 2)).collect::<Vec<_>>());
}

#[test]
fn what_cannot_be_is_told() {
    let cases = [
        ("offset = 1\noffset_seconds = 0.1", "line 13: `offset_seconds` is 0.1; expected either `offset`"),
        ("offset_seconds = nan", "line 12: `offset_seconds` is NaN; expected seconds"),
        ("first = 8", "camera \"a\", frame 0: a.avi: there is no frame 8; the video has 8"),
        ("offset = 8", "no frame is in all cameras: camera \"a\" ends before frame 0 of the take"),
        ("count = 0", "`count` is 0; expected 1 to"),
    ];
    for (lines, expected) in cases {
        let message = with(lines, "", |_| {}).unwrap_err().to_string();
        assert!(message.contains(expected), "{message:?} should contain {expected:?}");
    }
    let message = with("", "", |files| drop(files.remove(Path::new("a.avi")))).unwrap_err().to_string();
    assert_eq!(message, "camera \"a\", frame 0: a.avi: there is no such file");
    let message = with("", "", |files| drop(files.insert("a.avi".into(), jpeg(1, MP4_SIZE)))).unwrap_err();
    assert!(message.to_string().contains("`camera.frames` is \"a.avi\"; expected a pattern"), "{message}");
    let other = |files: &mut BTreeMap<PathBuf, Vec<u8>>| drop(files.insert("a.avi".into(), avi(8, [16, 16])));
    let message = with("", "", other).unwrap_err().to_string();
    assert_eq!(message, "camera \"a\", frame 0: a.avi: has 16×16 pixels; expected 32×16");
}

#[test]
fn a_video_that_is_cut_is_noted() {
    let cut = |files: &mut BTreeMap<PathBuf, Vec<u8>>| {
        let whole = files.get_mut(Path::new("a.avi")).unwrap();
        whole.truncate(whole.len() * 2 / 3);
    };
    let take = with("count = 7", "", cut).unwrap();
    assert!((1..7).contains(&take.frame_count()), "{}", take.frame_count());
    let notes = take.notes().join("\n");
    assert!(notes.contains("camera \"a\": the file ends too early"), "{notes}");
    assert!(notes.contains("the take ends with camera \"a\""), "{notes}");
}

#[test]
fn times_that_do_not_fit_are_noted() {
    let slow = |files: &mut BTreeMap<PathBuf, Vec<u8>>| {
        files.insert("b.mp4".into(), Mp4 { lasts: vec![50; 10], ..Mp4::new(10) }.bytes());
    };
    let notes = with("", "", slow).unwrap().notes().join("\n");
    assert!(notes.contains("camera \"b\" has 20.00 frames per second, the take 25.00"), "{notes}");
    assert!(notes.contains("camera \"b\": frames of one number are up to 0.070 s apart"), "{notes}");
}

#[test]
fn a_background_may_be_a_video() {
    let background = |lines: &str, frames: &[usize]| {
        let lines = format!("background = \"b.mp4\"\n{lines}");
        let take = with(&lines, "", |_| {}).unwrap();
        let found: Vec<usize> =
            take.background(0).unwrap().map(|picture| number_of(&picture.unwrap())).collect();
        assert_eq!(found, frames, "{lines}");
        assert!(take.background(1).unwrap().len() == 0);
    };
    background("", &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9]);
    background("background_first = 6", &[6, 7, 8, 9]);
    background("background_first = 2\nbackground_count = 3", &[2, 3, 4]);
    let message = with("background = \"c.mp4\"", "", |_| {}).unwrap_err().to_string();
    assert_eq!(message, "camera \"a\", background: c.mp4: there is no such file");
    let message = with("background = \"b.mp4\"\nbackground_first = 10", "", |_| {}).unwrap_err().to_string();
    assert!(message.contains("background: b.mp4: there is no frame 10"), "{message}");
}
