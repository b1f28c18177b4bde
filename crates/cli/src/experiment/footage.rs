//! `backlit experiment footage`: a take tracked from many starts, and how many of them end at the keypoints.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use anyhow::{Context, bail};
use backlit_runs::track::{TakeReader, TrackEnding, TrackMessage, TrackRun};
use backlit_tracking::cancel::CancelToken;
use clap::Args;
use indicatif::ProgressBar;
use serde::Serialize;

use crate::follow_options::FollowArguments;
use crate::output::{self, number};
use crate::progress::each_frame;
use crate::table::Table;
use crate::take_options::{self, PartArguments, StartArguments};
use crate::track::{measure_overlaps, take_in};
use crate::track_report::{TrackReport, TrackSummary};

/// What `backlit experiment footage` is told.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Take: its folder or its take.toml. It needs reference keypoints
    take: PathBuf,
    /// Another body than the take's, as from fit-body: a file, or a built-in one by name
    #[arg(long, value_name = "MODEL")]
    model: Option<String>,
    /// How many starts: seeds from --seed on
    #[arg(long, value_name = "N", default_value_t = 12, value_parser = clap::value_parser!(u64).range(1..=1000))]
    starts: u64,
    /// A start has held if no joint of any frame is farther than this from its keypoint, millimetres
    #[arg(long, value_name = "MM", default_value_t = 150.0)]
    within_mm: f64,
    #[command(flatten)]
    part: PartArguments,
    #[command(flatten)]
    start: StartArguments,
    #[command(flatten)]
    follow: FollowArguments,
    /// Print the numbers as JSON
    #[arg(long)]
    json: bool,
}

/// All starts together.
#[derive(Debug, Serialize)]
struct Report {
    within_mm: f64,
    held: usize,
    starts: Vec<OneStart>,
}

#[derive(Debug, Serialize)]
struct OneStart {
    seed: u64,
    held: bool,
    track: TrackSummary,
}

/// Runs the experiment and prints. All starts go through the take together, so that each frame is segmented once.
///
/// # Errors
/// A take that cannot be read, or one without reference keypoints.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let smoothing = arguments.follow.smoothing()?;
    let footage = take_options::open_with_model(&arguments.take, arguments.model.as_deref())?;
    let take = footage.take();
    let (frames, cameras) = (arguments.part.frames(take)?, arguments.part.cameras(take)?);
    let reader = Arc::new(TakeReader::of_silhouettes(footage.clone(), cameras));
    let (cancel, mut starts) = (CancelToken::new(), Vec::new());
    for seed in (arguments.start.seed..).take(arguments.starts as usize) {
        let fit = arguments.follow.solver.options()?;
        let start = StartArguments { seed, ..arguments.start.clone() };
        let start = start.pose(&footage, &reader.cameras, frames[0], &fit)?;
        let run = TrackRun::new(reader.clone(), arguments.follow.plan(take, start, &frames)?);
        starts.push((seed, run, TrackReport::new(take, &reader.cameras)));
    }
    let hidden = ProgressBar::hidden();
    each_frame(&reader, &frames, |_, read| {
        for (seed, run, report) in &mut starts {
            let (began, mut failed) = (Instant::now(), None);
            run.step_with(read, &cancel, &mut |message| match message {
                TrackMessage::Done(TrackEnding::Failed { frame, error }) => failed = Some((frame, error)),
                message => take_in(take, message, report, began.elapsed().as_secs_f64() * 1e3, &hidden),
            });
            if let Some((frame, error)) = failed {
                return Err(error).with_context(|| format!("seed {seed}, frame {frame}"));
            }
        }
        Ok(())
    })?;
    if smoothing.is_some() {
        for (_, run, report) in &mut starts {
            run.end(TrackEnding::Whole, &mut |message| take_in(take, message, report, 0.0, &hidden));
            report.not_smoothed.map_or(Ok(()), Err)?;
        }
        let renderer = arguments.follow.solver.options()?.renderer;
        let mut reports: Vec<&mut TrackReport> = starts.iter_mut().map(|(_, _, report)| report).collect();
        measure_overlaps(&reader, &frames, renderer, &mut reports)?;
    }
    let mut report = Report { within_mm: arguments.within_mm, held: 0, starts: Vec::new() };
    for (seed, _, mut track) in starts {
        track.finish(take);
        let Some(errors) = track.errors.overall() else {
            bail!("the take has no reference keypoints in these frames to compare with");
        };
        let held = errors.max <= arguments.within_mm;
        report.held += usize::from(held);
        report.starts.push(OneStart { seed, held, track: track.summary() });
    }
    if arguments.json { output::print_json(&report) } else { output::print(&text(&report)) }
}

fn text(report: &Report) -> String {
    let titles = ["seed", "error, mm: mean", "max", "without offsets", "IoU", "lost", "jitter, mm", "held"];
    let mut table = Table::new(titles);
    for start in &report.starts {
        let errors = start.track.joint_error_mm.as_ref();
        let without = errors.and_then(|errors| errors.without_offsets.as_ref()).map(|errors| errors.mean);
        let (mean, max) = (errors.map(|errors| errors.overall.mean), errors.map(|errors| errors.overall.max));
        let [mean, max, without] = [mean, max, without].map(|mm| number(mm, 1));
        let held = if start.held { "yes" } else { "no" };
        table.row([
            start.seed.to_string(),
            mean,
            max,
            without,
            number(start.track.iou.mean, 3),
            start.track.lost.to_string(),
            number(start.track.jitter_mm, 1),
            held.to_owned(),
        ]);
    }
    let (held, count, within) = (report.held, report.starts.len(), report.within_mm);
    format!("{}\n{held} of {count} starts stay within {within} mm everywhere\n", table.to_text())
}
