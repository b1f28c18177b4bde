//! Takes made of footage: a folder of pictures, and another tool's whole project.

use std::path::Path;

use backlit_formats::import::{
    self, ImportError, ImportOptions, ImportSurvey, MatchedBy, PictureSize, Project, WriteOptions,
};
use backlit_formats::masks::MaskValues;
use backlit_formats::take::BodySizes;
use backlit_formats::{Footage, Take, calibration, images};
use backlit_tracking::camera::{Camera, CameraFromWorld, Distortion, Intrinsics, Rig};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::silhouette::Label;
use glam::DVec3;
use image::{Rgb, RgbImage};

use crate::calibration_files::formats;

const SIZE: [u64; 2] = [160, 120];

pub(crate) fn camera(name: &str, x: f64) -> Camera {
    let place = CameraFromWorld::looking_at(DVec3::new(x, -4.0, 1.0), DVec3::new(0.0, 0.0, 1.0), DVec3::Z);
    let intrinsics = Intrinsics { fx: 150.0, fy: 150.0, cx: 79.5, cy: 59.5 };
    Camera::new(name, SIZE, intrinsics, Distortion::None, place).unwrap()
}

/// A block before a wall that steps to the side and up and down.
pub(crate) fn picture(frame: u32) -> RgbImage {
    RgbImage::from_fn(160, 120, |x, y| {
        let is_block =
            (20 + 5 * frame..44 + 5 * frame).contains(&x) && (20 + frame % 4..100 + frame % 4).contains(&y);
        if is_block { Rgb([220, 120, 90]) } else { Rgb([90 + (x % 9) as u8, 110, 130 + (y % 7) as u8]) }
    })
}

/// A folder of two cameras' pictures, numbered from 5, and their calibration.
fn recording(folder: &Path) {
    let rig = Rig::new(vec![camera("cam_01", -1.0), camera("cam_02", 1.0)]).unwrap();
    std::fs::create_dir_all(folder.join("calibration")).unwrap();
    let text = calibration::backlit::to_text(&rig);
    std::fs::write(folder.join("calibration/cameras.json"), text).unwrap();
    for (camera, count) in [("Camera 1", 20), ("Camera 2", 18)] {
        std::fs::create_dir_all(folder.join("images").join(camera)).unwrap();
        for frame in 0..count {
            let path = folder.join("images").join(camera).join(format!("{:04}.png", 5 + frame));
            images::write_png(&path, &picture(frame).into()).unwrap();
        }
    }
}

fn look(folder: &Path, options: &ImportOptions) -> Result<ImportSurvey, ImportError> {
    import::survey(&[folder.to_owned()], options)
}

fn write(found: &ImportSurvey, out: &Path) -> Result<std::path::PathBuf, ImportError> {
    import::write(found, out, WriteOptions::default(), &CancelToken::new(), &mut |_| {})
}

#[test]
fn a_folder_of_pictures_becomes_a_take_with_silhouettes() {
    let folder = tempfile::tempdir().unwrap();
    let recorded = folder.path().join("my recording");
    recording(&recorded);
    let found = look(&recorded, &ImportOptions::default()).unwrap();
    assert_eq!((found.project, found.matched_by, found.count), (Project::Plain, MatchedBy::Name, 18));
    assert_eq!((found.name.as_str(), found.frame_rate, found.left_out.len()), ("my recording", None, 0));
    let out = folder.path().join("take");
    assert!(matches!(write(&found, &out), Err(ImportError::NoFrameRate)), "nothing says it");
    let options = ImportOptions { frame_rate: Some(50.0), ..ImportOptions::default() };
    let found = look(&recorded, &options).unwrap();
    write(&found, &out).unwrap();
    assert!(matches!(write(&found, &out), Err(ImportError::Exists(_))), "a take is not written over");
    let take = Take::open(&out).unwrap();
    assert_eq!((take.frame_count(), take.frame_rate(), take.sizes()), (18, 50.0, BodySizes::Fit));
    assert!(take.start().is_none() && take.reference().is_none());
    let footage = Footage::new(take);
    for (camera, frame) in [(0, 0), (1, 17)] {
        let picture = footage.picture(camera, frame).unwrap();
        let mask = footage.mask(camera, frame, &picture, &footage.take().measurement()[camera]).unwrap();
        let found = mask.count(Label::Subject);
        assert!(found.abs_diff(24 * 80) < 80, "frame {frame}: {found} pixels of {}", 24 * 80);
    }
}

