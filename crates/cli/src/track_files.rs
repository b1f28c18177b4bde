//! The files that `backlit track` writes, and those of them that are read again, also by `--resume`.

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::{Context, ensure};
use backlit_formats::export::resume_file::{self, Resume};
use backlit_formats::export::track_read::WrittenTrack;
use backlit_formats::export::{self, TrackExport};
use backlit_formats::{DiskFiles, Take, TakeFiles, json_text, model_file};
pub(crate) use backlit_runs::results::{BODY, path_in, read};
use backlit_runs::track::{EarlierFrames, Smoothing, TakeReader, TrackRun};
use backlit_runs::track_summary::TrackMaking;
use backlit_tracking::body::{Pose, builtin};
use backlit_tracking::track::{FrameEstimate, KalmanOptions, REWOUND_FRAMES};
use serde::Deserialize;

use crate::output;
use crate::person::Begun;
use crate::track_report::TrackReport;

/// What `--resume` goes on from.
const RESUME: &str = "resume.json";
/// What `--json` prints.
pub(crate) const SUMMARY: &str = "summary.json";
/// The longest summary that is read, bytes.
pub(crate) const MAX_SUMMARY: u64 = 1 << 20;

/// Results so far are written this often: nothing is lost if the program is stopped.
const WRITE_EVERY: Duration = Duration::from_secs(5);

/// Writes the results of a track while it goes on and at its end, and loses nothing of them where a disk is full or a folder
/// vanishes.
#[derive(Debug)]
pub(crate) struct Writer<'a> {
    folder: &'a Path,
    take: &'a Take,
    written: Instant,
    is_told: bool,
}

impl<'a> Writer<'a> {
    /// Into a folder; nothing is written yet.
    pub(crate) fn new(folder: &'a Path, take: &'a Take) -> Self {
        Self { folder, take, written: Instant::now(), is_told: false }
    }

    /// Writes what there is if it is time to. What cannot be written is told once; the track goes on.
    pub(crate) fn now_and_then(&mut self, report: &TrackReport, run: &TrackRun<TakeReader>) {
        if self.written.elapsed() <= WRITE_EVERY {
            return;
        }
        if let Err(error) = self.write(report, run.resume_point().as_ref())
            && !self.is_told
        {
            output::complain(&format!("{error:#}; the track goes on, and is written at its end"));
            self.is_told = true;
        }
        self.written = Instant::now();
    }

    /// Writes all files: all of them, or none.
    fn write(&self, report: &TrackReport, resume: Option<&Resume>) -> anyhow::Result<()> {
        let Self { folder, take, .. } = *self;
        output::make_folder(folder)?;
        let cameras: Vec<&str> = report.cameras.iter().map(String::as_str).collect();
        let export = TrackExport {
            name: take.name(),
            frame_rate: take.frame_rate(),
            model: take.model(),
            cameras: &cameras,
            track: &report.track,
        };
        let summary = serde_json::to_string_pretty(&report.summary())? + "\n";
        let mut others = vec![(SUMMARY, summary.as_bytes())];
        let body = model_file::to_text(take.model());
        if builtin::of_name(take.model().name()).is_none_or(|model| model != **take.model()) {
            others.push((BODY, body.as_bytes()));
        }
        // After the take's last frame there is nothing to go on with.
        let has_ended =
            report.track.frames.keys().next_back().is_some_and(|&last| last + 1 >= take.frame_count());
        let resume = resume.filter(|_| !has_ended).map(resume_file::to_text);
        if let Some(resume) = &resume {
            others.push((RESUME, resume.as_bytes()));
        }
        export::write(folder, &export, &others)?;
        if has_ended {
            // One that cannot be removed is refused when it is read: it is of another frame.
            let _ = fs::remove_file(folder.join(RESUME));
        }
        Ok(())
    }

    /// Writes all there is; where that cannot be, into a folder for temporary files.
    pub(crate) fn at_the_end(&self, report: &TrackReport, resume: Option<&Resume>) -> anyhow::Result<()> {
        let Err(error) = self.write(report, resume) else { return Ok(()) };
        let other = std::env::temp_dir().join(format!("backlit-track-{}", std::process::id()));
        let elsewhere = Writer { folder: &other, ..*self };
        Err(match elsewhere.write(report, resume) {
            Ok(()) => error.context(format!("the results are in {}", other.display())),
            Err(_) => error,
        })
    }
}

/// A track that was stopped.
#[derive(Debug)]
pub(crate) struct Earlier {
    pub(crate) written: WrittenTrack,
    /// What was found before it began.
    pub(crate) begun: Option<Begun>,
    /// What its tracker knew; not read where no frame is left.
    resume: Option<Resume>,
}

impl Earlier {
    /// Reads it from the folder of the results.
    pub(crate) fn read(folder: &Path, model: Option<&str>) -> anyhow::Result<Self> {
        let path = folder.join("track.json");
        let written = read(&path, model).context("--resume")?;
        ensure!(!written.track.frames.is_empty(), "--resume: {} has no frame to go on from", path.display());
        Ok(Self { written, begun: begun(folder), resume: None })
    }

