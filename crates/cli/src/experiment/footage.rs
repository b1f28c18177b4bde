//! `backlit experiment footage`: a take tracked from many starts, and how many of them end at the keypoints.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use anyhow::{Context, bail, ensure};
use backlit_formats::footage::changes::ChangeSurvey;
use backlit_formats::{Footage, FootageError};
use backlit_lab::experiment::disturbed_pictures::PictureDisturbance;
use backlit_runs::changes::change_text;
use backlit_runs::track::{FrameReader, TrackEnding, TrackMessage, TrackRun};
use backlit_runs::track_summary::ErrorSummary;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::cues::FrameCues;
use backlit_tracking::fit::FitView;
use clap::Args;
use image::RgbImage;
use indicatif::ProgressBar;
use serde::Serialize;

use crate::fit_options::{Words, one_of};
use crate::follow_options::FollowArguments;
use crate::numbers::within;
use crate::output::{self, number};
use crate::progress::each_frame;
use crate::table::Table;
use crate::take_options::{self, PartArguments, StartArguments};
use crate::track::{measure_overlaps, take_in};
use crate::track_report::{TrackReport, TrackSummary};

/// A take with keypoints, tracked from many starts: how many stay near the keypoints everywhere
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Take: its folder or its take.toml. It needs reference keypoints
    take: PathBuf,
    /// Another body than the take's, as from fit-body: a file, or a built-in one by name
    #[arg(long, value_name = "MODEL")]
    model: Option<String>,
    /// How many starts: seeds from --seed on [1 to 1000]
    #[arg(long, value_name = "N", default_value_t = 12, value_parser = within(1..=1000_u64))]
    starts: u64,
    /// A start has held if no joint of any frame is farther than this from its keypoint, millimetres [0 to 10000]
    #[arg(long, value_name = "MM", default_value_t = 150.0, value_parser = within(0.0..=10_000.0_f64))]
    within_mm: f64,
    /// What disturbs the pictures of one camera
    #[arg(long, value_name = "WHAT", value_parser = one_of(DISTURBANCES))]
    disturb: Option<PictureDisturbance>,
    /// The number of that camera, from 1 [1 to 64]
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = within(1..=64_usize))]
    disturbed_camera: usize,
    /// The first frame that is disturbed [0 to 999999]
    #[arg(long, value_name = "K", default_value_t = 20, value_parser = within(0..=999_999_usize))]
    disturbed_from: usize,
    /// Backgrounds that change are not learnt again
    #[arg(long)]
    no_relearn: bool,
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

/// Words for what disturbs pictures.
const DISTURBANCES: Words<PictureDisturbance> = &[
    ("standing-limb", "A patch as large as an arm that stands still", PictureDisturbance::StandingLimb),
    ("standing-body", "A patch as large as a body that stands still", PictureDisturbance::StandingBody),
    ("moving-limb", "A patch as large as an arm that goes to and fro", PictureDisturbance::MovingLimb),
    ("moving-body", "A patch as large as a body that goes to and fro", PictureDisturbance::MovingBody),
    ("slow-light", "A lamp at the side grows bright within 100 frames", PictureDisturbance::SlowLight),
    ("sudden-light", "The same lamp is switched on", PictureDisturbance::SuddenLight),
];

/// Reads a take one of whose cameras has disturbed pictures from some frame on.
#[derive(Debug)]
struct DisturbedReader {
    footage: Arc<Footage>,
    cameras: Vec<usize>,
    /// What, which camera, from which frame on.
    disturbance: Option<(PictureDisturbance, usize, usize)>,
}

impl DisturbedReader {
    fn picture(&self, camera: usize, frame: usize) -> Result<RgbImage, FootageError> {
        let mut picture = self.footage.picture(camera, frame)?;
        if let Some((what, disturbed, from)) = self.disturbance
            && disturbed == camera
            && let Some(since) = frame.checked_sub(from)
        {
            what.apply(&mut picture, since);
        }
        Ok(picture)
    }

    /// Learns backgrounds again that change in these frames, and says which.
    fn relearn(&mut self, frames: &[usize]) -> anyhow::Result<()> {
        let (footage, picture) = (&*self.footage, |camera, frame| self.picture(camera, frame));
        let (cameras, measurement) = (&self.cameras, footage.take().measurement());
        let survey = ChangeSurvey { footage, cameras, frames, measurement, picture };
        let found = survey.changes(&CancelToken::new(), |_| {})?.unwrap_or_default();
        let take = self.footage.take();
        found.iter().for_each(|change| output::complain(&change_text(change, take)));
        self.footage = Arc::new(self.footage.with_changes(Arc::new(found)));
        Ok(())
    }
}

impl FrameReader for DisturbedReader {
    type Data = Vec<FitView>;

    fn read(&self, frame: usize) -> Result<Self::Data, FootageError> {
        let mut masks = self.footage.single_masks(&self.cameras, frame)?;
        if let Some((_, camera, from)) = self.disturbance
            && frame >= from
            && let Some(place) = self.cameras.iter().position(|used| *used == camera)
        {
            let picture = self.picture(camera, frame)?;
            let options = &self.footage.take().measurement()[camera];
            masks[place] = self.footage.mask(camera, frame, &picture, options)?;
        }
        Ok(self.footage.supported_views(&self.cameras, frame, masks))
    }

    fn views(&self, frame: &Self::Data) -> Vec<FitView> {
        frame.clone()
    }

    fn cues(&self, _: &Self::Data) -> Result<FrameCues, FootageError> {
        Ok(FrameCues::default())
    }
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
        let (disturbed, from) = (self.disturbed_camera - 1, self.disturbed_from);
        ensure!(
            self.disturb.is_none() || cameras.contains(&disturbed),
            "--disturbed-camera {}: expected one of the cameras that are used",
            disturbed + 1
        );
        let disturbance = self.disturb.map(|what| (what, disturbed, from));
        let mut reader = DisturbedReader { footage: footage.clone(), cameras, disturbance };
        if !self.no_relearn {
            reader.relearn(&frames)?;
        }
        let reader = Arc::new(reader);
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
            measure_overlaps(&reader, take.model(), &frames, renderer, &mut reports)?;
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
