//! `bl.fit`: frame after frame of masks, as `backlit track` follows a take.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use anyhow::{Context, anyhow, ensure};
use backlit_document::likely_poses;
use backlit_document::tracking_choices::Following;
use backlit_formats::take::{BodySizes, CameraFootage};
use backlit_formats::{Footage, Take};
use backlit_runs::changes::change_text;
use backlit_runs::people;
use backlit_runs::person::PersonSearch;
use backlit_runs::track::{
    FrameReader, TakeReader, TrackEnding, TrackError, TrackMessage, TrackPlan, TrackRun, survey,
};
use backlit_tracking::body::Pose;
use backlit_tracking::body_fit::Person;
use backlit_tracking::body_fit::survey::LOOKED_AT;
use backlit_tracking::camera::RigError;
use backlit_tracking::cues::Cue;
use backlit_tracking::fit::{FitOptions, Preset};
use backlit_tracking::people::{FEWEST_CAMERAS, FollowedPerson};
use backlit_tracking::search::start;
use backlit_tracking::track::FrameEstimate;
use pyo3::prelude::*;

use crate::arrays::MaskShape;
use crate::body::BodyArgument;
use crate::errors::{raised, refused, wrong};
use crate::options::{Choices, preset_of};
use crate::pose::PyPose;
use crate::take::{ArrayTake, CamerasOrTake, MaskValues, PyTake, fits_sizes};
use crate::track::PyTrack;
use crate::work::{Job, interruptible};

/// What is tracked, and how.
struct Request {
    take: PyTake,
    preset: Preset,
    fit: FitOptions,
    /// The pose of the first frame, where it is given.
    start: Option<Pose>,
    /// Frames in their order.
    frames: Vec<usize>,
    /// Indices of the cameras, ascending.
    cameras: Vec<usize>,
    /// Whether the person's own sizes are found first; as the take says if `None`.
    fits_sizes: Option<bool>,
    cues: Vec<Cue>,
    /// How motion is carried; as the preset says if `None`.
    motion: Option<Following>,
    /// Who of several people is followed, from 1.
    person: Option<usize>,
}

/// Follows a person through masks: ``backlit track`` for arrays, with the same result to the bit.
///
/// ``cams`` is a :class:`CameraGroup` beside ``masks`` (C, T, H, W), or a :class:`Take` alone; :meth:`Take.from_arrays` says what
/// masks, ``keypoints``, ``fps``, ``sizes`` and ``mask_values`` are. ``body`` is a :class:`Body`, a file, or ``full_body``,
/// ``upper_body`` or ``single_limb``. ``start`` is the pose of the first frame; without one it is searched for. ``renderer`` is
/// ``capsule``, ``cylinder`` or ``sphere_tree`` (with ``spheres`` a limb), ``preset`` ``robust`` or ``report``, ``iterations`` the
/// most of a frame. ``frames`` are numbers of frames to follow, in their order; ``cameras`` are names. ``cues`` lists what else
/// pulls: ``keypoints`` (default where keypoints are given), ``flow``, ``stereo``. ``motion`` says how motion is carried from frame to
/// frame: ``still``, ``velocity``, ``kalman``, ``steered`` or ``smoothed``. ``person`` follows one of several people: 1 is who is in
/// view longest, and pixels of others are unknown. ``n_threads`` changes the time and no bit.
/// ``progress`` is called with (done, all, text). Ctrl+C raises ``KeyboardInterrupt``. Raises :class:`InputError`, :class:`FileError`
/// or :class:`Error`. Returns a :class:`Track`.
#[pyfunction]
#[pyo3(signature = (cams, masks = None, *, body = None, start = None, keypoints = None, fps = None, sizes = None,
    preset = "robust", renderer = None, spheres = None, ramp = None, iterations = None, frames = None, cameras = None,
    cues = None, motion = None, person = None, mask_values = None, n_threads = None, progress = None))]
