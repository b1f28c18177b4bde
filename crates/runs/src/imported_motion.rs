//! Motions of files and of our own results on a body.

use std::path::Path;

use backlit_formats::motion::Motion;
use backlit_formats::recording::RecordingOptions;
use backlit_take::motion::{FollowOptions, follow_recording, standing};
use backlit_tracking::body::Model;
use glam::DVec3;

use crate::results::{is_ours, read_tracked};

/// Reads a motion as poses of a body, z up, feet on the floor z = 0, the first frame over the origin; poses of ours keep their body.
///
/// # Errors
/// As [`follow_recording`] and [`read_tracked`].
pub fn read_motion(
    path: &Path,
    reading: &RecordingOptions,
    model: &Model,
    options: FollowOptions,
) -> anyhow::Result<Motion> {
    if is_ours(path) {
        let tracked = read_tracked(path, None)?;
        let up = options.up.or(tracked.up).unwrap_or(DVec3::Z);
        return Ok(standing(tracked.motion, up));
    }
    follow_recording(path, reading, model, options, &mut |_, _| {})
}
