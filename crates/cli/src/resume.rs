//! `backlit track --resume`: what an earlier run has tracked, and where it goes on.

use anyhow::{Context, bail, ensure};
use backlit_formats::Take;
use backlit_formats::export::track_read::WrittenTrack;
use backlit_tracking::body::Pose;

use super::own_body::Begun;
use super::track::TrackArguments;
use super::track_files;

/// A track that was stopped.
#[derive(Debug)]
pub(crate) struct Earlier {
    pub(crate) written: WrittenTrack,
    /// What was found before it began.
    pub(crate) begun: Option<Begun>,
}

impl Earlier {
    /// Reads it from the folder of the results.
    ///
    /// # Errors
    /// There is none, it cannot be read, or options with which nothing can go on.
    pub(crate) fn read(arguments: &TrackArguments) -> anyhow::Result<Self> {
        if arguments.follow.is_kalman() {
            bail!(
                "--resume is not for --motion kalman or smoothed: what the filter believes of the last frame is not in \
                 track.json"
            );
        }
        let folder = &arguments.out;
        let path = folder.join("track.json");
        let written = track_files::read(&path, arguments.model.as_deref()).context("--resume")?;
        ensure!(!written.track.frames.is_empty(), "--resume: {} has no frame to go on from", path.display());
        Ok(Self { written, begun: track_files::begun(folder) })
    }

    /// The frames that it has not tracked, of those that are wanted.
    ///
    /// # Errors
    /// It is of another take, other cameras, or other frames.
    pub(crate) fn frames_left<'a>(
        &self,
        take: &Take,
        cameras: &[usize],
        frames: &'a [usize],
    ) -> anyhow::Result<&'a [usize]> {
        let written = &self.written;
        let names = cameras.iter().map(|&camera| take.rig().cameras()[camera].name());
        let (name, rate) = (take.name(), take.frame_rate());
        ensure!(
            written.name == name && written.frame_rate == rate,
            "--resume: the track is of \"{}\" with {} frames a second; expected \"{name}\" with {rate}",
            written.name,
            written.frame_rate
        );
        let names: Vec<&str> = names.collect();
        ensure!(
            written.cameras == names,
            "--resume: the track is of the cameras {}; expected {}",
            written.cameras.join(", "),
            names.join(", ")
        );
        let done = written.track.frames.len();
        ensure!(
            done <= frames.len() && written.track.frames.keys().eq(&frames[..done]),
            "--resume: the track is not of the first {done} of these frames; expected the same --frames"
        );
        Ok(&frames[done..])
    }

    /// The pose of its last frame.
    pub(crate) fn last_pose(&self) -> Pose {
        let last = self.written.track.frames.values().next_back();
        last.map_or_else(|| Pose::rest(&self.written.model), |last| last.pose.clone())
    }
}
