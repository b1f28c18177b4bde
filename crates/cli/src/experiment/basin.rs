//! `backlit experiment basin`: how far off a start may be, and still end at the truth.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Instant;

use anyhow::Context;
use backlit_formats::starts_file::{self, Start};
use backlit_lab::experiment::Progress;
use backlit_lab::experiment::starts::Draw;
use backlit_plot::{Axis, Figure, Line};
use backlit_runs::basin::{Basin, FitChoice, SUCCESS_MM, Subject, SuccessRate};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::Preset;
use backlit_tracking::render::RendererKind;
use backlit_tracking::search::SearchOptions;
use backlit_tracking::search::start::{LEVELS, Level};
use clap::Args;
use serde::Serialize;

use super::arguments::{OutputArguments, PictureSize};
use super::files;
use super::frame_basin::{self, FrameArguments};
use super::waiting;
use crate::output;
use crate::table::Table;

/// How far off a start may be: share of starts that end at the truth, by distance and number of cameras
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Numbers of cameras
    #[arg(long, value_name = "N,…", value_delimiter = ',', default_values_t = [1, 2, 4])]
    cameras: Vec<usize>,
    /// How far every joint of the starts is turned, degrees: of 5, 10, 20, 30 and 45, which go with 2, 5, 10,
    /// 15 and 20 cm of the root; with --take any whole degrees [default: all five]
    #[arg(long, value_name = "DEG,…", value_delimiter = ',', conflicts_with = "map")]
    angles: Vec<u32>,
    /// Starts of every angle; or a file of starts with their truth and masks, of which all are taken
    #[arg(long, value_name = "N|FILE", default_value = "40", conflicts_with = "map")]
    starts: String,
    /// Seed of poses, cameras and starts that are drawn
    #[arg(long, value_name = "S", default_value_t = 1, conflicts_with = "map")]
    seed: u64,
    /// Size of the pictures that are drawn, pixels
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "48x36")]
    size: PictureSize,
    /// Set of choices: report (as in 2004) or robust
    #[arg(long, default_value_t = Preset::Robust)]
    preset: Preset,
    /// Solid that stands for a limb: capsule, cylinder or sphere-tree
    #[arg(long, value_name = "SOLID", default_value_t = RendererKind::Capsule)]
    renderer: RendererKind,
    /// Go downhill from the start alone, without a search for other hypotheses
    #[arg(long)]
    downhill: bool,
    /// Ignore the starts: the search begins in the visual hull. On all cores
    #[arg(long, conflicts_with_all = ["downhill", "unscaled", "take"])]
    no_start: bool,
    /// Leave the preset's annealing as it is, whatever the size of the pictures
    #[arg(long)]
    unscaled: bool,
    #[command(flatten)]
    frame: FrameArguments,
    #[command(flatten)]
    output: OutputArguments,
}

/// What was done, for the file with the numbers.
#[derive(Debug, Serialize)]
struct BasinConditions<'a> {
    cameras: &'a [usize],
    preset: Preset,
    renderer: RendererKind,
    scaled: bool,
    hypotheses: Option<&'a SearchOptions>,
    no_start: bool,
    starts: &'a str,
    draw: Option<&'a Draw>,
}

/// One entry a number of cameras.
#[derive(Debug, Serialize)]
struct Report {
    basins: Vec<CameraBasin>,
}

/// The basin with one number of cameras.
#[derive(Debug, Serialize)]
struct CameraBasin {
    cameras: usize,
    /// Share of starts that found their truth, by degrees off.
    success: BTreeMap<u32, f64>,
    /// Median of the mean distances, by degrees off.
    median_mm: BTreeMap<u32, f64>,
    /// Mean wall time of a start, milliseconds.
    ms_per_start: f64,
}

/// Runs the experiment, writes and prints. `--json` prints one object a number of cameras: by itself if there
/// is one, else a list.
///
/// # Errors
/// Returns an error if an option is out of range, or if a file cannot be read or written.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let mut choice = FitChoice::best_of(arguments.preset);
    choice.fit.renderer = arguments.renderer;
    let scaled = arguments.preset == Preset::Robust && !arguments.unscaled;
    choice.fit.to_scale &= scaled;
    choice.ignores_start = arguments.no_start;
    if arguments.downhill {
        choice.hypotheses = None;
    }
    if let Some(take) = &arguments.frame.take {
        let draw = (arguments.angles.as_slice(), arguments.starts.as_str(), arguments.seed);
        return frame_basin::run(&arguments.frame, take, draw, choice, &arguments.output);
    }
    let (starts, draw) = starts(arguments)?;
    let report = Report { basins: basins(&arguments.cameras, &starts, &choice)? };
    let conditions = BasinConditions {
        cameras: &arguments.cameras,
        preset: arguments.preset,
        renderer: arguments.renderer,
        scaled,
        hypotheses: choice.hypotheses.as_ref(),
        no_start: arguments.no_start,
        starts: &arguments.starts,
        draw: draw.as_ref(),
    };
    let figures = [("basin".to_owned(), figure(&report, starts.len()))];
    // The numbers that are printed are those of the basins alone.
    let files = OutputArguments { json: false, out: arguments.output.out.clone(), ..arguments.output };
    if !arguments.output.json {
        return files::finish(&files, "basin", &conditions, &report, &figures, &table(&report));
    }
    files::write(&files, "basin", &conditions, &report, &figures)?;
    match report.basins.as_slice() {
        [one] => output::print_json(one),
        several => output::print_json(&several),
    }
}

