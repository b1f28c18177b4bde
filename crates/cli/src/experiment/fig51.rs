//! `backlit experiment fig5.1`: one limb seen from the side, with three renderers.

use backlit_lab::experiment::fig51::{self, Options, Part, Report};
use backlit_plot::{Axis, Figure, Line};
use backlit_tracking::cancel::CancelToken;
use clap::Args;

use super::arguments::{DataWord, OutputArguments};
use super::files;
use crate::table::Table;

/// What `backlit experiment fig5.1` is told.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Distances of the camera, metres; the limb is as large in all pictures
    #[arg(long, value_name = "M,…", value_delimiter = ',', default_values_t = [10.0, 0.8])]
    distance: Vec<f64>,
    /// How far along its axis the limb starts from the truth, metres
    #[arg(long, value_name = "M", default_value_t = 0.1, allow_negative_numbers = true)]
    offset: f64,
    /// What the camera sees
    #[arg(long, value_enum, default_value_t = DataWord::Prediction)]
    data: DataWord,
    #[command(flatten)]
    output: OutputArguments,
}

/// Runs the experiment, writes and prints.
///
/// # Errors
/// Options that make no sense, or files that cannot be written.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let options = Options {
        distances_m: arguments.distance.clone(),
        offset_m: arguments.offset,
        simulation: arguments.data.into(),
        ..Options::default()
    };
    let report = fig51::run(&options, &CancelToken::new(), |_| {})?;
    let figures: Vec<(String, Figure)> =
        report.parts.iter().map(|part| (format!("fig5.1-{}m", part.distance_m), figure(part))).collect();
    files::finish(&arguments.output, "fig5.1", &options, &report, &figures, &table(&report))
}

fn table(report: &Report) -> String {
    let mut table =
        Table::new(["camera, renderer", "start cost", "end cost", "% of start", "joint error, mm"]);
    for part in &report.parts {
        for curve in &part.curves {
            let [start, end] =
                [curve.costs.first(), curve.costs.last()].map(|cost| cost.copied().unwrap_or(0.0));
            table.row([
                format!("{} m, {}", part.distance_m, curve.name),
                format!("{start:.0}"),
                format!("{end:.0}"),
                format!("{:.2}", curve.final_percent()),
                format!("{:.1}", curve.final_joint_error_mm()),
            ]);
        }
    }
    table.to_text()
}

fn figure(part: &Part) -> Figure {
    let lines = part.curves.iter().enumerate();
    Figure {
        title: "One limb seen from the side, started off along its axis".to_owned(),
        subtitle: format!("Report 2004, thesis ramp; the camera is {} m away", part.distance_m),
        x: Axis::linear("iteration"),
        y: Axis::log("cost, % of the start").within(0.01, 150.0),
        lines: lines
            .map(|(style, curve)| Line::of_values(&curve.name, style, &curve.percent_of_start()))
            .collect(),
    }
}
