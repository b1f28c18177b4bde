//! A take whose cameras are synchronous, every other camera of a set shifted by whole frames, and what is found of that from the
//! motion of the silhouettes.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use anyhow::Result;
use backlit_tracking::silhouette::Mask;
use backlit_tracking::synchronise::{
    CameraOffset, Recording, Synchronisation, SynchroniseOptions, synchronise,
};
use clap::Args;
use serde::Serialize;

use super::{Experiment, Run};
use crate::numbers::within;
use crate::output::number;
use crate::take_options;

/// Cameras whose clocks are off by known times, found from the motion of the silhouettes
#[derive(Debug, Args, Serialize)]
pub(crate) struct ShiftedTake {
    /// A take whose cameras are synchronous, to be shifted by whole frames
    take: PathBuf,
    /// Frames that every other camera of a take is shifted by [-100000 to 100000]
    #[arg(long, value_name = "N,…", value_delimiter = ',', default_values_t = [0, 1, 7, -12, 20], allow_hyphen_values = true, value_parser = within(-100_000..=100_000_i64))]
    shifts: Vec<i64>,
}

#[derive(Debug, Serialize)]
pub(crate) struct Report {
    cases: Vec<Case>,
}

/// One set of cameras.
#[derive(Debug, Serialize)]
struct Case {
    setting: String,
    trouble: String,
    found: Vec<ClockOffset>,
}

impl Case {
    /// Sizes of the errors, frames, ascending.
    fn errors_in_frames(&self) -> Vec<f64> {
        let frames = |found: &ClockOffset| Some((found.error_s? / found.period_s).abs());
        let mut errors: Vec<f64> = self.found.iter().filter_map(frames).collect();
        errors.sort_by(f64::total_cmp);
        errors
    }
}

/// What was found of one camera's clock.
#[derive(Debug, Serialize)]
struct ClockOffset {
    trial: usize,
    camera: usize,
    /// How far its clock is ahead of the first one's.
    truth_s: f64,
    /// What was found less that; `None` where nothing was told, for the reason `why`.
    error_s: Option<f64>,
    deviation_s: Option<f64>,
    probability: Option<f64>,
    why: Option<String>,
    /// A frame of the slowest camera.
    period_s: f64,
    /// Time that it took for all cameras, silhouettes given.
    took_s: f64,
    /// How far pairs contradict one another.
    loop_error_s: Option<f64>,
}

impl Experiment for ShiftedTake {
    const NAME: &'static str = "sync";
    type Report = Report;

    fn run(&mut self, run: &Run) -> Result<Report> {
        let footage = take_options::open(&self.take)?;
        let take = footage.take();
        let cameras: Vec<usize> = (0..take.rig().count()).collect();
        let total = take.frame_count();
        let mut masks: Vec<Vec<Arc<Mask>>> = vec![Vec::new(); cameras.len()];
        for frame in 0..total {
            run.progress(frame, total)?;
            for (all, mask) in masks.iter_mut().zip(footage.single_masks(&cameras, frame)?) {
                all.push(Arc::new(mask));
            }
        }
        let period_s = 1.0 / take.frame_rate();
        let pairs = cameras.iter().flat_map(|&a| cameras[a + 1..].iter().map(move |&b| vec![a, b]));
        let mut sets: Vec<Vec<usize>> = pairs.collect();
        if cameras.len() > 2 {
            sets.push(cameras);
        }
        let mut cases = Vec::new();
        for set in sets {
            let mut found = Vec::new();
            for (trial, &shift) in self.shifts.iter().enumerate() {
                // Every other camera began later, or earlier, by the shift.
                let ahead = |at: usize| if at % 2 == 1 { shift as f64 * period_s } else { 0.0 };
                let ahead: Vec<f64> = (0..set.len()).map(ahead).collect();
                let record = |(&camera, ahead): (&usize, &f64)| {
                    let mut recording = Recording::new((*footage.cameras[camera]).clone());
                    for (frame, mask) in masks[camera].iter().enumerate() {
                        recording.push(frame as f64 * period_s + ahead, mask);
                    }
                    recording
                };
                let recordings: Vec<Recording> = set.iter().zip(&ahead).map(record).collect();
                found.append(&mut find_offsets(&recordings, &ahead, period_s, trial));
            }
            let names: Vec<&str> = set.iter().map(|&camera| footage.cameras[camera].name()).collect();
            cases.push(Case { setting: names.join(", "), trouble: "real footage".to_owned(), found });
        }
        Ok(Report { cases })
    }

    fn table(&self, report: &Report) -> String {
        let mut text = "| cameras | what is wrong | told | wrong | error, frames: median | largest | deviation told, frames | \
                        loops, ms | s |\n|---|---|---|---|---|---|---|---|---|\n"
            .to_owned();
        for case in &report.cases {
            let errors = case.errors_in_frames();
            let mut deviations: Vec<f64> =
                case.found.iter().filter_map(|found| Some(found.deviation_s? / found.period_s)).collect();
            deviations.sort_by(f64::total_cmp);
            let loops = case.found.iter().filter_map(|found| found.loop_error_s).reduce(f64::max);
            let took = case.found.iter().map(|found| found.took_s).fold(0.0, f64::max);
            text += &format!(
                "| {} | {} | {} of {} | {} | {} | {} | {} | {} | {took:.2} |\n",
                case.setting,
                case.trouble,
                errors.len(),
                case.found.len(),
                errors.iter().filter(|error| **error > 0.5).count(),
                number(errors.get(errors.len() / 2).copied(), 2),
                number(errors.last().copied(), 2),
                number(deviations.get(deviations.len() / 2).copied(), 2),
                number(loops.map(|error| 1e3 * error), 1),
            );
        }
        text
    }
}

fn find_offsets(recordings: &[Recording], ahead: &[f64], period_s: f64, trial: usize) -> Vec<ClockOffset> {
    let begun = Instant::now();
    let found = synchronise(recordings, &SynchroniseOptions::default());
    let took_s = begun.elapsed().as_secs_f64();
    let found =
        found.unwrap_or(Synchronisation { cameras: Vec::new(), pairs: Vec::new(), loop_error_s: None });
    let told_of = |(camera, offset): (usize, &CameraOffset)| {
        let (told, why) = match offset {
            CameraOffset::Reference => return None,
            CameraOffset::Found(offset) => (Some(*offset), None),
            CameraOffset::Undecided(why) => (None, Some(why.to_string())),
        };
        Some(ClockOffset {
            trial,
            camera,
            truth_s: ahead[camera],
            error_s: told.map(|told| told.seconds - ahead[camera]),
            deviation_s: told.map(|told| told.deviation_s),
            probability: told.map(|told| told.probability),
            why,
            period_s,
            took_s,
            loop_error_s: found.loop_error_s,
        })
    };
    found.cameras.iter().enumerate().filter_map(told_of).collect()
}
