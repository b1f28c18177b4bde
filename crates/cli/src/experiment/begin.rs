//! Ways to begin ([`initialisation`](backlit_tracking::initialisation)): where a fit is to start when the pose is hardly known or
//! not at all (the report's 6.4), one beside another.
//!
//! They begin at drawn starts, or on frames of a take with keypoints by all sets of this many cameras. There a given start is the
//! pose of the fit that begins at the keypoints, with every joint turned and the root moved, and a pose is judged beside that fit.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Instant;

use anyhow::Result;
use backlit_formats::starts_file::Start;
use backlit_lab::experiment::starts::Draw;
use backlit_plot::{Axis, Figure, FigureOrSheet, Line};
use backlit_tracking::body::Pose;
use backlit_tracking::initialisation::{InitialisationInputs, InitialisationMethod, InitialisationOptions};
use backlit_tracking::metrics::leaf_error_mm;
use backlit_tracking::search::start::{Level, perturb};
use backlit_tracking::statistics::{Statistics, Z_95, wilson};
use clap::Args;
use serde::Serialize;

use super::arguments::{OutputArguments, picture_size};
use super::basin::{levels_of, starts_of, views_of};
use super::keypoint_frame::{KeypointFrame, error_mm, sets};
use super::{Experiment, Run};
use crate::numbers::within;
use crate::output::number;
use crate::table::Table;
use crate::take_options;

/// Below this mean distance a fit has found its truth, millimetres.
const SUCCESS_MM: f64 = 20.0;

/// Ways to begin, side by side: downhill, particles, templates, the search; what they find, evaluations of Λ, time
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Ways to begin: report, ramp, particles, templates, search
    #[arg(long, value_name = "WAY,…", value_delimiter = ',', default_values_t = InitialisationMethod::COMPARED)]
    methods: Vec<InitialisationMethod>,
    /// Numbers of cameras; with --take all sets of this many are tried [1 to 64]
    #[arg(long, value_name = "N,…", value_delimiter = ',', default_values_t = [2], value_parser = within(1..=64_usize))]
    cameras: Vec<usize>,
    /// How far every joint of the starts is turned, degrees: of 5, 10, 20, 30 and 45, which go with 2, 5, 10, 15 and 20 cm
    /// of the root [1 to 180]
    #[arg(long, value_name = "DEG,…", value_delimiter = ',', default_values_t = [10, 30], value_parser = within(1..=180_u32))]
    angles: Vec<u32>,
    /// Starts of every angle [1 to 1000]; or a file of starts with their truth and masks
    #[arg(long, value_name = "N|FILE", default_value = "10", conflicts_with = "take")]
    starts: String,
    /// Ignore the starts: nothing is known of the pose
    #[arg(long)]
    no_start: bool,
    /// Seed of what is drawn [0 to 4294967295]
    #[arg(long, value_name = "S", default_value_t = 1, value_parser = within(0..=4_294_967_295_u64))]
    seed: u64,
    /// Size of the pictures that are drawn, pixels
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = picture_size, default_value = "48x36", conflicts_with = "take")]
    size: [u64; 2],
    /// Particles of the filter [1 to 100000] [default: 200 from a start, 400 without]
    #[arg(long, value_name = "N", value_parser = within(1..=100_000_usize))]
    particles: Option<usize>,
    /// Annealing layers of the filter [1 to 100]
    #[arg(long, value_name = "N", value_parser = within(1..=100_usize))]
    layers: Option<usize>,
    /// Places of the head that templates go on with; 1 as Mikić et al. do it [1 to 100]
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = within(1..=100_usize))]
    heads: usize,
    /// Take with reference keypoints whose frames are used instead of drawn scenes: its folder or its take.toml
    #[arg(long, value_name = "TAKE")]
    take: Option<PathBuf>,
    /// Another body than the take's, as from fit-body: a file, or a built-in one by name
    #[arg(long, value_name = "MODEL", requires = "take")]
    model: Option<String>,
    /// Frames of the take, counted from 0 [0 to 999999]
    #[arg(long, value_name = "K,…", value_delimiter = ',', default_values_t = [0], requires = "take", value_parser = within(0..=999_999_usize))]
    frames: Vec<usize>,
    /// The person counts as found if the mean joint error is at most so much above that of a fit from the keypoints, millimetres [0 to 10000]
    #[arg(long, value_name = "MM", default_value_t = 25.0, requires = "take", value_parser = within(0.0..=10_000.0_f64))]
    within_mm: f64,
    #[command(flatten)]
    output: OutputArguments,
}

