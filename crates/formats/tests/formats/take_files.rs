//! Takes: a whole one opens, and every way in which one can be broken is told by file, line, camera or frame.

use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use backlit_formats::take::Joint;
use backlit_formats::{MemoryFiles, Take, TakeError};
use backlit_tracking::body::builtin;
use image::{ImageFormat, Rgb, RgbImage};

use crate::damaged::assert_refused;
use crate::small_videos::cameras;

const TAKE: &str = r#"format = "backlit-take 1"
name = "two cameras"
frame_rate = 25
footage = "${BACKLIT_NO_SUCH_VARIABLE:-footage}"
model = "upper_body"
start = "start.json"

[cameras]
calibration = "cameras.json"

[[camera]]
name = "b"
frames = "b/%03d.png"
first = 5
background = "b/plate.png"

[[camera]]
name = "a"
frames = "a/{:02}.jpg"
count = 3
background = "a/empty_{}.png"
[camera.measurement]
region = { x = 1, y = 2, width = 3, height = 4 }

[reference]
keypoints = "keypoints.csv"
[reference.markers]
Crown = "head"
Hip = "root"

[measurement]
opening_px = 2
shadow = false
"#;

fn picture(width: u32, height: u32, level: u8, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    RgbImage::from_pixel(width, height, Rgb([level; 3])).write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

/// A take that is right in everything.
fn good() -> BTreeMap<PathBuf, Vec<u8>> {
    let pose = r#"{"format": "backlit-pose 1", "root": [0, 1, 0], "rotations": {"head": [2, 0, 0, 0]}}"#;
    let mut files = BTreeMap::from([
        ("t/take.toml".into(), TAKE.into()),
        ("t/start.json".into(), pose.into()),
        ("t/footage/cameras.json".into(), cameras(&["a", "b", "c"], [8, 6], 9, "")),
        ("t/footage/keypoints.csv".into(), "frame,marker,x,y,z\n0,Crown,0,0,1\n2,Hip,1,2,3\n".into()),
        ("t/footage/b/plate.png".into(), picture(8, 6, 200, ImageFormat::Png)),
    ]);
    for k in 0..3_u8 {
        files.insert(format!("t/footage/b/{:03}.png", k + 5).into(), picture(8, 6, k, ImageFormat::Png));
        files.insert(format!("t/footage/a/{k:02}.jpg").into(), picture(8, 6, 80 + k, ImageFormat::Jpeg));
        files.insert(format!("t/footage/a/empty_{k}.png").into(), picture(8, 6, 100, ImageFormat::Png));
    }
    files
}

fn open(files: BTreeMap<PathBuf, Vec<u8>>) -> Result<Take, TakeError> {
    Take::from_files(Arc::new(MemoryFiles::new(files)), Path::new("t/take.toml"))
}

#[test]
fn pictures_behind_a_gap_are_told() {
    let mut files = good();
    assert!(open(files.clone()).unwrap().notes().is_empty());
    for number in [10, 12] {
        files.insert(format!("t/footage/b/{number:03}.png").into(), picture(8, 6, 1, ImageFormat::Png));
    }
    let notes = open(files.clone()).unwrap().notes();
    let expected = "camera \"b\": pictures 8 to 9 are missing, so that its frames end there; at least 2 later ones are not used";
    assert_eq!(notes, [expected]);
    // Who says how many frames there are means those.
    let text = TAKE.replacen("first = 5", "first = 5\ncount = 3", 1);
    files.insert("t/take.toml".into(), text.into_bytes());
    assert!(open(files).unwrap().notes().is_empty());
}

/// What a take says whose file `path` is changed by `change`.
fn message(path: &str, change: impl FnOnce(&mut Vec<u8>)) -> String {
    let mut files = good();
    change(files.get_mut(Path::new(path)).unwrap());
    open(files).unwrap_err().to_string()
}

#[test]
fn a_whole_take_opens() {
    let take = open(good()).unwrap();
    assert_eq!((take.name(), take.frame_rate(), take.frame_count()), ("two cameras", 25.0, 3));
    let names: Vec<&str> = take.rig().cameras().iter().map(|camera| camera.name()).collect();
    assert_eq!(names, ["b", "a"], "the take file's order");
    assert_eq!(take.start().unwrap().root.y, 1.0);
    assert!(take.start().unwrap().rotations.iter().all(|q| (q.length() - 1.0).abs() < 1e-12));
    assert_eq!(take.frame(0, 2).unwrap().get_pixel(3, 3), &Rgb([2; 3]));
    assert_eq!(take.frame(1, 0).unwrap().dimensions(), (8, 6));
    assert_eq!(take.background(0).unwrap().len(), 1);
    assert_eq!(take.background(1).unwrap().len(), 3);
    let head = builtin::upper_body().limb_index("head").unwrap();
    let reference = take.reference().unwrap();
    assert_eq!(reference.frame(0).next().unwrap().1, Joint::End(head));
    assert_eq!(reference.frame(2).next().unwrap().1, Joint::Root);
    let [b, a] = take.measurement() else { panic!() };
    assert_eq!((b.opening_px, b.shadow, b.region), (2, None, None));
    assert_eq!((a.opening_px, a.region.unwrap().height), (2, 4));
}

#[test]
fn a_take_of_the_disk_opens_by_folder_and_by_file() {
    let folder = tempfile::tempdir().unwrap();
    for (path, bytes) in good() {
        let path = folder.path().join(path);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, bytes).unwrap();
    }
    let take = Take::open(&folder.path().join("t")).unwrap();
    assert_eq!(take.frame(1, 2).unwrap().dimensions(), (8, 6));
    Take::open(&folder.path().join("t/take.toml")).unwrap();
    let message = Take::open(folder.path()).unwrap_err().to_string();
    assert!(message.contains("take.toml: there is no such file"), "{message}");
}

