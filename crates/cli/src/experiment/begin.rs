//! `backlit experiment begin`: ways to begin, one beside another.

use std::path::{Path, PathBuf};

use backlit_lab::experiment::begin::{self, MethodRow, Options, Report, footage};
use backlit_lab::experiment::starts::Draw;
use backlit_plot::{Axis, Figure, Line};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::initialisation::{InitialisationMethod, InitialisationOptions};
use backlit_tracking::search::start::{LEVELS, Level};
use clap::Args;
use serde::Serialize;

use super::arguments::{OutputArguments, PictureSize};
use super::basin;
use super::files;
use super::waiting::listener;
use crate::table::Table;
use crate::take_options;

/// Ways to begin, side by side: downhill, particles, templates, the search; what they find, evaluations of Λ, time
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Ways to begin: report, ramp, particles, templates, search
    #[arg(long, value_name = "WAY,…", value_delimiter = ',', default_values_t = InitialisationMethod::COMPARED)]
    methods: Vec<InitialisationMethod>,
    /// Numbers of cameras; with --take all sets of this many are tried
    #[arg(long, value_name = "N,…", value_delimiter = ',', default_values_t = [2])]
    cameras: Vec<usize>,
    /// How far every joint of the starts is turned, degrees: of 5, 10, 20, 30 and 45, which go with 2, 5, 10, 15 and 20 cm
    /// of the root
    #[arg(long, value_name = "DEG,…", value_delimiter = ',', default_values_t = [10, 30])]
    angles: Vec<u32>,
    /// Starts of every angle; or a file of starts with their truth and masks
    #[arg(long, value_name = "N|FILE", default_value = "10", conflicts_with = "take")]
    starts: String,
    /// Ignore the starts: nothing is known of the pose
    #[arg(long)]
    no_start: bool,
    /// Seed of what is drawn
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Size of the pictures that are drawn, pixels
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "48x36", conflicts_with = "take")]
    size: PictureSize,
    /// Particles of the filter [default: 200 from a start, 400 without]
    #[arg(long, value_name = "N")]
    particles: Option<usize>,
    /// Annealing layers of the filter
    #[arg(long, value_name = "N")]
    layers: Option<usize>,
    /// Places of the head that templates go on with; 1 as Mikić et al. do it
    #[arg(long, value_name = "N", default_value_t = 3)]
    heads: usize,
    /// Take with reference keypoints whose frames are used instead of drawn scenes: its folder or its take.toml
    #[arg(long, value_name = "TAKE")]
    take: Option<PathBuf>,
    /// Frames of the take, counted from 0
    #[arg(long, value_name = "K,…", value_delimiter = ',', default_values_t = [0], requires = "take")]
    frames: Vec<usize>,
    /// The person counts as found if the mean joint error is at most so much above that of a fit from the keypoints, millimetres
    #[arg(long, value_name = "MM", default_value_t = 25.0, requires = "take")]
    within_mm: f64,
    #[command(flatten)]
    output: OutputArguments,
}

/// What was done, for the file with the numbers.
#[derive(Debug, Serialize)]
struct BeginConditions<'a> {
    #[serde(flatten)]
    options: &'a Options,
    starts: Option<&'a str>,
    draw: Option<&'a Draw>,
    frames: Option<&'a footage::Frames>,
}

/// Runs the experiment, writes and prints.
///
/// # Errors
/// Returns an error if an option is out of range, or if a file cannot be read or written.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let options = options(arguments);
    let (cancel, listener) = (CancelToken::new(), listener());
    if let Some(take) = &arguments.take {
        let frames = frames(arguments)?;
        let report = on_footage(take, &options, &frames, &cancel, listener)?;
        let conditions =
            BeginConditions { options: &options, starts: None, draw: None, frames: Some(&frames) };
        return finish(arguments, &conditions, &report);
    }
    let scenes = (arguments.cameras.as_slice(), arguments.size.0, arguments.seed);
    let (starts, draw) = basin::starts_of(&arguments.starts, &arguments.angles, scenes)?;
    let report = begin::run(&options, &starts, &cancel, listener)?;
    let conditions = BeginConditions {
        options: &options,
        starts: Some(&arguments.starts),
        draw: draw.as_ref(),
        frames: None,
    };
    finish(arguments, &conditions, &report)
}

fn on_footage(
    take: &Path,
    options: &Options,
    frames: &footage::Frames,
    cancel: &CancelToken,
    listener: impl FnMut(backlit_lab::experiment::Progress),
) -> anyhow::Result<Report> {
    let footage = take_options::open(take)?;
    Ok(footage::run(&footage, options, frames, cancel, listener)?)
}

fn options(arguments: &Arguments) -> Options {
    let mut choices = InitialisationOptions { heads: arguments.heads, ..InitialisationOptions::default() };
    for chosen in [&mut choices.particles, &mut choices.particles_no_start] {
        chosen.particles = arguments.particles.unwrap_or(chosen.particles);
        chosen.layers = arguments.layers.unwrap_or(chosen.layers);
        chosen.seed = arguments.seed;
    }
    let (methods, cameras) = (arguments.methods.clone(), arguments.cameras.clone());
    Options { methods, cameras, no_start: arguments.no_start, choices }
}

fn frames(arguments: &Arguments) -> anyhow::Result<footage::Frames> {
    let wanted = |level: &Level| arguments.angles.contains(&level.degrees);
    let levels: Vec<Level> = LEVELS.into_iter().filter(wanted).collect();
    anyhow::ensure!(!levels.is_empty(), "--angles: expected some of 5, 10, 20, 30 and 45");
    let (within_mm, seed) = (arguments.within_mm, arguments.seed);
    Ok(footage::Frames { frames: arguments.frames.clone(), levels, within_mm, seed })
}

fn finish(arguments: &Arguments, conditions: &BeginConditions<'_>, report: &Report) -> anyhow::Result<()> {
    let figures = [("begin".to_owned(), figure(report))];
    files::finish(&arguments.output, "begin", conditions, report, &figures, &table(report))
}

fn table(report: &Report) -> String {
    let mut table =
        Table::new(["cameras, start off by: way", "found", "median, mm", "before", "evaluations of Λ", "ms"]);
    for row in &report.rows {
        let start = row.degrees.map_or_else(|| "no start".to_owned(), |degrees| format!("{degrees}°"));
        let before = row.median_before_mm.map_or_else(|| "–".to_owned(), |mm| format!("{mm:.1}"));
        table.row([
            format!("{}, {start}: {}", row.cameras, row.method),
            format!("{} of {}", row.found, row.tried),
            format!("{:.1}", row.median_mm),
            before,
            format!("{:.0}", row.evaluations),
            format!("{:.1}", row.ms),
        ]);
    }
    table.to_text()
}

/// What each way costs and what it finds: one line a way, one point a row.
fn figure(report: &Report) -> Figure {
    let share =
        |row: &MethodRow| [row.evaluations.max(1.0), 100.0 * row.found as f64 / row.tried.max(1) as f64];
    let line = |(style, method): (usize, InitialisationMethod)| Line {
        name: method.name().to_owned(),
        points: report.rows.iter().filter(|row| row.method == method).map(share).collect(),
        style,
        ..Line::default()
    };
    let ways = InitialisationMethod::COMPARED
        .into_iter()
        .filter(|way| report.rows.iter().any(|row| row.method == *way));
    Figure {
        title: "Ways to begin".to_owned(),
        subtitle: "one point a number of cameras and a distance of the start".to_owned(),
        x: Axis::log("evaluations of Λ"),
        y: Axis::linear("found, %"),
        lines: ways.enumerate().map(line).collect(),
    }
}
