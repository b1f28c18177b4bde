//! The committed built-in take: it opens, its files agree with the generator and with each other, and the
//! standard segmentation finds the person where the truth says.

use std::path::{Path, PathBuf};

use backlit_formats::Take;
use backlit_formats::pose_file::{self, Quaternions};
use backlit_lab::synthetic::{Build, Figure, motion, silhouette, studio};
use backlit_tracking::body::Kinematics;
use backlit_tracking::camera::{Camera, Rectification};
use backlit_tracking::segment::{Background, segment};
use backlit_tracking::silhouette::{Label, Mask, Overlap};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/take")
}

fn take() -> Take {
    Take::open(&folder()).unwrap()
}

#[test]
fn its_truth_and_its_cameras_are_the_generator_s() {
    let take = take();
    assert_eq!((take.frame_count(), take.rig().count()), (motion::FRAMES, 4));
    assert_eq!(take.rig(), &studio::cameras());
    let reference = take.reference().unwrap();
    for frame in 0..motion::FRAMES {
        let path = folder().join(format!("truth/pose_{frame:03}.json"));
        let pose = pose_file::read(&path, take.model(), Quaternions::Normalised).unwrap();
        let off = pose.local(&motion::pose(take.model(), frame as f64));
        assert!(off.iter().all(|x| x.abs() < 1e-9), "frame {frame}");
        let kinematics = Kinematics::new(take.model(), &pose);
        let joints = reference.joints(frame);
        assert_eq!(joints.len(), take.model().limbs().len() + 1);
        for (limb, position) in joints {
            let expected = limb.map_or(pose.root, |limb| kinematics.ends()[limb]);
            assert!(expected.distance(position) < 2e-5, "frame {frame}");
        }
    }
}

#[test]
fn its_start_is_plausibly_off() {
    let take = take();
    let step = take.start().unwrap().local(&motion::pose(take.model(), 0.0));
    let length = |block: &[f64]| block.iter().map(|x| x * x).sum::<f64>().sqrt();
    assert!((length(&step[..3]) - 0.04).abs() < 1e-9);
    for block in step[3..].chunks_exact(3) {
        assert!((length(block).to_degrees() - 8.0).abs() < 1e-6);
    }
}

/// The measured masks against the exact ones, and the true joints against the measured masks.
#[test]
fn the_segmentation_finds_the_person_where_the_truth_is() {
    let take = take();
    let mut failures = Vec::new();
    for (index, camera) in take.rig().cameras().iter().enumerate() {
        let rectification = Rectification::new(camera);
        let ideal = camera.without_distortion();
        let plates = take.background(index).unwrap();
        let plates: Vec<_> = plates.map(|plate| rectification.rectify(&plate.unwrap()).unwrap()).collect();
        let background = Background::from_frames(&plates).unwrap();
        for frame in (0..motion::FRAMES).step_by(9) {
            let picture = rectification.rectify(&take.frame(index, frame).unwrap()).unwrap();
            let mask = segment(&picture, &background, &take.measurement()[index]).unwrap();
            let pose = motion::pose(take.model(), frame as f64);
            let figure = Figure::new(take.model(), &pose, Build::default()).unwrap();
            let exact = silhouette(&figure, &ideal).unwrap();
            let level = |label: &Label| if *label == Label::Subject { 0.0 } else { 255.0 };
            let levels: Vec<f32> = exact.labels().iter().map(level).collect();
            let iou = Overlap::between(&mask, &levels).unwrap().iou().unwrap();
            let missed = joints_outside(&take, &mask, &ideal, frame);
            if iou < 0.9 || missed > 1 {
                failures
                    .push(format!("{} frame {frame}: IoU {iou:.3}, {missed} joints missed", camera.name()));
            }
            assert_eq!(joints_outside(&take, &exact, &ideal, frame), 0, "{} {frame}", camera.name());
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// How many reference joints are seen on the background.
fn joints_outside(take: &Take, mask: &Mask, camera: &Camera, frame: usize) -> usize {
    let reference = take.reference().unwrap();
    let outside = reference.joints(frame).into_iter().filter(|(_, position)| {
        let pixel = camera.project(*position).unwrap().round();
        mask.get(pixel.x as usize, pixel.y as usize) == Some(Label::Background)
    });
    outside.count()
}
