//! `backlit fit`: one moment's pose from its silhouettes, iteration by iteration.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use anyhow::{Context, bail};
use backlit_formats::calibration::{self, CalibrationOptions};
use backlit_formats::export::ending_text;
use backlit_formats::model_file;
use backlit_formats::pose_file;
use backlit_runs::track::TakeReader;
use backlit_tracking::body::{Model, Pose};
use backlit_tracking::fit::{Fit, FitView, Preset, SolverSummary};
use backlit_tracking::render::Ramp;
use backlit_tracking::statistics::Statistics;
use clap::Args;
use serde::Serialize;
use serde_json::Value;

use super::evidence;
use super::fit_options::{MODEL_HELP, SolverArguments};
use super::numbers::within;
use super::output::{self, object};
use super::person;
use super::table::Table;
use super::take_options::{self, StartArguments};

const AFTER_HELP: &str = "\
A folder of masks or grey levels holds NAME.png for every camera NAME, of the camera's size:
  --masks        white is the subject, black background, middle grey unknown
  --measurement  grey levels of D as they are, 0 subject … 255 background; the ramp says how far
                 they fade (half, if --ramp is not given with the robust preset)
Pictures of cameras with lens distortion are straightened first. A camera that sees no subject is left out.

Examples:
  backlit fit TAKE --frame 12 --start reference --start-noise 10deg,6cm
  backlit fit --model full_body --cameras cameras.json --start pose.json --masks masks --out fitted.json
  backlit fit --model full_body --cameras cameras.json --start pose.json --masks masks --preset report \\
      --iterations 25 --no-stop --timing --json";

/// What `backlit fit` is told.
#[derive(Debug, Args)]
#[command(after_help = AFTER_HELP)]
pub struct FitArguments {
    /// Take: its folder, its take.toml, or a project about it; gives model, cameras and silhouettes
    #[arg(requires = "frame", conflicts_with_all = ["model", "cameras", "masks", "measurement"])]
    take: Option<PathBuf>,
    /// The take's frame, counted from 0 [0 to 999999]
    #[arg(long, value_name = "K", requires = "take", value_parser = within(0..=999_999_usize))]
    frame: Option<usize>,
    /// Body model.
    #[arg(long, required_unless_present = "take", help = MODEL_HELP)]
    model: Option<String>,
    /// Calibrated cameras: any file that backlit cameras reads
    #[arg(long, required_unless_present = "take")]
    cameras: Option<PathBuf>,
    /// Folder of silhouettes
    #[arg(long, value_name = "DIR", required_unless_present_any = ["measurement", "take"])]
    masks: Option<PathBuf>,
    /// Folder of grey levels
    #[arg(long, value_name = "DIR", conflicts_with = "masks")]
    measurement: Option<PathBuf>,
    /// Write the fitted pose to this file
    #[arg(long, value_name = "POSE")]
    out: Option<PathBuf>,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
    /// Measure the time of every iteration
    #[arg(long)]
    timing: bool,
    #[command(flatten)]
    start: StartArguments,
    #[command(flatten)]
    solver: SolverArguments,
}

pub(crate) fn run(arguments: &FitArguments) -> anyhow::Result<()> {
    let mut options = arguments.solver.options()?;
    let takes_default_ramp = arguments.solver.ramp.is_none() && arguments.solver.preset == Preset::Robust;
    if arguments.measurement.is_some() && takes_default_ramp {
        // The preset's stages look at masks in their own ways; grey levels are what they are.
        options = options.with_ramp(Ramp::Half);
    }
    if let Some(path) = &arguments.out {
        output::check_folder_of(path)?;
    }
    let (model, views, start) = read(arguments)?;
    let mut fit = Fit::new(Arc::clone(&model), views, start, options)?;
    let (start_cost, start_rms) = (fit.initial_cost, fit.initial_rms);
    let times_us = run_timed(&mut fit);
    let summary = fit.summary();
    anyhow::ensure!(
        summary.initial_cost.is_finite() && summary.final_cost.is_finite(),
        "the fit has no cost: its numbers ran out of range; is the start near the cameras' view?"
    );
    if let Some(path) = &arguments.out {
        pose_file::write(path, &model, &summary.pose)?;
    }
    let times = arguments.timing.then(|| Times::of(&times_us)).flatten();
    let answer = answer(&model, &summary, start_rms, times)?;
    output::print_result(arguments.json, &answer, || text(&summary, start_cost, start_rms, times))
}

