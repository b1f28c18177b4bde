//! Readers on files that are cut, garbled or made up: an answer or an error, never a panic.

use std::io::Cursor;
use std::path::Path;
use std::sync::Arc;

use backlit_formats::calibration::{self, CalibrationOptions};
use backlit_formats::pose_file::{self, Quaternions};
use backlit_formats::{MemoryFiles, Take, images, model_file};
use backlit_tracking::body::{Pose, builtin};
use backlit_tracking::camera::{Camera, CameraFromWorld, Distortion, Intrinsics, Rig};
use glam::DVec3;
use image::{ImageFormat, Rgb, RgbImage};
use proptest::prelude::*;

const MATRICES: &str = r#"{"cameras": {"c": {"size": [8, 6], "K": [[9, 0, 4], [0, 9, 3], [0, 0, 1]], "K_4x3": [[4, 0, 2],
    [0, 4, 1], [0, 0, 1]], "dist": [0.1, 0, 0, 0], "R": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "t": [0, 0, 2]}}}"#;

const QUALISYS: &str = r#"<calibration><cameras><camera active="1" serial="c"><fov_video bottom="5" left="0" right="7" top="0"/>
    <transform r11="0" r12="1" r13="0" r21="0" r22="0" r23="1" r31="1" r32="0" r33="0" x="2000" y="100" z="1500"/>
    <intrinsic centerPointU="256" centerPointV="192" focalLengthU="576" focalLengthV="576" radialDistortion1="-0.05"
    radialDistortion2="0.14" radialDistortion3="0.0" tangentalDistortion1="0.001" tangentalDistortion2="0.002"/></camera></cameras></calibration>"#;

const TAKE: &str = r#"format = "backlit-take 1"
name = "t"
frame_rate = 25
footage = "${BACKLIT_NO_SUCH_VARIABLE:-.}"
model = "single_limb"
start = "start.json"
[cameras]
calibration = "cameras.json"
size = [8, 6]
[[camera]]
name = "c"
frames = "%02d.png"
last = 1
background = "bg{}.png"
background_count = 1
[camera.measurement]
region = { x = 1, y = 2, width = 3, height = 4 }
[reference]
keypoints = "keypoints.csv"
markers = { A = "limb", B = "root" }
[measurement]
opening_px = 2
shadow = { darkest = 0.5 }
"#;

const KEYPOINTS: &str = "frame,marker,x,y,z\n0,A,0,0.5,1\n1,B,1,2,-3e-1\n1,A,0,1,0\n";

fn rig() -> Rig {
    let place = CameraFromWorld::looking_at(DVec3::X, DVec3::ZERO, DVec3::Z);
    let lens = Distortion::OpenCv { k1: 0.1, k2: 0.0, p1: 0.0, p2: 0.0, k3: 0.0 };
    let intrinsics = Intrinsics { fx: 9.0, fy: 9.0, cx: 3.5, cy: 2.5 };
    Rig::new(vec![Camera::new("c", [8, 6], intrinsics, lens, place).unwrap()]).unwrap()
}

