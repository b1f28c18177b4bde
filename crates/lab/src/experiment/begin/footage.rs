//! Frames of a take with keypoints, begun at by every method, by all sets of this many cameras.
//!
//! A pose is judged as [`no_start`](super::super::no_start) does it: found where its mean joint error is no more than so much larger than that of
//! the fit that begins at the keypoints, which are a few centimetres accurate themselves. A given start is that fit's pose with every
//! joint turned and the root moved.

use backlit_formats::Footage;
use backlit_tracking::body::Pose;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::FitView;
use backlit_tracking::initialisation::InitialisationInputs;
use backlit_tracking::metrics::ReferenceJoints;
use backlit_tracking::search::start;
use serde::Serialize;

use super::{BeginTrial, MethodRow, Options, Report};
use crate::experiment::no_start::{error_mm, fit, sets};
use crate::experiment::{ExperimentError, Progress};
use backlit_tracking::search::start::Level;

/// Which frames, and how far off their starts.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Frames {
    /// Frames.
    pub frames: Vec<usize>,
    /// How far given starts are off, each tried once a frame and set of cameras.
    pub levels: Vec<Level>,
    /// A pose whose mean joint error is at most so much larger than that of the fit from the keypoints is found, mm.
    pub within_mm: f64,
    /// Seed of the starts.
    pub seed: u64,
}

/// Tries all methods on all frames by all sets of `options.cameras` cameras, from starts of all levels, or without.
///
/// # Errors
/// Returns an error if the take lacks a number of cameras, if a frame has no keypoints, if pictures cannot be read, or if it is
/// cancelled.
pub fn run(
    footage: &Footage,
    options: &Options,
    frames: &Frames,
    cancel: &CancelToken,
    mut on_progress: impl FnMut(Progress),
) -> Result<Report, ExperimentError> {
    let all = footage.cameras.len();
    let mut levels: Vec<Option<Level>> = frames.levels.iter().copied().map(Some).collect();
    if options.no_start {
        levels = vec![None];
    }
    let mut rows = Vec::new();
    let of_count: Vec<_> = options.cameras.iter().map(|&count| sets(all, count)).collect::<Result<_, _>>()?;
    let per_set = frames.frames.len() * options.methods.len() * levels.len();
    let (mut done, total) = (0, of_count.iter().map(Vec::len).sum::<usize>() * per_set);
    for (&cameras, sets) in options.cameras.iter().zip(&of_count) {
        let mut trials = vec![vec![Vec::new(); options.methods.len()]; levels.len()];
        for (set, &frame) in sets.iter().flat_map(|set| frames.frames.iter().map(move |frame| (set, frame))) {
            let scene = KeypointFrame::new(footage, set, frame, cancel)?;
            for (level, trials) in levels.iter().zip(&mut trials) {
                for (&method, trials) in options.methods.iter().zip(trials) {
                    on_progress(Progress { done, total });
                    done += 1;
                    let given = level.map(|level| scene.start(level, frames.seed.wrapping_add(frame as u64)));
                    let (model, views) = (footage.take().model(), &scene.views[..]);
                    let inputs = InitialisationInputs { model, views, start: given.as_ref(), cancel };
                    let error = |pose: &Pose| error_mm(model, pose, &scene.joints);
                    let is_found = |error: f64| error <= scene.fitted_mm + frames.within_mm;
                    trials.push(BeginTrial::run(options, method, &inputs, error, is_found)?);
                }
            }
        }
        for (level, trials) in levels.iter().zip(&trials) {
            let row = |(method, trials): (&_, &Vec<BeginTrial>)| {
                MethodRow::of(*method, cameras, level.map(|level| level.degrees), trials)
            };
            rows.extend(options.methods.iter().zip(trials).map(row));
        }
    }
    on_progress(Progress { done, total });
    Ok(Report { rows })
}

/// One frame by one set of cameras.
struct KeypointFrame<'a> {
    footage: &'a Footage,
    views: Vec<FitView>,
    joints: ReferenceJoints,
    fitted: Pose,
    fitted_mm: f64,
}

impl<'a> KeypointFrame<'a> {
    fn new(
        footage: &'a Footage,
        set: &[usize],
        frame: usize,
        cancel: &CancelToken,
    ) -> Result<Self, ExperimentError> {
        let model = footage.take().model();
        let joints = footage.take().reference().map(|reference| reference.joints(frame)).unwrap_or_default();
        let Some(at_keypoints) = start::from_joints(model, &joints) else {
            let expected = "a frame that has reference keypoints";
            return Err(ExperimentError::Option { option: "frames", value: frame as f64, expected });
        };
        let views = footage.fit_views(set, frame)?;
        let fitted = fit(model, &views, at_keypoints, cancel)?;
        let fitted_mm = error_mm(model, &fitted, &joints);
        Ok(Self { footage, views, joints, fitted, fitted_mm })
    }

    fn start(&self, level: Level, seed: u64) -> Pose {
        let angle = f64::from(level.degrees).to_radians();
        start::perturb(self.footage.take().model(), &self.fitted, angle, level.metres, seed)
    }
}
