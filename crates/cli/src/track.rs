//! `backlit track`: frame after frame through a take.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use anyhow::{Context, bail};
use backlit_formats::take::BodySizes;
use backlit_formats::{Footage, Take};
use backlit_runs::person::PersonSearch;
use backlit_runs::track::{
    FrameReader, Smoothing, TakeReader, TrackEnding, TrackError, TrackMessage, TrackPlan, TrackRun,
};
use backlit_runs::track_summary::TrackMaking;
use backlit_take::builtin;
use backlit_tracking::body::{Model, Pose};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::cues::Cue;
use backlit_tracking::filter::Innovation;
use backlit_tracking::fit::FitOptions;
use backlit_tracking::render::RendererKind;
use backlit_tracking::track::{FrameEstimate, KalmanOptions, Motion};
use clap::Args;
use indicatif::ProgressBar;

use crate::follow_options::FollowArguments;
use crate::interrupt::{self, Interrupted};
use crate::numbers::within;
use crate::person::PersonArguments;
use crate::program::Doubtful;
use crate::relearn::{RelearnArguments, changes_text};
use crate::take_options::{self, PartArguments, ReferenceArguments, StartArguments};
use crate::track_files::{Earlier, Writer};
use crate::track_people::Whom;
use crate::track_report::TrackReport;
use crate::{output, person, progress, track_people};

const AFTER_HELP: &str = "\
Writes to the folder of --out:
  track.json    of every frame: pose, joints (metres, world), cost, overlap, iterations
  poses.csv     the poses as a table
  joints.csv    the positions of the joints as a table: frame,joint,x,y,z
  frames.csv    of every frame: cost, overlap (IoU) by camera, iterations, limbs that are doubtful or wrong
  summary.json  what --json prints
  body.toml     the body, if it is not a built-in one
  resume.json   what --resume goes on from; not there once the take's last frame is tracked

If the take has no start, one is searched for. If the take asks for sizes, as one written by import does, \
the person's own sizes are found first. Joints are named after the limb that ends in them, or root. If the \
take has reference keypoints, joint errors are reported: millimetres between the fitted joint and the \
keypoint; then without what their markers are defined otherwise (placed), and how far the keypoints themselves \
scatter, from distances that cannot vary. IoU is intersection over union of silhouette and model; unknown pixels do not count. Times are \
from frame to frame, with reading and segmentation.

Examples:
  backlit track TAKE --out results
  backlit track TAKE --out results --reference other_tool.trc
  backlit track TAKE --out results --frames 0..300 --learn-placement openpose.json --tool BODY_25
  backlit track TAKE --out results --frames 300.. --placement openpose.json
  backlit track TAKE --out results --preset report --cameras cam01,cam03 --frames 10..40
  backlit track TAKE --out results --start reference --start-noise 5deg,3cm --seed 7 --json
  backlit track TAKE --out results --model person.toml --motion smoothed --search
  backlit track TAKE --out results --cues keypoints,flow,stereo
  backlit track TAKE --out results --prior people
  backlit track TAKE --out results --motion kalman --tune
  backlit track TAKE --out results --people 2
  backlit track TAKE --out results --resume";

/// What `backlit track` is told.
#[derive(Debug, Args)]
#[command(after_help = AFTER_HELP)]
pub struct TrackArguments {
    /// Take: its folder, its take.toml, or a project about it
    pub(crate) take: PathBuf,
    /// Folder for the results; made if it is not there
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Track several people, each into a folder of its own, person-1 and so on: 1 is who is in view longest. Needs three cameras
    /// or more [2 to 20]
    #[arg(long, value_name = "N", conflicts_with_all = ["person", "resume", "reference", "learn_placement"], value_parser = within(2..=20_usize))]
    people: Option<usize>,
    /// Go on where an earlier track into the same folder was stopped; give the same options again
    #[arg(long)]
    resume: bool,
    /// Exit with 3 where a frame is lost, or a limb is doubtful in more than a tenth of the frames; the track is written all the same
    #[arg(long)]
    strict: bool,
    /// Print the summary as JSON
    #[arg(long)]
    pub(crate) json: bool,
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
    pub(crate) part: PartArguments,
    #[command(flatten)]
    person: PersonArguments,
    #[command(flatten)]
    pub(crate) relearn: RelearnArguments,
    #[command(flatten)]
    pub(crate) start: StartArguments,
    #[command(flatten)]
    reference: ReferenceArguments,
    #[command(flatten)]
    pub(crate) follow: FollowArguments,
}

