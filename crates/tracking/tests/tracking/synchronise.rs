//! Offsets of clocks from silhouettes of a body that is not a person: three balls that wander.

use backlit_tracking::camera::{Camera, Distortion};
use backlit_tracking::silhouette::{Label, Mask};
use backlit_tracking::synchronise::{
    CameraOffset, PairCue, Recording, Synchronisation, SynchroniseError, SynchroniseOptions, Undecided,
    synchronise,
};
use glam::{DVec2, DVec3};

use crate::fixtures;

const SIZE: [u64; 2] = [120, 90];
const RATE: f64 = 25.0;
const FRAMES: usize = 70;

fn camera(at: DVec3) -> Camera {
    fixtures::camera(SIZE, [112.0, 112.0, 59.5, 44.5], at, DVec3::Z, DVec3::Z)
}

/// Around the balls, no two opposite each other.
fn around(count: usize) -> Vec<Camera> {
    let at = |index: usize| {
        let angle = 0.3 + 1.1 * index as f64;
        DVec3::new(4.0 * angle.cos(), 4.0 * angle.sin(), 1.0 + 0.4 * index as f64)
    };
    (0..count).map(|index| camera(at(index))).collect()
}

/// Middles and radii: nothing of it repeats itself.
fn balls(seconds: f64) -> [(DVec3, f64); 3] {
    let wave = |rate: f64, phase: f64| (rate * seconds + phase + 0.4 * (0.7 * seconds).sin()).sin();
    let middle = DVec3::new(0.3 * wave(2.3, 0.2), 0.25 * wave(1.7, 1.9), 1.0 + 0.2 * wave(3.1, 0.7));
    let up = DVec3::new(0.1 * wave(4.1, 0.0), 0.2 * wave(2.9, 1.0), 0.45);
    let arm = DVec3::new(0.4 * wave(2.1, 2.2), 0.35, 0.2 + 0.3 * wave(3.7, 0.4));
    [(middle, 0.3), (middle + up, 0.2), (middle + arm, 0.12)]
}

fn mask(camera: &Camera, seconds: f64) -> Mask {
    let balls = balls(seconds);
    fixtures::covered([camera.width(), camera.height()], |x, y| {
        let (eye, ray) = (camera.centre(), camera.ray_in_world(DVec2::new(x as f64, y as f64)).unwrap());
        let hits =
            |(middle, radius): (DVec3, f64)| (middle - eye).reject_from_normalized(ray).length() <= radius;
        balls.into_iter().any(hits)
    })
}

/// A camera whose clock is ahead, and what becomes of its masks.
fn record(camera: &Camera, ahead: f64, change: impl Fn(usize, Mask) -> Mask) -> Recording {
    let mut recording = Recording::new(camera.clone());
    for frame in 0..FRAMES {
        let clock = frame as f64 / RATE;
        recording.push(clock, &change(frame, mask(camera, clock - ahead)));
    }
    recording
}

fn find(recordings: &[Recording]) -> Synchronisation {
    synchronise(recordings, &SynchroniseOptions::default()).unwrap()
}

fn check(found: &Synchronisation, ahead: &[f64], within_frames: f64) {
    for (camera, ahead) in ahead.iter().enumerate() {
        let seconds =
            found.seconds(camera).unwrap_or_else(|| panic!("{camera}: {:?}", found.cameras[camera]));
        let off = (seconds - ahead) * RATE;
        assert!(off.abs() < within_frames, "camera {camera} is {off:.3} frames off\n{found:#?}");
    }
}

#[test]
fn whole_and_fractional_offsets_are_found_and_loops_close() {
    let ahead = [0.0, 8.0 / RATE, -5.37 / RATE, 12.61 / RATE];
    let recordings: Vec<Recording> =
        around(4).iter().zip(ahead).map(|(camera, ahead)| record(camera, ahead, |_, mask| mask)).collect();
    let found = find(&recordings);
    check(&found, &ahead, 0.12);
    assert_eq!(found.cameras[0], CameraOffset::Reference);
    for camera in &found.cameras[1..] {
        let CameraOffset::Found(offset) = camera else { panic!("{camera:?}") };
        assert!(offset.probability > 0.999 && offset.deviation_s * RATE < 0.2, "{offset:?}");
        assert!(offset.rival.is_none_or(|(_, nats)| nats < 0.5 * offset.evidence), "{offset:?}");
    }
    assert_eq!(found.pairs.len(), 6);
    assert!(found.pairs.iter().all(|pair| pair.cue == PairCue::EpipolarTangents), "{:#?}", found.pairs);
    assert!(found.loop_error_s.unwrap() * RATE < 0.1, "{:?}", found.loop_error_s);
    // The other way round the signs change.
    let back: Vec<Recording> = recordings.into_iter().rev().collect();
    check(&find(&back), &[0.0, ahead[2] - ahead[3], ahead[1] - ahead[3], -ahead[3]], 0.12);
}

