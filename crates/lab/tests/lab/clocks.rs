//! Clocks that are off by drawn times, found from the motion of silhouettes that are not as they should be.

use std::sync::Arc;

use backlit_lab::synthetic::masks::{noisy, widened};
use backlit_lab::synthetic::people::BREADTH;
use backlit_lab::synthetic::{capsules, motion, squats, studio};
use backlit_tracking::body::{Model, Pose, builtin};
use backlit_tracking::camera::Camera;
use backlit_tracking::synchronise::{CameraOffset, Recording, SynchroniseOptions, synchronise};
use glam::DVec3;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};
use rayon::prelude::*;

const SIZE: [u64; 2] = [108, 144];

/// Who moves, for how long and how far clocks are off at most (seconds), before which cameras.
struct Setting {
    cameras: Vec<Arc<Camera>>,
    times: [f64; 2],
    pose: fn(&Model, f64) -> Pose,
}

/// What is wrong.
#[derive(Default)]
struct Trouble {
    /// By which share of the shoulders masks are too wide; of every other camera alone, if so.
    wide: f64,
    every_other: bool,
    /// Which share of the pixels at borders are wrong.
    noise: f64,
    /// Frames a second of every other camera in the place of 30.
    other_rate: Option<f64>,
}

/// Offsets of the cameras but the first: the truth in seconds, what was found, and the slowest camera's frame in seconds.
fn offsets(setting: &Setting, trouble: &Trouble) -> Vec<(f64, CameraOffset, f64)> {
    let model = builtin::full_body();
    let [length, farthest] = setting.times;
    let mut random = Pcg64Mcg::seed_from_u64(1);
    let mut centred = || (random.next_u64() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
    let mut ahead = vec![0.0];
    ahead.extend(setting.cameras[1..].iter().map(|_| farthest * centred()));
    let rate = |camera: usize| trouble.other_rate.filter(|_| camera % 2 == 1).unwrap_or(30.0);
    let record = |(index, camera): (usize, &Arc<Camera>)| {
        let px_per_m = camera.intrinsics().mean_focal_px() / camera.depth(DVec3::new(0.0, 0.0, 0.85));
        let mask = |frame: usize| {
            let moment = frame as f64 / rate(index) - ahead[index];
            let mask = capsules::hard_mask(&model, &(setting.pose)(&model, moment), camera).unwrap();
            let mut random = Pcg64Mcg::seed_from_u64(1 + (index * 10_000 + frame) as u64);
            if trouble.noise > 0.0 {
                noisy(&mask, trouble.noise, 5e-4, &mut random)
            } else if trouble.every_other && index % 2 == 0 {
                mask
            } else {
                widened(mask, 0.5 * trouble.wide * BREADTH * px_per_m).unwrap()
            }
        };
        let frames = (rate(index) * length) as usize;
        let masks: Vec<_> = (0..frames).into_par_iter().map(mask).collect();
        let mut recording = Recording::new((**camera).clone());
        for (frame, mask) in masks.iter().enumerate() {
            recording.push(frame as f64 / rate(index), mask);
        }
        recording
    };
    let recordings: Vec<Recording> = setting.cameras.iter().enumerate().map(record).collect();
    let period_s = 1.0 / (0..ahead.len()).map(rate).fold(f64::INFINITY, f64::min);
    let found = synchronise(&recordings, &SynchroniseOptions::default()).unwrap();
    ahead.into_iter().zip(found.cameras).skip(1).map(|(truth, found)| (truth, found, period_s)).collect()
}

#[test]
fn clocks_are_found_whatever_is_wrong_with_the_masks() {
    let moving = |model: &Model, seconds: f64| motion::pose(model, motion::FRAME_RATE * (seconds - 0.25));
    let around = Setting { cameras: studio::pinholes(SIZE).unwrap(), times: [2.5, 0.5], pose: moving };
    let phones = Setting { cameras: squats::cameras(SIZE).unwrap(), times: [8.0, 2.0], pose: squats::pose };
    let nothing = Trouble::default;
    let cases = [
        ("nothing", &around, nothing()),
        ("too wide", &around, Trouble { wide: 0.05, ..nothing() }),
        ("noise", &around, Trouble { noise: 0.3, ..nothing() }),
        ("another rate", &around, Trouble { other_rate: Some(25.0), ..nothing() }),
        ("phones, one too wide", &phones, Trouble { wide: 0.05, every_other: true, ..nothing() }),
        ("phones, noise", &phones, Trouble { noise: 0.3, ..nothing() }),
    ];
    for (name, setting, trouble) in cases {
        for (truth, found, period_s) in offsets(setting, &trouble) {
            let CameraOffset::Found(offset) = found else { panic!("{name}: {found:?}") };
            let frames = ((offset.seconds - truth) / period_s).abs();
            assert!(frames < 0.25, "{name}: {frames} frames off");
        }
    }
}

#[test]
fn a_person_who_stands_still_is_refused() {
    let still = |model: &Model, _: f64| motion::pose(model, 12.0);
    let still = Setting { cameras: studio::pinholes(SIZE).unwrap(), times: [2.5, 0.5], pose: still };
    for noise in [0.0, 0.3] {
        for (_, found, _) in offsets(&still, &Trouble { noise, ..Trouble::default() }) {
            let CameraOffset::Undecided(why) = &found else { panic!("noise {noise}: {found:?}") };
            assert!(why.to_string().starts_with("nothing moves enough to tell"), "noise {noise}: {why}");
        }
    }
}
