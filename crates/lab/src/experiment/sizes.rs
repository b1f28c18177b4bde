//! The sizes of people of several builds, found from hard silhouettes and an average adult's body.
//!
//! Each person goes through the moments of the built-in movement; the fit begins with the generic body, and with
//! poses that are off in every joint.

use std::sync::Arc;

use backlit_tracking::body::{Kinematics, Model, Pose, SizeKind, builtin};
use backlit_tracking::body_fit::{BodyFit, BodyFitError, BodyFitOptions, BodyFrame, WELL_SEEN, fit_body};
use backlit_tracking::camera::Camera;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::render::{Ramp, RendererKind};
use backlit_tracking::search::start;
use glam::DVec3;
use serde::Serialize;

use super::{ExperimentError, Progress, Simulation, scene};
use crate::synthetic::people::{PEOPLE, Person};
use crate::synthetic::{motion, studio};

/// The pelvis of the average adult, metres above the floor: people of other statures stand on the same floor.
const PELVIS_HEIGHT: f64 = 0.9;

/// What to vary.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Options {
    /// Moments of the built-in movement, in its frames.
    pub moments: Vec<f64>,
    /// Pixels across and down of each of the four cameras.
    pub size_px: [u64; 2],
    /// How far every rotation starts from the truth, radians.
    pub start_angle_rad: f64,
    /// How far the root starts from the truth, metres.
    pub start_distance_m: f64,
    /// Seed of the starts.
    pub seed: u64,
    /// The fit.
    pub fit: BodyFitOptions,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            moments: vec![0.0, 8.0, 16.0, 24.0, 31.0, 41.0, 50.0, 59.0],
            size_px: [studio::WIDTH, studio::HEIGHT],
            start_angle_rad: 5.0_f64.to_radians(),
            start_distance_m: 0.03,
            seed: 1,
            fit: BodyFitOptions::default().with_proportions(WELL_SEEN),
        }
    }
}

/// What came of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// One build each.
    pub people: Vec<PersonReport>,
}

/// One build.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PersonReport {
    /// What the build is called.
    pub name: &'static str,
    /// True size of the body, as a factor of the average adult's.
    pub true_size: f64,
    /// The size that was found.
    pub size: f64,
    /// IoU of the body scaled as a whole and of the body found.
    pub iou: [Option<f64>; 2],
    /// Mean distance of the joints of all moments, millimetres.
    pub joint_error_mm: f64,
    /// Iterations of all stages.
    pub iterations: usize,
    /// Every size.
    pub sizes: Vec<SizeError>,
}

/// One size of one build, millimetres.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SizeError {
    /// The limb, without its side.
    pub name: String,
    /// Length or radius.
    pub kind: SizeKind,
    /// What it is.
    pub truth_mm: f64,
    /// What was found.
    pub found_mm: f64,
    /// Standard deviation that the fit states.
    pub deviation_mm: f64,
    /// Deviation over that of the proportions alone: 1 if the silhouettes say nothing.
    pub uncertainty: f64,
    /// Whether the fit says that the silhouettes hardly show it.
    pub held_by_prior: bool,
}

impl SizeError {
    /// Found less true, millimetres.
    #[must_use]
    pub fn error_mm(&self) -> f64 {
        self.found_mm - self.truth_mm
    }
}

impl PersonReport {
    /// The largest error of a kind, millimetres, with its size; of all sizes, or of those that silhouettes show.
    #[must_use]
    pub fn worst(&self, kind: SizeKind, seen_only: bool) -> Option<&SizeError> {
        let of_kind =
            self.sizes.iter().filter(|size| size.kind == kind && !(seen_only && size.held_by_prior));
        of_kind.max_by(|a, b| a.error_mm().abs().total_cmp(&b.error_mm().abs()))
    }

    /// The mean absolute error of a kind, millimetres.
    #[must_use]
    pub fn mean_mm(&self, kind: SizeKind) -> f64 {
        let errors: Vec<f64> =
            self.sizes.iter().filter(|size| size.kind == kind).map(|size| size.error_mm().abs()).collect();
        errors.iter().sum::<f64>() / errors.len().max(1) as f64
    }
}