/// What is tried.
#[derive(Debug, Serialize)]
struct Beginnings {
    methods: Vec<InitialisationMethod>,
    /// Numbers of cameras.
    cameras: Vec<usize>,
    /// Whether the starts are ignored.
    no_start: bool,
    #[serde(flatten)]
    choices: InitialisationOptions,
    starts: Option<String>,
    draw: Option<Draw>,
    frames: Option<Frames>,
    /// The starts themselves, if not [`Self::frames`].
    #[serde(skip)]
    given: Vec<Start>,
}

/// Frames of a take, and how far off their starts are.
#[derive(Debug, Serialize)]
struct Frames {
    #[serde(skip)]
    take: PathBuf,
    #[serde(skip)]
    model: Option<String>,
    frames: Vec<usize>,
    /// Each is tried once a frame and set of cameras.
    levels: Vec<Level>,
    /// A pose whose mean joint error is at most so much larger than that of the fit from the keypoints is found, mm.
    within_mm: f64,
    seed: u64,
}

impl Arguments {
    pub(crate) fn run(self) -> Result<()> {
        let mut choices = InitialisationOptions { heads: self.heads, ..InitialisationOptions::default() };
        for chosen in [&mut choices.particles, &mut choices.particles_no_start] {
            chosen.particles = self.particles.unwrap_or(chosen.particles);
            chosen.layers = self.layers.unwrap_or(chosen.layers);
            chosen.seed = self.seed;
        }
        let (methods, cameras, no_start) = (self.methods, self.cameras, self.no_start);
        let (mut starts, mut draw, mut frames, mut given) = (None, None, None, Vec::new());
        if let Some(take) = self.take {
            let (levels, within_mm, seed) = (levels_of(&self.angles)?, self.within_mm, self.seed);
            frames = Some(Frames { take, model: self.model, frames: self.frames, levels, within_mm, seed });
        } else {
            (given, draw) = starts_of(&self.starts, &self.angles, (&cameras, self.size, self.seed))?;
            starts = Some(self.starts);
        }
        Beginnings { methods, cameras, no_start, choices, starts, draw, frames, given }.perform(&self.output)
    }
}

#[derive(Debug, Serialize)]
struct Report {
    /// By number of cameras, then by how far the starts were off, then by method.
    rows: Vec<MethodRow>,
}

/// One method from all starts of one kind.
#[derive(Debug, Serialize)]
struct MethodRow {
    method: InitialisationMethod,
    cameras: usize,
    /// Degrees that every joint of the starts was off; `None` without starts.
    degrees: Option<u32>,
    tried: usize,
    /// Those that found their truth.
    found: usize,
    /// Ends of the interval that holds the true share 95 times of 100.
    interval: [f64; 2],
    /// Median of the mean distances from the truth, millimetres.
    median_mm: f64,
    /// The same before the last fit; `None` for methods that are one.
    median_before_mm: Option<f64>,
    /// Mean evaluations of Λ of a start.
    evaluations: f64,
    /// Median wall time of a start, milliseconds.
    ms: f64,
}

/// One start by one method.
struct Trial {
    error_mm: f64,
    before_mm: Option<f64>,
    evaluations: usize,
    seconds: f64,
    found: bool,
}

/// Trials by the place of their number of cameras, by degrees, by the place of their method.
type Trials = BTreeMap<(usize, Option<u32>, usize), Vec<Trial>>;

impl Experiment for Beginnings {
    const NAME: &'static str = "begin";
    type Report = Report;

    fn run(&mut self, run: &Run) -> Result<Report> {
        if let Some(frames) = &self.frames { self.on_frames(frames, run) } else { self.on_starts(run) }
    }

    fn table(&self, report: &Report) -> String {
        let start =
            |row: &MethodRow| row.degrees.map_or_else(|| "no start".to_owned(), |all| format!("{all}°"));
        Table::of(
            &report.rows,
            &[
                ("cameras, start off by: initialisation", &|row| {
                    format!("{}, {}: {}", row.cameras, start(row), row.method)
                }),
                ("found", &|row| format!("{} of {}", row.found, row.tried)),
                ("median, mm", &|row| number(row.median_mm, 1)),
                ("before", &|row| number(row.median_before_mm, 1)),
                ("evaluations of Λ", &|row| number(row.evaluations, 0)),
                ("ms", &|row| number(row.ms, 1)),
            ],
        )
    }

