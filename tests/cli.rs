//! The built program, run as people and programs run it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use backlit_tracking::body::{Kinematics, Model, Parameters, Pose, builtin};
use backlit_tracking::camera::{Camera, CameraFromWorld, Distortion, Intrinsics, Rig};
use backlit_tracking::io::pose_file::{self, Quaternions};
use backlit_tracking::io::{calibration, images};
use glam::DVec3;
use image::{DynamicImage, GrayImage, Luma};
use serde_json::Value;
use tempfile::TempDir;

/// A folder with two cameras and a pose of the upper body, and what the program says in it.
struct Scene {
    folder: TempDir,
    model: Model,
}

impl Scene {
    fn new() -> Self {
        let scene = Self { folder: tempfile::tempdir().unwrap(), model: builtin::upper_body() };
        let lens = Distortion::OpenCv { k1: -0.1, k2: 0.02, p1: 1e-3, p2: 0.0, k3: 0.0 };
        let camera = |name: &str, centre: DVec3, lens: Distortion| {
            let place = CameraFromWorld::looking_at(centre, DVec3::new(0.0, 0.2, 0.0), DVec3::Y);
            let intrinsics = Intrinsics { fx: 120.0, fy: 120.0, cx: 63.5, cy: 47.5 };
            Camera::new(name, [128, 96], intrinsics, lens, place).unwrap()
        };
        let cameras = vec![
            camera("front", DVec3::new(0.0, 0.3, 2.2), Distortion::None),
            camera("side", DVec3::new(2.0, 0.4, 0.6), lens),
        ];
        calibration::backlit::write(&scene.path("cameras.json"), &Rig::new(cameras).unwrap()).unwrap();
        pose_file::write(&scene.path("pose.json"), &scene.model, &scene.pose()).unwrap();
        scene
    }

    /// Some pose away from rest.
    fn pose(&self) -> Pose {
        let columns = Parameters::Tangent.columns(self.model.rotation_count());
        let step: Vec<f64> = (0..columns).map(|i| 0.15 * (i as f64 * 1.3).sin()).collect();
        Pose::rest(&self.model).retract(Parameters::Tangent, &step)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn write(&self, name: &str, content: &str) {
        fs::write(self.path(name), content).unwrap();
    }

    fn run(&self, arguments: &str) -> Output {
        Command::new(env!("CARGO_BIN_EXE_backlit"))
            .current_dir(self.folder.path())
            .args(arguments.split_whitespace())
            .output()
            .unwrap()
    }

    /// Runs a command that must succeed; its standard output.
    fn ok(&self, arguments: &str) -> String {
        let output = self.run(arguments);
        let complaint = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "backlit {arguments}: {complaint}");
        String::from_utf8(output.stdout).unwrap()
    }

    /// Runs a command that must fail with this exit code and say all of these in one line.
    fn fails(&self, arguments: &str, code: i32, expected: &[&str]) {
        let output = self.run(arguments);
        let complaint = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "backlit {arguments}: {complaint}");
        for part in expected {
            assert!(complaint.contains(part), "backlit {arguments}: {complaint:?} should say {part:?}");
        }
        let is_raw =
            ["backtrace", "panicked", "Error {", "Some("].iter().any(|word| complaint.contains(word));
        assert!(!is_raw, "backlit {arguments}: {complaint}");
        if code == 1 {
            assert_eq!(complaint.lines().count(), 1, "{complaint}");
        }
    }

    /// Draws the pose and makes hard masks of it.
    fn masks(&self) {
        self.ok("render --model upper_body --cameras cameras.json --pose pose.json --out drawn");
        fs::create_dir_all(self.path("masks")).unwrap();
        for name in ["front", "side"] {
            let mut picture = images::read_grey(&self.path("drawn").join(format!("{name}.png"))).unwrap();
            picture.pixels_mut().for_each(|pixel| pixel.0 = [if pixel.0[0] < 128 { 255 } else { 0 }]);
            let path = self.path("masks").join(format!("{name}.png"));
            images::write_png(&path, &DynamicImage::ImageLuma8(picture)).unwrap();
        }
    }

    /// A start a few degrees away.
    fn start(&self) {
        let columns = Parameters::Tangent.columns(self.model.rotation_count());
        let step: Vec<f64> = (0..columns).map(|i| 0.06 * (i as f64 * 2.1).cos()).collect();
        let start = self.pose().retract(Parameters::Tangent, &step);
        pose_file::write(&self.path("start.json"), &self.model, &start).unwrap();
    }

    /// Mean distance of the joints of a pose file from the true pose's, millimetres.
    fn error_mm(&self, name: &str) -> f64 {
        let pose = pose_file::read(&self.path(name), &self.model, Quaternions::Normalised).unwrap();
        let (found, truth) =
            (Kinematics::new(&self.model, &pose), Kinematics::new(&self.model, &self.pose()));
        let distances = found.ends().iter().zip(truth.ends()).map(|(a, b)| 1000.0 * a.distance(*b));
        distances.sum::<f64>() / found.ends().len() as f64
    }
}

