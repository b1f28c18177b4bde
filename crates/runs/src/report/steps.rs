//! Frames fitted again, to show every step.

use std::sync::Arc;

use backlit_formats::export::ending_text;
use backlit_report::{FitStep, FitSteps};
use backlit_tracking::body::Pose;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{Fit, FitView};
use backlit_tracking::search::start;

use super::{PageFootage, ReportError, ReportSource};

/// The fits of these frames, each from the pose of the frame before. One that cannot be made is noted.
pub(super) fn fits(
    source: &ReportSource,
    seen: &PageFootage<'_>,
    frames: &[usize],
    notes: &mut Vec<String>,
    cancel: &CancelToken,
) -> Result<Vec<FitSteps>, ReportError> {
    let mut fits = Vec::new();
    for &frame in frames {
        if cancel.is_cancelled() {
            return Err(ReportError::Stopped);
        }
        let Some((pose, from)) = start_of(source, seen, frame) else {
            notes.push(format!("No steps of frame {frame}: nothing is known of the pose it was begun with."));
            continue;
        };
        match steps(source, seen, frame, pose) {
            Ok((steps, ending)) => fits.push(FitSteps { frame, start: from, ending, steps }),
            Err(why) => notes.push(format!("No steps of frame {frame}: {why}.")),
        }
    }
    Ok(fits)
}

/// Where a fit of the frame begins, and what that is.
fn start_of(source: &ReportSource, seen: &PageFootage<'_>, frame: usize) -> Option<(Pose, String)> {
    if let Some((before, estimate)) = source.track.frames.range(..frame).next_back() {
        return Some((estimate.pose.clone(), format!("the pose of frame {before}")));
    }
    let take = seen.footage.take();
    let own = take.start().filter(|pose| pose.check(&source.model).is_ok());
    let reference = || {
        let joints = take.reference()?.joints(frame);
        Some((start::from_joints(&source.model, &joints)?, "the reference".to_owned()))
    };
    own.map(|pose| (pose.clone(), "the take's start".to_owned())).or_else(reference)
}

/// The start and all steps of a fit, and why it ended.
fn steps(
    source: &ReportSource,
    seen: &PageFootage<'_>,
    frame: usize,
    start: Pose,
) -> Result<(Vec<FitStep>, String), String> {
    let data = source.fit.stages.first().map(|stage| stage.data).unwrap_or_default();
    let mut views = Vec::with_capacity(seen.cameras.len());
    for ((&camera, loaded), &weight) in seen.cameras.iter().zip(seen.load(frame)).zip(&seen.weights) {
        if let Some(evidence) = loaded.evidence(data) {
            views.push(FitView { camera: Arc::clone(&seen.footage.cameras[camera]), evidence, weight });
        }
    }
    let model = &source.model;
    let begun = Fit::new(Arc::clone(model), views, start.clone(), source.fit.clone());
    let mut fit = begun.map_err(|error| error.to_string())?;
    let mut steps = vec![FitStep::new(model, &start, [fit.initial_cost; 2], 0, true)];
    while let Some(record) = fit.step() {
        let costs = [record.cost, record.trial_cost];
        steps.push(FitStep::new(model, &record.point, costs, record.stage, record.accepted));
    }
    let ending = fit.termination.map_or(String::new(), ending_text);
    Ok((steps, ending))
}
