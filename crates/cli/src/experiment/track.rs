//! `backlit experiment track`: a movement followed at several speeds through noisy masks.

use backlit_lab::experiment::track::{self, Options, Report};
use backlit_plot::{Axis, Figure, Line};
use backlit_tracking::cancel::CancelToken;
use clap::{Args, ValueEnum};

use super::arguments::{OutputArguments, StartArguments};
use super::files;
use super::waiting::Waiting;
use crate::table::Table;

/// What `backlit experiment track` is told.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Who moves before which cameras
    #[arg(long, value_enum, default_value_t = MovementWord::UpperBody)]
    movement: MovementWord,
    #[command(flatten)]
    start: StartArguments,
    /// Frames of every track [default: 50; of squats 100]
    #[arg(long, value_name = "N")]
    frames: Option<usize>,
    /// Cameras around the upper body
    #[arg(long, value_name = "N", default_value_t = 2)]
    cameras: usize,
    /// Times the movement's own speed; for squats, only every Nth frame is seen [default: 1,2,3,4; of squats 1,2,4]
    #[arg(long, value_name = "N", value_delimiter = ',')]
    speeds: Option<Vec<usize>>,
    #[command(flatten)]
    output: OutputArguments,
}

/// Who moves before which cameras.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum MovementWord {
    /// The report's upper body, before cameras around it
    UpperBody,
    /// The full body, before two phones 37° apart whose masks are too wide
    Squats,
}

/// Runs the experiment, writes and prints.
///
/// # Errors
/// Options that make no sense, or files that cannot be written.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let defaults = match arguments.movement {
        MovementWord::UpperBody => Options { cameras: arguments.cameras, ..Options::default() },
        MovementWord::Squats => Options::squats(),
    };
    let mut options = Options {
        frames: arguments.frames.unwrap_or(defaults.frames),
        speeds: arguments.speeds.clone().unwrap_or_else(|| defaults.speeds.clone()),
        seed: arguments.start.seed,
        ..defaults
    };
    (options.starts, options.angle_rad, options.distance_m) =
        arguments.start.or(options.starts, options.angle_rad, options.distance_m);
    let report = track::run(&options, &CancelToken::new(), Waiting::new().listener())?;
    let figure = Figure {
        title: match arguments.movement {
            MovementWord::UpperBody => "Upper body followed through noisy masks: worst frame",
            MovementWord::Squats => "Squats followed through masks that are too wide: worst frame",
        }
        .to_owned(),
        subtitle: format!(
            "{} × {} pixels, {} cameras, {} frames of {} starts",
            options.size_px[0], options.size_px[1], options.cameras, options.frames, options.starts
        ),
        x: Axis::linear("times the speed"),
        y: Axis::log("largest joint error of a frame, mm"),
        lines: lines(&report),
    };
    let figures = [("track".to_owned(), figure)];
    files::finish(&arguments.output, "track", &options, &report, &figures, &table(&report))
}

fn lines(report: &Report) -> Vec<Line> {
    let ways = report.ways.iter().enumerate();
    ways.map(|(style, way)| {
        let points = way.speeds.iter().map(|found| [found.speed as f64, found.max_mm]);
        Line::of_points(&way.name, style, points.collect())
    })
    .collect()
}

fn table(report: &Report) -> String {
    let mut table = Table::new(["way", "speed", "joint error, mm: mean", "95 %", "max"]);
    for way in &report.ways {
        for found in &way.speeds {
            table.row([
                way.name.clone(),
                format!("{}×", found.speed),
                format!("{:.2}", found.mean_mm),
                format!("{:.2}", found.p95_mm),
                format!("{:.1}", found.max_mm),
            ]);
        }
    }
    table.to_text()
}
