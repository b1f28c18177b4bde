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
use crate::numbers::within;
use crate::output::{self, number};
use crate::progress::each_frame;
use crate::table::Table;
use crate::take_options::{self, PartArguments, StartArguments};
use crate::track::{measure_overlaps, take_in};
use crate::track_report::{ErrorSummary, TrackReport, TrackSummary};

/// A take with keypoints, tracked from many starts: how many stay near the keypoints everywhere
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Take: its folder or its take.toml. It needs reference keypoints
    take: PathBuf,
    /// Another body than the take's, as from fit-body: a file, or a built-in one by name
    #[arg(long, value_name = "MODEL")]
    model: Option<String>,
    /// How many starts: seeds from --seed on [1 to 1000]
    #[arg(long, value_name = "N", default_value_t = 12, allow_negative_numbers = true, value_parser = within(1..=1000_u64))]
    starts: u64,
    /// A start has held if no joint of any frame is farther than this from its keypoint, millimetres [0 to 10000]
    #[arg(long, value_name = "MM", default_value_t = 150.0, allow_negative_numbers = true, value_parser = within(0.0..=10_000.0_f64))]
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

impl Arguments {
    pub(crate) fn run(self) -> anyhow::Result<()> {
        let report = self.report()?;
        if self.json { output::print_json(&report) } else { output::print(&text(&report)) }
    }

    /// All starts go through the take together, so that each frame is segmented once.
    fn report(&self) -> anyhow::Result<Report> {
        let smoothing = self.follow.smoothing()?;
        let segmentation = self.follow.solver.segmentation();
        let footage = take_options::open_segmented(&self.take, self.model.as_deref(), segmentation)?;
        let take = footage.take();
        let (frames, cameras) = (self.part.frames(take)?, self.part.cameras(take)?);
        let reader = Arc::new(TakeReader::of_silhouettes(footage.clone(), cameras));
        let (cancel, mut starts) = (CancelToken::new(), Vec::new());
        for seed in (self.start.seed..).take(self.starts as usize) {
            let fit = self.follow.solver.options()?;
            let start = StartArguments { seed, ..self.start.clone() };
            let start = start.pose(&footage, &reader.cameras, frames[0], &fit)?;
            let run = TrackRun::new(reader.clone(), self.follow.plan(take, start, &frames)?);
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
            let renderer = self.follow.solver.options()?.renderer;
            let mut reports: Vec<&mut TrackReport> = starts.iter_mut().map(|(_, _, report)| report).collect();
            measure_overlaps(&reader, &frames, renderer, &mut reports)?;
        }
        let mut report = Report { within_mm: self.within_mm, held: 0, starts: Vec::new() };
        for (seed, _, mut track) in starts {
            track.finish(take);
            let Some(errors) = track.errors.overall() else {
                bail!("the take has no reference keypoints in these frames to compare with");
            };
            let held = errors.max <= self.within_mm;
            report.held += usize::from(held);
            report.starts.push(OneStart { seed, held, track: track.summary() });
        }
        Ok(report)
    }
}

fn text(report: &Report) -> String {
    let error = |start: &&OneStart, of: fn(&ErrorSummary) -> Option<f64>| {
        number(start.track.joint_error_mm.as_ref().and_then(of), 1)
    };
    let table = Table::of(
        &report.starts,
        &[
            ("seed", &|start| start.seed.to_string()),
            ("error, mm: mean", &|start| error(start, |errors| Some(errors.overall.mean))),
            ("max", &|start| error(start, |errors| Some(errors.overall.max))),
            ("placed", &|start| error(start, |errors| Some(errors.placed?.mean))),
            ("noise of the reference", &|start| error(start, |errors| errors.reference_noise)),
            ("IoU", &|start| number(start.track.iou.mean, 3)),
            ("lost", &|start| start.track.lost.to_string()),
            ("jitter, mm", &|start| number(start.track.jitter_mm, 1)),
            ("held", &|start| if start.held { "yes" } else { "no" }.to_owned()),
        ],
    );
    let (held, count, within) = (report.held, report.starts.len(), report.within_mm);
    format!("{table}\n{held} of {count} starts stay within {within} mm everywhere\n")
}
