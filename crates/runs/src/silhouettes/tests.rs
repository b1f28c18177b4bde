//! Worst silhouettes and tuned settings of the built-in take.

use std::collections::BTreeMap;
use std::sync::Arc;

use backlit_formats::Footage;
use backlit_formats::footage::BrushStroke;
use backlit_take::builtin;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::search::start::from_joints;
use backlit_tracking::segment::SegmentOptions;
use backlit_tracking::silhouette::{Label, Stroke};

use super::{PosedBody, TuneError, changes, tune, worst};

const FRAMES: [usize; 3] = [0, 12, 24];

/// The take with some settings, and the true poses of three frames.
fn take(options: &SegmentOptions) -> (Footage, Arc<Vec<SegmentOptions>>, PosedBody) {
    let take = builtin::open().unwrap().with_measurement(|_, _| options.clone());
    let model = Arc::clone(take.model());
    let reference = take.reference().unwrap();
    let pose = |frame: usize| Some((frame, from_joints(&model, &reference.joints(frame))?));
    let poses: BTreeMap<_, _> = FRAMES.into_iter().filter_map(pose).collect();
    let measurement = Arc::new(take.measurement().to_vec());
    (Footage::new(take), measurement, PosedBody { model, fit: Arc::default(), poses })
}

#[test]
fn settings_that_are_wrong_are_mended_and_those_that_suit_stay() {
    let usual = SegmentOptions::default();
    let wrong = SegmentOptions { z_threshold: 25.0, opening_px: 4, ..usual.clone() };
    let (footage, measurement, body) = take(&wrong);
    let mut told = 0;
    let found = tune(&footage, &measurement, &body, &CancelToken::new(), |[done, all]| {
        assert!(done <= all);
        told = done;
    });
    let found = found.unwrap();
    assert!(told > 10 && found.tried > 10);
    assert!(found.after.mean() > found.before.mean() + 0.05, "{found:?}");
    assert!(found.options.z_threshold < 10.0 && found.options.opening_px < 4, "{found:?}");

    let (footage, measurement, body) = take(&found.options);
    let again = tune(&footage, &measurement, &body, &CancelToken::new(), |_| {}).unwrap();
    assert!(again.after.mean() >= found.after.mean() - 0.01, "{:?}", changes(&found.options, &again.options));
}

#[test]
fn without_a_pose_nothing_is_tuned() {
    let (footage, measurement, body) = take(&SegmentOptions::default());
    let none = PosedBody { poses: BTreeMap::new(), ..body };
    let found = tune(&footage, &measurement, &none, &CancelToken::new(), |_| {});
    assert!(matches!(found, Err(TuneError::NoPose)));
}

#[test]
fn the_worst_silhouette_is_the_one_that_was_spoilt() {
    let (mut footage, measurement, body) = take(&SegmentOptions::default());
    let look =
        |footage: &Footage| worst(footage, &measurement, &FRAMES, Some(&body), &CancelToken::new(), |_| {});
    let clean = look(&footage);
    assert!(clean.iter().all(|one| one.badness() < 0.1), "{clean:?}");
    let centre = footage.cameras[1].width() as f32 / 2.0;
    let middle = [centre, footage.cameras[1].height() as f32 / 2.0];
    let stroke = Stroke { label: Label::Background, radius_px: 40.0, points: vec![middle] };
    footage.brush = Arc::new(vec![BrushStroke { camera: 1, frames: [12, 12], stroke }]);
    let spoilt = look(&footage);
    assert_eq!((spoilt[0].camera, spoilt[0].frame), (1, 12), "{spoilt:?}");
    assert!(spoilt[0].badness() > 0.1 && spoilt[0].reason().contains('%'), "{spoilt:?}");
}
