//! Projects of other tools, laid out as those tools lay them out: found by what is in them, and made takes of.

use std::path::Path;

use backlit_formats::calibration::write::{Format, to_text};
use backlit_formats::import::{self, ImportOptions, ImportSurvey, Project, WriteOptions};
use backlit_formats::{Footage, Take};
use backlit_tracking::camera::Rig;
use backlit_tracking::cancel::CancelToken;
use glam::DQuat;
use image::codecs::jpeg::JpegEncoder;

use crate::calibration_files::formats;
use crate::import::{camera, picture};
use crate::small_videos::avi_of;

const FRAMES: u32 = 12;

fn put(path: &Path, bytes: impl AsRef<[u8]>) {
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(path, bytes).unwrap();
}

/// A film of a block that moves.
fn film() -> Vec<u8> {
    let jpeg = |frame| {
        let mut bytes = std::io::Cursor::new(Vec::new());
        JpegEncoder::new_with_quality(&mut bytes, 95).encode_image(&picture(frame)).unwrap();
        bytes.into_inner()
    };
    avi_of(&(0..FRAMES).map(jpeg).collect::<Vec<_>>(), [160, 120], b"MJPG")
}

/// Cameras of these names in a tool's format.
fn texts(names: [&str; 2], format: Format) -> Vec<String> {
    let rig = Rig::new(vec![camera(names[0], -1.0), camera(names[1], 1.0)]).unwrap();
    to_text(&rig, format).unwrap()
}

/// Looks, writes a take, reads a silhouette of the second camera.
fn taken(project: &Path, out: &Path) -> ImportSurvey {
    let found = import::survey(&[project.to_owned()], &ImportOptions::default()).unwrap();
    import::write(&found, out, WriteOptions::default(), &CancelToken::new(), &mut |_| {}).unwrap();
    let footage = Footage::new(Take::open(out).unwrap());
    let mask = footage.fit_views(&[0, 1], 3).unwrap();
    assert_eq!(mask.len(), 2);
    found
}

fn names(found: &ImportSurvey) -> Vec<&str> {
    found.cameras.iter().map(|camera| camera.camera.name()).collect()
}

#[test]
fn an_easymocap_project() {
    let folder = tempfile::tempdir().unwrap();
    let project = folder.path().join("dance");
    let cameras = texts(["1", "2"], Format::EasyMocap);
    put(&project.join("intri.yml"), &cameras[0]);
    put(&project.join("extri.yml"), &cameras[1]);
    for camera in ["1", "2"] {
        put(&project.join(format!("videos/{camera}.avi")), film());
    }
    let found = taken(&project, &folder.path().join("take"));
    assert_eq!((found.project, found.count), (Project::EasyMocap, FRAMES as usize));
    assert_eq!((names(&found), found.frame_rate.map(f64::round)), (vec!["1", "2"], Some(25.0)));
}

#[test]
fn an_anipose_session() {
    let folder = tempfile::tempdir().unwrap();
    let project = folder.path().join("reach");
    put(&project.join("config.toml"), "nesting = 1\n[calibration]\nboard_type = \"charuco\"\n");
    put(&project.join("day1/calibration/calibration.toml"), &texts(["A", "B"], Format::Anipose)[0]);
    for camera in ["A", "B"] {
        put(&project.join(format!("day1/videos-raw/trial1-cam{camera}.avi")), film());
    }
    let found = taken(&project, &folder.path().join("take"));
    assert_eq!((found.project, names(&found)), (Project::Anipose, vec!["A", "B"]));
    for camera in &found.cameras {
        let file = format!("trial1-cam{}.avi", camera.camera.name());
        assert!(camera.pictures.path().ends_with(&file), "{}", camera.pictures.path().display());
    }
}

#[test]
fn a_freemocap_session() {
    let folder = tempfile::tempdir().unwrap();
    let project = folder.path().join("session_1");
    let text = &texts(["cam_0", "cam_1"], Format::Anipose)[0];
    put(&project.join("session_1_camera_calibration.toml"), text);
    for camera in 0..2 {
        put(&project.join(format!("synchronized_videos/Camera_{camera:03}_synchronized.avi")), film());
    }
    let found = taken(&project, &folder.path().join("take"));
    assert_eq!((found.project, found.cameras.len()), (Project::FreeMoCap, 2));
}