pub(crate) fn run(arguments: &TrackArguments) -> anyhow::Result<()> {
    let cancel = interrupt::listen()?;
    if let Some(count) = arguments.people {
        return track_people::run(arguments, count, &cancel);
    }
    let earlier = match arguments.resume {
        true => Some(Earlier::read(&arguments.out, arguments.model.as_deref())?),
        false => None,
    };
    let footage = open(arguments, earlier.as_ref())?;
    let frames = arguments.part.frames(footage.take())?;
    let cameras = arguments.part.cameras(footage.take())?;
    let footage = arguments.person.follow(footage, &cameras, &frames, &cancel)?;
    let footage = arguments.relearn.learn(footage, (&cameras, &frames), &cancel)?;
    let start = match earlier {
        Some(_) => None,
        None => arguments.start.known_pose(footage.take(), frames[0])?,
    };
    let whom = Whom { footage, frames, start, found: None, out: &arguments.out };
    let (report, _) = track(arguments, whom, earlier, &cancel)?;
    output::print_result(arguments.json, &report.summary(), || report.text())?;
    let doubtful = if arguments.strict { report.summary().doubtful } else { None };
    doubtful.map_or(Ok(()), |why| Err(Doubtful(why).into()))
}

/// Tracks one person, and writes the files. Returns what came of it, and the person's body.
pub(crate) fn track(
    arguments: &TrackArguments,
    whom: Whom<'_>,
    earlier: Option<Earlier>,
    cancel: &CancelToken,
) -> anyhow::Result<(TrackReport, Arc<Model>)> {
    let smoothing = arguments.follow.smoothing()?;
    let known_notes = whom.footage.take().notes();
    let (all_frames, out) = (whom.frames.clone(), whom.out);
    let inputs = TrackInputs::new(arguments, whom, &all_frames, earlier, smoothing, cancel)?;
    let TrackInputs { reader, frames, start, begun, earlier } = inputs;
    let take = reader.footage.take();
    let judge = arguments.reference.take(take)?;
    let known = earlier.as_ref().and_then(Earlier::noise);
    let plan = plan(arguments, &reader, start, frames, known, cancel)?;
    let renderer = plan.fit.renderer;
    let mut report = TrackReport::new(take, &reader.cameras);
    report.background_changes = changes_text(&reader.footage);
    report.made = Some(TrackMaking {
        take: output::in_full(&arguments.take),
        command: output::command_line(),
        settings: plan.settings(),
    });
    let mut run = TrackRun::new(reader.clone(), plan).remembering();
    if let Some(earlier) = earlier {
        run = earlier.go_on(take, run, &mut report)?;
    }
    let mut writer = Writer::new(out, take);
    let tracked = follow(take, &mut run, frames.len(), &mut report, cancel, |run, report| {
        writer.now_and_then(report, run);
    });
    // What cannot be smoothed or measured, as where the footage is gone, is written as it is.
    let mut smoothed = report.not_smoothed.map_or(Ok(()), |error| Err(error.into()));
    if smoothing.is_some() && smoothed.is_ok() {
        let done: Vec<usize> = report.track.frames.keys().copied().collect();
        let silhouettes = TakeReader::of_silhouettes(reader.footage.clone(), reader.cameras.clone());
        smoothed =
            measure_overlaps(&Arc::new(silhouettes), take.model(), &done, renderer, &mut [&mut report]);
    }
    take_options::show_new_notes(take, &known_notes);
    report.finish(take);
    report.is_partial = tracked.is_err();
    report.begun = begun;
    if let Some(judge) = &judge {
        report.judge(judge);
    }
    let done = report.track.frames.len();
    if done > 0 {
        writer.at_the_end(&report, run.resume_point().as_ref())?;
    }
    if let Err(error) = tracked {
        let (all, folder) = (all_frames.len(), out.display());
        return Err(match done {
            0 => error,
            _ => error.context(format!("stopped after {done} of {all} frames, which are in {folder}")),
        });
    }
    smoothed
        .and_then(|()| arguments.reference.learn(&report.errors))
        .context("what was tracked is written")?;
    let model = Arc::clone(take.model());
    Ok((report, model))
}

