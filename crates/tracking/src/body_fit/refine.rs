//! Cameras refined by the silhouettes of a person: follow, choose frames, fit everything, judge by what was held out.
//!
//! The body is tracked with the cameras as they are given. In well-spread frames of that track, poses, the body's sizes and the
//! cameras are fitted together (`body_fit::cameras` says what is held), then again without frames that fit worse than the others:
//! a limb in a wrong place pulls cameras after it. The body is followed again with the cameras found, each in the frame that is
//! nearest by its own clock, and so on. In frames that nothing was fitted to, every camera is held out in turn: the pose is
//! fitted to all others, and the overlap with the silhouette of the one held out says how well the rig agrees on it, before and
//! after.

use std::collections::BTreeMap;
use std::sync::Arc;

use thiserror::Error;

use super::cameras::{CameraChoice, CameraDeviations, CameraSet, CameraState};
use super::fit::{BodyFitError, BodyProgress, CameraFit, FirstSizes, fit_body, fit_cameras};
use super::frames::{BodyFrame, Choice, PosedFrame, choose};
use super::options::{BodyFitOptions, CLOTHED};
use super::person::{OrViews, PersonError, PersonOptions, PersonProgress, follow};
use super::report::BodyFit;
use super::survey::usable_views;
use super::whole_frames::WholeFrames;
use crate::body::{Model, Pose};
use crate::camera::Camera;
use crate::cancel::CancelToken;
use crate::fit::{Fit, FitOptions, FitView};
use crate::silhouette::Overlap;
use crate::statistics::{MAD, upper_median};

/// Fewer cameras than this have nothing to agree on.
pub const FEWEST_CAMERAS: usize = 2;
/// Fewer frames than this say too little of cameras.
const FEWEST_FRAMES: usize = 3;
/// A frame fits worse than the others if its IoU is below the median by this number of deviations, and by this much at least.
const WORSE_DEVIATIONS: f64 = 3.0;
const WORSE_IOU: f64 = 0.01;
/// Neighbours in time that are farther apart say nothing of a pose's rate, seconds.
const RATE_WITHIN_S: f64 = 0.3;

/// Every choice of a refinement.
#[derive(Debug, Clone, PartialEq)]
pub struct CameraRefinementOptions {
    /// How the person is followed; sizes and joints are not asked for.
    pub person: PersonOptions,
    /// What of each camera is free beside its turn and its place.
    pub choice: CameraChoice,
    /// How far calibrations are usually off.
    pub deviations: CameraDeviations,
    /// The fit of poses, sizes and cameras.
    pub fit: BodyFitOptions,
    /// Frames that are fitted to.
    pub fitted: usize,
    /// Frames that judge.
    pub held_out: usize,
    /// How often the body is followed and cameras are fitted.
    pub rounds: usize,
}

impl CameraRefinementOptions {
    /// For a recording of this many frames a second.
    pub fn new(fit: FitOptions, frame_rate: f64) -> Self {
        let fit = FitOptions { exact: true, ..fit };
        let person = PersonOptions { most_followed: 240, ..PersonOptions::new(fit, false, frame_rate) };
        Self {
            person,
            choice: CameraChoice::default(),
            deviations: CameraDeviations::default(),
            fit: BodyFitOptions::default().with_proportions(CLOTHED),
            fitted: 16,
            held_out: 4,
            rounds: 3,
        }
    }
}

/// Why cameras cannot be refined.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum CameraRefinementError {
    #[error("cameras that are used: {found}; expected {FEWEST_CAMERAS} or more, which can disagree")]
    FewCameras { found: usize },
    #[error(
        "{found} frames can be used, expected {FEWEST_FRAMES} or more: of {all} that were followed {} are lost, {} turned round, {} \
         seen poorly", choice.lost, choice.turned, choice.poor
    )]
    FewFrames { found: usize, all: usize, choice: Choice },
    #[error(transparent)]
    Person(#[from] PersonError),
    #[error(transparent)]
    Fit(#[from] BodyFitError),
    #[error("stopped by you")]
    Cancelled,
}

/// How far it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraRefinementProgress {
    /// The round, from 0 on.
    pub round: usize,
    /// How many there are.
    pub rounds: usize,
    /// What is done in it.
    pub step: CameraRefinementStep,
}

/// What is being done.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CameraRefinementStep {
    /// The person is followed.
    Following(PersonProgress),
    /// Poses and sizes are fitted with the cameras as given.
    Body(BodyProgress),
    /// Everything is fitted.
    Cameras(BodyProgress),
    /// How many of the frames held out are judged, and how many there are.
    Judging(usize, usize),
}

