//! Readers of bodies, poses, starts, tracks, motions, priors, cameras and keypoints, and what must hold of what they read.

use std::path::Path;
use std::sync::Arc;

use backlit_formats::calibration::write::{self, Format};
use backlit_formats::calibration::{self, CalibrationOptions};
use backlit_formats::export::track_read::WrittenTrack;
use backlit_formats::export::{TrackExport, resume_file, track_json, track_read};
use backlit_formats::pose_file::{self, Quaternions};
use backlit_formats::recording::{self, RecordingOptions};
use backlit_formats::{
    MemoryFiles, bvh, keypoints, model_file, motion, placement_file, prior_file, starts_file,
};
use backlit_tracking::body::{Pose, builtin};
use backlit_tracking::camera::Rig;
use backlit_tracking::cues::CueOptions;
use backlit_tracking::fit::FitOptions;
use backlit_tracking::track::{KalmanOptions, Motion, Tracker};

use crate::engine::Outcome;
use crate::seeds;

const OPTIONS: CalibrationOptions = CalibrationOptions { size: None, metres_per_unit: 1.0 };

pub(super) fn model(bytes: &[u8]) -> Outcome {
    let found = model_file::parse(Path::new("body.toml"), bytes);
    if let Ok(model) = &found {
        let again = model_file::parse(Path::new("again.toml"), model_file::to_text(model).as_bytes());
        assert_eq!(&again.unwrap(), model);
    }
    found.into()
}

pub(super) fn pose(bytes: &[u8]) -> Outcome {
    let model = builtin::upper_body();
    let path = Path::new("pose.json");
    let raw = pose_file::parse(path, bytes, &model, Quaternions::Raw);
    if let Ok(pose) = &raw {
        let text = pose_file::to_text(&model, pose);
        assert_eq!(&pose_file::parse(path, text.as_bytes(), &model, Quaternions::Raw).unwrap(), pose);
        let unit = pose_file::parse(path, bytes, &model, Quaternions::Normalised).unwrap();
        assert!(unit.rotations.iter().all(|q| (q.length() - 1.0).abs() < 1e-9), "{unit:?}");
    }
    raw.into()
}

/// A recording by its name; whether there are joints in it or not.
pub(super) fn recording(name: &str, bytes: &[u8]) -> Outcome {
    let options = RecordingOptions { frame_rate: Some(30.0), ..RecordingOptions::default() };
    let found = recording::parse(Path::new(name), bytes, &options);
    if let Ok(recording) = &found {
        assert!(recording.points.iter().all(|points| points.len() == recording.names.len()));
        assert!(recording.angles.values().all(|angles| angles.len() == recording.times.len()));
        let _ = recording.trajectories(Path::new(name), &options);
    }
    found.into()
}

pub(super) fn bvh_motion(bytes: &[u8]) -> Outcome {
    let path = Path::new("motion.bvh");
    let found = bvh::parse(path, bytes);
    if let Ok(motion) = &found {
        let last = motion.frame_count().saturating_sub(1);
        assert_eq!(motion.joints_at(last).len(), motion.joints().len());
        // Whether there is a person in it or not.
        let _ = motion.body_points(path);
    }
    if let Ok(track) = motion::parse_bvh(path, bytes) {
        assert!(track.frames.iter().all(|(_, places)| places.len() == track.joints.len()));
    }
    found.into()
}

pub(super) fn prior(bytes: &[u8]) -> Outcome {
    let path = Path::new("prior.json");
    let found = prior_file::parse(path, bytes);
    if let Ok(prior) = &found {
        // Six digits of a covariance may be none any more; what is read of them stays.
        if let Ok(again) = prior_file::parse(path, prior_file::to_text(prior).unwrap().as_bytes()) {
            assert_eq!(again.parts.len(), prior.parts.len());
        }
        for part in &prior.parts {
            let far = part.poses.pull(&vec![1e3; part.poses.size()].into());
            assert!(far.energy >= 0.0 && !far.energy.is_nan(), "{}", far.energy);
        }
    }
    found.into()
}

pub(super) fn placement(bytes: &[u8]) -> Outcome {
    let (path, model) = (Path::new("placement.json"), builtin::upper_body());
    let found = placement_file::parse(path, bytes, &model);
    if let Ok(placement) = &found {
        // Numbers are rounded once; then they stay.
        let again =
            placement_file::parse(path, placement_file::to_text(placement).as_bytes(), &model).unwrap();
        assert_eq!(placement_file::to_text(&again), placement_file::to_text(placement));
    }
    found.into()
}