/// The take, with the body of an earlier track if that is gone on with.
pub(crate) fn open(arguments: &TrackArguments, earlier: Option<&Earlier>) -> anyhow::Result<Arc<Footage>> {
    let segmentation = arguments.follow.solver.segmentation();
    let Some(earlier) = earlier else {
        let model = arguments.model.as_deref();
        return take_options::open_segmented(&arguments.take, model, segmentation);
    };
    take_options::open_with_body(&arguments.take, Some(earlier.written.model.clone()), segmentation)
}

/// What is known before the first frame is tracked.
struct TrackInputs<'a> {
    reader: Arc<TakeReader>,
    frames: &'a [usize],
    start: Pose,
    /// What was found from the silhouettes.
    begun: Option<person::Begun>,
    earlier: Option<Earlier>,
}

impl<'a> TrackInputs<'a> {
    fn new(
        arguments: &TrackArguments,
        whom: Whom<'_>,
        all_frames: &'a [usize],
        earlier: Option<Earlier>,
        smoothing: Option<Smoothing>,
        cancel: &CancelToken,
    ) -> anyhow::Result<Self> {
        let Whom { footage, start, found: begun_before, out, .. } = whom;
        let cameras = arguments.part.cameras(footage.take())?;
        let mut reader = TakeReader::of_silhouettes(footage, cameras);
        let take = reader.footage.take();
        if let Some(mut earlier) = earlier {
            let frames = earlier.frames_left(take, &reader.cameras, all_frames)?;
            if !frames.is_empty() {
                earlier.recall(out, smoothing)?;
            }
            reader.cues.clone_from(&arguments.cues);
            let (start, begun) = (earlier.last_pose(), earlier.begun.clone());
            return Ok(Self { reader: Arc::new(reader), frames, start, begun, earlier: Some(earlier) });
        }
        person::check_silhouettes(&reader, all_frames)?;
        // A body that is named has its sizes.
        let sizes = begun_before.is_none() && arguments.model.is_none() && take.sizes() == BodySizes::Fit;
        output::make_folder(out)?;
        let (model, fit) = (Arc::clone(take.model()), arguments.follow.fit()?);
        let search = PersonSearch { model, fit, start, frames: all_frames.to_vec(), sizes };
        let (found, begun) = person::find(&reader, search, cancel)?;
        if !Arc::ptr_eq(&found.model, reader.footage.take().model())
            && let Some(sized) = reader.footage.with_body(found.model.clone())
        {
            reader.footage = Arc::new(sized);
        }
        reader.cues.clone_from(&arguments.cues);
        let (start, begun) = (found.start, begun_before.or(Some(begun)));
        Ok(Self { reader: Arc::new(reader), frames: all_frames, start, begun, earlier: None })
    }
}

