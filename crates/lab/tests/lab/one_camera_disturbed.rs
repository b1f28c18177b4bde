//! The built-in take with one camera's pictures disturbed: what no other camera supports is unknown, and the body stays.

use std::path::Path;
use std::sync::Arc;

use backlit_formats::{Footage, Take};
use backlit_lab::experiment::disturbed_pictures::PictureDisturbance;
use backlit_tracking::fit::{Evidence, FitView};
use backlit_tracking::segment::SegmentOptions;
use backlit_tracking::silhouette::{Label, Mask};

const CAMERAS: [usize; 4] = [0, 1, 2, 3];

fn footage(needs_support: bool) -> Footage {
    let take = Take::open(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/take")).unwrap();
    Footage::new(take.with_measurement(|own, _| SegmentOptions { needs_support, ..own.clone() }))
}

fn mask(view: &FitView) -> &Mask {
    let Evidence::Mask(mask) = &view.evidence else { panic!("a mask") };
    mask
}

/// The pixels that are subject in one mask and have this label in another.
fn subject_and(mask: &Mask, other: &Mask, label: Label) -> usize {
    let pairs = mask.labels().iter().zip(other.labels());
    pairs.filter(|pair| *pair == (&Label::Subject, &label)).count()
}

#[test]
fn clean_pictures_stay_as_they_are() {
    let footage = footage(true);
    for frame in (0..footage.frame_count()).step_by(7) {
        let single = footage.single_masks(&CAMERAS, frame).unwrap();
        let views = footage.fit_views(&CAMERAS, frame).unwrap();
        for (camera, (view, single)) in views.iter().zip(&single).enumerate() {
            assert_eq!(mask(view), single, "frame {frame}, camera {camera}");
        }
        let measurement = Arc::new(footage.take().measurement().to_vec());
        let frame = footage.load_frame(&measurement, frame);
        assert!(frame.cameras.iter().all(|camera| camera.unsupported_px == 0));
    }
}

#[test]
fn a_disturbed_picture_loses_what_is_not_the_body() {
    let (footage, without) = (footage(true), footage(false));
    let frame = 30;
    let clean = footage.single_masks(&CAMERAS, frame).unwrap();
    for what in PictureDisturbance::ALL {
        let (mut wrong, mut left, mut lost, mut body) = (0, 0, 0, 0);
        for camera in CAMERAS {
            let mut picture = footage.picture(camera, frame).unwrap();
            what.apply(&mut picture, 20);
            let mut masks = clean.clone();
            masks[camera] =
                footage.mask(camera, frame, &picture, &footage.take().measurement()[camera]).unwrap();
            let same = without.supported_views(&CAMERAS, frame, masks.clone());
            assert_eq!(mask(&same[camera]), &masks[camera], "nothing is asked for");
            wrong += subject_and(&masks[camera], &clean[camera], Label::Background);
            let views = footage.supported_views(&CAMERAS, frame, masks);
            left += subject_and(mask(&views[camera]), &clean[camera], Label::Background);
            lost += subject_and(&clean[camera], mask(&views[camera]), Label::Unknown);
            body += clean[camera].count(Label::Subject);
            for other in CAMERAS.into_iter().filter(|other| *other != camera) {
                assert_eq!(mask(&views[other]), &clean[other], "{what:?} in camera {camera}");
            }
        }
        println!("{what:?}: wrong {wrong}, left {left}, body {body}, lost {lost}");
        assert!(50 * lost < body, "{what:?}: {lost} of {body}");
        if matches!(what, PictureDisturbance::StandingBody | PictureDisturbance::MovingBody) {
            assert!(2 * left < wrong, "{what:?}: {left} of {wrong}");
        }
    }
}