/// Finds every person's sizes.
///
/// # Errors
/// Options that make no sense, or `cancel`.
pub fn run(
    options: &Options,
    cancel: &CancelToken,
    mut on_progress: impl FnMut(Progress),
) -> Result<Report, ExperimentError> {
    let adult = Arc::new(builtin::full_body());
    let [width, height] = options.size_px;
    let cameras: Vec<Arc<Camera>> = studio::cameras()
        .cameras()
        .iter()
        .map(|camera| Ok(Arc::new(camera.without_distortion().resized(width, height)?)))
        .collect::<Result<_, ExperimentError>>()?;
    let mut people = Vec::new();
    for person in &PEOPLE {
        on_progress(Progress { done: people.len(), total: PEOPLE.len() });
        let body = person.of(&adult)?;
        let truths: Vec<Pose> =
            options.moments.iter().map(|&moment| true_pose(person, &body, moment)).collect();
        let frames = frames(options, &adult, &body, &truths, &cameras)?;
        let fit = fit_body(adult.clone(), frames, None, &options.fit, cancel, |_| {});
        let fit = fit.map_err(|error| match error {
            BodyFitError::Cancelled => ExperimentError::Cancelled,
            error => ExperimentError::Body { person: person.name, error },
        })?;
        people.push(report(person, &body, &truths, &fit));
    }
    on_progress(Progress { done: PEOPLE.len(), total: PEOPLE.len() });
    Ok(Report { people })
}

/// The movement's pose, lowered to where this person's feet are on the floor.
pub(super) fn true_pose(person: &Person, body: &Model, moment: f64) -> Pose {
    let mut pose = motion::pose(body, moment);
    pose.root -= DVec3::Z * (PELVIS_HEIGHT * (1.0 - person.stature));
    pose
}

fn frames(
    options: &Options,
    adult: &Model,
    body: &Model,
    truths: &[Pose],
    cameras: &[Arc<Camera>],
) -> Result<Vec<BodyFrame>, ExperimentError> {
    let frame = |(index, truth): (usize, &Pose)| {
        let see =
            |camera| scene::view(body, truth, camera, Simulation::Mask, RendererKind::Capsule, Ramp::Half);
        let seed = options.seed.wrapping_add(index as u64);
        Ok(BodyFrame {
            frame: index,
            views: cameras.iter().map(see).collect::<Result<_, _>>()?,
            start: start::perturb(adult, truth, options.start_angle_rad, options.start_distance_m, seed),
            joints: Vec::new(),
        })
    };
    truths.iter().enumerate().map(frame).collect()
}

fn report(person: &Person, body: &Model, truths: &[Pose], fit: &BodyFit) -> PersonReport {
    let (mut sum, mut count) = (0.0, 0.0);
    for (&frame, pose) in fit.frames.iter().zip(&fit.poses) {
        let (truth, found) = (Kinematics::new(body, &truths[frame]), Kinematics::new(&fit.model, pose));
        for (truth, found) in truth.ends().iter().zip(found.ends()) {
            sum += truth.distance(*found);
            count += 1.0;
        }
    }
    let sizes = fit.sizes.iter().map(|size| {
        let is_it = |name: &str| name == size.name || name.strip_prefix("right ") == Some(&size.name);
        let limb = body.limbs().iter().find(|limb| is_it(&limb.name));
        let truth = limb.map_or(f64::NAN, |limb| match size.kind {
            SizeKind::Length => limb.length,
            SizeKind::Radius => limb.radius,
        });
        SizeError {
            name: size.name.clone(),
            kind: size.kind,
            truth_mm: 1000.0 * truth,
            found_mm: 1000.0 * size.found,
            deviation_mm: 1000.0 * size.deviation,
            uncertainty: size.uncertainty(),
            held_by_prior: size.is_held_by_prior(),
        }
    });
    PersonReport {
        name: person.name,
        true_size: person.stature,
        size: fit.size,
        iou: fit.iou,
        joint_error_mm: 1000.0 * sum / count,
        iterations: fit.iterations,
        sizes: sizes.collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Half of the experiment's moments.
    #[test]
    fn people_of_all_builds_get_their_sizes() {
        let options = Options { moments: vec![0.0, 16.0, 31.0, 50.0], ..Options::default() };
        let report = run(&options, &CancelToken::new(), |_| {}).unwrap();
        let mut failures = Vec::new();
        for person in &report.people {
            for (kind, most_mm) in [(SizeKind::Length, 10.0), (SizeKind::Radius, 5.0)] {
                let worst = person.worst(kind, true).unwrap();
                if worst.error_mm().abs() > most_mm {
                    failures.push(format!("{}: {worst:?}", person.name));
                }
            }
        }
        assert!(failures.is_empty(), "{}", failures.join("\n"));
    }

    #[test]
    fn a_cancelled_experiment_says_so() {
        let cancel = CancelToken::new();
        cancel.cancel();
        assert_eq!(run(&Options::default(), &cancel, |_| {}), Err(ExperimentError::Cancelled));
    }
}