fn picture(format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let picture = RgbImage::from_fn(8, 6, |x, y| Rgb([x as u8 * 30, y as u8 * 40, 9]));
    picture.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

fn start() -> String {
    pose_file::to_text(&builtin::single_limb(), &Pose::rest(&builtin::single_limb()))
}

/// Opens a take one of whose files is replaced, and reads all its pictures.
fn read_take(replaced: &str, bytes: &[u8]) -> bool {
    let mut files = vec![
        ("take.toml", TAKE.as_bytes().to_vec()),
        ("start.json", start().into_bytes()),
        ("cameras.json", calibration::backlit::to_text(&rig()).into_bytes()),
        ("keypoints.csv", KEYPOINTS.as_bytes().to_vec()),
    ];
    files.extend(["00.png", "01.png", "bg0.png"].map(|name| (name, picture(ImageFormat::Png))));
    for (path, content) in &mut files {
        if *path == replaced {
            *content = bytes.to_vec();
        }
    }
    let Ok(take) = Take::from_files(Arc::new(MemoryFiles::new(files)), Path::new("take.toml")) else {
        return false;
    };
    let mut whole = true;
    for camera in 0..take.rig().count() {
        whole &= (0..take.frame_count()).all(|frame| take.frame(camera, frame).is_ok());
        whole &= take.background(camera).is_ok();
    }
    whole
}

/// A reader by name, a file that it reads, and how it reads.
type Case = (&'static str, Vec<u8>, fn(&[u8]) -> bool);

fn cases() -> Vec<Case> {
    fn calibrated(bytes: &[u8]) -> bool {
        let half = CalibrationOptions { size: Some([4, 3]), ..CalibrationOptions::default() };
        calibration::parse(Path::new("c"), bytes, half).is_ok()
            & calibration::parse(Path::new("c"), bytes, CalibrationOptions::default()).is_ok()
    }
    vec![
        ("model", model_file::to_text(&builtin::full_body()).into_bytes(), |bytes| {
            model_file::parse(Path::new("m"), bytes).is_ok()
        }),
        ("pose", start().into_bytes(), |bytes| {
            let model = builtin::single_limb();
            let pose = pose_file::parse(Path::new("p"), bytes, &model, Quaternions::Normalised);
            if let Ok(pose) = &pose {
                assert!(pose.rotations.iter().all(|q| (q.length() - 1.0).abs() < 1e-9), "{pose:?}");
            }
            pose.is_ok() & pose_file::parse(Path::new("p"), bytes, &model, Quaternions::Raw).is_ok()
        }),
        ("cameras", calibration::backlit::to_text(&rig()).into_bytes(), calibrated),
        ("matrices", MATRICES.into(), calibrated),
        ("qualisys", QUALISYS.into(), calibrated),
        ("png", picture(ImageFormat::Png), |bytes| images::decode(Path::new("i"), bytes).is_ok()),
        ("jpeg", picture(ImageFormat::Jpeg), |bytes| images::decode(Path::new("i"), bytes).is_ok()),
        ("take", TAKE.into(), |bytes| read_take("take.toml", bytes)),
        ("reference", KEYPOINTS.into(), |bytes| read_take("keypoints.csv", bytes)),
        ("start of a take", start().into_bytes(), |bytes| read_take("start.json", bytes)),
        ("frame of a take", picture(ImageFormat::Png), |bytes| read_take("01.png", bytes)),
    ]
}

#[test]
fn whole_files_are_read() {
    for (name, bytes, read) in cases() {
        assert!(read(&bytes), "{name}");
    }
}

#[test]
fn cut_files_do_not_panic() {
    for (_, bytes, read) in cases() {
        for length in (0..bytes.len()).step_by(1 + bytes.len() / 300) {
            read(&bytes[..length]);
        }
    }
}

/// One thing done to a file.
#[derive(Debug, Clone)]
enum Damage {
    Set(usize, u8),
    Insert(usize, Vec<u8>),
    Remove(usize, usize),
    Repeat(usize, usize),
}

impl Damage {
    fn apply(&self, bytes: &mut Vec<u8>) {
        let at = |place: usize| place % (bytes.len() + 1);
        match *self {
            Self::Set(place, value) if !bytes.is_empty() => {
                let place = place % bytes.len();
                bytes[place] = value;
            }
            Self::Set(..) => {}
            Self::Insert(place, ref what) => {
                let place = at(place);
                bytes.splice(place..place, what.iter().copied());
            }
            Self::Remove(place, count) => {
                let start = at(place);
                bytes.drain(start..(start + count).min(bytes.len()));
            }
            Self::Repeat(place, count) => {
                let start = at(place);
                let end = (start + count).min(bytes.len());
                bytes.extend_from_within(start..end);
            }
        }
    }
}

fn damage() -> impl Strategy<Value = Damage> {
    let words = [
        "nan",
        "inf",
        "-1",
        "1e999",
        "1e300",
        "0",
        "99999999999999999999",
        "null",
        "true",
        "[",
        "]",
        "{",
        "}",
        "\"",
        "\n",
        "\u{0}",
        "ü",
        "<",
        "&lt;",
        ",",
        "[[limb]]\n",
        "parent = \"limb\"\n",
        "-",
        ".",
        "%",
        "{}",
        "${",
        "\r",
    ];
    let words: Vec<Vec<u8>> = words.iter().map(|word| word.as_bytes().to_vec()).collect();
    prop_oneof![
        (any::<usize>(), any::<u8>()).prop_map(|(place, value)| Damage::Set(place, value)),
        (any::<usize>(), proptest::sample::select(words))
            .prop_map(|(place, what)| Damage::Insert(place, what)),
        (any::<usize>(), 1..20_usize).prop_map(|(place, count)| Damage::Remove(place, count)),
        (any::<usize>(), 1..200_usize).prop_map(|(place, count)| Damage::Repeat(place, count)),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(200) })]

    #[test]
    fn garbled_files_do_not_panic(damages in proptest::collection::vec(damage(), 1..4)) {
        for (_, mut bytes, read) in cases() {
            for damage in &damages {
                damage.apply(&mut bytes);
            }
            read(&bytes);
        }
    }

    #[test]
    fn made_up_files_do_not_panic(bytes in proptest::collection::vec(any::<u8>(), 0..300), head in 0..12_usize) {
        for (_, whole, read) in cases() {
            let bytes = [&whole[..head.min(whole.len())], &bytes[..]].concat();
            read(&bytes);
        }
    }
}

#[test]
fn deep_nesting_is_an_error() {
    for (name, _, read) in cases() {
        for (open, head) in [("[", "{\"format\": \"backlit-pose 1\", \"root\": "), ("[", "a = "), ("<a>", "")]
        {
            let bytes = head.to_owned() + &open.repeat(100_000);
            assert!(!read(bytes.as_bytes()), "{name}");
        }
    }
}
