//! `backlit track --resume`: what an earlier run has tracked, and where it goes on.

use std::path::PathBuf;

use anyhow::{Context, ensure};
use backlit_formats::export::resume_file::{self, Resume};
use backlit_formats::export::track_read::WrittenTrack;
use backlit_formats::{Footage, Take};
use backlit_tracking::body::Pose;
use backlit_tracking::cues::Cue;
use backlit_tracking::track::{KalmanOptions, Tracker};

use super::own_body::Begun;
use super::track::{TrackArguments, wants_pictures};
use super::track_files;
use super::track_report::{Smoothing, TrackReport};

/// A track that was stopped.
#[derive(Debug)]
pub(crate) struct Earlier {
    pub(crate) written: WrittenTrack,
    /// What was found before it began.
    pub(crate) begun: Option<Begun>,
    folder: PathBuf,
    /// What its tracker knew; not read where no frame is left.
    knew: Option<Resume>,
}

impl Earlier {
    /// Reads it from the folder of the results.
    ///
    /// # Errors
    /// There is none, or it cannot be read.
    pub(crate) fn read(arguments: &TrackArguments) -> anyhow::Result<Self> {
        let folder = &arguments.out;
        let path = folder.join("track.json");
        let written = track_files::read(&path, arguments.model.as_deref()).context("--resume")?;
        ensure!(!written.track.frames.is_empty(), "--resume: {} has no frame to go on from", path.display());
        Ok(Self { written, begun: track_files::begun(folder), folder: folder.clone(), knew: None })
    }

    /// Reads what the tracker knew after its last frame.
    ///
    /// # Errors
    /// It is not there or cannot be read, is of another frame, or of a track that was smoothed in another way.
    pub(crate) fn recall(&mut self, smoothing: Option<Smoothing>) -> anyhow::Result<()> {
        let path = self.folder.join(track_files::RESUME);
        let knew = resume_file::read(&path, &self.written.model).context("--resume")?;
        let last = self.written.track.frames.keys().next_back().copied();
        ensure!(
            last == Some(knew.memory.last.frame),
            "--resume: {} is of frame {}; expected the last frame of track.json",
            path.display(),
            knew.memory.last.frame
        );
        let was = knew.smoothing.as_ref().map(|waiting| Smoothing { lag: waiting.lag });
        ensure!(
            was == smoothing,
            "--resume: the track was smoothed in another way; expected the same --motion and --lag"
        );
        self.knew = Some(knew);
        Ok(())
    }

    /// The noise of its Kalman filter, if it had one.
    pub(crate) fn noise(&self) -> Option<KalmanOptions> {
        Some(self.knew.as_ref()?.memory.filter.as_ref()?.noise)
    }

    /// The tracker and the report as they were.
    ///
    /// # Errors
    /// Other options than the earlier track's, or pictures of its last frame that cannot be had.
    pub(crate) fn go_on(
        self,
        footage: &Footage,
        cameras: &[usize],
        cues: &[Cue],
        mut tracker: Tracker,
        report: &mut TrackReport,
    ) -> anyhow::Result<Tracker> {
        let take = footage.take();
        let Some(knew) = self.knew else {
            report.resume(take, self.written.track, None);
            return Ok(tracker);
        };
        let last = knew.memory.last.frame;
        let begins_flow = knew.memory.cues.as_ref().is_some_and(|cues| cues.before.is_some());
        let noise = knew.memory.filter.as_ref().map(|filter| filter.noise);
        report.memory = Some(knew.memory.clone());
        tracker = tracker.with_memory(knew.memory).context("--resume")?;
        if begins_flow && wants_pictures(cues) {
            let views = footage.fit_views(cameras, last)?;
            tracker = tracker.with_pictures_before(&views, footage.cues(cameras, last, true)?);
        }
        report.resume(take, self.written.track, knew.smoothing.zip(noise));
        Ok(tracker)
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