/// One camera.
#[derive(Debug, Clone, PartialEq)]
pub struct RefinedCamera {
    /// The camera found, for the same pictures.
    pub camera: Camera,
    /// By how much it differs from the one given.
    pub change: CameraState,
    /// Standard deviations of that.
    pub deviation: CameraState,
    /// IoU of its silhouettes with the body posed by the other cameras, in frames held out, with the cameras given and with
    /// those found; `None` where no frame could be judged.
    pub held_out_iou: [Option<f64>; 2],
}

/// What was found.
#[derive(Debug, Clone)]
pub struct RefinedCameras {
    /// The cameras, in the order in which the views have them.
    pub cameras: Vec<RefinedCamera>,
    /// Poses and sizes that were fitted with them.
    pub body: BodyFit,
    /// The same with the cameras given.
    pub before: BodyFit,
    /// The frames that judged.
    pub held_out: Vec<usize>,
}

/// Refines the cameras that see a person, who begins the first of `frames` in a pose.
///
/// `views(frame)` gives what the cameras see: always the same cameras, as ideal pinholes.
///
/// # Errors
/// What `views` returns; too few cameras or frames, silhouettes that cannot be a person's, options out of range, or `cancel`.
pub fn refine_cameras<E: From<CameraRefinementError>>(
    model: &Arc<Model>,
    start: Pose,
    frames: &[usize],
    options: &CameraRefinementOptions,
    cancel: &CancelToken,
    mut views: impl FnMut(usize) -> Result<Vec<FitView>, E>,
    mut progress: impl FnMut(CameraRefinementProgress),
) -> Result<RefinedCameras, E> {
    let &first = frames.first().ok_or(CameraRefinementError::Person(PersonError::NoFrame))?;
    let given: Vec<Arc<Camera>> = views(first)?.into_iter().map(|view| view.camera).collect();
    if given.len() < FEWEST_CAMERAS {
        return Err(CameraRefinementError::FewCameras { found: given.len() }.into());
    }
    let mut found = CameraFit { changes: vec![CameraState::default(); given.len()], deviations: Vec::new() };
    // What is followed is scaled alone: sizes that were fitted to wrong poses would keep them wrong.
    let (mut followed_body, mut body, mut before) = (Arc::clone(model), Arc::clone(model), None);
    let mut last = None;
    let wrong = |error: BodyFitError| E::from(CameraRefinementError::from(error));
    let rounds = options.rounds.max(1);
    let frame_rate = options.person.frame_rate;
    let all_frames = first..=frames.last().copied().unwrap_or(first);
    for round in 0..rounds {
        let mut progress = |step| progress(CameraRefinementProgress { round, rounds, step });
        let now = changed(&given, &found.changes);
        let clocks = WholeFrames::of(&found.changes, frame_rate, all_frames.clone());
        let mut seen =
            |frame| clocks.views(frame, &mut views).map(|views| seen_by(views, &now)).map_err(OrViews::Views);
        let person = &options.person;
        let followed = follow(&followed_body, start.clone(), frames, person, cancel, &mut seen, &mut |at| {
            progress(CameraRefinementStep::Following(at));
        });
        let posed = followed.map_err(not_followed)?;
        let choice = choose(&followed_body, &posed, options.fitted, options.held_out);
        let fitted = read_frames(&posed, &choice.fitted, &clocks, &mut views)?;
        if cancel.is_cancelled() {
            return Err(CameraRefinementError::Cancelled.into());
        }
        if fitted.len() < FEWEST_FRAMES {
            let (found, all) = (fitted.len(), posed.len());
            return Err(CameraRefinementError::FewFrames { found, all, choice }.into());
        }
        if before.is_none() {
            let told = |at| progress(CameraRefinementStep::Body(at));
            let sizes = FirstSizes::Scaled(0.0);
            let fit = fit_body(Arc::clone(model), fitted.clone(), sizes, &options.fit, cancel, told);
            let fit = fit.map_err(wrong)?;
            body = Arc::new(fit.as_seen());
            before = Some(fit);
        }
        let rates = rates(&posed, frame_rate);
        let CameraRefinementOptions { choice: columns, deviations, .. } = options;
        let set = CameraSet::new(given.clone(), *columns, deviations, &fitted, rates, frame_rate)
            .with_earlier(clocks.earlier.clone());
        let told = |at| progress(CameraRefinementStep::Cameras(at));
        let begin = (&*body, &found.changes[..]);
        let fit = fit_without_worse(model, fitted, begin, &set, &options.fit, cancel, told);
        let (fit, cameras) = fit.map_err(wrong)?;
        if let Ok(scaled) = model.scaled(fit.size) {
            followed_body = Arc::new(scaled);
        }
        (body, found) = (Arc::new(fit.as_seen()), cameras);
        last = Some((fit, posed, choice.held_out, clocks));
    }
    let (fit, posed, judging, clocks) = last.ok_or(CameraRefinementError::Cancelled)?;
    let as_given = WholeFrames::of(&vec![CameraState::default(); given.len()], frame_rate, all_frames);
    let mut read = |clocks| read_frames(&posed, &judging, clocks, &mut views);
    let held_out = [read(&as_given)?, read(&clocks)?];
    let before = before.ok_or(CameraRefinementError::Cancelled)?;
    let now = changed(&given, &found.changes);
    let rigs = [(Arc::new(before.as_seen()), &given, &held_out[0][..]), (body, &now, &held_out[1][..])];
    let overlaps = judge(&rigs, &options.person.fit, cancel, |done, count| {
        let step = CameraRefinementStep::Judging(done, count);
        progress(CameraRefinementProgress { round: rounds - 1, rounds, step });
    });
    let overlaps = overlaps.map_err(wrong)?;
    let cameras = now.iter().enumerate().map(|(index, camera)| RefinedCamera {
        camera: (**camera).clone(),
        change: found.changes[index],
        deviation: found.deviations[index],
        held_out_iou: overlaps[index].map(|overlap| overlap.and_then(|overlap| overlap.iou())),
    });
    let held_out = held_out[1].iter().map(|frame| frame.frame).collect();
    Ok(RefinedCameras { cameras: cameras.collect(), body: fit, before, held_out })
}

