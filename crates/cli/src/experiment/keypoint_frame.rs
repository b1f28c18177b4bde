//! Frames of a take with keypoints, and what a fit from these is worth.
//!
//! Keypoints are a few centimetres accurate, so that a pose is judged beside the one that a fit from the keypoints finds with the
//! same cameras: it is found where its mean joint error is no more than so much larger. A body turned round is some hundred
//! millimetres off.

use std::sync::Arc;

use anyhow::{Result, bail, ensure};
use backlit_formats::Footage;
use backlit_tracking::body::{Kinematics, Model, Pose};
use backlit_tracking::fit::{Fit, FitOptions, FitView};
use backlit_tracking::metrics::ReferenceJoints;
use backlit_tracking::search::start;

use super::Run;
use crate::take_options::reference_joints;

/// All sets of this many of `all` cameras, in order.
pub(super) fn sets(all: usize, count: usize) -> Result<Vec<Vec<usize>>> {
    ensure!(
        (1..=all).contains(&count),
        "`cameras` is {count}; expected 1 to as many cameras as the take has"
    );
    let mut sets: Vec<Vec<usize>> = vec![Vec::new()];
    for _ in 0..count {
        let longer = |set: Vec<usize>| {
            let next = set.last().map_or(0, |last| last + 1);
            (next..all).map(move |camera| [&set[..], &[camera]].concat())
        };
        sets = sets.into_iter().flat_map(longer).collect();
    }
    Ok(sets)
}

/// Mean distance of the joints that are known.
pub(super) fn error_mm(model: &Model, pose: &Pose, joints: &ReferenceJoints) -> f64 {
    let kinematics = Kinematics::new(model, pose);
    let place = |limb: Option<usize>| limb.map_or(pose.root, |limb| kinematics.ends()[limb]);
    let sum: f64 = joints.iter().map(|(limb, at)| place(*limb).distance(*at)).sum();
    1e3 * sum / joints.len().max(1) as f64
}

/// A frame by one set of cameras, and what a fit with the usual choices from its keypoints is worth.
pub(super) struct KeypointFrame<'a> {
    pub(super) model: &'a Arc<Model>,
    pub(super) views: Vec<FitView>,
    pub(super) joints: ReferenceJoints,
    pub(super) fitted: Pose,
    pub(super) fitted_mm: f64,
}

impl<'a> KeypointFrame<'a> {
    pub(super) fn new(footage: &'a Footage, set: &[usize], frame: usize, run: &Run) -> Result<Self> {
        let take = footage.take();
        let model = take.model();
        let joints = reference_joints(take, frame);
        let Some(at_keypoints) = start::from_joints(model, &joints) else {
            bail!("`frames` is {frame}; expected a frame that has reference keypoints");
        };
        let views = footage.fit_views(set, frame)?;
        let mut fit = Fit::new(Arc::clone(model), views.clone(), at_keypoints, FitOptions::default())?;
        let fitted = fit.run(&run.cancel, |_| {}).pose;
        let fitted_mm = error_mm(model, &fitted, &joints);
        Ok(Self { model, views, joints, fitted, fitted_mm })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_sets_of_cameras_are_tried() {
        assert_eq!(sets(4, 4).unwrap(), [[0, 1, 2, 3]]);
        assert_eq!(sets(4, 2).unwrap(), [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]]);
        assert!(sets(4, 5).unwrap_err().to_string().contains("as many cameras as the take has"));
        assert!(sets(4, 0).is_err());
    }
}
