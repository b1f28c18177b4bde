//! Frames of a take with keypoints, looked at without a start, by all sets of this many cameras: how many end where a fit that
//! begins at the keypoints does.
//!
//! Keypoints are a few centimetres accurate, so that a pose is judged beside the one that a fit from the keypoints finds
//! with the same cameras: it is found where its mean joint error is no more than so much larger. A body turned round is some
//! hundred millimetres off.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use anyhow::{Result, bail, ensure};
use backlit_formats::Footage;
use backlit_tracking::body::{Kinematics, Model, Pose};
use backlit_tracking::fit::{Fit, FitOptions, FitView};
use backlit_tracking::metrics::ReferenceJoints;
use backlit_tracking::search::{Doubt, WithoutStartError, WithoutStartOptions, start, without_start};
use backlit_tracking::statistics::Statistics;
use clap::Args;
use serde::Serialize;

use super::{Experiment, Run};
use crate::interrupt::Interrupted;
use crate::numbers::within;
use crate::output::number;
use crate::table::Table;
use crate::take_options::{self, PartArguments};

/// A take with keypoints, single frames without a start, by all sets of cameras: how many find the person
#[derive(Debug, Args, Serialize)]
pub(crate) struct NoStart {
    /// Take: its folder or its take.toml. It needs reference keypoints
    #[serde(skip)]
    take: PathBuf,
    /// Another body than the take's, as from fit-body: a file, or a built-in one by name
    #[arg(long, value_name = "MODEL")]
    #[serde(skip)]
    model: Option<String>,
    /// Numbers of cameras; all sets of this many are tried [1 to 64]
    #[arg(long = "sets-of", value_name = "N,…", value_delimiter = ',', default_values_t = [2, 4], allow_negative_numbers = true, value_parser = within(1..=64_usize))]
    #[serde(rename = "cameras")]
    sets_of: Vec<usize>,
    #[arg(skip)]
    #[serde(rename = "frames")]
    frame_numbers: Vec<usize>,
    /// The person counts as found if the mean joint error is at most so much above that of a fit from the keypoints,
    /// millimetres [0 to 10000]
    #[arg(long, value_name = "MM", default_value_t = 25.0, allow_negative_numbers = true, value_parser = within(0.0..=10_000.0_f64))]
    within_mm: f64,
    #[command(flatten)]
    #[serde(skip)]
    part: PartArguments,
}

#[derive(Debug, Serialize)]
pub(crate) struct Report {
    groups: Vec<BySetSize>,
}

/// All sets of one number of cameras.
#[derive(Debug, Serialize)]
struct BySetSize {
    cameras: usize,
    found: usize,
    /// Mean and longest wall time of a trial, silhouettes given.
    seconds: [f64; 2],
    trials: Vec<Trial>,
}

/// One frame by one set of cameras.
#[derive(Debug, Serialize)]
struct Trial {
    cameras: Vec<String>,
    frame: usize,
    /// Mean joint error to the keypoints; `None` where nothing was found.
    error_mm: Option<f64>,
    /// That of the fit that began at the keypoints.
    from_keypoints_mm: f64,
    found: bool,
    seconds: f64,
    /// What the silhouettes leave open, or why there is no pose.
    doubts: Vec<String>,
}

impl Experiment for NoStart {
    const NAME: &'static str = "no-start";
    type Report = Report;

    fn run(&mut self, run: &Run) -> Result<Report> {
        let footage = take_options::open_with_model(&self.take, self.model.as_deref())?;
        ensure!(self.part.cameras.is_none(), "--cameras: all sets are tried; ask for --sets-of");
        self.frame_numbers = self.part.frames(footage.take())?;
        let all = footage.cameras.len();
        let sets: Vec<Vec<Vec<usize>>> =
            self.sets_of.iter().map(|&count| sets(all, count)).collect::<Result<_>>()?;
        let (mut done, total) = (0, sets.iter().map(Vec::len).sum::<usize>() * self.frame_numbers.len());
        let mut groups = Vec::new();
        for (&cameras, sets) in self.sets_of.iter().zip(&sets) {
            let mut trials = Vec::new();
            for &frame in &self.frame_numbers {
                for set in sets {
                    run.progress(done, total)?;
                    done += 1;
                    trials.push(trial(&footage, set, frame, self.within_mm, run)?);
                }
            }
            let seconds = || trials.iter().map(|trial| trial.seconds);
            groups.push(BySetSize {
                cameras,
                found: trials.iter().filter(|trial| trial.found).count(),
                seconds: [seconds().sum::<f64>() / trials.len().max(1) as f64, seconds().fold(0.0, f64::max)],
                trials,
            });
        }
        Ok(Report { groups })
    }

    fn table(&self, report: &Report) -> String {
        let median = |sets: &&BySetSize, of: fn(&Trial) -> Option<f64>| {
            let values: Vec<f64> = sets.trials.iter().filter_map(of).collect();
            number(Statistics::of(&values).map(|all| all.median), 1)
        };
        let table = Table::of(
            &report.groups,
            &[
                ("cameras", &|sets| sets.cameras.to_string()),
                ("found", &|sets| format!("{} of {}", sets.found, sets.trials.len())),
                ("error, mm: median", &|sets| median(sets, |trial| trial.error_mm)),
                ("from keypoints", &|sets| median(sets, |trial| Some(trial.from_keypoints_mm))),
                ("s: mean", &|sets| number(sets.seconds[0], 2)),
                ("longest", &|sets| number(sets.seconds[1], 2)),
            ],
        );
        let missed = report.groups.iter().flat_map(|sets| &sets.trials).filter(|trial| !trial.found);
        let line = |trial: &Trial| {
            let error = trial.error_mm.map_or_else(|| trial.doubts.join("; "), |mm| format!("{mm:.0} mm"));
            format!("\nmissed: frame {}, {}: {error}", trial.frame, trial.cameras.join(", "))
        };
        table + &missed.map(line).collect::<String>()
    }
}

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
        let joints = take.reference().map(|reference| reference.joints(frame)).unwrap_or_default();
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

fn trial(footage: &Footage, set: &[usize], frame: usize, within_mm: f64, run: &Run) -> Result<Trial> {
    let scene = KeypointFrame::new(footage, set, frame, run)?;
    let began = Instant::now();
    let found = without_start(scene.model, &scene.views, &WithoutStartOptions::default(), &run.cancel);
    let seconds = began.elapsed().as_secs_f64();
    let (error_mm, doubts) = match found {
        Ok(found) => (
            Some(error_mm(scene.model, found.pose(), &scene.joints)),
            found.doubts.iter().map(Doubt::to_string).collect(),
        ),
        Err(WithoutStartError::Cancelled) => return Err(Interrupted.into()),
        Err(error) => (None, vec![error.to_string()]),
    };
    Ok(Trial {
        cameras: set.iter().map(|&camera| footage.cameras[camera].name().to_owned()).collect(),
        frame,
        error_mm,
        from_keypoints_mm: scene.fitted_mm,
        found: error_mm.is_some_and(|error| error <= scene.fitted_mm + within_mm),
        seconds,
        doubts,
    })
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
