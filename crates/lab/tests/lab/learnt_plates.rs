//! Backgrounds learnt from footage: again without the body that was tracked, and with what keypoints say of a frame.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use backlit_formats::plate::{PlateError, plate_without_body};
use backlit_formats::take::PlateKnowledge;
use backlit_formats::{Footage, MemoryFiles, Take, calibration};
use backlit_lab::synthetic::{motion, studio};
use backlit_tracking::body::{Kinematics, Pose, builtin};
use backlit_tracking::camera::{Camera, Rig};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::render::prediction::covered;
use backlit_tracking::render::{Ramp, RendererKind, View};
use backlit_tracking::silhouette::Label;
use glam::DVec3;
use image::{Rgb, RgbImage, RgbaImage};

use crate::png;

const FRAMES: usize = 16;

/// The body walks aside, by a good limb's width a frame.
fn pose(frame: usize) -> Pose {
    let mut pose = motion::pose(&builtin::full_body(), 0.0);
    pose.root += DVec3::new(0.03, 0.05, 0.0) * frame as f64;
    pose
}

fn wall(x: u32, y: u32) -> Rgb<u8> {
    Rgb([90 + (x % 5) as u8, 110 + (y % 7) as u8, 130])
}

fn picture(camera: &Camera, frame: usize) -> RgbImage {
    let body = builtin::full_body();
    let place = Kinematics::new(&body, &pose(frame));
    let subject = covered(&View::new(&body, &place, camera, RendererKind::Capsule, Ramp::Half));
    RgbImage::from_fn(camera.width() as u32, camera.height() as u32, |x, y| {
        if subject[y as usize * camera.width() + x as usize] { Rgb([220, 60, 40]) } else { wall(x, y) }
    })
}

/// Two cameras, lenses and all; `more` is added to each camera's table, and to the files.
fn take(more: &str, mut files: Vec<(PathBuf, Vec<u8>)>) -> Take {
    let resized = |camera: &Camera| camera.resized(108, 144).unwrap();
    let rig = Rig::new(studio::cameras().cameras()[..2].iter().map(resized).collect()).unwrap();
    let mut text = "format = \"backlit-take 1\"\nname = \"wall\"\nframe_rate = 30\nmodel = \"full_body\"\n\
                    [cameras]\ncalibration = \"cameras.json\"\n"
        .to_owned();
    files.push(("cameras.json".into(), calibration::backlit::to_text(&rig).into_bytes()));
    for camera in rig.cameras() {
        let name = camera.name();
        text += &format!("[[camera]]\nname = \"{name}\"\nframes = \"{name}/%d.png\"\n{more}");
        for frame in 0..FRAMES {
            files.push((format!("{name}/{frame}.png").into(), png(picture(camera, frame))));
        }
    }
    files.push(("take.toml".into(), text.into_bytes()));
    Take::from_files(Arc::new(MemoryFiles::new(files)), Path::new("take.toml")).unwrap()
}

#[test]
fn a_plate_is_learnt_without_the_body_that_is_tracked() {
    let take = take("", Vec::new());
    let poses: BTreeMap<usize, Pose> = (0..FRAMES).map(|frame| (frame, pose(frame))).collect();
    let body = builtin::full_body();
    for camera in 0..2 {
        let plate = plate_without_body(&take, camera, &body, &poses, &CancelToken::new()).unwrap();
        assert!(plate.known_share() > 0.85, "camera {camera}: {}", plate.known_share());
        for ((x, y, pixel), known) in plate.picture.enumerate_pixels().zip(&plate.known) {
            assert!(*known != PlateKnowledge::Scene || *pixel == wall(x, y), "camera {camera}: {x}, {y}");
        }
    }
    // A body that is somewhere else leaves the subject in the plate, or finds it in no level that is the wall's.
    let elsewhere: BTreeMap<usize, Pose> = (0..3).map(|frame| (frame, pose(FRAMES - 1))).collect();
    let plate = plate_without_body(&take, 0, &body, &elsewhere, &CancelToken::new()).unwrap();
    let wrong = |((x, y, pixel), known): ((u32, u32, &Rgb<u8>), &PlateKnowledge)| {
        *known == PlateKnowledge::Scene && *pixel != wall(x, y)
    };
    assert!(plate.picture.enumerate_pixels().zip(&plate.known).any(wrong));
    let error = plate_without_body(&take, 7, &body, &poses, &CancelToken::new()).unwrap_err().to_string();
    assert!(error.contains('7'), "{error}");
    assert!(plate_without_body(&take, 0, &body, &BTreeMap::new(), &CancelToken::new()).is_err());
    let stopped = CancelToken::new();
    stopped.cancel();
    let error = plate_without_body(&take, 0, &body, &poses, &stopped).unwrap_err();
    assert!(matches!(error, PlateError::Cancelled), "{error}");
}

#[test]
fn where_the_background_is_unknown_keypoints_say_what_is_subject() {
    let resized = studio::cameras().cameras()[0].resized(108, 144).unwrap();
    let body = builtin::full_body();
    let ends = Kinematics::new(&body, &pose(0)).ends().to_vec();
    // One file for both cameras, as the first sees the joints: the second has no use for it.
    let seen: Vec<String> = ends
        .iter()
        .filter_map(|end| resized.project(*end))
        .map(|at| format!("{}, {}, 0.9", at.x, at.y))
        .collect();
    let people = format!("{{\"people\": [{{\"pose_keypoints_2d\": [{}]}}]}}", seen.join(", "));
    let files = vec![
        ("plate.png".into(), png(RgbaImage::new(108, 144))),
        ("keypoints/00.json".into(), people.into_bytes()),
        ("keypoints/01.json".into(), b"{\"people\": [{\"pose_keypoints_2d\": [1, 2]}]}".to_vec()),
    ];
    let more = "background = \"plate.png\"\nkeypoints = \"keypoints/%02d.json\"\n";
    let footage = Footage::new(take(more, files));
    let mask = |frame: usize| {
        let picture = footage.picture(0, frame).unwrap();
        footage.mask(0, frame, &picture, &footage.take().measurement()[0])
    };
    let found = mask(0).unwrap();
    let knee =
        footage.cameras[0].project(ends[body.limb_index("left lower thigh").unwrap()]).unwrap().round();
    assert_eq!(found.get(knee.x as usize, knee.y as usize), Some(Label::Subject));
    assert_eq!(found.get(2, 2), Some(Label::Background));
    assert!(found.count(Label::Unknown) > 0);
    // A frame without keypoints is unknown; one whose file is wrong says so.
    assert_eq!(mask(2).unwrap().count(Label::Subject), 0);
    let error = mask(1).unwrap_err().to_string();
    assert!(error.contains("01.json") && error.contains("people[0].pose_keypoints_2d"), "{error}");
}
