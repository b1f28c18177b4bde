//! `backlit experiment sizes`: the sizes of people of several builds, from hard silhouettes; with `--widened` from a track
//! with the average body through silhouettes that are too wide, and what the track with these sizes is worth.

use backlit_lab::experiment::own_sizes::{self, BodyReport, Case};
use backlit_lab::experiment::sizes::{self, Options, PersonReport, Report};
use backlit_plot::Figure;
use backlit_tracking::body::SizeKind;
use backlit_tracking::cancel::CancelToken;
use clap::Args;

use super::arguments::OutputArguments;
use super::files;
use super::waiting::Waiting;
use crate::table::Table;

/// What `backlit experiment sizes` is told.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Moments of the built-in movement (its frames, 0 to 59) to look at
    #[arg(long, value_name = "K,…", value_delimiter = ',')]
    moments: Option<Vec<f64>>,
    /// Seed of the poses that the fits begin with
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Find sizes from a track with the average body instead, through silhouettes that are too wide by so many per cent of
    /// the person's breadth, and track with them: four cameras around, and two phones
    #[arg(long, value_name = "PERCENT,…", value_delimiter = ',', value_parser = percent)]
    widened: Option<Vec<f64>>,
    /// With --widened: only every Nth frame of the movement is seen
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=20))]
    every: u32,
    #[command(flatten)]
    output: OutputArguments,
}

/// 0 to 50 %, as a share.
fn percent(text: &str) -> anyhow::Result<f64> {
    match text.parse::<f64>() {
        Ok(percent) if (0.0..=50.0).contains(&percent) => Ok(percent / 100.0),
        _ => anyhow::bail!("expected per cent from 0 to 50"),
    }
}

/// Its table says all.
const NO_PLOTS: [(String, Figure); 0] = [];

/// Runs the experiment, writes and prints.
///
/// # Errors
/// Options that make no sense, or files that cannot be written.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    if let Some(widened) = &arguments.widened {
        return run_widened(arguments, widened);
    }
    let defaults = Options::default();
    let moments = arguments.moments.clone().unwrap_or(defaults.moments);
    let options = Options { moments, seed: arguments.seed, ..Options::default() };
    let report = sizes::run(&options, &CancelToken::new(), Waiting::new().listener())?;
    files::finish(&arguments.output, "sizes", &options, &report, &NO_PLOTS, &table(&report))
}

fn run_widened(arguments: &Arguments, widened: &[f64]) -> anyhow::Result<()> {
    let options = own_sizes::Options {
        widened: widened.to_vec(),
        every: arguments.every as usize,
        seed: arguments.seed,
        ..own_sizes::Options::default()
    };
    let report = own_sizes::run(&options, &CancelToken::new(), Waiting::new().listener())?;
    let table = widened_table(&report);
    files::finish(&arguments.output, "sizes-widened", &options, &report, &NO_PLOTS, &table)
}

fn widened_table(report: &own_sizes::Report) -> String {
    let mut table = Table::new([
        "mm, means of all builds",
        "too wide",
        "lengths: before",
        "now",
        "radii: before",
        "now",
        "girth: before",
        "now",
        "joints: average body",
        "before",
        "now",
        "worst build: average body",
        "before",
        "now",
        "not taken",
    ]);
    for cases in report.groups() {
        let mean = |of: &dyn Fn(&Case) -> f64| cases.iter().map(of).sum::<f64>() / cases.len() as f64;
        let worst = |of: fn(&Case) -> BodyReport| {
            format!("{:.1}", cases.iter().map(|case| of(case).track_mm).fold(0.0, f64::max))
        };
        let mm = |of: &dyn Fn(&Case) -> f64| format!("{:.1}", mean(of));
        let girth = |of: &dyn Fn(&Case) -> f64| format!("{:+.1} %", 100.0 * (mean(of).exp() - 1.0));
        let refused = cases.iter().filter(|case| !case.doubts.is_empty()).count();
        table.row([
            cases[0].setting.label().to_owned(),
            format!("{:.0} %, {:.1} px", 100.0 * cases[0].widened, mean(&|case| case.widened_px)),
            mm(&|case| case.before.length_mm),
            mm(&|case| case.now.length_mm),
            mm(&|case| case.before.radius_mm),
            mm(&|case| case.now.radius_mm),
            girth(&|case| case.before.girth),
            girth(&|case| case.now.girth),
            mm(&|case| case.average.track_mm),
            mm(&|case| case.before.track_mm),
            mm(&|case| case.now.track_mm),
            worst(|case| case.average),
            worst(|case| case.before),
            worst(|case| case.now),
            format!("{refused} of {}", cases.len()),
        ]);
    }
    table.to_text()
        + "\nBefore: a generic prior, silhouettes taken as they are, frames evenly spread, all that is found taken.\n"
}

fn table(report: &Report) -> String {
    let mut table = Table::new([
        "error, mm",
        "lengths: mean",
        "worst seen",
        "worst",
        "radii: mean",
        "worst seen",
        "worst",
        "joints",
        "IoU",
    ]);
    for person in &report.people {
        let worst = |kind, seen_only| {
            person
                .worst(kind, seen_only)
                .map_or_else(|| "–".to_owned(), |size| format!("{:.1} {}", size.error_mm().abs(), size.name))
        };
        let mean = |person: &PersonReport, kind| format!("{:.1}", person.mean_mm(kind));
        table.row([
            person.name.to_owned(),
            mean(person, SizeKind::Length),
            worst(SizeKind::Length, true),
            worst(SizeKind::Length, false),
            mean(person, SizeKind::Radius),
            worst(SizeKind::Radius, true),
            worst(SizeKind::Radius, false),
            format!("{:.1}", person.joint_error_mm),
            person.iou[1].map_or_else(|| "–".to_owned(), |iou| format!("{iou:.3}")),
        ]);
    }
    table.to_text() + "\nSeen: sizes that the fit does not mark as held by the proportions alone.\n"
}
