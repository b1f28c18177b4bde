//! Single frames of a take with keypoints: sets of its cameras, and what a fit from the keypoints is worth.

use std::sync::Arc;

use backlit_tracking::body::{Kinematics, Model, Pose};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{Fit, FitOptions, FitView};
use backlit_tracking::metrics::ReferenceJoints;

use super::ExperimentError;

/// All sets of this many of `all` cameras, in order.
///
/// # Errors
/// There are not this many.
pub fn sets(all: usize, count: usize) -> Result<Vec<Vec<usize>>, ExperimentError> {
    if !(1..=all).contains(&count) {
        let (value, expected) = (count as f64, "1 to as many cameras as the take has");
        return Err(ExperimentError::Option { option: "cameras", value, expected });
    }
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

/// The pose that a fit with the usual choices ends with.
///
/// # Errors
/// The fit cannot begin.
pub fn fit(
    model: &Arc<Model>,
    views: &[FitView],
    start: Pose,
    cancel: &CancelToken,
) -> Result<Pose, ExperimentError> {
    let mut fit = Fit::new(Arc::clone(model), views.to_vec(), start, FitOptions::default())?;
    Ok(fit.run(cancel, |_| {}).pose)
}

/// Mean distance of the joints that are known.
#[must_use]
pub fn error_mm(model: &Model, pose: &Pose, joints: &ReferenceJoints) -> f64 {
    let kinematics = Kinematics::new(model, pose);
    let place = |limb: Option<usize>| limb.map_or(pose.root, |limb| kinematics.ends()[limb]);
    let sum: f64 = joints.iter().map(|(limb, at)| place(*limb).distance(*at)).sum();
    1e3 * sum / joints.len().max(1) as f64
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
