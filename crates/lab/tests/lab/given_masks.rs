//! A take of nothing but masks and cameras: it opens, and a person is tracked in it at a working size.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use backlit_formats::pose_file;
use backlit_formats::{Footage, MemoryFiles, Take, calibration};
use backlit_lab::synthetic::{capsules, motion, studio};
use backlit_tracking::body::{Kinematics, builtin};
use backlit_tracking::body_fit::survey;
use backlit_tracking::camera::{Camera, Rig};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{FitOptions, Preset};
use backlit_tracking::search::start::perturb;
use backlit_tracking::track::Tracker;

use crate::png;

const FRAMES: usize = 4;

fn take(reduction: usize) -> Take {
    let body = builtin::full_body();
    let resized = |camera: &Camera| camera.without_distortion().resized(192, 256).unwrap();
    let rig = Rig::new(studio::cameras().cameras().iter().map(resized).collect()).unwrap();
    let start = perturb(&body, &motion::pose(&body, 0.0), 0.08, 0.02, 3);
    let mut text = format!(
        "format = \"backlit-take 1\"\nname = \"masks\"\nframe_rate = 30\nmodel = \"full_body\"\nstart = \"start.json\"\n\
         reduction = {reduction}\n[cameras]\ncalibration = \"cameras.json\"\n"
    );
    let mut files: Vec<(PathBuf, Vec<u8>)> = vec![
        ("cameras.json".into(), calibration::backlit::to_text(&rig).into_bytes()),
        ("start.json".into(), pose_file::to_text(&body, &start).into_bytes()),
    ];
    for camera in rig.cameras() {
        let name = camera.name();
        text += &format!("[[camera]]\nname = \"{name}\"\nmasks = \"masks/{name}/%d.png\"\n");
        for frame in 0..FRAMES {
            let mask = capsules::hard_mask(&body, &motion::pose(&body, frame as f64), camera).unwrap();
            files.push((format!("masks/{name}/{frame}.png").into(), png(mask.to_gray())));
        }
    }
    files.push(("take.toml".into(), text.into_bytes()));
    Take::from_files(Arc::new(MemoryFiles::new(files)), Path::new("take.toml")).unwrap()
}

#[test]
fn a_take_of_masks_alone_is_tracked_at_a_working_size() {
    let footage = Footage::new(take(2));
    let take = footage.take();
    let cameras: Vec<usize> = (0..footage.cameras.len()).collect();
    assert_eq!((take.frame_count(), footage.cameras[0].width()), (FRAMES, 96));
    let all: Vec<usize> = (0..FRAMES).collect();
    let looked =
        survey::survey(&survey::spread(&all, 3), |frame| footage.fit_views(&cameras, frame)).unwrap();
    assert_eq!(
        (looked.frames.as_slice(), looked.check(), looked.doubts().count()),
        (&[0, 1, 3][..], Ok(()), 0)
    );
    let (body, options) = (take.model(), FitOptions::preset(Preset::Robust));
    let mut tracker = Tracker::new(Arc::clone(body), options, take.start().unwrap().clone()).unwrap();
    for frame in 0..FRAMES {
        let views = footage.fit_views(&cameras, frame).unwrap();
        let found = tracker.track_frame(frame, views, &CancelToken::new()).unwrap();
        let [found, truth] =
            [found.pose, motion::pose(body, frame as f64)].map(|pose| Kinematics::new(body, &pose));
        let off = found.ends().iter().zip(truth.ends()).map(|(a, b)| a.distance(*b)).sum::<f64>();
        let mean_mm = 1e3 * off / truth.ends().len() as f64;
        assert!(mean_mm < 12.0, "frame {frame}: {mean_mm:.1} mm");
    }
}
