//! The check of the cameras, on calibrations with one known fault.

use std::sync::Arc;

use backlit_lab::experiment::calibration_faults::{Fault, FilmedPerson};
use backlit_lab::synthetic::studio;
use backlit_tracking::body::builtin;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::diagnosis::{Diagnosis, DiagnosisError, DiagnosisOptions, FaultKind, diagnose};
use backlit_tracking::synchronise::Recording;

fn person() -> FilmedPerson {
    filmed(None)
}

fn filmed(keypoint_px: Option<f64>) -> FilmedPerson {
    let model = Arc::new(builtin::full_body());
    FilmedPerson::simulated(studio::cameras().cameras(), &model, 320, 124, keypoint_px).unwrap()
}

fn checked(person: &FilmedPerson, fault: Option<Fault>) -> Diagnosis {
    let (recordings, lenses) = person.with_fault(fault).unwrap();
    let options = DiagnosisOptions::default();
    diagnose(&recordings, &lenses, &options, &CancelToken::new(), |_, _| {}).unwrap()
}

#[test]
fn right_cameras_have_no_fault_and_the_subject_is_as_tall_as_a_person() {
    let found = checked(&person(), None);
    assert_eq!(found.findings, []);
    assert!(found.subject_m.is_some_and(|tall| (1.4..2.0).contains(&tall)), "{:?}", found.subject_m);
    assert_eq!(found.pairs.len(), 6);
    assert!(found.pairs.iter().all(|pair| pair.apart_px[0].is_some_and(|px| px < 1.0)), "{:?}", found.pairs);
}

/// One fault of each kind that a picture of this size can show, and how large it is told to be.
#[test]
fn a_fault_is_told_with_its_camera_and_its_size() {
    use FaultKind as K;
    let person = person();
    let cases = [
        (K::PictureTurned, 0, 0.0, 180.0, 1e-9),
        (K::PictureScaled, 1, 0.5, 2.0, 0.05),
        (K::InvertedExtrinsics, 2, 0.0, 0.0, 0.0),
        (K::Unit, 3, 1000.0, 1000.0, 1e-6),
        (K::WorldAxes, 0, 0.0, 0.0, 0.0),
        (K::CameraAxes, 1, 0.0, 0.0, 0.0),
        (K::Swapped, 2, 0.0, 0.0, 0.0),
        (K::Focal, 3, 1.05, 5.0, 0.6),
        (K::Turned, 3, 2.0_f64.to_radians(), 2.0, 0.3),
        (K::Shifted, 3, 0.1, 10.0, 1.5),
        (K::Offset, 1, 0.2, 0.2, 0.03),
        (K::FrameRate, 0, 0.5, 0.5, 1e-9),
        (K::Bumped, 2, 2.0_f64.to_radians(), 2.0, 0.5),
    ];
    for (kind, camera, size, told, within) in cases {
        let fault = Fault { kind, camera: Some(camera), with: (camera + 1) % 4, size, seed: camera as u64 };
        let found = checked(&person, Some(fault));
        let [finding] = &found.findings[..] else { panic!("{fault:?}: {:?}", found.findings) };
        let is_camera = finding.camera == Some(camera) || kind == K::Swapped && finding.with == Some(camera);
        assert!(finding.kind == kind && is_camera, "{fault:?}: {finding:?}");
        let value = finding.sizes.first().map_or(0.0, |size| size.value);
        assert!((value - told).abs() <= within, "{fault:?}: {:?}", finding.sizes);
        if !kind.is_clock() && kind != K::Bumped {
            let (recordings, lenses) = person.with_fault(Some(fault)).unwrap();
            let both = lenses.iter().zip(&finding.cameras);
            let recordings =
                recordings.iter().zip(both).map(|(old, (lens, camera))| old.with_calibration(lens, camera));
            let repaired = FilmedPerson::real(finding.cameras.clone(), recordings.collect());
            assert_eq!(checked(&repaired, None).findings, [], "{fault:?} is repaired");
        }
    }
}

