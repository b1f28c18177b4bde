//! Frames of a take with keypoints, looked at without a start, by all sets of so many cameras: how many end where a fit that
//! begins at the keypoints does.
//!
//! Keypoints are a few centimetres accurate, so that a pose is judged beside the one that a fit from the keypoints finds
//! with the same cameras: it is found where its mean joint error is no more than so much larger. A body turned round is some
//! hundred millimetres off.

use std::sync::Arc;
use std::time::Instant;

use backlit_formats::Footage;
use backlit_tracking::body::{Kinematics, Model, Pose};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{Fit, FitOptions, FitView};
use backlit_tracking::metrics::ReferenceJoints;
use backlit_tracking::search::{Doubt, WithoutStart, WithoutStartError, start, without_start};
use serde::Serialize;

use super::{ExperimentError, Progress};

/// What to try.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Options {
    /// Numbers of cameras; all sets of so many are tried.
    pub cameras: Vec<usize>,
    /// Frames.
    pub frames: Vec<usize>,
    /// A pose whose mean joint error is at most so much larger than that of the fit from the keypoints is found, mm.
    pub within_mm: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self { cameras: vec![2, 4], frames: vec![0], within_mm: 25.0 }
    }
}

/// What came of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// By number of cameras, in the order of the options.
    pub groups: Vec<Group>,
}

/// All sets of one number of cameras.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Group {
    /// Cameras of a set.
    pub cameras: usize,
    /// Trials that found the person.
    pub found: usize,
    /// Mean and longest wall time of a trial, seconds, silhouettes given.
    pub seconds: [f64; 2],
    /// All of them.
    pub trials: Vec<Trial>,
}

/// One frame by one set of cameras.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Trial {
    /// Names.
    pub cameras: Vec<String>,
    /// The frame.
    pub frame: usize,
    /// Mean joint error to the keypoints, millimetres; `None` where nothing was found, for `why`.
    pub error_mm: Option<f64>,
    /// That of the fit that began at the keypoints.
    pub from_keypoints_mm: f64,
    /// Whether it is the person's pose.
    pub found: bool,
    /// Wall time, seconds.
    pub seconds: f64,
    /// What the silhouettes leave open, or why there is no pose.
    pub doubts: Vec<String>,
}

/// Tries all frames by all sets.
///
/// # Errors
/// A number of cameras that the take does not have, frames without keypoints, pictures that cannot be read, or `cancel`.
pub fn run(
    footage: &Footage,
    options: &Options,
    cancel: &CancelToken,
    mut on_progress: impl FnMut(Progress),
) -> Result<Report, ExperimentError> {
    let all = footage.cameras.len();
    let sets: Vec<Vec<Vec<usize>>> =
        options.cameras.iter().map(|&count| sets(all, count)).collect::<Result<_, _>>()?;
    let total = sets.iter().map(Vec::len).sum::<usize>() * options.frames.len();
    let mut done = 0;
    let mut groups: Vec<Group> = Vec::new();
    for (&cameras, sets) in options.cameras.iter().zip(&sets) {
        let mut trials = Vec::new();
        for &frame in &options.frames {
            for set in sets {
                on_progress(Progress { done, total });
                done += 1;
                trials.push(trial(footage, set, frame, options.within_mm, cancel)?);
            }
        }
        let seconds = || trials.iter().map(|trial| trial.seconds);
        groups.push(Group {
            cameras,
            found: trials.iter().filter(|trial| trial.found).count(),
            seconds: [seconds().sum::<f64>() / trials.len().max(1) as f64, seconds().fold(0.0, f64::max)],
            trials,
        });
    }
    on_progress(Progress { done, total });
    Ok(Report { groups })
}

/// All sets of so many of `all` cameras, in order.
pub(super) fn sets(all: usize, count: usize) -> Result<Vec<Vec<usize>>, ExperimentError> {
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

fn trial(
    footage: &Footage,
    set: &[usize],
    frame: usize,
    within_mm: f64,
    cancel: &CancelToken,
) -> Result<Trial, ExperimentError> {
    let take = footage.take();
    let model = take.model();
    let joints = take.reference().map(|reference| reference.joints(frame)).unwrap_or_default();
    let Some(at_keypoints) = start::from_joints(model, &joints) else {
        let expected = "a frame that has reference keypoints";
        return Err(ExperimentError::Option { option: "frames", value: frame as f64, expected });
    };
    let views = footage.fit_views(set, frame)?;
    let fitted = fit(model, &views, at_keypoints, cancel)?;
    let from_keypoints_mm = error_mm(model, &fitted, &joints);
    let began = Instant::now();
    let found = without_start(model, &views, &WithoutStart::default(), cancel);
    let seconds = began.elapsed().as_secs_f64();
    let (error_mm, doubts) = match found {
        Ok(found) => (
            Some(error_mm(model, found.pose(), &joints)),
            found.doubts.iter().map(Doubt::to_string).collect(),
        ),
        Err(WithoutStartError::Cancelled) => return Err(ExperimentError::Cancelled),
        Err(error) => (None, vec![error.to_string()]),
    };
    Ok(Trial {
        cameras: set.iter().map(|&camera| footage.cameras[camera].name().to_owned()).collect(),
        frame,
        error_mm,
        from_keypoints_mm,
        found: error_mm.is_some_and(|error| error <= from_keypoints_mm + within_mm),
        seconds,
        doubts,
    })
}

pub(super) fn fit(
    model: &Arc<Model>,
    views: &[FitView],
    start: Pose,
    cancel: &CancelToken,
) -> Result<Pose, ExperimentError> {
    let mut fit = Fit::new(Arc::clone(model), views.to_vec(), start, FitOptions::default())?;
    Ok(fit.run(cancel, |_| {}).pose)
}

/// Mean distance of the joints that are known.
pub(super) fn error_mm(model: &Model, pose: &Pose, joints: &ReferenceJoints) -> f64 {
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
