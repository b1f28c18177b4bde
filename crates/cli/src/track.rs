//! `backlit track`: frame after frame through a take.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use anyhow::{Context, bail};
use backlit_formats::take::BodySizes;
use backlit_formats::{Footage, Take, prior_file};
use backlit_tracking::body::Pose;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::cues::{Cue, CueOptions, FrameCues};
use backlit_tracking::filter::Innovation;
use backlit_tracking::fit::{FitOptions, Preset};
use backlit_tracking::residual::learnt_prior::LearntPrior;
use backlit_tracking::track::{KalmanOptions, Motion, Tracker, WhenToSearch, tune};
use clap::{Args, ValueEnum};

use super::each_frame::each_frame;
use super::fit_options::SolverArguments;
use super::interrupt::{self, Interrupted};
use super::output;
use super::own_body;
use super::reference_options::ReferenceArguments;
use super::resume::Earlier;
use super::take_options::{self, PartArguments, StartArguments};
use super::track_files::Writer;
use super::track_report::{Smoothing, TrackReport};

/// Frames that the filter's noise is estimated from, at most: a filter keeps a third of a megabyte of each.
const TUNED_FRAMES: usize = 600;

const NOTES: &str = "\
Writes to the folder of --out:
  track.json    of every frame: pose, joints (metres, world), cost, overlap, iterations
  poses.csv     the poses as a table
  joints.csv    the positions of the joints as a table: frame,joint,x,y,z
  frames.csv    cost, overlap (IoU) by camera and iterations of every frame
  summary.json  what --json prints
  body.toml     the body, if it is not a built-in one
  resume.json   what --resume goes on from; not there once the take's last frame is tracked

If the take has no start, one is searched for. If the take asks for sizes, as one written by import does, \
the person's own sizes are found first. Joints are named after the limb that ends in them, or root. If the \
take has reference keypoints, joint errors are reported: millimetres between the fitted joint and the \
keypoint. IoU is intersection over union of silhouette and model; unknown pixels do not count. Times are \
from frame to frame, with reading and segmentation.

Examples:
  backlit track TAKE --out results
  backlit track TAKE --out results --reference other_tool.trc
  backlit track TAKE --out results --preset report --cameras cam01,cam03 --frames 10..40
  backlit track TAKE --out results --start reference --start-noise 5deg,3cm --seed 7 --json
  backlit track TAKE --out results --model person.toml --motion smoothed --search
  backlit track TAKE --out results --cues keypoints,flow,stereo
  backlit track TAKE --out results --prior people
  backlit track TAKE --out results --motion kalman --tune
  backlit track TAKE --out results --resume";

/// What `backlit track` is told.
#[derive(Debug, Args)]
#[command(after_help = NOTES)]
pub struct TrackArguments {
    /// Take: its folder or its take.toml
    take: PathBuf,
    /// Folder for the results; made if it is not there
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Go on where an earlier track into the same folder was stopped; give the same options again
    #[arg(long)]
    resume: bool,
    /// Print the summary as JSON
    #[arg(long)]
    json: bool,
    /// Estimate the Kalman filter's noise from these frames first, from 600 at most, then track with it
    #[arg(long)]
    tune: bool,
    /// What else pulls at limbs that the silhouettes do not hold, with commas between: keypoints, flow, stereo
    #[arg(long, value_name = "CUES", value_delimiter = ',', value_parser = cue)]
    cues: Vec<Cue>,
    /// Another body than the take's, as from fit-body: a file, or a built-in one by name
    #[arg(long, value_name = "MODEL")]
    pub(crate) model: Option<String>,
    #[command(flatten)]
    part: PartArguments,
    #[command(flatten)]
    start: StartArguments,
    #[command(flatten)]
    reference: ReferenceArguments,
    #[command(flatten)]
    pub(crate) follow: FollowArguments,
}

/// How frames are followed.
#[derive(Debug, Args)]
pub(crate) struct FollowArguments {
    /// The fit of a frame.
    #[command(flatten)]
    pub(crate) solver: SolverArguments,
    /// Let a prior learnt from motion say which poses are likely: a file of backlit prior, or people, the one that comes
    /// with the program
    #[arg(long, value_name = "FILE")]
    pub(crate) prior: Option<PathBuf>,
    /// How motion is carried from frame to frame [default: velocity, with the report preset still]
    #[arg(long, value_enum)]
    pub(crate) motion: Option<MotionWord>,
    /// The Kalman filter's noise, as --tune prints it: a pixel's deviation (grey levels), accelerations of joints (rad/s^1.5)
    /// and root (m/s^1.5)
    #[arg(long, value_name = "R,TURN,MOVE", value_delimiter = ',')]
    pub(crate) noise: Option<Vec<f64>>,
    /// Smooth every frame by only so many frames after it, as a live track with that delay could
    #[arg(long, value_name = "FRAMES")]
    pub(crate) lag: Option<usize>,
    /// When to look for other poses than the one downhill, in the first frame and after a lost one
    /// [default: poor, with the report preset never]
    #[arg(long, value_enum, value_name = "WHEN", num_args = 0..=1, default_missing_value = "always")]
    pub(crate) search: Option<SearchWord>,
}