#[test]
fn a_caliscope_project() {
    let folder = tempfile::tempdir().unwrap();
    let project = folder.path().join("lab");
    let table = |port: usize, x: f64| {
        let pose = *camera("c", x).camera_from_world();
        let (axis, angle) = DQuat::from_mat3(&pose.rotation).to_axis_angle();
        let ([a, b, c], [x, y, z]) = ((axis * angle).to_array(), pose.translation.to_array());
        format!(
            "[cameras.{port}]\ncam_id = {port}\nsize = [160, 120]\nrotation_count = 0\nerror = 0.3\n\
             matrix = [[150.0, 0.0, 79.5], [0.0, 150.0, 59.5], [0.0, 0.0, 1.0]]\n\
             distortions = [0.0, 0.0, 0.0, 0.0, 0.0]\nrotation = [{a}, {b}, {c}]\ntranslation = [{x}, {y}, {z}]\n"
        )
    };
    put(&project.join("camera_array.toml"), table(0, -1.0) + &table(1, 1.0));
    for port in 0..2 {
        put(&project.join(format!("recordings/walk/port_{port}.avi")), film());
    }
    let found = taken(&project, &folder.path().join("take"));
    assert_eq!((found.project, names(&found)), (Project::Caliscope, vec!["0", "1"]));
}

#[test]
fn an_opencap_session() {
    let Some(formats) = formats() else { return };
    let pickle = formats.join("calibration/opencap_pickle/sandbox_cameraIntrinsicsExtrinsics.pickle");
    let folder = tempfile::tempdir().unwrap();
    let project = folder.path().join("OpenCapData_1");
    put(&project.join("sessionMetadata.yaml"), "subjectID: s1\nmass_kg: 70.0\nheight_m: 1.75\n");
    for camera in ["Cam0", "Cam1"] {
        let own = project.join("Videos").join(camera);
        put(&own.join("cameraIntrinsicsExtrinsics.pickle"), std::fs::read(&pickle).unwrap());
        put(&own.join("InputMedia/walk/walk.avi"), film());
    }
    let found = import::survey(&[project], &ImportOptions::default()).unwrap();
    assert_eq!((found.project, names(&found)), (Project::OpenCap, vec!["Cam0", "Cam1"]));
    for camera in &found.cameras {
        let own = format!("Videos/{}/InputMedia/walk/walk.avi", camera.camera.name());
        assert!(camera.pictures.path().ends_with(&own), "{}", camera.pictures.path().display());
    }
}

/// A folder for each camera: `config.xml` without the pictures' size, the video, the video of the empty scene, one of a board.
#[test]
fn folders_of_cameras_with_videos_of_the_empty_scene() {
    let folder = tempfile::tempdir().unwrap();
    let project = folder.path().join("data");
    let config = include_str!("../../fuzz/corpus/calibration_sized/config.xml");
    let config = config.replace("500. 0. 320. 0. 501. 240.", "150. 0. 80. 0. 150. 60.");
    for camera in ["cam1", "cam2"] {
        put(&project.join(camera).join("config.xml"), config.replace("1. 0.5 2.", "1. 0.5 4."));
        for name in ["background", "checkerboard", "video"] {
            put(&project.join(camera).join(name).with_extension("avi"), film());
        }
    }
    let out = folder.path().join("take");
    let found = taken(&project, &out);
    assert_eq!((names(&found), found.count), (vec!["cam1", "cam2"], FRAMES as usize));
    for camera in &found.cameras {
        assert!(
            camera.pictures.path().ends_with(format!("{}/video.avi", camera.camera.name())),
            "{camera:?}"
        );
    }
    let text = std::fs::read_to_string(out.join("take.toml")).unwrap();
    assert!(text.contains("cam2/background.avi\""), "{text}");
    assert_eq!(Take::open(&out).unwrap().background(1).unwrap().len(), FRAMES as usize);
}

/// `OpenPose` puts a file a camera in one folder; a Caliscope camera without a place is told.
#[test]
fn files_named_after_serial_numbers_and_cameras_without_a_place() {
    let folder = tempfile::tempdir().unwrap();
    let project = folder.path().join("openpose");
    let text = include_str!("../../fuzz/corpus/calibration_sized/openpose.xml");
    for camera in ["17012332", "18284509"] {
        put(&project.join(format!("cameras/{camera}.xml")), text);
        put(&project.join(format!("videos/{camera}.avi")), film());
    }
    let found = import::survey(&[project], &ImportOptions::default()).unwrap();
    assert_eq!(names(&found), ["17012332", "18284509"]);
    let project = folder.path().join("caliscope");
    put(
        &project.join("camera_array.toml"),
        include_str!("../../fuzz/corpus/calibration_toml/camera_array_null.toml"),
    );
    put(&project.join("videos/cam_0.avi"), film());
    let found = import::survey(&[project], &ImportOptions::default()).unwrap();
    assert_eq!(found.left_out, [("1".to_owned(), "the file has no place of it".to_owned())]);
}