    /// Reads what the tracker knew after its last frame.
    pub(crate) fn recall(&mut self, folder: &Path, smoothing: Option<Smoothing>) -> anyhow::Result<()> {
        let path = folder.join(RESUME);
        let resume = resume_file::read(&path, &self.written.model).context("--resume")?;
        let last = self.written.track.frames.keys().next_back().copied();
        ensure!(
            last == Some(resume.memory.last.frame),
            "--resume: {} is of frame {}; expected the last frame of track.json",
            path.display(),
            resume.memory.last.frame
        );
        let was = resume.smoothing.as_ref().map(|waiting| Smoothing { lag: waiting.lag });
        ensure!(
            was == smoothing,
            "--resume: the track was smoothed in another way; expected the same --motion and --lag"
        );
        self.resume = Some(resume);
        Ok(())
    }

    /// The noise of its Kalman filter, if it had one.
    pub(crate) fn noise(&self) -> Option<KalmanOptions> {
        Some(self.resume.as_ref()?.memory.filter.as_ref()?.noise)
    }

    /// The run and the report as they were.
    pub(crate) fn go_on(
        self,
        take: &Take,
        run: TrackRun<TakeReader>,
        report: &mut TrackReport,
    ) -> anyhow::Result<TrackRun<TakeReader>> {
        let mut track = self.written.track;
        let Some(Resume { memory, smoothing, rewind }) = self.resume else {
            track.frames.into_values().for_each(|estimate| report.keep(take, estimate));
            return Ok(run);
        };
        let waiting = smoothing.into_iter().flat_map(|smoothing| smoothing.frames).map(|waiting| {
            let known = track.frames.remove(&waiting.frame);
            let known = known.unwrap_or_else(|| FrameEstimate::of_pose(waiting.frame, waiting.pose.clone()));
            (known, waiting)
        });
        let waiting: Vec<_> = waiting.collect();
        for (known, waiting) in &waiting {
            let newest = FrameEstimate { pose: waiting.pose.clone(), ..known.clone() };
            report.track.frames.insert(newest.frame, newest);
        }
        let newest = track.frames.values().rev().take(REWOUND_FRAMES).rev();
        let recent = newest.map(|one| (one.frame, one.pose.clone())).collect();
        track.frames.into_values().for_each(|estimate| report.keep(take, estimate));
        run.resuming(EarlierFrames { memory, waiting, recent, rewind }).context("--resume")
    }

    /// The frames that it has not tracked, of those that are wanted.
    pub(crate) fn frames_left<'a>(
        &self,
        take: &Take,
        cameras: &[usize],
        frames: &'a [usize],
    ) -> anyhow::Result<&'a [usize]> {
        let written = &self.written;
        let (name, rate) = (take.name(), take.frame_rate());
        ensure!(
            written.name == name && written.frame_rate == rate,
            "--resume: the track is of \"{}\" with {} frames a second; expected \"{name}\" with {rate}",
            written.name,
            written.frame_rate
        );
        let names: Vec<&str> = cameras.iter().map(|&camera| take.rig().cameras()[camera].name()).collect();
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

    pub(crate) fn last_pose(&self) -> Pose {
        let last = self.written.track.frames.values().next_back();
        last.map_or_else(|| Pose::rest(&self.written.model), |last| last.pose.clone())
    }
}

/// What was found before an earlier track into this folder began.
fn begun(folder: &Path) -> Option<Begun> {
    #[derive(Deserialize)]
    struct OfBegun {
        begun: Option<Begun>,
    }
    let path = folder.join(SUMMARY);
    let bytes = DiskFiles.read(&path, MAX_SUMMARY).ok()?;
    json_text::parse_bytes::<OfBegun>(&path, &bytes).ok()?.begun
}

/// How the track was made, from the summary beside it; nothing where there is none.
pub(crate) fn making(track: &Path) -> TrackMaking {
    #[derive(Deserialize)]
    struct OfMaking {
        made: Option<TrackMaking>,
    }
    let path = track.with_file_name(SUMMARY);
    let bytes = DiskFiles.read(&path, MAX_SUMMARY).ok();
    let read = bytes.and_then(|bytes| json_text::parse_bytes::<OfMaking>(&path, &bytes).ok());
    read.and_then(|read| read.made).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use backlit_tracking::track::FrameEstimate;

    /// A folder that has vanished is made again; where none can be, the results are elsewhere, and that is said.
    #[test]
    fn results_are_not_lost_with_their_folder() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/take");
        let take = Take::open(&path).unwrap();
        let mut report = TrackReport::new(&take, &[0]);
        let estimate =
            FrameEstimate { overlap: vec![None], ..FrameEstimate::of_pose(0, take.start().unwrap().clone()) };
        report.add(&take, estimate, true, 1.0);
        let folder = std::env::temp_dir().join(format!("backlit-vanished-{}", std::process::id()));
        let out = folder.join("results");
        Writer::new(&out, &take).at_the_end(&report, None).unwrap();
        fs::remove_dir_all(&folder).unwrap();
        Writer::new(&out, &take).at_the_end(&report, None).unwrap();
        assert!(out.join("track.json").is_file());

        let error = Writer::new(&out.join("track.json"), &take).at_the_end(&report, None).unwrap_err();
        let message = format!("{error:#}");
        let elsewhere = message.strip_prefix("the results are in ").unwrap().split(':').next().unwrap();
        assert!(message.contains("track.json"), "{message}");
        let again = read(Path::new(elsewhere), None).unwrap();
        assert_eq!(again.track.frames.len(), 1);
        fs::remove_dir_all(elsewhere).unwrap();
        fs::remove_dir_all(&folder).unwrap();
    }
}