impl FollowArguments {
    /// The fit of a frame, with its prior if it has one.
    ///
    /// # Errors
    /// Options that contradict each other, or a prior that cannot be read.
    pub(crate) fn fit(&self) -> anyhow::Result<FitOptions> {
        let mut fit = self.solver.options()?;
        if let Some(path) = &self.prior {
            fit.prior = Some(LearntPrior::new(Arc::new(prior_file::read_or_built_in(path)?)));
        }
        Ok(fit)
    }

    /// A tracker through a take that starts from this pose.
    ///
    /// # Errors
    /// Options that contradict each other.
    pub(crate) fn tracker(&self, take: &Take, start: Pose) -> anyhow::Result<Tracker> {
        self.tracker_with(take, start, self.noise()?)
    }

    /// Whether a Kalman filter follows the motion.
    pub(crate) fn is_kalman(&self) -> bool {
        matches!(self.motion, Some(MotionWord::Kalman | MotionWord::Smoothed))
    }

    /// The Kalman filter's noise.
    fn noise(&self) -> anyhow::Result<KalmanOptions> {
        let default = KalmanOptions::default();
        match self.noise.as_deref() {
            None => Ok(default),
            Some(_) if !self.is_kalman() => bail!("--noise is for --motion kalman or smoothed"),
            Some(&[measurement_deviation, turn_acceleration, move_acceleration]) => {
                Ok(KalmanOptions { measurement_deviation, turn_acceleration, move_acceleration, ..default })
            }
            Some(numbers) => bail!("--noise has {} numbers; expected three: R,TURN,MOVE", numbers.len()),
        }
    }

    fn tracker_with(&self, take: &Take, start: Pose, noise: KalmanOptions) -> anyhow::Result<Tracker> {
        let default = match self.solver.preset {
            Preset::Report => SearchWord::Never,
            Preset::Robust => SearchWord::Poor,
        };
        let tracker = Tracker::new(Arc::clone(take.model()), self.fit()?, start)?;
        let search = self.search.unwrap_or(default).into();
        let motion = match self.motion {
            None => Motion::of_preset(Some(self.solver.preset)),
            Some(MotionWord::Still) => Motion::Still,
            Some(MotionWord::Velocity) => Motion::Velocity,
            Some(MotionWord::Kalman | MotionWord::Smoothed) => Motion::Kalman(noise),
        };
        Ok(tracker.with_motion(motion, take.frame_rate())?.with_search(search))
    }

    /// How later frames smooth earlier ones, if they do.
    ///
    /// # Errors
    /// A lag of what is not smoothed.
    pub(crate) fn smoothing(&self) -> anyhow::Result<Option<Smoothing>> {
        let is_smoothed = self.motion == Some(MotionWord::Smoothed);
        if self.lag.is_some() && !is_smoothed {
            bail!("--lag is for --motion smoothed");
        }
        Ok(is_smoothed.then_some(Smoothing { lag: self.lag }))
    }
}

/// When to look for other poses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum SearchWord {
    /// Never
    Never,
    /// Where the fit overlaps poorly: IoU below 0.9
    Poor,
    /// Always
    Always,
}

impl From<SearchWord> for WhenToSearch {
    fn from(word: SearchWord) -> Self {
        match word {
            SearchWord::Never => Self::Never,
            SearchWord::Poor => Self::WhenPoor,
            SearchWord::Always => Self::Always,
        }
    }
}

/// How motion is carried from frame to frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum MotionWord {
    /// Start from the last pose
    Still,
    /// Start where the motion between the last two frames leads
    Velocity,
    /// Pose and velocity by the iterated extended Kalman filter
    Kalman,
    /// The same, and earlier frames smoothed by later ones at the end
    Smoothed,
}

