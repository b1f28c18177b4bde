//! A tiny take in memory: an arm of two limbs before two cameras, drawn as thick lines on a plain wall.

use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use backlit_formats::{MemoryFiles, Take};
use backlit_tracking::body::{Kinematics, Model, ModelSpec, Pose};
use backlit_tracking::camera::{Camera, CameraFromWorld, Distortion, Intrinsics};
use glam::{DQuat, DVec2, DVec3};
use image::{ImageFormat, Rgb, RgbImage};

/// Width and height of the pictures.
const SIZE: [u64; 2] = [64, 48];
/// Frames of the take.
pub(crate) const FRAMES: usize = 3;

const ARM: &str = r#"format = "backlit-body 1"
name = "arm"
[[limb]]
name = "right upper arm"
direction = [1, 0, 0]
length = 0.3
radius = 0.06
[[limb]]
name = "right forearm"
parent = "right upper arm"
direction = [1, 0, 0]
length = 0.28
radius = 0.05
"#;

const TAKE: &str = r#"format = "backlit-take 1"
name = "arm"
frame_rate = 10
model = "arm.toml"
start = "start.json"
[cameras]
calibration = "cameras.json"
[[camera]]
name = "front"
frames = "front/%d.png"
background = "front/empty.png"
[[camera]]
name = "above"
frames = "above/%d.png"
background = "above/empty.png"
[measurement]
opening_px = 0
closing_px = 0
min_component_px = 4
"#;

const START: &str = r#"{"format": "backlit-pose 1", "root": [0, 0, 0],
"rotations": {"right upper arm": [0.999, 0, 0.045, 0], "right forearm": [0.99, 0, -0.14, 0]}}"#;

/// The take's files, as bytes.
pub(crate) fn files() -> Vec<(PathBuf, Vec<u8>)> {
    files_of(FRAMES, &[])
}

/// The files of a take with this number of frames; the arm is out of the picture in the `empty` ones.
fn files_of(frames: usize, empty: &[usize]) -> Vec<(PathBuf, Vec<u8>)> {
    let cameras = cameras();
    let mut files = vec![
        (PathBuf::from("take.toml"), TAKE.into()),
        (PathBuf::from("arm.toml"), ARM.into()),
        (PathBuf::from("start.json"), START.into()),
        (PathBuf::from("cameras.json"), cameras_json(&cameras).into_bytes()),
    ];
    let spec: ModelSpec = toml::from_str(ARM).unwrap();
    let model = Model::new(&spec).unwrap();
    for camera in &cameras {
        let folder = PathBuf::from(camera.name());
        files.push((folder.join("empty.png"), picture(camera, None)));
        for frame in 0..frames {
            let kinematics = Kinematics::new(&model, &truth(&model, frame));
            let body = (!empty.contains(&frame)).then_some((&model, &kinematics));
            files.push((folder.join(format!("{frame}.png")), picture(camera, body)));
        }
    }
    files
}

/// Writes the take to a folder.
pub(crate) fn write_to(folder: &Path) {
    write_frames_to(folder, FRAMES);
}

/// The same with another number of frames.
pub(crate) fn write_frames_to(folder: &Path, frames: usize) {
    for (path, bytes) in files_of(frames, &[]) {
        let path = folder.join(path);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, bytes).unwrap();
    }
}

/// The take.
pub(crate) fn take() -> Take {
    Take::from_files(Arc::new(MemoryFiles::new(files())), Path::new("take.toml")).unwrap()
}

/// A take with this number of frames; the arm is out of the picture in the `empty` ones.
pub(crate) fn take_of(frames: usize, empty: &[usize]) -> Take {
    let files = MemoryFiles::new(files_of(frames, empty));
    Take::from_files(Arc::new(files), Path::new("take.toml")).unwrap()
}

/// A take without silhouettes: neither masks nor pictures of the empty room.
pub(crate) fn take_without_backgrounds() -> Take {
    let mut files = files();
    let toml = TAKE.lines().filter(|line| !line.starts_with("background")).collect::<Vec<_>>().join("\n");
    files[0].1 = toml.into_bytes();
    Take::from_files(Arc::new(MemoryFiles::new(files)), Path::new("take.toml")).unwrap()
}

/// The pose in which a frame was drawn.
pub(crate) fn truth(model: &Model, frame: usize) -> Pose {
    let mut pose = Pose::rest(model);
    pose.root = DVec3::new(0.01 * frame as f64, 0.0, 0.02);
    pose.rotations[1] = DQuat::from_rotation_y(-0.5 - 0.05 * frame as f64);
    pose
}

fn cameras() -> Vec<Camera> {
    let intrinsics = Intrinsics { fx: 110.0, fy: 110.0, cx: 31.5, cy: 23.5 };
    let camera = |name: &str, centre: DVec3| {
        let place = CameraFromWorld::looking_at(centre, DVec3::new(0.28, 0.0, 0.0), DVec3::Z);
        Camera::new(name, SIZE, intrinsics, Distortion::None, place).unwrap()
    };
    vec![camera("front", DVec3::new(0.28, -1.9, 0.1)), camera("above", DVec3::new(0.9, -1.3, 1.1))]
}

fn cameras_json(cameras: &[Camera]) -> String {
    let one = |camera: &Camera| {
        let (place, k) = (camera.camera_from_world(), camera.intrinsics());
        let rows = place.rotation.transpose();
        let [x, y, z] = [rows.x_axis, rows.y_axis, rows.z_axis].map(|row| row.to_array());
        format!(
            r#"{{"name": "{}", "width": 64, "height": 48, "fx": {}, "fy": {}, "cx": {}, "cy": {},
            "rotation": [{x:?}, {y:?}, {z:?}], "translation": {:?}}}"#,
            camera.name(),
            k.fx,
            k.fy,
            k.cx,
            k.cy,
            place.translation.to_array()
        )
    };
    let all: Vec<String> = cameras.iter().map(one).collect();
    format!(r#"{{"format": "backlit-cameras 1", "cameras": [{}]}}"#, all.join(","))
}

fn picture(camera: &Camera, body: Option<(&Model, &Kinematics)>) -> Vec<u8> {
    let mut image = RgbImage::new(64, 48);
    for (x, y, pixel) in image.enumerate_pixels_mut() {
        let wall = 170 + (x / 2) as u8 + (y / 3) as u8;
        let inside = body.is_some_and(|(model, kinematics)| {
            let at = DVec2::new(f64::from(x), f64::from(y));
            (0..model.limbs().len()).any(|limb| {
                let (from, to) = (kinematics.starts()[limb], kinematics.ends()[limb]);
                let radius = 110.0 * model.limbs()[limb].radius / camera.depth(0.5 * (from + to));
                distance(at, camera.project(from).unwrap(), camera.project(to).unwrap()) < radius
            })
        });
        *pixel = if inside { Rgb([60, 40, 30]) } else { Rgb([wall; 3]) };
    }
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, ImageFormat::Png).unwrap();
    bytes.into_inner()
}

fn distance(point: DVec2, from: DVec2, to: DVec2) -> f64 {
    let along = to - from;
    let share = ((point - from).dot(along) / along.length_squared()).clamp(0.0, 1.0);
    point.distance(from + share * along)
}
