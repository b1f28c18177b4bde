//! Motions by name: joints of a track for the recognizer, and what it was learnt from.

use std::path::Path;

use anyhow::Context;
use backlit_formats::motion::JointTrack;
use backlit_formats::{DiskFiles, MAX_TEXT_BYTES, TakeFiles};
use backlit_recognition::{JointMotion, MotionError, Recognizer};
use glam::DVec3;

/// The frames of a track that are given, as a motion. `up` counts where the track does not say which way is up.
///
/// # Errors
/// Returns an error if a joint is missing or the frames are too few; see [`MotionError`].
pub fn joint_motion(
    track: &JointTrack,
    frames: &[(usize, Vec<DVec3>)],
    up: DVec3,
) -> Result<JointMotion, MotionError> {
    let frames = frames.iter().map(|(frame, positions)| (*frame, &positions[..]));
    JointMotion::from_named(&track.joints, track.frame_rate, track.up.unwrap_or(up), frames)
}

/// Reads a file of `backlit recognise --train`; without a file, what comes with the program.
///
/// # Errors
/// Returns an error that names the file, and the line or field, if it cannot be read.
pub fn read_recognizer(file: Option<&Path>) -> anyhow::Result<Recognizer> {
    let Some(path) = file else { return Ok(Recognizer::built_in()) };
    let bytes = DiskFiles.read(path, MAX_TEXT_BYTES)?;
    let text = String::from_utf8(bytes).with_context(|| format!("{}: is not UTF-8 text", path.display()))?;
    Recognizer::from_text(&text).with_context(|| path.display().to_string())
}
