//! Joints of a track as the recognizer reads them.

use backlit_formats::motion::JointTrack;
use backlit_recognition::{JointMotion, MotionError};
use glam::DVec3;

/// The frames of a track that are given, as a motion. `up` counts where the track does not say which way is up.
///
/// # Errors
/// A joint is missing, or the frames are too few; see [`MotionError`].
pub fn motion_of(
    track: &JointTrack,
    frames: &[(usize, Vec<DVec3>)],
    up: DVec3,
) -> Result<JointMotion, MotionError> {
    let frames = frames.iter().map(|(frame, positions)| (*frame, &positions[..]));
    JointMotion::from_named(&track.joints, track.frame_rate, track.up.unwrap_or(up), frames)
}
