//! A small scene on the disk, and the program run in it.

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};

use backlit_formats::pose_file::{self, Quaternions};
use backlit_formats::{calibration, images};
use backlit_tracking::body::{Kinematics, Model, Parameters, Pose, builtin};
use backlit_tracking::camera::{Camera, CameraFromWorld, Distortion, Intrinsics, Rig};
use glam::DVec3;
use image::DynamicImage;
use serde_json::Value;
use tempfile::TempDir;

pub(crate) const RENDER: &str = "render --model upper_body --cameras cameras.json --pose pose.json --out out";
pub(crate) const FIT: &str = "fit --model upper_body --cameras cameras.json --start start.json --masks masks";

/// The take that comes with the program.
pub(crate) const BUILT_IN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/take");

/// A folder with two cameras and a pose of the upper body, and what the program says in it.
pub(crate) struct Scene {
    folder: TempDir,
    pub(crate) model: Model,
}

impl Scene {
    pub(crate) fn new() -> Self {
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
    pub(crate) fn pose(&self) -> Pose {
        let columns = Parameters::Tangent.columns(self.model.rotation_count());
        let step: Vec<f64> = (0..columns).map(|i| 0.15 * (i as f64 * 1.3).sin()).collect();
        Pose::rest(&self.model).retract(Parameters::Tangent, &step)
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, content: &str) {
        fs::write(self.path(name), content).unwrap();
    }

    /// The program with arguments that have no spaces in them.
    pub(crate) fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_backlit"));
        command.current_dir(self.folder.path()).args(arguments.split_whitespace());
        command
    }

    fn run(&self, arguments: &str) -> Output {
        self.command(arguments).output().unwrap()
    }

    /// Runs a command that must succeed; its standard output and what it says beside it.
    pub(crate) fn told(&self, arguments: &str) -> [String; 2] {
        let output = self.run(arguments);
        let complaint = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "backlit {arguments}: {complaint}");
        [String::from_utf8(output.stdout).unwrap(), complaint]
    }

    /// Runs a command that must succeed; its standard output.
    pub(crate) fn ok(&self, arguments: &str) -> String {
        let [printed, _] = self.told(arguments);
        printed
    }

    /// Runs a command that must succeed and print JSON.
    pub(crate) fn json(&self, arguments: &str) -> Value {
        serde_json::from_str(&self.ok(arguments)).unwrap()
    }

    /// A JSON file.
    pub(crate) fn read_json(&self, name: &str) -> Value {
        serde_json::from_str(&fs::read_to_string(self.path(name)).unwrap()).unwrap()
    }

    /// Runs a command that must fail with this exit code and say all of these in one line.
    pub(crate) fn fails(&self, arguments: &str, code: i32, expected: &[&str]) {
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
            // Notes of what was seen before it failed do not count.
            let errors = complaint.lines().filter(|line| !line.starts_with("note: "));
            assert_eq!(errors.count(), 1, "{complaint}");
        }
    }

    /// Draws the pose and makes hard masks of it.
    pub(crate) fn masks(&self) {
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
    pub(crate) fn start(&self) {
        let columns = Parameters::Tangent.columns(self.model.rotation_count());
        let step: Vec<f64> = (0..columns).map(|i| 0.06 * (i as f64 * 2.1).cos()).collect();
        let start = self.pose().retract(Parameters::Tangent, &step);
        pose_file::write(&self.path("start.json"), &self.model, &start).unwrap();
    }

    /// Mean distance of the joints of a pose file from the true pose's, millimetres.
    pub(crate) fn error_mm(&self, name: &str) -> f64 {
        let pose = pose_file::read(&self.path(name), &self.model, Quaternions::Normalised).unwrap();
        let (found, truth) =
            (Kinematics::new(&self.model, &pose), Kinematics::new(&self.model, &self.pose()));
        let distances = found.ends().iter().zip(truth.ends()).map(|(a, b)| 1000.0 * a.distance(*b));
        distances.sum::<f64>() / found.ends().len() as f64
    }
}
