//! Frames of a take with keypoints, looked at without a start, by all sets of this many cameras: how many end where a fit that
//! begins at the keypoints does.
//!
//! Keypoints are a few centimetres accurate, so that a pose is judged beside the one that a fit from the keypoints finds
//! with the same cameras: it is found where its mean joint error is no more than so much larger. A body turned round is some
//! hundred millimetres off.

use std::path::PathBuf;
use std::time::Instant;

use anyhow::{Result, bail, ensure};
use backlit_formats::Footage;
use backlit_lab::experiment::no_start::{error_mm, fit, sets};
use backlit_tracking::search::{Doubt, WithoutStartError, WithoutStartOptions, start, without_start};
use backlit_tracking::statistics::Statistics;
use clap::Args;
use serde::Serialize;

use super::{Experiment, Run};
use crate::interrupt::Interrupted;
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
    /// Numbers of cameras; all sets of this many are tried
    #[arg(long = "sets-of", value_name = "N,…", value_delimiter = ',', default_values_t = [2, 4])]
    #[serde(rename = "cameras")]
    sets_of: Vec<usize>,
    #[arg(skip)]
    #[serde(rename = "frames")]
    frame_numbers: Vec<usize>,
    /// The person counts as found if the mean joint error is at most so much above that of a fit from the keypoints,
    /// millimetres
    #[arg(long, value_name = "MM", default_value_t = 25.0)]
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
            self.sets_of.iter().map(|&count| sets(all, count)).collect::<Result<_, _>>()?;
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

fn trial(footage: &Footage, set: &[usize], frame: usize, within_mm: f64, run: &Run) -> Result<Trial> {
    let take = footage.take();
    let model = take.model();
    let joints = take.reference().map(|reference| reference.joints(frame)).unwrap_or_default();
    let Some(at_keypoints) = start::from_joints(model, &joints) else {
        bail!("`frames` is {frame}; expected a frame that has reference keypoints");
    };
    let views = footage.fit_views(set, frame)?;
    let fitted = fit(model, &views, at_keypoints, &run.cancel)?;
    let from_keypoints_mm = error_mm(model, &fitted, &joints);
    let began = Instant::now();
    let found = without_start(model, &views, &WithoutStartOptions::default(), &run.cancel);
    let seconds = began.elapsed().as_secs_f64();
    let (error_mm, doubts) = match found {
        Ok(found) => (
            Some(error_mm(model, found.pose(), &joints)),
            found.doubts.iter().map(Doubt::to_string).collect(),
        ),
        Err(WithoutStartError::Cancelled) => return Err(Interrupted.into()),
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