/// Tracks, writes and prints.
///
/// # Errors
/// A take that cannot be read. What was tracked until then is written.
pub(crate) fn run(arguments: &TrackArguments) -> anyhow::Result<()> {
    let cancel = interrupt::listen()?;
    let smoothing = arguments.follow.smoothing()?;
    let mut earlier = if arguments.resume { Some(Earlier::read(arguments)?) } else { None };
    let mut footage = open(arguments, earlier.as_ref())?;
    let known_notes = footage.take().notes();
    let all_frames = arguments.part.frames(footage.take())?;
    let cameras = arguments.part.cameras(footage.take())?;
    let frames = match &earlier {
        Some(earlier) => earlier.frames_left(footage.take(), &cameras, &all_frames)?,
        None => &all_frames,
    };
    if let Some(earlier) = &mut earlier
        && !frames.is_empty()
    {
        earlier.recall(smoothing)?;
    }
    let fit = arguments.follow.fit()?;
    let (start, begun) = if let Some(earlier) = &earlier {
        (earlier.last_pose(), earlier.begun.clone())
    } else {
        let known = arguments.start.known_pose(footage.take(), frames[0])?;
        own_body::check_silhouettes(&footage, &cameras, frames)?;
        // A body that is named has its sizes.
        let sizes = arguments.model.is_none() && footage.take().sizes() == BodySizes::Fit;
        output::make_folder(&arguments.out)?;
        let (start, body, begun) = own_body::begin(&footage, &cameras, frames, &fit, known, sizes, &cancel)?;
        if let Some(body) = body {
            footage = Footage::new(Take::open_with_model(&arguments.take, body)?);
        }
        (start, Some(begun))
    };
    let take = footage.take();
    let judge = arguments.reference.take(take)?;
    let part = Followed { footage: &footage, cameras: &cameras, frames, cues: &arguments.cues };
    let known = earlier.as_ref().and_then(Earlier::noise);
    let mut tracker = tracker(arguments, part, start, known, &cancel)?;
    let mut report = TrackReport::new(take, &cameras, smoothing);
    if let Some(earlier) = earlier {
        tracker = earlier.go_on(&footage, &cameras, &arguments.cues, tracker, &mut report)?;
    }
    let mut writer = Writer::new(&arguments.out, take);
    let tracked = follow(part, tracker, &mut report, &cancel, |report| {
        writer.now_and_then(report);
        Ok(())
    });
    // What cannot be smoothed or measured, as where the footage is gone, is written as it is.
    let mut smoothed = Ok(());
    if smoothing.is_some() {
        let (done, renderer) = (report.frames(), fit.renderer);
        smoothed = report.smooth(take).map_err(anyhow::Error::from).and_then(|()| {
            each_frame(&footage, &cameras, &done, |frame, views, _| {
                report.measure_overlap(take, frame, &views, renderer);
                Ok(())
            })
        });
    }
    take_options::tell_news(take, &known_notes);
    report.finish(take);
    report.is_partial = tracked.is_err();
    report.begun = begun;
    if let Some(judge) = &judge {
        report.judge(judge);
    }
    if !report.track().frames.is_empty() {
        writer.at_the_end(&report)?;
    }
    if let Err(error) = tracked {
        let (done, all, folder) = (report.track().frames.len(), all_frames.len(), arguments.out.display());
        return Err(match done {
            0 => error,
            _ => error.context(format!("stopped after {done} of {all} frames, which are in {folder}")),
        });
    }
    smoothed.context("what was tracked is written")?;
    if arguments.json { output::print_json(&report.summary()) } else { output::print(&report.text()) }
}

/// The take, with the body of an earlier track if that is gone on with.
///
/// # Errors
/// A take or a body that cannot be read.
fn open(arguments: &TrackArguments, earlier: Option<&Earlier>) -> anyhow::Result<Footage> {
    let Some(earlier) = earlier else {
        return take_options::open_with_model(&arguments.take, arguments.model.as_deref());
    };
    let take = Take::open_with_model(&arguments.take, earlier.written.model.clone())?;
    Ok(Footage::new(take_options::told(take)))
}

/// The tracker that these frames are followed with. Noise that is `known` from an earlier track is not estimated again.
///
/// # Errors
/// Options that contradict each other or the take, or pictures that cannot be had while the noise is tuned.
fn tracker(
    arguments: &TrackArguments,
    part: Followed<'_>,
    start: Pose,
    known: Option<KalmanOptions>,
    cancel: &CancelToken,
) -> anyhow::Result<Tracker> {
    let (follow, take) = (&arguments.follow, part.footage.take());
    let mut noise = known.unwrap_or(follow.noise()?);
    if arguments.tune && !follow.is_kalman() {
        bail!("--tune is for --motion kalman or smoothed");
    }
    if arguments.tune && known.is_none() {
        let tracker = follow.tracker_with(take, start.clone(), noise)?;
        noise = tuned(Followed { cues: &[], ..part }, tracker, noise, cancel)?;
    }
    let tracker = follow.tracker_with(take, start, noise)?;
    if arguments.cues.is_empty() {
        return Ok(tracker);
    }
    if arguments.cues.contains(&Cue::Keypoints) && take.keypoint_order()?.is_none() {
        bail!("--cues keypoints: the take has no keypoints of a body (`keypoints` of its cameras)");
    }
    Ok(tracker.with_cues(CueOptions::default().only(&arguments.cues))?)
}