#[expect(clippy::too_many_arguments, reason = "each is an argument of Python's, most by name")]
pub(crate) fn fit(
    py: Python<'_>,
    cams: CamerasOrTake<'_>,
    masks: Option<&Bound<'_, PyAny>>,
    body: Option<BodyArgument<'_>>,
    start: Option<&PyPose>,
    keypoints: Option<&Bound<'_, PyAny>>,
    fps: Option<f64>,
    sizes: Option<&str>,
    preset: &str,
    renderer: Option<&str>,
    spheres: Option<usize>,
    ramp: Option<&str>,
    iterations: Option<usize>,
    frames: Option<Vec<usize>>,
    cameras: Option<Vec<String>>,
    cues: Option<Vec<String>>,
    motion: Option<&str>,
    person: Option<usize>,
    mask_values: Option<MaskValues>,
    n_threads: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<PyTrack> {
    let preset = preset_of(preset)?;
    let choices = Choices { renderer, spheres, ramp, iterations, ..Choices::default() };
    let mut fit = choices.options(preset)?;
    if preset == Preset::Robust {
        fit.prior = Some(likely_poses::people());
    }
    let has_body = body.is_some();
    let cues = match cues {
        None if keypoints.is_some() => vec![Cue::Keypoints],
        words => words.unwrap_or_default().iter().map(|word| cue(word)).collect::<PyResult<_>>()?,
    };
    let motion = motion.map(following).transpose()?;
    let mut sizes = fits_sizes(sizes)?;
    if has_body && matches!(cams, CamerasOrTake::Take(_)) {
        // A body that is named has its sizes.
        sizes = sizes.or(Some(false));
    }
    let told = ArrayTake {
        body,
        fps,
        keypoints,
        start: None,
        fits_sizes: sizes == Some(true),
        name: None,
        mask_values,
    };
    let take = cams.take(py, masks, MaskShape::Recording, told)?;
    let start = start.map(|start| start.pose.clone());
    if let Some(start) = &start {
        start.check(take.footage.take().model()).map_err(refused)?;
    }
    let frames = frame_numbers(&take.footage, frames)?;
    let cameras = camera_indices(&take.footage, cameras)?;
    if let Some(person) = person {
        if person == 0 {
            return Err(wrong("person", "1 or more", "0"));
        }
        if cameras.len() < FEWEST_CAMERAS {
            return Err(wrong(
                "person",
                &format!("{FEWEST_CAMERAS} cameras or more"),
                &cameras.len().to_string(),
            ));
        }
    }
    let request =
        Request { take, preset, fit, start, frames, cameras, fits_sizes: sizes, cues, motion, person };
    interruptible(py, n_threads, progress, |job| request.run(job))?.map_err(raised)
}

fn cue(word: &str) -> PyResult<Cue> {
    let offered = [Cue::Keypoints, Cue::Flow, Cue::Stereo];
    let known = offered.into_iter().find(|cue| cue.name() == word);
    known.ok_or_else(|| wrong("cues", "keypoints, flow or stereo", &format!("{word:?}")))
}

fn following(word: &str) -> PyResult<Following> {
    let known = Following::NAMED.into_iter().find(|(name, ..)| *name == word);
    let expected = "still, velocity, kalman, steered or smoothed";
    known.map(|(.., how)| how).ok_or_else(|| wrong("motion", expected, &format!("{word:?}")))
}

impl Request {
    fn run(self, job: &Job) -> anyhow::Result<PyTrack> {
        let frames = self.frames.clone();
        let (footage, changes) = self.learnt_again(job)?;
        let footage = self.of_person(footage, job)?;
        let take = self.take.footage.take();
        let mut notes = take.notes();
        notes.extend(changes);
        let mut reader = TakeReader::of_silhouettes(footage, self.cameras.clone());
        notes.extend(looked_at(&reader, &frames, job)?);
        let start = self.start.clone().or_else(|| known_start(take, frames[0]));
        let sizes = self.fits_sizes.unwrap_or_else(|| take.sizes() == BodySizes::Fit);
        let (model, fit) = (Arc::clone(take.model()), self.fit.clone());
        let search = PersonSearch { model, fit, start, frames: frames.clone(), sizes };
        let person = search.run(take, &reader, &job.cancel, |text| job.tell(0, frames.len(), text));
        let person = person.with_context(|| format!("frame {}: no start can be found", frames[0]))?;
        ensure!(!job.cancel.is_cancelled(), "stopped");
        notes.extend(told_of(&person, frames[0]));
        if !Arc::ptr_eq(&person.model, reader.footage.take().model()) {
            let take = self.take.source.open(Some((*person.model).clone()))?;
            let footage = Footage::new(take).with_changes(reader.footage.changes.clone());
            reader.footage = Arc::new(footage.with_person(reader.footage.take().person().cloned()));
        }
        reader.cues.clone_from(&self.cues);
        if self.cues.contains(&Cue::Keypoints) && reader.footage.take().keypoint_order()?.is_none() {
            return Err(anyhow!("keypoints: they make no body, by the order of COCO or of BODY_25"));
        }
        self.follow(reader, person.start, &frames, notes, job)
    }

    /// The footage with backgrounds that change learnt again, and what was found of them in words.
    fn learnt_again(&self, job: &Job) -> anyhow::Result<(Arc<Footage>, Vec<String>)> {
        let footage = &self.take.footage;
        let take = footage.take();
        if take.footage().iter().all(CameraFootage::has_masks) {
            return Ok((Arc::clone(footage), Vec::new()));
        }
        let survey = footage.change_survey(&self.cameras, &self.frames);
        let looking = "looking for backgrounds that change";
        let found =
            survey.changes(&job.cancel, |[done, all]| job.tell(done, all, looking)).context(looking)?;
        let changes = found.unwrap_or_default();
        let words = changes.iter().map(|change| change_text(change, take)).collect();
        Ok((Arc::new(footage.with_changes(Arc::new(changes))), words))
    }

    /// The footage of the person who is asked for, by what the cameras show.
    fn of_person(&self, footage: Arc<Footage>, job: &Job) -> anyhow::Result<Arc<Footage>> {
        let Some(number) = self.person else { return Ok(footage) };
        let reader = Arc::new(TakeReader::of_silhouettes(Arc::clone(&footage), self.cameras.clone()));
        let people = people::find(&reader, &self.frames, &job.cancel, |done, all| {
            job.tell(done, all, "looking for people".to_owned());
        })?;
        ensure!(!job.cancel.is_cancelled(), "stopped");
        let person = FollowedPerson::of(&people, number - 1);
        let person = person.with_context(|| format!("person {number}: in view are {}", people.len()))?;
        Ok(Arc::new(footage.with_person(Some(Arc::new(person)))))
    }

    fn follow(
        self,
        reader: TakeReader,
        start: Pose,
        frames: &[usize],
        notes: Vec<String>,
        job: &Job,
    ) -> anyhow::Result<PyTrack> {
        let reader = Arc::new(reader);
        let take = reader.footage.take();
        let mut plan = TrackPlan::of_preset(self.preset, self.fit, take, start, frames.to_vec().into());
        plan.cues = self.cues;
        if let Some(motion) = self.motion {
            plan = plan.following(motion);
        }
        let (renderer, is_smoothed) = (plan.fit.renderer, plan.smoothing.is_some());
        let mut run = TrackRun::new(reader.clone(), plan);
        let mut found: BTreeMap<usize, FrameEstimate> = BTreeMap::new();
        let (mut ending, mut not_smoothed) = (None, None);
        while ending.is_none() {
            run.step(&job.cancel, &mut |message| match message {
                TrackMessage::Frame { estimate, .. } => {
                    found.insert(estimate.frame, *estimate);
                }
                TrackMessage::Revised(known) | TrackMessage::Rewound(known) => {
                    found.extend(known.into_iter().map(|one| (one.frame, one)));
                }
                TrackMessage::Done(how) => ending = Some(how),
                TrackMessage::NotSmoothed(error) => not_smoothed = Some(error),
                TrackMessage::Taken(..) | TrackMessage::Joined { .. } => {}
            });
            job.tell(
                found.len(),
                frames.len(),
                format!("{} of {} frames tracked", found.len(), frames.len()),
            );
        }
        match ending {
            Some(TrackEnding::Failed { frame, error: error @ TrackError::Fit(_) }) => {
                return Err(anyhow::Error::from(error).context(format!("frame {frame}")));
            }
            Some(TrackEnding::Failed { error, .. }) => return Err(error.into()),
            Some(TrackEnding::Whole | TrackEnding::Cancelled) | None => {}
        }
        if let Some(error) = not_smoothed {
            return Err(error.into());
        }
        let silhouettes = TakeReader::of_silhouettes(reader.footage.clone(), reader.cameras.clone());
        for one in found.values_mut() {
            if is_smoothed {
                // Smoothing has moved the pose.
                let views = silhouettes.views(&silhouettes.read(one.frame)?);
                one.measure_overlap(take.model(), renderer, &views);
            }
            // By far the largest part of a track, and nothing that Python sees.
            (one.belief, one.modes, one.signs) = (None, Vec::new(), Vec::new());
        }
        Ok(PyTrack {
            model: Arc::clone(take.model()),
            name: take.name().to_owned(),
            frame_rate: take.frame_rate(),
            cameras: reader.cameras.iter().map(|&camera| (*reader.footage.cameras[camera]).clone()).collect(),
            frames: found,
            notes,
        })
    }
}

/// Indices of the cameras with these names, ascending; of all without names.
pub(crate) fn camera_indices(footage: &Footage, names: Option<Vec<String>>) -> PyResult<Vec<usize>> {
    let rig = footage.take().rig();
    let Some(names) = names else { return Ok((0..rig.count()).collect()) };
    let indices: Result<BTreeSet<usize>, RigError> = names.iter().map(|name| rig.index(name)).collect();
    let indices = indices.map_err(|error| refused(anyhow::Error::from(error).context("cameras")))?;
    if indices.is_empty() {
        return Err(wrong("cameras", "a name or more", "none"));
    }
    Ok(indices.into_iter().collect())
}

/// These frames if the take has them; all without any.
pub(crate) fn frame_numbers(footage: &Footage, frames: Option<Vec<usize>>) -> PyResult<Vec<usize>> {
    let count = footage.frame_count();
    let Some(frames) = frames else { return Ok((0..count).collect()) };
    if frames.is_empty() {
        return Err(wrong("frames", "a frame or more", "none"));
    }
    if let Some(frame) = frames.iter().find(|frame| **frame >= count) {
        return Err(wrong("frames", &format!("numbers below {count}"), &frame.to_string()));
    }
    if !frames.is_sorted_by(|a, b| a < b) && !frames.is_sorted_by(|a, b| a > b) {
        return Err(wrong("frames", "each once, forwards or backwards", "another order"));
    }
    Ok(frames)
}

/// Looks at some silhouettes; what speaks against them, in words.
fn looked_at(reader: &TakeReader, frames: &[usize], job: &Job) -> anyhow::Result<Vec<String>> {
    let found = survey(reader, frames, LOOKED_AT, &job.cancel);
    ensure!(!job.cancel.is_cancelled(), "stopped");
    found.check()?;
    let mut notes: Vec<String> = found.doubts().map(|doubt| doubt.to_string()).collect();
    if let Some(several) = found.several_people().filter(|_| reader.footage.take().person().is_none()) {
        notes.push(format!("{several}: person=K follows one of them"));
    }
    Ok(notes)
}

/// The pose to begin a frame with, where the take knows one: its own start, else what its reference shows.
pub(crate) fn known_start(take: &Take, frame: usize) -> Option<Pose> {
    let joints = || take.reference().map(|reference| reference.joints(frame)).unwrap_or_default();
    take.start().cloned().or_else(|| start::from_joints(take.model(), &joints()))
}

/// How a person was found, in words.
fn told_of(person: &Person, first: usize) -> Vec<String> {
    let mut notes = Vec::new();
    if let Some(found) = &person.search {
        notes.push(format!("frame {first}: a start was found from the silhouettes"));
        notes.extend(found.doubts.iter().map(ToString::to_string));
    }
    match &person.sizes {
        Some(Ok(own)) if own.is_taken() => notes.push("the person's own sizes were fitted".to_owned()),
        Some(Ok(_)) => notes.push("the person's own sizes were not used, the body is only scaled".to_owned()),
        Some(Err(error)) => notes.push(format!(
            "the body is only scaled as a whole: the person's own sizes cannot be found: {error}"
        )),
        None => {}
    }
    notes
}
