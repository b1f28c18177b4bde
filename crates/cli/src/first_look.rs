//! A take tracked with the robust preset and judged in words, for those who have no display.

use std::path::Path;
use std::sync::Arc;

use backlit_formats::Footage;
use backlit_take::builtin;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::FitOptions;
use backlit_tracking::track::Tracker;

use crate::output;
use crate::take_options::{self, StartArguments};
use crate::track::{Followed, follow};
use crate::track_report::TrackReport;

/// Tracks a take, the built-in one without a path, and prints how well.
///
/// # Errors
/// It cannot be opened, or has nothing that can be tracked.
pub fn print(path: Option<&Path>) -> anyhow::Result<()> {
    let footage = match path {
        Some(path) => take_options::open(path)?,
        None => Footage::new(builtin::open()?),
    };
    output::print(&format!("Tracking \"{}\" with the robust preset.\n\n", footage.take().name()))?;
    output::print(&track(&footage)?.text())
}

/// Tracks all of a take with the robust preset.
fn track(footage: &Footage) -> anyhow::Result<TrackReport> {
    let take = footage.take();
    let frames: Vec<usize> = (0..take.frame_count()).collect();
    let cameras: Vec<usize> = (0..take.rig().count()).collect();
    let start = StartArguments::none().pose(footage, &cameras, 0, &FitOptions::default())?;
    let tracker = Tracker::new(Arc::clone(take.model()), FitOptions::default(), start)?;
    let mut report = TrackReport::new(take, &cameras, None);
    let part = Followed { footage, cameras: &cameras, frames: &frames, cues: &[] };
    follow(part, tracker, &mut report, &CancelToken::new(), |_| Ok(()))?;
    Ok(report)
}
