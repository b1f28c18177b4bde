//! What is found of clocks that are off by known times, and how well.

use std::time::Instant;

use backlit_tracking::synchronise::{
    CameraOffset, Recording, Synchronisation, SynchroniseOptions, synchronise,
};
use serde::Serialize;

use crate::output::number;

#[derive(Debug, Serialize)]
pub(super) struct Report {
    pub(super) cases: Vec<Case>,
}

impl Report {
    pub(super) fn markdown(&self) -> String {
        let mut text = "| cameras | what is wrong | told | wrong | error, frames: median | largest | deviation told, frames | \
                        loops, ms | s |\n|---|---|---|---|---|---|---|---|---|\n"
            .to_owned();
        for case in &self.cases {
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

/// One setting with one trouble.
#[derive(Debug, Serialize)]
pub(super) struct Case {
    pub(super) setting: String,
    pub(super) trouble: String,
    pub(super) found: Vec<ClockOffset>,
}

impl Case {
    /// Sizes of the errors, frames, ascending.
    pub(super) fn errors_in_frames(&self) -> Vec<f64> {
        let frames = |found: &ClockOffset| Some((found.error_s? / found.period_s).abs());
        let mut errors: Vec<f64> = self.found.iter().filter_map(frames).collect();
        errors.sort_by(f64::total_cmp);
        errors
    }
}

/// What was found of one camera's clock.
#[derive(Debug, Serialize)]
pub(super) struct ClockOffset {
    trial: usize,
    camera: usize,
    /// How far its clock is ahead of the first one's.
    truth_s: f64,
    /// What was found less that; `None` where nothing was told, for the reason `why`.
    pub(super) error_s: Option<f64>,
    deviation_s: Option<f64>,
    probability: Option<f64>,
    pub(super) why: Option<String>,
    /// A frame of the slowest camera.
    period_s: f64,
    /// Time that it took for all cameras, silhouettes given.
    took_s: f64,
    /// How far pairs contradict one another.
    loop_error_s: Option<f64>,
}

pub(super) fn find_offsets(
    recordings: &[Recording],
    ahead: &[f64],
    period_s: f64,
    trial: usize,
) -> Vec<ClockOffset> {
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