/// How the frames are followed. Noise that is `known` from an earlier track is not estimated again.
fn plan(
    arguments: &TrackArguments,
    reader: &Arc<TakeReader>,
    start: Pose,
    frames: &[usize],
    known: Option<KalmanOptions>,
    cancel: &CancelToken,
) -> anyhow::Result<TrackPlan> {
    let (follow, take) = (&arguments.follow, reader.footage.take());
    let mut plan = follow.plan(take, start.clone(), frames)?;
    if arguments.tune && !follow.is_kalman() {
        bail!("--tune is for --motion kalman, steered or smoothed");
    }
    if let Some(noise) = known.filter(|_| follow.is_kalman()) {
        plan.motion = Motion::Kalman(noise);
    } else if arguments.tune {
        plan.motion = Motion::Kalman(tuned(&plan, reader, follow.noise()?, cancel)?);
    }
    if arguments.cues.contains(&Cue::Keypoints) && take.keypoint_order()?.is_none() {
        bail!("--cues keypoints: the take has no keypoints of a body (`keypoints` of its cameras)");
    }
    plan.cues.clone_from(&arguments.cues);
    plan.tracker(start)?;
    Ok(plan)
}

/// Tracks once to learn by which noise the frames are most likely, and says so.
fn tuned(
    plan: &TrackPlan,
    reader: &TakeReader,
    noise: KalmanOptions,
    cancel: &CancelToken,
) -> anyhow::Result<KalmanOptions> {
    let silhouettes = TakeReader::of_silhouettes(reader.footage.clone(), reader.cameras.clone());
    let progress = progress::bar(plan.legs[0].frames.len());
    let found = plan.tune(Arc::new(silhouettes), noise, cancel, |estimate| {
        progress.set_message(overlap_text(estimate));
        progress.inc(1);
    });
    progress.finish_and_clear();
    let found = found.map_err(|ending| ended(ending).unwrap_or(Interrupted.into()))?;
    let found = found.context("--tune needs ten frames or more that follow one another")?;
    let ratio = |innovation: Innovation| innovation.ratio().unwrap_or(f64::NAN);
    let KalmanOptions { measurement_deviation, turn_acceleration, move_acceleration, .. } = found.noise;
    let measurement_deviation = measurement_deviation.unwrap_or(f64::NAN);
    eprintln!(
        "noise from innovations: --noise {measurement_deviation:.3},{turn_acceleration:.3},{move_acceleration:.3} \
         (mean square of the innovations {:.2}, with the noise that was given {:.2})",
        ratio(found.innovation),
        ratio(found.before)
    );
    Ok(found.noise)
}

fn cue(text: &str) -> Result<Cue, &'static str> {
    // Edges were measured to do more harm than good (docs/chapter6.md).
    let offered = [Cue::Keypoints, Cue::Flow, Cue::Stereo];
    offered.into_iter().find(|cue| cue.name() == text).ok_or("expected keypoints, flow or stereo")
}

fn overlap_text(estimate: &FrameEstimate) -> String {
    estimate.iou().map(|iou| format!("IoU {iou:.3}")).unwrap_or_default()
}

/// The error of a run that did not track all its frames.
fn ended(ending: TrackEnding) -> Option<anyhow::Error> {
    match ending {
        TrackEnding::Whole => None,
        TrackEnding::Cancelled => Some(Interrupted.into()),
        TrackEnding::Failed { frame, error: error @ TrackError::Fit(_) } => {
            Some(anyhow::Error::from(error).context(format!("frame {frame}")))
        }
        TrackEnding::Failed { error, .. } => Some(error.into()),
    }
}

/// Tracks all frames into a report, with a progress bar on a terminal.
pub(crate) fn follow(
    take: &Take,
    run: &mut TrackRun<TakeReader>,
    frames: usize,
    report: &mut TrackReport,
    cancel: &CancelToken,
    mut after_step: impl FnMut(&TrackRun<TakeReader>, &TrackReport),
) -> anyhow::Result<()> {
    let progress = progress::bar(frames);
    let mut ending = None;
    let mut began = Instant::now();
    while ending.is_none() {
        run.step(cancel, &mut |message| {
            if let TrackMessage::Done(how) = message {
                ending = Some(how);
                return;
            }
            take_in(take, message, report, began.elapsed().as_secs_f64() * 1e3, &progress);
            began = Instant::now();
        });
        after_step(run, report);
    }
    progress.finish_and_clear();
    match ending.and_then(ended) {
        Some(error) => Err(error),
        None => Ok(()),
    }
}