#[test]
fn missing_frames_are_told_by_camera_file_and_frame() {
    let without = |path: &str| {
        let mut files = good();
        files.remove(Path::new(path)).unwrap();
        open(files).unwrap_err().to_string()
    };
    let cases = [
        ("t/footage/a/01.jpg", "camera \"a\", frame 1: t/footage/a/01.jpg: there is no such file"),
        ("t/footage/b/005.png", "camera \"b\", frame 0: t/footage/b/005.png: there is no such file"),
        (
            "t/footage/b/007.png",
            "camera \"b\" has 2 frames, camera \"a\" 3; the first that is missing is t/footage/b/007.png",
        ),
        ("t/footage/b/plate.png", "camera \"b\", background: t/footage/b/plate.png: there is no such file"),
        (
            "t/footage/a/empty_0.png",
            "camera \"a\", background: t/footage/a/empty_0.png: there is no such file",
        ),
        (
            "t/footage/cameras.json",
            "t/take.toml, line 4: `footage` is \"${BACKLIT_NO_SUCH_VARIABLE:-footage}\"; expected the folder of the \
             footage, but there is no t/footage/cameras.json",
        ),
        ("t/start.json", "t/start.json: there is no such file"),
    ];
    for (path, expected) in cases {
        assert_eq!(without(path), expected);
    }
    let take = open(good()).unwrap();
    assert!(take.frame(0, 3).unwrap_err().to_string().contains("no frame 3; the take has 3"));
    assert!(take.frame(2, 0).unwrap_err().to_string().contains("no camera 2; the take has 2"));
}

#[test]
fn pictures_of_another_size_are_told_with_both_sizes() {
    let other = || picture(6, 8, 0, ImageFormat::Png);
    assert_eq!(
        message("t/footage/b/005.png", |bytes| *bytes = other()),
        "camera \"b\", frame 0: t/footage/b/005.png: has 6×8 pixels; expected 8×6"
    );
    let mut files = good();
    files.insert("t/footage/a/02.jpg".into(), other());
    files.insert("t/footage/b/plate.png".into(), other());
    let take = open(files).unwrap();
    assert_eq!(
        take.frame(1, 2).unwrap_err().to_string(),
        "camera \"a\", frame 2: t/footage/a/02.jpg: has 6×8 pixels; expected 8×6"
    );
    assert_eq!(
        take.background(0).unwrap().next().unwrap().unwrap_err().to_string(),
        "camera \"b\", background: t/footage/b/plate.png: has 6×8 pixels; expected 8×6"
    );
}

#[test]
fn truncated_pictures_are_told() {
    for path in ["t/footage/a/01.jpg", "t/footage/b/006.png"] {
        let mut files = good();
        let bytes = files.get_mut(Path::new(path)).unwrap();
        bytes.truncate(bytes.len() - 3);
        let camera = usize::from(path.ends_with("jpg"));
        let message = open(files).unwrap().frame(camera, 1).unwrap_err().to_string();
        assert!(message.contains(path) && message.contains("not a whole picture"), "{message}");
    }
}

