//! The files that `backlit track` writes.

use std::path::Path;

use backlit_formats::export::{TrackExport, tables, track_json};
use backlit_formats::{Take, atomic};

use super::track_report::TrackReport;

/// Writes all files, each whole or not at all.
///
/// # Errors
/// The folder is not writable; the message names the file.
pub(crate) fn write(folder: &Path, take: &Take, report: &TrackReport) -> anyhow::Result<()> {
    let cameras: Vec<&str> = report.cameras().iter().map(String::as_str).collect();
    let export = TrackExport {
        name: take.name(),
        frame_rate: take.frame_rate(),
        model: take.model(),
        cameras: &cameras,
        track: report.track(),
    };
    track_json::write(&folder.join("track.json"), &export)?;
    tables::write_poses(&folder.join("poses.csv"), &export)?;
    tables::write_joints(&folder.join("joints.csv"), &export)?;
    tables::write_frames(&folder.join("frames.csv"), &export)?;
    let summary = serde_json::to_string_pretty(&report.summary())? + "\n";
    atomic::write(&folder.join("summary.json"), summary.as_bytes())?;
    Ok(())
}
