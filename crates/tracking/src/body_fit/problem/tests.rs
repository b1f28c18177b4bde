use std::sync::Arc;

use glam::DVec3;

use super::*;
use crate::body::{SizeChoice, builtin};
use crate::body_fit::cameras::{CameraChoice, CameraDeviations};
use crate::camera::Distortion;
use crate::fit::Evidence;
use crate::fixtures;
use crate::optimize::gradient_check::{DifferenceOptions, check_gradient};
use crate::silhouette::Measurement;

#[test]
fn the_gradient_is_that_of_the_cost() {
    for (lengths, radii) in [(true, true), (true, false), (false, true), (false, false)] {
        check_choice(SizeChoice { lengths, radii, symmetric: radii }, 0.0, false);
    }
    check_choice(SizeChoice::default(), 0.02, false);
    check_choice(SizeChoice::default(), 0.02, true);
    check_choice(SizeChoice { lengths: false, radii: false, symmetric: true }, 0.0, true);
}

/// Two frames with two cameras, grey data, joints and all priors: the gradient of the whole by every column.
fn check_choice(choice: SizeChoice, widening: f64, are_cameras_free: bool) {
    let body = if widening > 0.0 { builtin::full_body() } else { builtin::upper_body() };
    let start = Arc::new(body);
    let sizes = Sizes::new(start.clone(), choice);
    let camera = |centre: DVec3| {
        let at = DVec3::new(0.0, 0.3, 0.0);
        Arc::new(fixtures::camera([40, 32], [40.0, 41.0, 19.5, 15.5], centre, at, DVec3::Y))
    };
    let view = |centre: DVec3, weight: f64| {
        let values = (0..40 * 32).map(|i| 127.0 + 120.0 * (i as f32 * 0.31).sin()).collect();
        let data = Measurement::new(40, 32, values, vec![1.0; 40 * 32]).unwrap();
        FitView { camera: camera(centre), evidence: Evidence::Measurement(Arc::new(data)), weight }
    };
    let columns = Parameters::Tangent.columns(start.rotation_count());
    let bent = |seed: f64| fixtures::bent(&start, 0.2, seed);
    let frames: Vec<BodyFrame> = [0.0, 2.0]
        .map(|seed| BodyFrame {
            frame: seed as usize,
            views: vec![view(DVec3::new(0.1, 0.3, 2.0), 1.0), view(DVec3::new(1.8, 0.5, 0.4), 0.5)],
            start: bent(seed),
            joints: vec![(None, DVec3::new(0.1, -0.05, 0.0)), (Some(5), DVec3::new(-0.4, 0.3, 0.2))],
        })
        .to_vec();
    let options = BodyFitOptions { widening, ..BodyFitOptions::default() };
    let distances = vec![vec![None, None]; 2];
    let mut stage = options.stages[1];
    stage.stage.stride = 1;
    let body = BodySizes::scaled(&sizes, 0.0);
    let begin = BodyState { poses: vec![bent(0.3), bent(2.2)], body, cameras: Vec::new() };
    let cameras = are_cameras_free.then(|| cameras(&frames, columns));
    let of_cameras = cameras.as_ref();
    let mut problem = BodyProblem::new(&sizes, &frames, &distances, of_cameras, &options, stage, &begin);
    let ratios = (0..sizes.count()).map(|i| 0.1 * (i as f64 * 2.3).sin()).collect();
    let state = BodyState {
        poses: vec![bent(0.0), bent(2.0)],
        body: BodySizes {
            log_ratios: ratios,
            size: 0.07,
            girth: -0.04,
            widening_px: if widening > 0.0 { 0.8 } else { 0.0 },
        },
        cameras: of_cameras.map_or(Vec::new(), |cameras| {
            let step: Vec<f64> = (0..cameras.columns()).map(|i| 0.02 * (i as f64 * 1.9).sin()).collect();
            cameras.retract(&[CameraState::default(); 2], &step)
        }),
    };
    let (of_cameras_columns, first_pose) = (problem.of_cameras(), problem.first_pose(0));
    assert_eq!(problem.widening_deviation_px.is_some(), widening > 0.0);
    let moved = |column: usize, offset: f64| {
        let mut moved = state.clone();
        if let Some(column) = column.checked_sub(first_pose) {
            let (frame, column) = (column / columns, column % columns);
            moved.poses[frame] = moved.poses[frame].nudged(Parameters::Tangent, column, offset);
        } else if let Some(column) = column.checked_sub(of_cameras_columns.start) {
            let mut step = vec![0.0; of_cameras_columns.len()];
            step[column] = offset;
            moved.cameras = of_cameras.unwrap().retract(&state.cameras, &step);
        } else {
            match column {
                size if size < sizes.count() => moved.body.log_ratios[size] += offset,
                size if size == sizes.count() => moved.body.size += offset,
                size if size == sizes.count() + 1 => moved.body.girth += offset,
                _ => moved.body.widening_px += offset,
            }
        }
        moved
    };
    let name = |column: usize| match column.checked_sub(first_pose) {
        Some(of_pose) => format!("frame {}, pose column {}", of_pose / columns, of_pose % columns),
        None => sizes.parameters.get(column).map_or_else(
            || "size, girth, widening or camera".to_owned(),
            |parameter| format!("{} {}", parameter.name, parameter.kind),
        ),
    };
    let options = DifferenceOptions { tolerance: 1e-5, ..DifferenceOptions::default() };
    let check = check_gradient(&mut problem, &state, moved, name, &options);
    assert!(check.passes() && check.skipped_share() < 0.3, "{choice:?}, {widening}: {check}");
}

/// Both cameras free in everything, and a body that moves.
fn cameras(frames: &[BodyFrame], columns: usize) -> CameraSet {
    let given = frames[0].views.iter().enumerate().map(|(index, view)| {
        let place = *view.camera.camera_from_world();
        let (size, name) = ([40, 32], format!("c{index}"));
        Arc::new(Camera::new(&name, size, *view.camera.intrinsics(), Distortion::None, place).unwrap())
    });
    let choice = CameraChoice { focal_length: true, principal_point: true, offset: true, drift: true };
    let rate = |frame: &BodyFrame| {
        let rates = (0..columns).map(|column| 0.8 * (column as f64 * 0.7 + frame.frame as f64).sin());
        (frame.frame, rates.collect())
    };
    let rates = frames.iter().map(rate).collect();
    CameraSet::new(given.collect(), choice, &CameraDeviations::default(), frames, rates, 10.0)
}