    /// What each initialisation costs and what it finds: one line for each, one point a row.
    fn pictures(&self, report: &Report) -> Vec<(String, FigureOrSheet)> {
        let share =
            |row: &MethodRow| [row.evaluations.max(1.0), 100.0 * row.found as f64 / row.tried.max(1) as f64];
        let line = |(style, method): (usize, InitialisationMethod)| {
            let rows = report.rows.iter().filter(|row| row.method == method);
            Line::of_points(method.name(), style, rows.map(share).collect())
        };
        let is_tried = |way: &InitialisationMethod| report.rows.iter().any(|row| row.method == *way);
        let ways = InitialisationMethod::COMPARED.into_iter().filter(is_tried);
        let figure = Figure {
            title: "Ways to begin".to_owned(),
            subtitle: "one point a number of cameras and a distance of the start".to_owned(),
            x: Axis::log("evaluations of Λ"),
            y: Axis::linear("found, %"),
            lines: ways.enumerate().map(line).collect(),
        };
        vec![("begin".to_owned(), FigureOrSheet::Figure(figure))]
    }
}

impl Beginnings {
    /// Tries all methods from all starts.
    fn on_starts(&self, run: &Run) -> Result<Report> {
        let (mut done, total) = (0, self.cameras.len() * self.given.len() * self.methods.len());
        let mut trials = Trials::new();
        for &cameras in &self.cameras {
            for start in &self.given {
                let views = views_of(start, cameras)?;
                let given = (!self.no_start).then_some(&start.start);
                let inputs =
                    InitialisationInputs { model: &start.model, views, start: given, cancel: &run.cancel };
                let error = |pose: &Pose| leaf_error_mm(&start.model, pose, &start.truth);
                for (index, &method) in self.methods.iter().enumerate() {
                    run.progress(done, total)?;
                    done += 1;
                    let trial = self.one(method, &inputs, error, |error| error < SUCCESS_MM, run)?;
                    let degrees = given.map(|_| start.degrees);
                    trials.entry((cameras, degrees, index)).or_default().push(trial);
                }
            }
        }
        Ok(self.report(&trials, |cameras| cameras))
    }

    /// Tries all methods on all frames by all sets of cameras, from starts of all levels, or without.
    fn on_frames(&self, frames: &Frames, run: &Run) -> Result<Report> {
        let footage = take_options::open_with_model(&frames.take, frames.model.as_deref())?;
        let all = footage.cameras.len();
        let mut levels: Vec<Option<Level>> = frames.levels.iter().copied().map(Some).collect();
        if self.no_start {
            levels = vec![None];
        }
        let of_count: Vec<_> = self.cameras.iter().map(|&count| sets(all, count)).collect::<Result<_>>()?;
        let per_set = frames.frames.len() * self.methods.len() * levels.len();
        let (mut done, total) = (0, of_count.iter().map(Vec::len).sum::<usize>() * per_set);
        let mut trials = Trials::new();
        for (place, sets) in of_count.iter().enumerate() {
            for (set, &frame) in
                sets.iter().flat_map(|set| frames.frames.iter().map(move |frame| (set, frame)))
            {
                let scene = KeypointFrame::new(&footage, set, frame, run)?;
                for level in &levels {
                    let given = level.map(|Level { degrees, metres }| {
                        let seed = frames.seed.wrapping_add(frame as u64);
                        perturb(scene.model, &scene.fitted, f64::from(degrees).to_radians(), metres, seed)
                    });
                    let inputs = InitialisationInputs {
                        model: scene.model,
                        views: &scene.views,
                        start: given.as_ref(),
                        cancel: &run.cancel,
                    };
                    let error = |pose: &Pose| error_mm(scene.model, pose, &scene.joints);
                    let is_found = |error: f64| error <= scene.fitted_mm + frames.within_mm;
                    for (index, &method) in self.methods.iter().enumerate() {
                        run.progress(done, total)?;
                        done += 1;
                        let trial = self.one(method, &inputs, error, is_found, run)?;
                        let degrees = level.map(|level| level.degrees);
                        trials.entry((place, degrees, index)).or_default().push(trial);
                    }
                }
            }
        }
        Ok(self.report(&trials, |place| self.cameras[place]))
    }