/// Keypoints that are a little off accuse nobody, and where a camera is wrong they say so too.
#[test]
fn keypoints_bear_witness_beside_silhouettes() {
    let [without, with] = [None, Some(1.5)].map(filmed);
    let healthy = checked(&with, None);
    assert_eq!(healthy.findings, []);
    assert!(healthy.keypoint_noise_px.is_some_and(|px| (1.0..3.0).contains(&px)), "{healthy:?}");
    assert!(healthy.pairs.iter().all(|pair| pair.keypoints_apart_px[0].is_some_and(|px| px < 3.0)));
    let fault = Fault { kind: FaultKind::Focal, camera: Some(3), with: 0, size: 1.05, seed: 0 };
    let [without, with] = [without, with].map(|person| checked(&person, Some(fault)));
    assert_eq!((without.keypoint_noise_px, without.findings[0].keypoints_apart_px), (None, None));
    let [found] = &with.findings[..] else { panic!("{:?}", with.findings) };
    assert_eq!((found.kind, found.camera), (fault.kind, fault.camera));
    assert!((found.sizes[0].value - 5.0).abs() < 0.6, "{:?}", found.sizes);
    let [before, after] = found.keypoints_apart_px.unwrap();
    assert!(before > 1.5 * after, "keypoints are {before} px apart, {after} repaired");
}

#[test]
fn a_fault_of_all_cameras_is_told_of_all() {
    let person = person();
    for (kind, size) in [(FaultKind::InvertedExtrinsics, 0.0), (FaultKind::Unit, 1000.0)] {
        let found = checked(&person, Some(Fault { kind, camera: None, with: 0, size, seed: 0 }));
        let [finding] = &found.findings[..] else { panic!("{kind:?}: {:?}", found.findings) };
        assert_eq!((finding.kind, finding.camera), (kind, None));
    }
}

#[test]
fn the_last_finding_has_cameras_with_all_faults_repaired() {
    let person = person();
    let of_all = Fault { kind: FaultKind::Unit, camera: None, with: 0, size: 1000.0, seed: 0 };
    let (recordings, lenses) = person.with_fault(Some(of_all)).unwrap();
    let in_millimetres = FilmedPerson::real(lenses, recordings);
    let focal = Fault { kind: FaultKind::Focal, camera: Some(3), with: 0, size: 1.05, seed: 0 };
    let found = checked(&in_millimetres, Some(focal));
    let kinds: Vec<FaultKind> = found.findings.iter().map(|finding| finding.kind).collect();
    assert_eq!(kinds, [FaultKind::Focal, FaultKind::Unit]);
    for (camera, own) in found.findings[1].cameras.iter().zip(person.cameras()) {
        assert!(camera.centre().distance(own.centre()) < 1e-6, "{}", camera.name());
        assert!((camera.intrinsics().fx / own.intrinsics().fx - 1.0).abs() < 0.01, "{}", camera.name());
    }
}

#[test]
fn cameras_that_cannot_be_checked_are_refused() {
    let (recordings, lenses) = person().with_fault(None).unwrap();
    let check = |recordings: &[Recording], lenses: usize, cancel: &CancelToken| {
        diagnose(recordings, &person().cameras()[..lenses], &DiagnosisOptions::default(), cancel, |_, _| {})
    };
    let running = CancelToken::new();
    assert_eq!(check(&recordings[..1], 1, &running), Err(DiagnosisError::Count { count: 1 }));
    assert_eq!(check(&recordings, 3, &running), Err(DiagnosisError::Lenses { lenses: 3, recordings: 4 }));
    let stopped = CancelToken::new();
    stopped.cancel();
    assert_eq!(check(&recordings, 4, &stopped), Err(DiagnosisError::Cancelled));
    let blind: Vec<Recording> = lenses.iter().map(|lens| Recording::new(lens.without_distortion())).collect();
    let none = diagnose(&blind, &lenses, &DiagnosisOptions::default(), &running, |_, _| {}).unwrap();
    assert_eq!((none.findings, none.subject_m), (Vec::new(), None));
}
