//! Motions as the recognizer reads them: those of a track, and those of a folder with a labels.csv.

use std::path::Path;

use backlit_formats::motion::{self, JointTrack, MotionLabel};
use backlit_recognition::{JointMotion, NamedMotion};
use glam::DVec3;

pub(crate) type Error = Box<dyn std::error::Error>;

pub(crate) fn motion_of(track: &JointTrack) -> Result<JointMotion, Error> {
    let frames = track.frames.iter().map(|(frame, at)| (*frame, &at[..]));
    Ok(JointMotion::from_named(&track.joints, track.frame_rate, track.up.unwrap_or(DVec3::Z), frames)?)
}

/// The motions of a folder and what its labels.csv calls them, in its order.
pub(crate) fn motions(folder: &Path) -> Result<Vec<NamedMotion>, Error> {
    let read = |label: MotionLabel| {
        let motion = motion_of(&motion::read_joints(&folder.join(&label.file), None)?)?;
        Ok(NamedMotion { name: label.file, class: label.class, subject: label.subject, motion })
    };
    motion::read_labels(&folder.join("labels.csv"))?.into_iter().map(read).collect()
}
