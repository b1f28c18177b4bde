//! Writes the built-in take, pictures and truth, from a seed:
//!
//! ```text
//! cargo run --release -p backlit-lab --example make_builtin_take -- assets/take
//! ```
//!
//! The same files every time, to the byte, on any number of threads. `take.toml` and `README.md` in that folder
//! are written too; everything else there is left alone.

use std::error::Error;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use backlit_formats::calibration::backlit;
use backlit_formats::pose_file;
use backlit_lab::synthetic::{Build, Figure, Picture, Plate, Room, Sensor, motion, studio};
use backlit_tracking::body::{Kinematics, Model, Pose, builtin};
use backlit_tracking::search::start;
use image::codecs::jpeg::JpegEncoder;

/// Everything random follows from it.
const SEED: u64 = 2004;
/// Pictures of the empty room, a camera.
const EMPTY_FRAMES: usize = 6;
/// JPEG quality: the highest that keeps the take near 4 MB.
const QUALITY: u8 = 90;
/// Rays a pixel are the square of this, for the room and for the figure.
const ROOM_SAMPLES: usize = 6;
const FIGURE_SAMPLES: usize = 3;
/// The camera that was darker when the subject was there than when the room was empty, and how much.
const DARKER: (usize, f64) = (2, 0.93);
/// How far off the start pose is: every joint, and the root.
const START_OFF_RAD: f64 = 8.0 * std::f64::consts::PI / 180.0;
const START_OFF_M: f64 = 0.04;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).ok_or("usage: make_builtin_take FOLDER")?);
    let model = builtin::full_body();
    let rig = studio::cameras();
    let poses: Vec<Pose> = (0..motion::FRAMES).map(|frame| motion::pose(&model, frame as f64)).collect();
    let figures: Option<Vec<Figure>> =
        poses.iter().map(|pose| Figure::new(&model, pose, Build::default())).collect();
    let figures = figures.ok_or("the full body lacks a limb of the figure")?;

    fs::create_dir_all(folder.join("truth"))?;
    let mut bytes = 0;
    for (index, camera) in rig.cameras().iter().enumerate() {
        let into = folder.join(camera.name());
        fs::create_dir_all(&into)?;
        let plate = Plate::new(&Room::default(), camera, ROOM_SAMPLES);
        for empty in 0..EMPTY_FRAMES {
            let gain = flicker(index, motion::FRAMES + 7 * empty);
            let path = into.join(format!("empty_{empty:03}.jpg"));
            bytes += shoot(&path, &plate.empty(), gain, picture_seed(index, 1000 + empty))?;
        }
        for (frame, figure) in figures.iter().enumerate() {
            let gain = flicker(index, frame) * if index == DARKER.0 { DARKER.1 } else { 1.0 };
            let path = into.join(format!("frame_{frame:03}.jpg"));
            let light = plate.with_figure(figure, FIGURE_SAMPLES);
            bytes += shoot(&path, &light, gain, picture_seed(index, frame))?;
        }
        println!("{}: {} pictures, {bytes} bytes so far", camera.name(), EMPTY_FRAMES + figures.len());
    }
    for (frame, pose) in poses.iter().enumerate() {
        pose_file::write(&folder.join(format!("truth/pose_{frame:03}.json")), &model, pose)?;
    }
    let off = start::perturb(&model, &poses[0], START_OFF_RAD, START_OFF_M, SEED);
    pose_file::write(&folder.join("start.json"), &model, &off)?;
    backlit::write(&folder.join("cameras.json"), &rig)?;
    fs::write(folder.join("truth.csv"), joint_table(&model, &poses)?)?;
    // Hands are three pixels wide here, so nothing is opened; the floor's shadow may hide a foot, so it is unknown.
    fs::write(folder.join("take.toml"), include_str!("../../../assets/take/take.toml"))?;
    fs::write(folder.join("README.md"), include_str!("../../../assets/take/README.md"))?;
    Ok(())
}

fn shoot(path: &Path, light: &Picture, gain: f64, seed: u64) -> Result<usize, Box<dyn Error>> {
    let image = Sensor::default().expose(light, gain, seed);
    let mut file = Vec::new();
    JpegEncoder::new_with_quality(&mut file, QUALITY).encode_image(&image)?;
    fs::write(path, &file)?;
    Ok(file.len())
}

fn picture_seed(camera: usize, picture: usize) -> u64 {
    SEED + (camera * 10_000 + picture) as u64
}

/// Slow wavering of the exposure, within ±1 %, different in every camera.
fn flicker(camera: usize, frame: usize) -> f64 {
    let (t, phase) = (frame as f64 / motion::FRAME_RATE, camera as f64 * 1.9);
    1.0 + 0.006 * (t * 4.1 + phase).sin() + 0.004 * (t * 9.7 + 2.0 * phase).sin()
}

/// Root and second joint of every limb, in every frame: metres, to a hundredth of a millimetre.
fn joint_table(model: &Model, poses: &[Pose]) -> Result<String, std::fmt::Error> {
    let mut out = String::from("frame,marker,x,y,z\n");
    for (frame, pose) in poses.iter().enumerate() {
        let kinematics = Kinematics::new(model, pose);
        let names = std::iter::once("root").chain(model.limbs().iter().map(|limb| limb.name.as_str()));
        let places = std::iter::once(&pose.root).chain(kinematics.ends());
        for (name, place) in names.zip(places) {
            writeln!(out, "{frame},{name},{:.5},{:.5},{:.5}", place.x, place.y, place.z)?;
        }
    }
    Ok(out)
}
