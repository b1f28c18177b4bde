//! What is decided at thresholds is decided alike with vectors of any width. A program of its own: once narrow, vectors stay so.

#![expect(clippy::unwrap_used, reason = "helpers of tests, where a panic is the answer")]

#[path = "tracking/fixtures.rs"]
mod fixtures;

use std::sync::Arc;

use backlit_tracking::body::builtin;
use backlit_tracking::body_fit::{
    Approach, BodyFit, BodyFitError, BodyFitOptions, FirstSizes, approach, fit_body,
};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::FitView;
use backlit_tracking::metrics::ReferenceJoints;
use glam::DVec3;

/// Sizes of a stouter body, by three cameras in three frames.
fn sizes() -> BodyFit {
    let model = Arc::new(builtin::full_body());
    let grown = |limb: usize| [model.limbs()[limb].length, 1.05 * model.limbs()[limb].radius];
    let person = model.with_sizes(grown).unwrap();
    let cameras = [(3.5, 0.4), (-2.5, 2.6), (0.5, -3.7)].map(|(x, y)| {
        let from = DVec3::new(x, y, 0.5);
        Arc::new(fixtures::camera([96, 128], [150.0, 150.0, 47.5, 63.5], from, DVec3::Z * 0.1, DVec3::Z))
    });
    let truth = |frame: usize| fixtures::bent(&model, 0.12, 0.1 * frame as f64);
    let view = |camera: &Arc<_>, frame: usize| {
        FitView::of_mask(Arc::clone(camera), fixtures::mask(&person, &truth(frame), camera))
    };
    let views = |frame: usize| -> Result<Vec<FitView>, BodyFitError> {
        Ok(cameras.iter().map(|camera| view(camera, frame)).collect())
    };
    let plan = Approach { start: truth(0), size: None, frames: vec![0, 1, 2], step: 1 };
    let (options, cancel, none) = (BodyFitOptions::default(), CancelToken::new(), |_| ReferenceJoints::new());
    let (size, frames) = approach(&model, &plan, &options, &cancel, views, none, |_, _| {}).unwrap();
    fit_body(model.clone(), frames, FirstSizes::Scaled(size), &options, &cancel, |_| {}).unwrap()
}

#[test]
fn a_widening_is_believed_alike() {
    let wide = sizes();
    backlit_tracking::processor::use_narrow_vectors();
    let narrow = sizes();
    let widening = wide.widening.unwrap();
    assert_eq!(widening.px.to_bits(), narrow.widening.unwrap().px.to_bits());
    assert_eq!(widening.is_believed, narrow.widening.unwrap().is_believed);
    assert_eq!(wide.poses, narrow.poses);
}