/// The cameras with these changes; where the numbers make no camera, the one given.
fn changed(given: &[Arc<Camera>], changes: &[CameraState]) -> Vec<Arc<Camera>> {
    let one = |(camera, state): (&Arc<Camera>, &CameraState)| {
        camera.changed(&state.change).map_or_else(|_| Arc::clone(camera), Arc::new)
    };
    given.iter().zip(changes).map(one).collect()
}

/// The same evidence, seen by other cameras of the same names.
fn seen_by(views: Vec<FitView>, cameras: &[Arc<Camera>]) -> Vec<FitView> {
    let of = |view: FitView| {
        let camera = cameras.iter().find(|camera| camera.name() == view.camera.name());
        FitView { camera: camera.map_or_else(|| Arc::clone(&view.camera), Arc::clone), ..view }
    };
    views.into_iter().map(of).collect()
}

/// Fits everything, then again without frames that fit worse than the others.
fn fit_without_worse(
    model: &Arc<Model>,
    frames: Vec<BodyFrame>,
    begin: (&Model, &[CameraState]),
    set: &CameraSet,
    options: &BodyFitOptions,
    cancel: &CancelToken,
    mut progress: impl FnMut(BodyProgress),
) -> Result<(BodyFit, CameraFit), BodyFitError> {
    let first = fit_cameras(model, frames.clone(), begin, set, options, cancel, &mut progress)?;
    let (fit, cameras) = &first;
    let well = well_fitted(fit, frames, set, &cameras.changes);
    if !(FEWEST_FRAMES..fit.frames.len()).contains(&well.len()) {
        return Ok(first);
    }
    fit_cameras(model, well, (&fit.as_seen(), &cameras.changes), set, options, cancel, progress)
}

/// The frames that a fit explains about as well as the others, with the poses found.
fn well_fitted(
    fit: &BodyFit,
    frames: Vec<BodyFrame>,
    set: &CameraSet,
    changes: &[CameraState],
) -> Vec<BodyFrame> {
    let body = fit.as_seen();
    let poses: BTreeMap<usize, &Pose> = fit.frames.iter().copied().zip(&fit.poses).collect();
    let posed = frames.into_iter().filter_map(|frame| {
        let start = (*poses.get(&frame.frame)?).clone();
        let seen = set.seen(&frame, &start, changes);
        let overlap = seen.iter().filter_map(|(frame, pose)| frame.overlap(&body, pose, 0.0));
        let iou = overlap.reduce(Overlap::merge)?.iou()?;
        Some((iou, BodyFrame { start, ..frame }))
    });
    let posed: Vec<(f64, BodyFrame)> = posed.collect();
    let median_of = |values: &mut Vec<f64>| upper_median(values).unwrap_or(0.0);
    let median = median_of(&mut posed.iter().map(|(iou, _)| *iou).collect());
    let apart = median_of(&mut posed.iter().map(|(iou, _)| (iou - median).abs()).collect());
    let worse = (WORSE_DEVIATIONS * apart / MAD).max(WORSE_IOU);
    posed.into_iter().filter(|(iou, _)| *iou >= median - worse).map(|(_, frame)| frame).collect()
}