/// The body, what cameras see of it, and where the fit begins.
fn read(arguments: &FitArguments) -> anyhow::Result<(Arc<Model>, Vec<FitView>, Pose)> {
    if let (Some(take), Some(frame)) = (&arguments.take, arguments.frame) {
        let footage = take_options::open_segmented(take, None, arguments.solver.segmentation())?;
        let cameras: Vec<usize> = (0..footage.cameras.len()).collect();
        let views = footage.fit_views(&cameras, frame)?;
        let reader = TakeReader::of_silhouettes(footage.clone(), cameras.clone());
        person::check_silhouettes(&reader, &[frame])?;
        let start = arguments.start.pose(&footage, &cameras, frame, &arguments.solver.options()?)?;
        return Ok((Arc::clone(footage.take().model()), views, start));
    }
    let (Some(model), Some(cameras)) = (&arguments.model, &arguments.cameras) else {
        bail!("expected a take, or --model and --cameras");
    };
    let model = model_file::resolve(model)?;
    let rig = calibration::read(cameras, CalibrationOptions::default())?;
    let start = arguments.start.pose_of(&model)?;
    let views = match (&arguments.masks, &arguments.measurement) {
        (Some(folder), _) => evidence::read(folder, &rig, evidence::mask)?,
        (None, Some(folder)) => evidence::read(folder, &rig, evidence::measurement)?,
        (None, None) => bail!("expected --masks or --measurement"),
    };
    Ok((Arc::new(model), views, start))
}

/// Runs to the end. Microseconds of every iteration but those that first set a new stage up.
fn run_timed(fit: &mut Fit) -> Vec<f64> {
    let mut times_us = Vec::new();
    let mut stage = fit.stage;
    let mut began = Instant::now();
    while let Some(record) = fit.step() {
        if record.stage == stage {
            times_us.push(began.elapsed().as_secs_f64() * 1e6);
        }
        stage = record.stage;
        began = Instant::now();
    }
    times_us
}

/// Times of iterations, microseconds.
#[derive(Debug, Clone, Copy, Serialize)]
struct Times {
    median: f64,
    min: f64,
    count: usize,
}

impl Times {
    fn of(times_us: &[f64]) -> Option<Self> {
        let statistics = Statistics::of(times_us)?;
        let min = times_us.iter().copied().fold(f64::INFINITY, f64::min);
        Some(Self { median: statistics.median, min, count: statistics.count })
    }
}

/// The answer as JSON has it. `costs` are those at the start, then after every iteration.
fn answer(
    model: &Model,
    summary: &SolverSummary,
    initial_rms: f64,
    times: Option<Times>,
) -> anyhow::Result<impl Serialize> {
    let iterations = summary.iterations.iter().map(|iteration| {
        object! {
            stage: iteration.stage,
            cost: iteration.cost,
            rms: iteration.rms,
            trial_cost: iteration.trial_cost,
            predicted_decrease: iteration.predicted_decrease,
            actual_decrease: iteration.actual_decrease,
            damping: iteration.damping,
            step_norm: iteration.step_norm,
            accepted: iteration.accepted,
        }
    });
    let later = summary.iterations.iter().map(|iteration| iteration.cost);
    let pose: Value =
        serde_json::from_str(&pose_file::to_text(model, &summary.pose)).context("the fitted pose")?;
    Ok(object! {
        initial_cost: summary.initial_cost,
        initial_rms: initial_rms,
        cost: summary.final_cost,
        rms: summary.final_rms,
        costs: std::iter::once(summary.initial_cost).chain(later).collect::<Vec<_>>(),
        iterations: iterations.collect::<Vec<_>>(),
        termination: object! {
            reason: summary.termination.name(),
            words: ending_text(summary.termination),
        },
        empty_cameras: summary.empty_cameras.clone(),
        pose: pose,
        #[serde(flatten)]
        times: times.map(|times| object! { us_per_iteration: times }),
    })
}

/// The answer for people: a line a stage.
fn text(summary: &SolverSummary, start_cost: f64, start_rms: f64, times: Option<Times>) -> String {
    let mut table = Table::new(["stage", "iterations", "rejected", "cost", "rms"]);
    let row = |name: &str, iterations: String, rejected: String, cost: f64, rms: f64| {
        [name.to_owned(), iterations, rejected, format!("{cost:.0}"), format!("{rms:.2}")]
    };
    table.row(row("start", String::new(), String::new(), start_cost, start_rms));
    for stage in summary.iterations.chunk_by(|a, b| a.stage == b.stage) {
        let Some(last) = stage.last() else { continue };
        let rejected = stage.iter().filter(|record| !record.accepted).count();
        let name = (last.stage + 1).to_string();
        table.row(row(&name, stage.len().to_string(), rejected.to_string(), last.cost, last.rms));
    }
    let mut out = table.to_text();
    out.push_str("cost in squared grey levels, rms in grey levels a pixel; each stage has its own measure\n");
    out.push_str(&format!("Stopped: {}.\n", ending_text(summary.termination)));
    if !summary.empty_cameras.is_empty() {
        out.push_str(&format!(
            "Left out because they see no subject: {}.\n",
            summary.empty_cameras.join(", ")
        ));
    }
    if let Some(Times { median, min, count }) = times {
        out.push_str(&format!(
            "Time of an iteration: median {median:.0} µs, least {min:.0} µs, of {count}.\n"
        ));
    }
    out
}