pub(super) fn starts(bytes: &[u8]) -> Outcome {
    let found = starts_file::parse(Path::new("starts.json"), bytes);
    if let Ok(starts) = &found {
        for start in starts {
            assert!(start.truth.check(&start.model).is_ok() && start.start.check(&start.model).is_ok());
        }
    }
    found.into()
}

/// A track as it is written.
fn track_text(written: &WrittenTrack) -> String {
    let cameras: Vec<&str> = written.cameras.iter().map(String::as_str).collect();
    track_json::to_text(&TrackExport {
        name: &written.name,
        frame_rate: written.frame_rate,
        model: &written.model,
        cameras: &cameras,
        track: &written.track,
    })
}

pub(super) fn track(bytes: &[u8]) -> Outcome {
    let path = Path::new("track.json");
    let found = track_read::parse(path, bytes, None);
    if let Ok(written) = &found {
        let again = track_read::parse(path, track_text(written).as_bytes(), None).unwrap();
        assert_eq!(&again, written);
    }
    found.into()
}

/// What was read is written and read again as the same, and a tracker takes it or says why not.
pub(super) fn resume(bytes: &[u8]) -> Outcome {
    let (path, model) = (Path::new("resume.json"), builtin::single_limb());
    let found = resume_file::parse(path, bytes, &model);
    if let Ok(resume) = &found {
        let again = resume_file::parse(path, resume_file::to_text(resume).as_bytes(), &model).unwrap();
        assert_eq!(&again, resume);
        let start = Pose::rest(&model);
        let tracker = Tracker::new(Arc::new(model), FitOptions::default(), start).unwrap();
        let tracker = match &resume.memory.filter {
            Some(_) => tracker.with_motion(Motion::Kalman(KalmanOptions::default()), 30.0).unwrap(),
            None => tracker,
        };
        let tracker = match &resume.memory.cues {
            Some(_) => tracker.with_cues(CueOptions::default()).unwrap(),
            None => tracker,
        };
        let tracker = tracker.with_memory(resume.memory.clone()).unwrap();
        assert!(tracker.start_of(resume.memory.last.frame).rotations.len() == 1);
    }
    found.into()
}

pub(super) fn keypoint_file(bytes: &[u8]) -> Outcome {
    let found = keypoints::parse(Path::new("frame.json"), bytes);
    if let Ok(people) = &found {
        // What becomes of them next.
        let _ = keypoints::generous_mask(people, [64, 48], 2);
        let _ = keypoints::sure_mask(people, [64, 48], 2);
        let _ = (keypoints::tallest(people), keypoints::largest_extent(people));
    }
    found.into()
}

/// A rig that was read is written in our own format and read as the same; what another format holds of it is read too.
fn check_rig(rig: &Rig) {
    let text = calibration::backlit::to_text(rig);
    assert_eq!(&calibration::parse(Path::new("again.json"), text.as_bytes(), OPTIONS).unwrap(), rig);
    for format in Format::ALL.into_iter().filter(|format| *format != Format::EasyMocap) {
        let Ok(texts) = write::to_text(rig, format) else { continue };
        let again = calibration::parse(Path::new("again"), texts[0].as_bytes(), OPTIONS);
        let again = again.unwrap_or_else(|error| panic!("{}: {error}\n{}", format.name(), texts[0]));
        let names =
            |rig: &Rig| rig.cameras().iter().map(|camera| camera.name().to_owned()).collect::<Vec<_>>();
        assert_eq!(names(&again), names(rig), "{}\n{}", format.name(), texts[0]);
    }
}

pub(super) fn cameras(bytes: &[u8]) -> Outcome {
    let found = calibration::parse(Path::new("cameras"), bytes, OPTIONS);
    if let Ok(rig) = &found {
        check_rig(rig);
    }
    found.into()
}

/// As [`cameras`] where only one of two files changes.
pub(super) fn pair(changed: &str, bytes: &[u8], beside: &str, kept: &str) -> Outcome {
    let files = MemoryFiles::new([(changed, bytes.to_vec()), (beside, seeds::file(kept))]);
    let found = calibration::read_from(&files, Path::new(changed), OPTIONS);
    if let Ok(rig) = &found {
        check_rig(rig);
    }
    found.into()
}

/// Sizes that a file does not say are given.
pub(super) fn sized(bytes: &[u8]) -> Outcome {
    calibration::parse(Path::new("cameras"), bytes, CalibrationOptions { size: Some([640, 480]), ..OPTIONS })
        .into()
}