/// Tracks once to learn by which noise the frames are most likely, and says so.
fn tuned(
    part: Followed<'_>,
    tracker: Tracker,
    noise: KalmanOptions,
    cancel: &CancelToken,
) -> anyhow::Result<KalmanOptions> {
    let mut report = TrackReport::new(part.footage.take(), part.cameras, None).with_beliefs();
    let part = Followed { frames: &part.frames[..part.frames.len().min(TUNED_FRAMES)], ..part };
    follow(part, tracker, &mut report, cancel, |_| Ok(()))?;
    let found =
        tune(report.track(), noise).context("--tune needs ten frames or more that follow one another")?;
    let ratio = |innovation: Innovation| innovation.ratio().unwrap_or(f64::NAN);
    let KalmanOptions { measurement_deviation, turn_acceleration, move_acceleration, .. } = found.noise;
    eprintln!(
        "noise from innovations: --noise {measurement_deviation:.3},{turn_acceleration:.3},{move_acceleration:.3} \
         (mean square of the innovations {:.2}, with the noise that was given {:.2})",
        ratio(found.innovation),
        ratio(found.before)
    );
    Ok(found.noise)
}

/// Which frames of which cameras are followed, and by what besides silhouettes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Followed<'a> {
    pub(crate) footage: &'a Footage,
    /// Indices in the take.
    pub(crate) cameras: &'a [usize],
    pub(crate) frames: &'a [usize],
    /// None: silhouettes alone.
    pub(crate) cues: &'a [Cue],
}

/// Whether any of these cues is one of pictures.
pub(crate) fn wants_pictures(cues: &[Cue]) -> bool {
    cues.iter().any(|cue| *cue != Cue::Keypoints)
}

fn cue(text: &str) -> Result<Cue, &'static str> {
    // Edges were measured to do more harm than good (docs/chapter6.md).
    let offered = [Cue::Keypoints, Cue::Flow, Cue::Stereo];
    offered.into_iter().find(|cue| cue.name() == text).ok_or("expected keypoints, flow or stereo")
}

/// Tracks these frames into a report, with a progress bar on a terminal. While one is fitted, the next is read
/// and segmented; the results do not depend on it.
///
/// # Errors
/// The first picture that cannot be had, what `after_frame` returns, or [`Interrupted`]. The report has what was tracked before.
pub(crate) fn follow(
    part: Followed<'_>,
    mut tracker: Tracker,
    report: &mut TrackReport,
    cancel: &CancelToken,
    mut after_frame: impl FnMut(&TrackReport) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    let Followed { footage, cameras, frames, cues } = part;
    let wants_pictures = wants_pictures(cues);
    let mut began = Instant::now();
    each_frame(footage, cameras, frames, |frame, views, progress| {
        let seen = match cues {
            [] => FrameCues::default(),
            _ => footage.cues(cameras, frame, wants_pictures)?,
        };
        let estimate = tracker
            .track_frame_with_cues(frame, views, seen, cancel)
            .with_context(|| format!("frame {frame}"))?;
        // A frame that was broken off is no frame.
        anyhow::ensure!(!cancel.is_cancelled(), Interrupted);
        report.add(footage.take(), estimate, began.elapsed().as_secs_f64() * 1e3)?;
        report.memory = tracker.memory();
        began = Instant::now();
        progress.set_message(report.progress_text());
        after_frame(report)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_tracked_before_ctrl_c_stays() {
        let take =
            Take::open(&std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/take")).unwrap();
        let start = take.start().unwrap().clone();
        let tracker = Tracker::new(take.model().clone(), FitOptions::default(), start).unwrap();
        let (footage, cancel) = (Footage::new(take), CancelToken::new());
        let mut report = TrackReport::new(footage.take(), &[0, 1], None);
        let frames: Vec<usize> = (0..10).collect();
        let part = Followed { footage: &footage, cameras: &[0, 1], frames: &frames, cues: &[] };
        let error = follow(part, tracker, &mut report, &cancel, |report| {
            if report.track().frames.len() == 3 {
                cancel.cancel();
            }
            Ok(())
        });
        assert!(error.unwrap_err().downcast_ref::<Interrupted>().is_some());
        assert_eq!(report.track().frames.len(), 3);
    }
}
