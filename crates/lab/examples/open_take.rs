//! What opening a large take costs, eight cameras of 1920 × 1080 with 3,000 frames each: the time until the take is known and
//! until the silhouettes of its first frame are there, and what scrubbing takes of time and memory.
//!
//! `cargo run --release -p backlit-lab --example open_take [REDUCTION]`

#[path = "../../formats/tests/formats/small_videos.rs"]
#[expect(dead_code, clippy::unwrap_used, reason = "it is a helper of tests, which make more kinds of videos")]
mod small_videos;

use std::io::Cursor;
use std::path::Path;
use std::time::Instant;

use backlit_formats::{Footage, Take, calibration, images};
use backlit_tracking::camera::{Camera, CameraFromWorld, Distortion, Intrinsics, Rig};
use glam::DVec3;
use image::codecs::jpeg::JpegEncoder;
use image::{Rgb, RgbImage};

const CAMERAS: usize = 8;
const FRAMES: usize = 3000;
const SIZE: [u32; 2] = [1920, 1080];

/// A body before a wall, which steps aside from frame to frame.
fn picture(step: Option<u32>) -> RgbImage {
    RgbImage::from_fn(SIZE[0], SIZE[1], |x, y| {
        let left = step.map(|step| 700 + 20 * step);
        if left.is_some_and(|left| (left..left + 200).contains(&x)) && (200..900).contains(&y) {
            return Rgb([210, 110, 80]);
        }
        Rgb([90 + (x / 64 % 4) as u8 * 10, 110, 120 + (y / 48 % 5) as u8 * 9])
    })
}

fn film() -> Result<Vec<u8>, Box<dyn std::error::Error>> {
    let mut different = Vec::new();
    for step in 0..10 {
        let mut bytes = Cursor::new(Vec::new());
        JpegEncoder::new_with_quality(&mut bytes, 80).encode_image(&picture(Some(step)))?;
        different.push(bytes.into_inner());
    }
    let frames: Vec<Vec<u8>> = different.iter().cycle().take(FRAMES).cloned().collect();
    Ok(small_videos::avi_of(&frames, SIZE, b"MJPG"))
}

fn make(folder: &Path, reduction: u32) -> Result<(), Box<dyn std::error::Error>> {
    let lens = Distortion::OpenCv { k1: -0.08, k2: 0.02, p1: 0.0, p2: 0.0, k3: 0.0 };
    let camera = |index: usize| {
        let angle = std::f64::consts::TAU * index as f64 / CAMERAS as f64;
        let place = DVec3::new(4.0 * angle.cos(), 4.0 * angle.sin(), 1.2);
        let place = CameraFromWorld::looking_at(place, DVec3::Z, DVec3::Z);
        let intrinsics = Intrinsics { fx: 1400.0, fy: 1400.0, cx: 959.5, cy: 539.5 };
        Camera::new(&format!("cam{index}"), SIZE.map(u64::from), intrinsics, lens, place)
    };
    let rig = Rig::new((0..CAMERAS).map(camera).collect::<Result<_, _>>()?)?;
    std::fs::write(folder.join("cameras.json"), calibration::backlit::to_text(&rig))?;
    images::write_png(&folder.join("plate.png"), &picture(None).into())?;
    std::fs::write(folder.join("film.avi"), film()?)?;
    let mut text = format!(
        "format = \"backlit-take 1\"\nname = \"large\"\nframe_rate = 25\nmodel = \"full_body\"\nreduction = {reduction}\n\
         [cameras]\ncalibration = \"cameras.json\"\n"
    );
    for index in 0..CAMERAS {
        text += &format!(
            "[[camera]]\nname = \"cam{index}\"\nframes = \"film.avi\"\nbackground = \"plate.png\"\n"
        );
    }
    std::fs::write(folder.join("take.toml"), text)?;
    Ok(())
}

/// Memory of this process now and at most so far, MB; nothing where the system does not say it.
fn memory_mb() -> Option<[f64; 2]> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let of = |key: &str| -> Option<f64> {
        let line = status.lines().find(|line| line.starts_with(key))?;
        Some(line.split_whitespace().nth(1)?.parse::<f64>().ok()? / 1024.0)
    };
    Some([of("VmRSS:")?, of("VmHWM:")?])
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let reduction = std::env::args().nth(1).map_or(Ok(3), |text| text.parse())?;
    let folder = std::env::temp_dir().join(format!("backlit-open-take-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let measured = make(&folder, reduction).and_then(|()| {
        // What was needed to make the videos does not count.
        let _ = std::fs::write("/proc/self/clear_refs", "5");
        measure(&folder)
    });
    std::fs::remove_dir_all(&folder)?;
    measured
}

fn measure(folder: &Path) -> Result<(), Box<dyn std::error::Error>> {
    let cameras: Vec<usize> = (0..CAMERAS).collect();
    let mut rounds: Vec<[f64; 2]> = Vec::new();
    let mut footage = None;
    for _ in 0..5 {
        let start = Instant::now();
        let opened = Footage::new(Take::open(folder)?);
        let known = start.elapsed().as_secs_f64();
        opened.fit_views(&cameras, 0)?;
        rounds.push([known, start.elapsed().as_secs_f64()]);
        footage = Some(opened);
    }
    for (part, name) in ["the take is known", "the first frame's silhouettes"].iter().enumerate() {
        let mut times: Vec<f64> = rounds.iter().map(|round| round[part]).collect();
        times.sort_by(f64::total_cmp);
        println!(
            "{name}: median {:.2} s, {:.2} to {:.2} of {} rounds",
            times[2],
            times[0],
            times[4],
            times.len()
        );
    }
    if let Some([now, most]) = memory_mb() {
        println!("memory with the first frame: {now:.0} MB, at most {most:.0} MB");
    }
    let Some(footage) = footage else { return Ok(()) };
    let mut times = Vec::new();
    for step in 0..200 {
        let frame = step * 37 % FRAMES;
        let start = Instant::now();
        footage.fit_views(&cameras, frame)?;
        times.push(start.elapsed().as_secs_f64() * 1e3);
    }
    times.sort_by(f64::total_cmp);
    println!(
        "a frame anywhere, all {CAMERAS} cameras: median {:.0} ms, 95 % {:.0} ms",
        times[100], times[190]
    );
    if let Some([now, most]) = memory_mb() {
        println!("memory after 200 frames: {now:.0} MB, at most {most:.0} MB");
    }
    Ok(())
}