/// Shape and values of an array of doubles.
fn read_npy(path: &Path) -> (String, Vec<f64>) {
    let bytes = fs::read(path).unwrap();
    assert_eq!(&bytes[..6], b"\x93NUMPY");
    let end = bytes.iter().position(|&byte| byte == b'\n').unwrap() + 1;
    let header = String::from_utf8_lossy(&bytes[10..end]);
    assert!(header.contains("<f8") && header.contains("False"), "{header}");
    let shape = header.split_once('(').unwrap().1.split_once(')').unwrap().0.to_owned();
    let values = bytes[end..].chunks_exact(8).map(|chunk| f64::from_le_bytes(chunk.try_into().unwrap()));
    (shape.trim_end_matches([',', ' ']).to_owned(), values.collect())
}

const RENDER: &str = "render --model upper_body --cameras cameras.json --pose pose.json --out out";
const FIT: &str = "fit --model upper_body --cameras cameras.json --start start.json --masks masks";

#[test]
fn render_writes_pictures_and_arrays() {
    let scene = Scene::new();
    for (renderer, columns, jacobian) in
        [("capsule", 27, "tangent"), ("cylinder", 35, "raw"), ("sphere-tree --spheres 5", 35, "raw")]
    {
        scene.ok(&format!("{RENDER} --renderer {renderer} --ramp thesis --npy --jacobian {jacobian}"));
        for name in ["front", "side"] {
            let picture = images::read_grey(&scene.path("out").join(format!("{name}.png"))).unwrap();
            let (shape, levels) = read_npy(&scene.path("out").join(format!("{name}.prediction.npy")));
            assert_eq!(shape, "96, 128");
            assert!(levels.iter().any(|&level| level < 10.0), "{renderer}: nobody is seen by {name}");
            let rounded: Vec<u8> = levels.iter().map(|level| level.round() as u8).collect();
            assert_eq!(picture.as_raw(), &rounded);
            let (shape, slopes) = read_npy(&scene.path("out").join(format!("{name}.jacobian.npy")));
            assert_eq!(shape, format!("12288, {columns}"));
            // Row-major: a pixel that no ramp touches has a row of zeros, a grey one has not.
            for (level, row) in levels.iter().zip(slopes.chunks_exact(columns)) {
                let pulls = row.iter().any(|&slope| slope != 0.0);
                assert_eq!(pulls, *level > 0.0 && *level < 255.0, "{renderer}, {name}: λ = {level}");
            }
        }
    }
}

#[test]
fn render_takes_quaternions_as_they_are() {
    let scene = Scene::new();
    let text = r#"{"format": "backlit-pose 1", "root": [0, 0, 0], "rotations": {"torso": [Q, 0, 0, 0]}}"#;
    let dark = |q: &str| {
        scene.write("pose.json", &text.replace('Q', q));
        scene.ok(&format!("{RENDER} --npy"));
        let (_, levels) = read_npy(&scene.path("out").join("front.prediction.npy"));
        levels.iter().map(|level| 255.0 - level).sum::<f64>()
    };
    let (one, longer) = (dark("1"), dark("1.2"));
    assert!(longer > 1.05 * one, "a longer quaternion makes longer limbs: {one} {longer}");
}

#[test]
fn fit_finds_the_pose() {
    let scene = Scene::new();
    scene.masks();
    scene.start();
    let text = scene.ok(&format!("{FIT} --out fitted.json"));
    assert!(text.contains("Stopped: ") && text.contains("stage"), "{text}");
    let (before, after) = (scene.error_mm("start.json"), scene.error_mm("fitted.json"));
    assert!(after < 0.5 * before, "{before} mm before, {after} mm after");

    // Grey levels made by the ramp that looks at them, without the priors: nothing but rounding is left.
    let grey = FIT.replace("--masks masks", "--measurement drawn");
    let options = "--preset report --ramp half --method lm --parameters tangent --iterations 80";
    scene.ok(&format!("{grey} {options} --out fitted.json"));
    let after = scene.error_mm("fitted.json");
    assert!(after < 20.0, "{before} mm before, {after} mm after");
}

#[test]
fn fit_answers_in_json() {
    let scene = Scene::new();
    scene.masks();
    scene.start();
    let options = "--preset report --iterations 7 --no-stop --timing --json";
    let answer: Value = serde_json::from_str(&scene.ok(&format!("{FIT} {options}"))).unwrap();
    assert_eq!(answer["iterations"].as_array().unwrap().len(), 7);
    assert_eq!(answer["costs"].as_array().unwrap().len(), 8);
    assert_eq!(answer["termination"]["reason"], "step-limit");
    assert_eq!(answer["termination"]["words"], "7 steps done");
    assert_eq!(answer["us_per_iteration"]["count"], 7);
    assert!(answer["us_per_iteration"]["min"].as_f64() <= answer["us_per_iteration"]["median"].as_f64());
    assert_eq!(answer["pose"]["format"], "backlit-pose 1");
    assert_eq!(answer["empty_cameras"].as_array().unwrap().len(), 0);
    // Far beyond convergence, where a step can only fail.
    for method in ["gauss-newton", "lm"] {
        let options = format!("--ramp half --method {method} --iterations 90 --no-stop --json");
        let answer: Value = serde_json::from_str(&scene.ok(&format!("{FIT} {options}"))).unwrap();
        assert_eq!(answer["iterations"].as_array().unwrap().len(), 90, "{method}");
    }
}