/// Fits all starts with each number of cameras, one after the other on one core; without starts on all cores.
fn basins(cameras: &[usize], starts: &[Start], choice: &FitChoice) -> anyhow::Result<Vec<CameraBasin>> {
    let (mut listener, total) = (waiting::listener(), cameras.len() * starts.len());
    let mut found = Vec::with_capacity(cameras.len());
    for (index, &cameras) in cameras.iter().enumerate() {
        let subject = |start: &Start| {
            let views = start.views.get(&cameras).cloned();
            let views = views.with_context(|| {
                format!("`cameras` is {cameras}; expected a number of cameras that the starts have")
            })?;
            let subject = Subject { model: start.model.clone(), views, reference: start.truth.clone() };
            anyhow::Ok((subject, start.start.clone()))
        };
        let subjects = starts.iter().map(subject).collect::<Result<_, _>>()?;
        let basin = Basin::from_starts(subjects, choice.clone());
        let mut errors: BTreeMap<u32, Vec<f64>> = BTreeMap::new();
        let mut seconds = 0.0;
        for (trial, start) in starts.iter().enumerate() {
            listener(Progress { done: index * starts.len() + trial, total });
            let began = Instant::now();
            let error_mm = basin.run(trial, &CancelToken::new())?.error_mm;
            seconds += began.elapsed().as_secs_f64();
            errors.entry(start.degrees).or_default().push(error_mm);
        }
        let rate = |(degrees, errors)| (degrees, SuccessRate::of(errors, SUCCESS_MM));
        let rates: Vec<(u32, SuccessRate)> = errors.into_iter().map(rate).collect();
        let by_degrees = |value: fn(&SuccessRate) -> Option<f64>| {
            rates.iter().map(|(degrees, rate)| (*degrees, value(rate).unwrap_or_default())).collect()
        };
        found.push(CameraBasin {
            cameras,
            success: by_degrees(|rate| rate.success),
            median_mm: by_degrees(|rate| rate.median_mm),
            ms_per_start: 1e3 * seconds / starts.len().max(1) as f64,
        });
    }
    listener(Progress { done: total, total });
    Ok(found)
}

fn starts(arguments: &Arguments) -> anyhow::Result<(Vec<Start>, Option<Draw>)> {
    let scenes = (arguments.cameras.as_slice(), arguments.size.0, arguments.seed);
    starts_of(&arguments.starts, &arguments.angles, scenes)
}

/// Starts by number or from a file, of some angles (none: of all). `scenes` has the cameras, pixels and seed of drawn ones.
///
/// # Errors
/// Returns an error if the file cannot be read, or if no start has one of the angles.
pub(super) fn starts_of(
    starts: &str,
    angles: &[u32],
    scenes: (&[usize], [u64; 2], u64),
) -> anyhow::Result<(Vec<Start>, Option<Draw>)> {
    let (cameras, size_px, seed) = scenes;
    let wanted = |degrees: u32| angles.is_empty() || angles.contains(&degrees);
    let Ok(count) = starts.parse() else {
        let mut found = starts_file::read(&PathBuf::from(starts))?;
        found.retain(|start| wanted(start.degrees));
        anyhow::ensure!(!found.is_empty(), "{starts} has no start of --angles");
        return Ok((found, None));
    };
    let levels: Vec<Level> = LEVELS.into_iter().filter(|level| wanted(level.degrees)).collect();
    anyhow::ensure!(!levels.is_empty(), "--angles: expected some of 5, 10, 20, 30 and 45");
    let draw = Draw { starts: count, levels, cameras: cameras.to_vec(), size_px, seed };
    Ok((draw.draw()?, Some(draw)))
}

fn table(report: &Report) -> String {
    let mut table = Table::new(["cameras, start off by", "found, %", "median, mm", "ms a start"]);
    for basin in &report.basins {
        for (degrees, success) in &basin.success {
            let median = basin.median_mm.get(degrees).copied().unwrap_or_default();
            table.row([
                format!("{}, {degrees}°", basin.cameras),
                format!("{:.1}", 100.0 * success),
                format!("{median:.1}"),
                format!("{:.1}", basin.ms_per_start),
            ]);
        }
    }
    table.to_text()
}

fn figure(report: &Report, starts: usize) -> Figure {
    let line = |(style, basin): (usize, &CameraBasin)| Line {
        name: if basin.cameras == 1 { "one camera".to_owned() } else { format!("{} cameras", basin.cameras) },
        points: basin.success.iter().map(|(&degrees, &found)| [f64::from(degrees), 100.0 * found]).collect(),
        style,
        ..Line::default()
    };
    Figure {
        title: "Basin: starts that end within 20 mm of the truth".to_owned(),
        subtitle: format!("upper body, {starts} starts"),
        x: Axis::linear("degrees that every joint of the start is off"),
        y: Axis::linear("found, %"),
        lines: report.basins.iter().enumerate().map(line).collect(),
    }
}