    /// Tries a method from one start.
    fn one(
        &self,
        method: InitialisationMethod,
        inputs: &InitialisationInputs<'_>,
        error_mm: impl Fn(&Pose) -> f64,
        is_found: impl Fn(f64) -> bool,
        run: &Run,
    ) -> Result<Trial> {
        let began = Instant::now();
        let result = self.choices.run(method, inputs, &mut |_| {});
        let seconds = began.elapsed().as_secs_f64();
        run.check()?;
        let result = result?;
        let before_mm = result.before.as_ref().map(&error_mm);
        let error_mm = result.pose().map_or(f64::INFINITY, error_mm);
        let (evaluations, found) = (result.evaluations.unwrap_or(0), is_found(error_mm));
        Ok(Trial { error_mm, before_mm, evaluations, seconds, found })
    }

    fn report(&self, trials: &Trials, cameras: impl Fn(usize) -> usize) -> Report {
        let row = |(&(place, degrees, method), trials): (&_, &Vec<Trial>)| {
            MethodRow::of(self.methods[method], cameras(place), degrees, trials)
        };
        Report { rows: trials.iter().map(row).collect() }
    }
}

impl MethodRow {
    fn of(method: InitialisationMethod, cameras: usize, degrees: Option<u32>, trials: &[Trial]) -> Self {
        let median = |list: Vec<f64>| Statistics::of(&list).map(|all| all.median);
        let (tried, found) = (trials.len(), trials.iter().filter(|trial| trial.found).count());
        let evaluations = trials.iter().map(|trial| trial.evaluations as f64).sum::<f64>();
        Self {
            method,
            cameras,
            degrees,
            tried,
            found,
            interval: wilson(found, tried, Z_95),
            median_mm: median(trials.iter().map(|trial| trial.error_mm).collect()).unwrap_or(f64::INFINITY),
            median_before_mm: median(trials.iter().filter_map(|trial| trial.before_mm).collect()),
            evaluations: evaluations / tried.max(1) as f64,
            ms: 1e3 * median(trials.iter().map(|trial| trial.seconds).collect()).unwrap_or(0.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::Parameters;

    use super::*;

    /// The report of two cameras from starts that are this many degrees off, moved if asked.
    fn report(degrees: u32, count: usize, no_start: bool, cameras: usize, is_moved: bool) -> Result<Report> {
        let levels = vec![Level { degrees, metres: 0.1 }];
        let draw = Draw { starts: count, levels, cameras: vec![2], ..Draw::default() };
        let mut given = draw.draw().unwrap();
        if is_moved {
            let step = vec![0.7; 3 + 3 * given[0].model.rotation_count()];
            given[0].start = given[0].start.retract(Parameters::Tangent, &step);
        }
        let (methods, cameras) = (InitialisationMethod::COMPARED.to_vec(), vec![cameras]);
        let choices = InitialisationOptions::default();
        let (starts, draw, frames) = (None, None, None);
        Beginnings { methods, cameras, no_start, choices, starts, draw, frames, given }.run(&Run::hidden())
    }

    #[test]
    fn every_method_is_tried_and_counted_and_twice_the_same() {
        let all = || report(10, 2, false, 2, false).unwrap();
        let report = all();
        assert_eq!(report.rows.len(), InitialisationMethod::COMPARED.len());
        for row in &report.rows {
            assert!(row.tried == 2 && row.evaluations > 10.0 && row.median_mm.is_finite(), "{row:?}");
            assert_eq!(row.degrees, Some(10));
        }
        let errors =
            |report: &Report| -> Vec<u64> { report.rows.iter().map(|row| row.median_mm.to_bits()).collect() };
        assert_eq!(errors(&report), errors(&all()));
        let of = |method| report.rows.iter().find(|row| row.method == method).unwrap();
        let ramp = of(InitialisationMethod::Ramp);
        assert_eq!(ramp.found, 2, "{report:?}");
        assert!(of(InitialisationMethod::Particles).evaluations > 10.0 * ramp.evaluations);
    }

    #[test]
    fn without_a_start_none_is_looked_at() {
        let [there, moved] = [false, true].map(|is_moved| {
            let report = report(45, 1, true, 2, is_moved).unwrap();
            report.rows.iter().map(|row| row.median_mm).collect::<Vec<_>>()
        });
        assert_eq!(there, moved);
    }

    #[test]
    fn cameras_that_the_starts_do_not_have_are_named() {
        let error = report(5, 1, false, 3, false).unwrap_err();
        assert!(error.to_string().contains("cameras"), "{error}");
    }
}