/// Takes what a run tells into a report.
pub(crate) fn take_in<F>(
    take: &Take,
    message: TrackMessage<F>,
    report: &mut TrackReport,
    time_ms: f64,
    progress: &ProgressBar,
) {
    match message {
        TrackMessage::Frame { estimate, is_final } => {
            progress.set_message(overlap_text(&estimate));
            progress.inc(1);
            report.add(take, *estimate, is_final, time_ms);
        }
        TrackMessage::Revised(known) => known.into_iter().for_each(|one| report.keep(take, one)),
        TrackMessage::Rewound(mended) => report.mend(take, mended),
        TrackMessage::NotSmoothed(error) => {
            report.not_smoothed.get_or_insert(error);
        }
        TrackMessage::Taken(..) | TrackMessage::Joined { .. } | TrackMessage::Done(_) => {}
    }
}

/// Measures the overlaps of frames again in these reports, as after smoothing has moved their poses.
pub(crate) fn measure_overlaps<R: FrameReader>(
    reader: &Arc<R>,
    model: &Model,
    frames: &[usize],
    renderer: RendererKind,
    reports: &mut [&mut TrackReport],
) -> anyhow::Result<()> {
    progress::each_frame(reader, frames, |frame, read| {
        let views = reader.views(read);
        for report in &mut *reports {
            if let Some(estimate) = report.track.frames.get_mut(&frame) {
                estimate.measure_overlap(model, renderer, &views);
            }
        }
        Ok(())
    })
}

/// A take tracked with the robust preset and judged in words, for a terminal without a display: the built-in one without a
/// path.
pub fn print_robust_track(path: Option<&Path>) -> anyhow::Result<()> {
    let footage = match path {
        Some(path) => take_options::open(path)?,
        None => Arc::new(Footage::new(builtin::open()?)),
    };
    let take = footage.take();
    output::print(&format!("Tracking \"{}\" with the robust preset.\n\n", take.name()))?;
    let (frames, cameras) = (0..take.frame_count(), (0..take.rig().count()).collect());
    let report = robust_track(&footage, cameras, frames.collect(), &CancelToken::new())?;
    output::print(&report.text())
}

/// These frames of these cameras, tracked with the robust preset from where the take begins.
pub(crate) fn robust_track(
    footage: &Arc<Footage>,
    cameras: Vec<usize>,
    frames: VecDeque<usize>,
    cancel: &CancelToken,
) -> anyhow::Result<TrackReport> {
    let (take, count) = (footage.take(), frames.len());
    let reader = TakeReader::of_silhouettes(footage.clone(), cameras);
    let first = frames.front().copied().unwrap_or(0);
    let start = StartArguments::none().pose(footage, &reader.cameras, first, &FitOptions::default())?;
    let plan = TrackPlan::of_frames(take, start, frames);
    let mut report = TrackReport::new(take, &reader.cameras);
    let mut run = TrackRun::new(Arc::new(reader), plan);
    follow(take, &mut run, count, &mut report, cancel, |_, _| {})?;
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_tracked_before_ctrl_c_stays() {
        let take = builtin::open().unwrap();
        let (start, cancel) = (take.start().unwrap().clone(), CancelToken::new());
        let plan = TrackPlan::of_frames(&take, start, (0..10).collect());
        let reader = Arc::new(TakeReader::of_silhouettes(Arc::new(Footage::new(take)), vec![0, 1]));
        let take = reader.footage.take();
        let mut report = TrackReport::new(take, &[0, 1]);
        let mut run = TrackRun::new(reader.clone(), plan);
        let error = follow(take, &mut run, 10, &mut report, &cancel, |_, report| {
            if report.track.frames.len() == 3 {
                cancel.cancel();
            }
        });
        assert!(error.unwrap_err().downcast_ref::<Interrupted>().is_some());
        assert_eq!(report.track.frames.len(), 3);
    }
}