#[test]
fn an_empty_mask_is_left_out_and_nothing_to_see_is_an_error() {
    let scene = Scene::new();
    scene.masks();
    scene.start();
    let empty = DynamicImage::ImageLuma8(GrayImage::from_pixel(128, 96, Luma([0])));
    images::write_png(&scene.path("masks/side.png"), &empty).unwrap();
    let answer: Value = serde_json::from_str(&scene.ok(&format!("{FIT} --json"))).unwrap();
    assert_eq!(answer["empty_cameras"][0], "side");
    assert!(scene.ok(FIT).contains("side"));
    images::write_png(&scene.path("masks/front.png"), &empty).unwrap();
    scene.fails(FIT, 1, &["no camera has a silhouette", "front", "side"]);
}

#[test]
fn bad_files_are_named() {
    let scene = Scene::new();
    scene.masks();
    scene.start();
    let good = fs::read(scene.path("masks/front.png")).unwrap();
    fs::write(scene.path("masks/front.png"), &good[..good.len() / 2]).unwrap();
    scene.fails(FIT, 1, &["masks/front.png", "not a whole picture"]);
    let small = DynamicImage::ImageLuma8(GrayImage::new(32, 96));
    images::write_png(&scene.path("masks/front.png"), &small).unwrap();
    scene.fails(FIT, 1, &["masks/front.png", "32×96", "128×96"]);
    fs::remove_file(scene.path("masks/front.png")).unwrap();
    scene.fails(FIT, 1, &["masks/front.png", "no such file"]);

    scene.write("start.json", "{\"format\": \"backlit-pose 1\",\n\"root\": [0, NaN, 0], \"rotations\": {}}");
    scene.fails(FIT, 1, &["start.json, line 2", "root"]);
    scene.write(
        "start.json",
        "{\"format\": \"backlit-pose 1\", \"root\": [0, 0, 0],\n\"rotations\": {\"tail\": [1, 0, 0, 0]}}",
    );
    scene.fails(FIT, 1, &["start.json, line 2", "tail"]);

    let limb = |name: &str, parent: &str| {
        format!(
            "[[limb]]\nname = \"{name}\"\nparent = \"{parent}\"\ndirection = [0, 1, 0]\nlength = 1\nradius = 0.1\n"
        )
    };
    let model = |limbs: &str| {
        scene.write("body.toml", &format!("format = \"backlit-body 1\"\nname = \"b\"\n{limbs}"))
    };
    let render = RENDER.replace("upper_body", "body.toml");
    model(&(limb("a", "b") + &limb("b", "a")));
    scene.fails(&render, 1, &["body.toml, line ", "`parent`"]);
    model(&limb("a", "nobody"));
    scene.fails(&render, 1, &["body.toml, line 5", "nobody"]);
    scene.fails(&RENDER.replace("upper_body", "none.toml"), 1, &["none.toml", "full_body"]);
}

#[test]
fn senseless_commands_are_explained() {
    let scene = Scene::new();
    scene.start();
    scene.fails(&format!("{RENDER} --renderer torus"), 2, &["torus", "capsule, cylinder or sphere-tree"]);
    scene.fails(&format!("{RENDER} --renderer capsule --spheres 3"), 2, &["--spheres", "sphere-tree"]);
    scene.fails(&format!("{RENDER} --ramp width=-1"), 2, &["width=-1", "pixels above 0"]);
    scene.fails(&FIT.replace("--masks masks", ""), 2, &["--masks"]);
    scene.fails(&format!("{FIT} --damping nan"), 2, &["--damping", "finite"]);
    scene.fails("dance", 2, &["dance"]);
}

#[test]
fn a_jacobian_of_absurd_size_is_refused_before_anything_is_written() {
    let scene = Scene::new();
    let text = fs::read_to_string(scene.path("cameras.json")).unwrap();
    let large = text.replacen("128", "16384", 1).replacen("96", "16384", 1);
    assert_ne!(text, large);
    scene.write("cameras.json", &large);
    scene.fails(&format!("{RENDER} --jacobian raw"), 1, &["camera \"front\"", "35 columns", "MiB"]);
    assert!(!scene.path("out").exists());
}

#[test]
fn help_explains() {
    let scene = Scene::new();
    assert!(scene.ok("--help").contains("Examples:"));
    for (command, words) in [("render", "height × width"), ("fit", "white is the subject")] {
        let help = scene.ok(&format!("{command} --help"));
        assert!(help.contains("Example") && help.contains(words), "{help}");
    }
    assert!(scene.ok("--version").starts_with("backlit "));
}