#[test]
fn errors_in_the_take_file_name_the_line() {
    assert_refused(
        TAKE,
        |text| open(BTreeMap::from_iter(good().into_iter().chain([("t/take.toml".into(), text.into())]))),
        r#"
        frame_rate = 25 ⇒ frame_rate = 25\nframes = 3 ⇒ t/take.toml, line 4: unknown field `frames`
        first = 5 ⇒ start = 5 ⇒ line 14: in `camera[0]`: unknown field `start`
        opening_px = 2 ⇒ opening = 2 ⇒ line 32: `measurement.opening`: unknown field
        region = { x = 1 ⇒ region = { z = 1 ⇒ line 23: `measurement.region`: unknown field `z`
        frame_rate = 25 ⇒ frame_rate = 0 ⇒ line 3: `frame_rate` is 0.0; expected frames per second
        frame_rate = 25 ⇒ frame_rate = nan ⇒ line 3: `frame_rate` is NaN
        ${BACKLIT_NO_SUCH_VARIABLE:-footage} ⇒ ${BACKLIT_NO_SUCH_VARIABLE} ⇒ line 4: `footage`: the environment variable BACKLIT_NO_SUCH_VARIABLE is not set
        "upper_body" ⇒ "upper_bdy" ⇒ t/upper_bdy: there is no such file, and no built-in model
        name = "b" ⇒ name = "x" ⇒ line 12: there is no camera "x"; there are a, b, c
        name = "b" ⇒ name = "a" ⇒ camera name "a" is used twice
        b/%03d.png ⇒ b/%3d.png ⇒ line 13: `camera.frames` is "b/%3d.png"; expected a pattern
        count = 3 ⇒ count = 0 ⇒ line 20: `count` is 0; expected 1 to
        count = 3 ⇒ count = 4 ⇒ camera "a", frame 3: t/footage/a/03.jpg: there is no such file
        count = 3 ⇒ count = 3\nlast = 2 ⇒ line 21: `last` is 2; expected either
        first = 5 ⇒ first = 5\nlast = 3 ⇒ line 15: `last` is 3; expected 1 to
        Crown = "head" ⇒ Crown = "hat" ⇒ line 28: `reference.markers.Crown` names "hat"
        Crown = ⇒ Toe = ⇒ keypoints.csv: `marker` is never "Toe"
        backlit-take 1 ⇒ backlit-take 2 ⇒ line 1: `format` is "backlit-take 2"; expected "backlit-take 1"
        [cameras] ⇒ [cameras]\nsize = [80, 70] ⇒ expected the proportions of 80×70
        [[camera]]\nname = "b" ⇒ [[camera] ⇒ line 11: is not valid TOML
        name = "two cameras" ⇒ name = "a\u001B[2Jb" ⇒ line 2: `name` is "a\u{1b}[2Jb"; expected 1 to 200 letters
        name = "a" ⇒ name = "\u001B]0;x\u0007" ⇒ there is no camera "\u{1b}]0;x\u{7}"
        "#,
    );
    let none = TAKE.split("[[camera]]").next().unwrap();
    let message = message("t/take.toml", |text| *text = none.into());
    assert!(message.contains("there is no camera"), "{message}");
}

#[test]
fn errors_in_files_of_the_take_name_that_file() {
    let cases = [
        (
            "t/start.json",
            r#"[2, 0, 0, 0] ⇒ [2, NaN, 0, 0] ⇒ t/start.json, line 1: is not valid JSON: in `rotations.head[1]`: NaN"#,
        ),
        ("t/footage/cameras.json", r#""fx": 9 ⇒ "fx": 0 ⇒ t/footage/cameras.json: camera "a": `fx` is 0"#),
        ("t/footage/keypoints.csv", r#"2,Hip,1 ⇒ 2,Hip,one ⇒ t/footage/keypoints.csv, line 3: `x` is "one""#),
    ];
    for (path, row) in cases {
        let text = String::from_utf8(good()[Path::new(path)].clone()).unwrap();
        let with =
            |text: &str| open(BTreeMap::from_iter(good().into_iter().chain([(path.into(), text.into())])));
        assert_refused(&text, with, row);
    }
}

#[test]
fn a_body_with_a_cycle_or_an_unknown_parent_is_told() {
    let body = |parent: &str| {
        let limb = |name: &str, parent: &str| {
            format!(
                "[[limb]]\nname = \"{name}\"\nparent = \"{parent}\"\ndirection = [0, 1, 0]\nlength = 1\nradius = 0.1\n"
            )
        };
        format!("format = \"backlit-body 1\"\nname = \"b\"\n{}{}", limb("arm", parent), limb("hand", "arm"))
    };
    let cases =
        [("hand", "makes a cycle: arm → hand → arm"), ("leg", "names \"leg\", and no limb has that name")];
    for (parent, expected) in cases {
        let mut files = good();
        files.insert("t/body.toml".into(), body(parent).into_bytes());
        files.insert("t/take.toml".into(), TAKE.replacen("upper_body", "body.toml", 1).into_bytes());
        let message = open(files).unwrap_err().to_string();
        assert!(message.starts_with("t/body.toml, line 5: limb \"arm\": `parent`"), "{message}");
        assert!(message.contains(expected), "{message}");
    }
}

/// The sizes of the cameras are enough: no picture is there.
#[test]
fn a_take_that_needs_more_memory_than_it_may_is_refused_before_pictures_are_read() {
    let huge = cameras(&["a", "b", "c"], [8192, 8192], 9, "");
    assert_eq!(
        message("t/footage/cameras.json", |bytes| *bytes = huge),
        "t/take.toml: the pictures and backgrounds of its 2 cameras need about 13.2 GB of memory; expected at most 4 GB: \
         raise that with --memory, or set `reduction`"
    );
}