/// The picture ends at the middle of the body, frames are empty, and pixels about the body are unknown.
#[test]
fn cut_empty_and_unknown_frames_do_no_harm() {
    let ahead = [0.0, -6.3 / RATE];
    let cameras = around(2);
    let cut = |frame: usize, mut mask: Mask| {
        if frame % 7 == 3 || (20..26).contains(&frame) {
            mask.labels_mut().fill(Label::Background);
        }
        let is_near = |labels: &[Label], at: usize| labels[at - 1] == Label::Subject;
        for at in (1..mask.labels().len()).filter(|at| at % 3 == 0) {
            if mask.labels()[at] == Label::Background && is_near(mask.labels(), at) {
                mask.labels_mut()[at] = Label::Unknown;
            }
        }
        mask
    };
    let whole = record(&cameras[0], ahead[0], cut);
    // The same camera with a picture that ends in the middle of the body.
    let pinhole = *cameras[1].intrinsics();
    let place = *cameras[1].camera_from_world();
    let low = Camera::new("low", [120, 51], pinhole, Distortion::None, place).unwrap();
    let cut_off = record(&low, ahead[1], |_, mask| mask);
    check(&find(&[whole, cut_off]), &ahead, 0.3);
}

#[test]
fn a_body_that_stands_still_is_refused_and_so_is_nobody() {
    let cameras = around(3);
    let still: Vec<Recording> =
        cameras.iter().map(|camera| record(camera, 0.0, |_, _| mask(camera, 0.5))).collect();
    for offset in &find(&still).cameras[1..] {
        let CameraOffset::Undecided(why) = offset else { panic!("{offset:?}") };
        assert!(matches!(why, Undecided::NoMotion { spread_px } if *spread_px < 0.1), "{why}");
    }
    let empty = |frame: usize, mask: Mask| {
        if frame < 5 { mask } else { Mask::filled(mask.width(), mask.height(), Label::Background).unwrap() }
    };
    let found = find(&[record(&cameras[0], 0.0, |_, mask| mask), record(&cameras[1], 0.0, empty)]);
    let expected = Undecided::FewSilhouettes { found: 5, wanted: 12 };
    assert_eq!(found.cameras[1], CameraOffset::Undecided(expected));
    assert_eq!(expected.to_string(), "only 5 frames have a silhouette; 12 are needed");
}

/// One camera films something else: it is refused, and the others are none the worse for it.
#[test]
fn a_camera_that_sees_another_movement_is_refused() {
    let ahead = [0.0, 3.4 / RATE, -7.0 / RATE];
    let cameras = around(4);
    let mut recordings: Vec<Recording> =
        cameras.iter().zip(ahead).map(|(camera, ahead)| record(camera, ahead, |_, mask| mask)).collect();
    recordings.push(record(&cameras[3], -40.0, |_, mask| mask));
    let found = find(&recordings);
    check(&found, &ahead, 0.12);
    assert!(matches!(found.cameras[3], CameraOffset::Undecided(_)), "{:?}", found.cameras[3]);
}

#[test]
fn what_cannot_be_compared_is_told() {
    let cameras = around(2);
    let good: Vec<Recording> = cameras.iter().map(|camera| record(camera, 0.0, |_, mask| mask)).collect();
    let message = |recordings: &[Recording], options: &SynchroniseOptions| {
        synchronise(recordings, options).unwrap_err().to_string()
    };
    let options = SynchroniseOptions::default();
    assert_eq!(synchronise(&good[..1], &options), Err(SynchroniseError::Count { count: 1 }));
    let mut back = good.clone();
    back[1].push(0.3, &mask(&cameras[1], 0.0));
    let told = message(&back, &options);
    assert!(told.contains("camera 1: frame 70 is at 0.3 s"), "{told}");
    let mut endless = good.clone();
    endless[0].push(f64::NAN, &mask(&cameras[0], 0.0));
    assert!(message(&endless, &options).contains("camera 0: frame 70 is at NaN s"));
    let mut other = good.clone();
    other[0].push(99.0, &Mask::filled(8, 8, Label::Subject).unwrap());
    assert_eq!(synchronise(&other, &options), Err(SynchroniseError::Size { camera: 0, frame: 70 }));
    let wrong = SynchroniseOptions { least_overlap: f64::NAN, ..options };
    assert!(message(&good, &wrong).contains("`least_overlap` is NaN"));
    let wrong = SynchroniseOptions { farthest_s: -1.0, ..options };
    assert!(message(&good, &wrong).contains("`farthest_s` is -1"));
    // Cameras in one place, one frame, no time at all: no answer, no panic.
    let one_place = [good[0].clone(), good[0].clone()];
    assert_eq!(find(&one_place).cameras.len(), 2);
    let nothing: Vec<Recording> = cameras.iter().map(|camera| Recording::new(camera.clone())).collect();
    assert!(matches!(find(&nothing).cameras[1], CameraOffset::Undecided(Undecided::FewSilhouettes { .. })));
}