#[test]
fn pictures_of_half_the_size_get_cameras_of_half_the_size() {
    let folder = tempfile::tempdir().unwrap();
    recording(folder.path());
    let rig =
        Rig::new(["cam_01", "cam_02"].map(|name| camera(name, 1.0).resized(320, 240).unwrap()).to_vec());
    let text = calibration::backlit::to_text(&rig.unwrap());
    std::fs::write(folder.path().join("calibration/cameras.json"), text).unwrap();
    let found = look(folder.path(), &ImportOptions::default()).unwrap();
    for camera in &found.cameras {
        assert_eq!((camera.picture_size, camera.calibrated_size), (PictureSize::Scaled, [320, 240]));
        assert_eq!((camera.camera.width(), camera.camera.intrinsics().fx), (160, 150.0));
    }
    let cut = ImportOptions { picture_size: Some(PictureSize::CutAround), ..ImportOptions::default() };
    let found = look(folder.path(), &cut).unwrap();
    assert_eq!(found.cameras[0].camera.intrinsics().fx, 300.0);
}

#[test]
fn what_is_missing_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let message = |folder: &Path| look(folder, &ImportOptions::default()).unwrap_err().to_string();
    assert!(message(folder.path()).contains("no video and no numbered pictures are there"));
    recording(folder.path());
    std::fs::remove_file(folder.path().join("calibration/cameras.json")).unwrap();
    assert!(message(folder.path()).contains("no calibration is there that can be read"));
    std::fs::write(folder.path().join("calibration/cameras.json"), "{").unwrap();
    let said = message(folder.path());
    assert!(said.contains("cameras.json") && said.contains("name one"), "{said}");
    let rig = Rig::new(vec![camera("left", 0.0), camera("right", 1.0), camera("top", 2.0)]).unwrap();
    std::fs::write(folder.path().join("calibration/cameras.json"), calibration::backlit::to_text(&rig))
        .unwrap();
    let said = message(folder.path());
    assert!(said.contains("left, right, top") && said.contains("Camera 1"), "{said}");
}

/// Masks of the recording's block, as many as the camera has pictures.
fn masks(folder: &Path, pattern: impl Fn(u32, u32) -> String, white: u8, counts: [u32; 2]) {
    for (camera, count) in [1, 2].into_iter().zip(counts) {
        for frame in 0..count {
            let picture = picture(frame);
            let level = |x, y| image::Luma([if picture.get_pixel(x, y)[0] == 220 { white } else { 0 }]);
            let path = folder.join(pattern(camera, frame));
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            images::write_png(&path, &image::GrayImage::from_fn(160, 120, level).into()).unwrap();
        }
    }
}

/// The take that becomes of a folder, and its text.
fn taken(folder: &Path, out: &Path) -> (ImportSurvey, Footage, String) {
    let options = ImportOptions { frame_rate: Some(50.0), ..ImportOptions::default() };
    let found = look(folder, &options).unwrap();
    write(&found, out).unwrap();
    let text = std::fs::read_to_string(out.join("take.toml")).unwrap();
    (found, Footage::new(Take::open(out).unwrap()), text)
}

fn block(footage: &Footage, camera: usize, frame: usize) -> usize {
    footage.given_mask(camera, frame).unwrap().unwrap().count(Label::Subject)
}

#[test]
fn masks_beside_the_footage_are_found_and_named() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("take");
    let places: [&dyn Fn(u32, u32) -> String; 2] =
        [&|camera, frame| format!("masks/cam{camera}/{frame:06}.png"), &|camera, frame| {
            format!("images/Camera {camera}/{:04}_mask.png", frame + 5)
        }];
    for place in places {
        let recorded = folder.path().join("recording");
        recording(&recorded);
        masks(&recorded, place, 1, [20, 18]);
        let (found, footage, text) = taken(&recorded, &out);
        assert_eq!((found.matched_by, found.count, footage.take().reduction()), (MatchedBy::Name, 18, 1));
        for (index, camera) in found.cameras.iter().enumerate() {
            assert_eq!(camera.pictures.count(), [20, 18][index], "the footage is not the masks");
            let masks = camera.masks.as_ref().unwrap();
            assert_eq!((masks.values.as_ref(), masks.are_alone), (Some(&MaskValues::NonZero), false));
            assert!(camera.notes.is_empty(), "{:?}", camera.notes);
            assert_eq!(block(&footage, index, 17), 24 * 80);
        }
        assert!(text.contains("mask_values = \"nonzero\"") && !text.contains("background"), "{text}");
        assert_eq!(footage.picture(0, 3).unwrap().get_pixel(0, 0)[0], 90, "footage, not masks");
        std::fs::remove_dir_all(&recorded).unwrap();
        std::fs::remove_dir_all(&out).unwrap();
    }
    // Masks that do not go with the footage are told and left alone; so is a folder that only is called so.
    let recorded = folder.path().join("recording");
    recording(&recorded);
    masks(&recorded, places[0], 255, [20, 7]);
    let (found, _, text) = taken(&recorded, &out);
    assert!(found.cameras[0].masks.is_some() && found.cameras[1].masks.is_none());
    let note = &found.cameras[1].notes[0];
    assert!(note.contains("masks/cam2") && note.contains("there are 7, and 18 frames of footage"), "{note}");
    assert_eq!((text.matches("masks =").count(), text.matches("background =").count()), (1, 1), "{text}");
    std::fs::remove_dir_all(&recorded).unwrap();
    recording(&recorded);
    std::fs::rename(recorded.join("images"), recorded.join("seg")).unwrap();
    let found = look(&recorded, &ImportOptions::default()).unwrap();
    assert!(found.cameras.iter().all(|camera| camera.masks.is_none()));
}

