//! `backlit experiment fig5.5` and `fig5.6`: a body followed through a sequence.

use backlit_lab::experiment::Simulation;
use backlit_lab::experiment::fig55::{self, FRAMES, Options, Report, Way, WayReport};
use backlit_lab::experiment::looks::Look;
use backlit_lab::experiment::sequence::Sequence;
use backlit_plot::{Axis, Drawn, Figure, Line, Sheet};
use backlit_tracking::cancel::CancelToken;
use clap::Args;

use super::arguments::{OutputArguments, StartArguments};
use super::files;
use super::sequence::{Conditions, SequenceArguments, legend, rows, short_name};
use super::waiting::Waiting;
use crate::table::Table;

/// What `backlit experiment fig5.5` and `fig5.6` are told.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    sequence: SequenceArguments,
    /// Frames of the sequence, from its first
    #[arg(long, value_name = "N", default_value_t = 50)]
    frames: usize,
    #[command(flatten)]
    start: StartArguments,
    #[command(flatten)]
    output: OutputArguments,
}

/// Runs the experiment on pictures of this size, writes and prints.
///
/// # Errors
/// Options that make no sense, or files that cannot be read or written.
pub(crate) fn run(arguments: &Arguments, name: &str, size_px: [u64; 2]) -> anyhow::Result<()> {
    let sequence = arguments.sequence.sequence(size_px, arguments.frames)?;
    let mut options = Options { seed: arguments.start.seed, ..Options::default() };
    options.ways = arguments.sequence.smoothed(options.ways);
    (options.starts, options.angle_rad, options.distance_m) =
        arguments.start.or(options.starts, options.angle_rad, options.distance_m);
    let report = fig55::run(&options, &sequence, &CancelToken::new(), Waiting::new().listener())?;
    let conditions = Conditions::of(&options, &sequence);
    let words = format!(
        "{}; medians of {} starts {:.0}° and {:.0} cm off",
        conditions.text(),
        options.starts,
        options.angle_rad.to_degrees(),
        100.0 * options.distance_m
    );
    let mut drawn = vec![(format!("{name}-overlap"), Drawn::Figure(overlap_figure(&report, &words)))];
    if report.ways.iter().any(|way| way.joint_error_mm.is_some()) {
        drawn.insert(0, (format!("{name}-joints"), Drawn::Figure(joint_figure(&report, &words))));
    }
    let presets = options.ways.iter().filter(|way| way.simulation == Simulation::Mask).take(2);
    for way in presets {
        if let Some(found) = report.ways.iter().find(|found| found.name == way.name) {
            let sheet = sheet(&sequence, way, found, &conditions);
            drawn.push((format!("{name}-{}", short_name(&way.name)), Drawn::Sheet(sheet)));
        }
    }
    files::finish(&arguments.output, name, &conditions, &report, &drawn, &table(&report))
}

/// D and Λ of both cameras in the frames that the report shows, from the first start.
fn sheet(sequence: &Sequence, way: &Way, found: &WayReport, conditions: &Conditions<'_, Options>) -> Sheet {
    let (mut columns, mut looks) = (Vec::new(), Vec::new());
    let poses = found.sequences.first().map(|first| first.poses.as_slice()).unwrap_or_default();
    for frame in FRAMES {
        let (Some(pose), Some(moment)) = (poses.get(frame), sequence.moments.get(frame)) else { continue };
        let error = moment.joint_error_mm(&sequence.model, pose);
        let error = error.map_or_else(String::new, |mm| format!(", {mm:.0} mm"));
        columns.push(format!("frame {}{error}", frame + 1));
        looks.push(Look::at_the_end(&sequence.model, pose, &moment.views, &way.fit));
    }
    Sheet {
        title: format!("A sequence followed: {}", way.name),
        subtitle: conditions.text() + legend(&looks),
        columns,
        rows: rows(&conditions.cameras, &looks),
    }
}

fn table(report: &Report) -> String {
    let mut table =
        Table::new(["fit", "joint error, mm: mean", "median", "95 %", "max", "IoU", "lost frames"]);
    for way in &report.ways {
        let spread = way.joint_error_mm.map(|all| [all.mean, all.median, all.p95, all.max]);
        let error =
            |index: usize| spread.map_or_else(|| "–".to_owned(), |spread| format!("{:.1}", spread[index]));
        let count = way.median_iou.len().max(1) as f64;
        table.row([
            way.name.clone(),
            error(0),
            error(1),
            error(2),
            error(3),
            format!("{:.3}", way.median_iou.iter().sum::<f64>() / count),
            way.lost.to_string(),
        ]);
    }
    table.to_text()
}

fn lines(report: &Report, values: impl Fn(&WayReport) -> &[f64]) -> Vec<Line> {
    let ways = report.ways.iter().enumerate();
    ways.map(|(style, way)| Line::of_values(&way.name, style, values(way))).collect()
}

fn joint_figure(report: &Report, conditions: &str) -> Figure {
    Figure {
        title: "A sequence followed: joint error per frame".to_owned(),
        subtitle: conditions.to_owned(),
        x: Axis::linear("frame"),
        y: Axis::log("mean joint error, mm"),
        lines: lines(report, |way| &way.median_joint_error_mm),
    }
}

fn overlap_figure(report: &Report, conditions: &str) -> Figure {
    Figure {
        title: "A sequence followed: overlap per frame".to_owned(),
        subtitle: conditions.to_owned(),
        x: Axis::linear("frame"),
        y: Axis::linear("intersection over union"),
        lines: lines(report, |way| &way.median_iou),
    }
}