/// Frames of a track, by their places in it, with what enough cameras see by these clocks.
fn read_frames<E>(
    posed: &[PosedFrame],
    chosen: &[usize],
    clocks: &WholeFrames,
    views: &mut impl FnMut(usize) -> Result<Vec<FitView>, E>,
) -> Result<Vec<BodyFrame>, E> {
    let mut frames = Vec::new();
    for &at in chosen {
        let PosedFrame { frame, pose, .. } = &posed[at];
        let views = usable_views(*frame, clocks.views(*frame, views)?, &mut Vec::new());
        if views.len() >= FEWEST_CAMERAS {
            frames.push(BodyFrame { frame: *frame, views, start: pose.clone(), joints: Vec::new() });
        }
    }
    Ok(frames)
}

/// Rates of every pose, per second, from its neighbours in time.
fn rates(posed: &[PosedFrame], frame_rate: f64) -> BTreeMap<usize, Vec<f64>> {
    let near = |a: &PosedFrame, b: &PosedFrame| {
        !a.is_lost && !b.is_lost && (b.frame - a.frame) as f64 <= RATE_WITHIN_S * frame_rate
    };
    let rate = |at: usize| {
        let own = &posed[at];
        let before = at.checked_sub(1).map(|at| &posed[at]).filter(|before| near(before, own));
        let after = posed.get(at + 1).filter(|after| near(own, after));
        let (from, to) = (before.unwrap_or(own), after.unwrap_or(own));
        let seconds = (to.frame - from.frame) as f64 / frame_rate;
        let step = to.pose.local(&from.pose);
        (seconds > 0.0).then(|| (own.frame, step.into_iter().map(|step| step / seconds).collect()))
    };
    (0..posed.len()).filter_map(rate).collect()
}

/// A rig, its body, and the frames that judge it.
type JudgedRig<'a> = (Arc<Model>, &'a Vec<Arc<Camera>>, &'a [BodyFrame]);

/// Overlap of every camera's silhouette with the body that the other cameras pose, for each rig.
fn judge(
    rigs: &[JudgedRig<'_>; 2],
    options: &FitOptions,
    cancel: &CancelToken,
    mut progress: impl FnMut(usize, usize),
) -> Result<Vec<[Option<Overlap>; 2]>, BodyFitError> {
    let mut overlaps = vec![[None; 2]; rigs[0].1.len()];
    let (mut done, count) = (0, rigs.iter().map(|rig| rig.2.len()).sum());
    for (rig, (body, cameras, frames)) in rigs.iter().enumerate() {
        for frame in *frames {
            let at_frame = |error| BodyFitError::Frame { frame: frame.frame, error };
            let views = seen_by(frame.views.clone(), cameras);
            for (camera, of_camera) in cameras.iter().zip(&mut overlaps) {
                let is_own = |view: &FitView| view.camera.name() == camera.name();
                let (own, others): (Vec<_>, Vec<_>) = views.iter().cloned().partition(is_own);
                if own.is_empty() || others.is_empty() {
                    continue;
                }
                let start = frame.start.normalized();
                let mut fit = Fit::new(Arc::clone(body), others, start, options.clone()).map_err(at_frame)?;
                fit.run(cancel, |_| {});
                if cancel.is_cancelled() {
                    return Err(BodyFitError::Cancelled);
                }
                let own = BodyFrame { views: own, ..frame.clone() };
                let overlap = of_camera[rig].into_iter().chain(own.overlap(body, fit.pose(), 0.0));
                of_camera[rig] = overlap.reduce(Overlap::merge);
            }
            done += 1;
            progress(done, count);
        }
    }
    Ok(overlaps)
}

fn not_followed<E: From<CameraRefinementError>>(error: OrViews<PersonError, E>) -> E {
    match error {
        OrViews::Own(PersonError::Cancelled) => CameraRefinementError::Cancelled.into(),
        OrViews::Own(error) => CameraRefinementError::from(error).into(),
        OrViews::Views(error) => error,
    }
}