#[test]
fn masks_without_footage_become_a_take() {
    let folder = tempfile::tempdir().unwrap();
    let (recorded, out) = (folder.path().join("recording"), folder.path().join("take"));
    recording(&recorded);
    std::fs::remove_dir_all(recorded.join("images")).unwrap();
    masks(&recorded, |camera, frame| format!("silhouettes/cam{camera}_{frame}.png"), 255, [18, 18]);
    let (found, footage, text) = taken(&recorded, &out);
    assert!(found.cameras.iter().all(|camera| camera.masks.as_ref().unwrap().are_alone));
    assert_eq!((footage.take().frame_count(), text.matches("frames =").count()), (18, 0), "{text}");
    assert!(footage.take().footage()[1].is_masks_alone());
    assert_eq!(block(&footage, 1, 4), 24 * 80);
    // Several people: the take opens, and says what must be chosen where the masks are wanted.
    std::fs::remove_dir_all(&out).unwrap();
    masks(&recorded, |camera, frame| format!("silhouettes/cam{camera}_{frame}.png"), 2, [18, 18]);
    let path = recorded.join("silhouettes/cam1_0.png");
    let one = image::GrayImage::from_fn(160, 120, |x, _| image::Luma([u8::from(x < 9)]));
    images::write_png(&path, &one.into()).unwrap();
    let (found, footage, text) = taken(&recorded, &out);
    assert!(found.cameras[0].notes[0].contains("has the numbers 1, 2"), "{:?}", found.cameras[0].notes);
    assert!(text.contains("mask_values = \"auto\""), "{text}");
    assert!(footage.fit_views(&[0], 0).unwrap_err().to_string().contains("ids = [1]"));
}

#[test]
fn a_pose2sim_project_is_found_whole() {
    let Some(formats) = formats() else { return };
    let found = look(&formats.join("project_pose2sim_single"), &ImportOptions::default()).unwrap();
    assert_eq!((found.project, found.matched_by), (Project::Pose2Sim, MatchedBy::Name));
    assert_eq!((found.first, found.count, found.frame_rate.map(f64::round)), (0, 70, Some(60.0)));
    assert!(found.calibration.ends_with("calibration/Calib.qca.txt"));
    assert!(found.table.as_ref().unwrap().ends_with("S00_P00_T01_BalancingTrial_0-70.trc"));
    // The second video is VP9, which needs a program that need not be there; then it is left out by name.
    let names: Vec<&str> = found.cameras.iter().map(|camera| camera.camera.name()).collect();
    match names.as_slice() {
        ["cam01", "cam02", "cam03", "cam04"] => assert!(found.left_out.is_empty()),
        ["cam01", "cam03", "cam04"] => {
            assert!(
                found.left_out[0].0 == "cam02" && found.left_out[0].1.contains("ffmpeg"),
                "{:?}",
                found.left_out
            );
        }
        _ => panic!("{names:?}"),
    }
    for camera in &found.cameras {
        let name = camera.camera.name();
        // Two of the videos were scaled to 1080 columns with bars of seven rows.
        let is_boxed = matches!(name, "cam01" | "cam02");
        let expected = if is_boxed { PictureSize::Letterboxed } else { PictureSize::Same };
        assert_eq!(camera.picture_size, expected, "{name}");
        assert_eq!(
            (camera.camera.width(), camera.camera.height()),
            (if is_boxed { 1080 } else { 1088 }, 1920)
        );
        assert!(camera.pictures.path().ends_with(format!("videos/{name}.mp4")));
        let keypoints = camera.keypoints.as_ref().unwrap();
        assert!(keypoints.ends_with(format!("pose-associated/{name}_json")), "{}", keypoints.display());
    }
}
