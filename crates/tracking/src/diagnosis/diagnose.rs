//! The search for the fault that explains best what does not fit.

use thiserror::Error;

use super::fault::{ClockChange, FaultKind, Size};
use super::pair_angles::{Residuals, median_px};
use super::state::State;
use crate::camera::Camera;
use crate::cancel::CancelToken;
use crate::synchronise::Recording;

/// How faults are looked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiagnosisOptions {
    /// A fault is told where it explains so much more than none, nats.
    pub least_evidence: f64,
    /// Faults are told that move what a camera sees by so much, shares of the picture's height.
    pub least_effect: f64,
    /// Most faults that are told.
    pub most_findings: usize,
}

impl Default for DiagnosisOptions {
    fn default() -> Self {
        Self { least_evidence: 8.0, least_effect: 0.002, most_findings: 4 }
    }
}

/// What the cameras say of one another.
#[derive(Debug, Clone, PartialEq)]
pub struct Diagnosis {
    /// What is wrong; each was found with those before it repaired.
    pub findings: Vec<Finding>,
    /// Every two cameras.
    pub pairs: Vec<PairAgreement>,
    /// How tall the subject is in the take's metres, the median over frames: its largest extent.
    pub subject_m: Option<f64>,
    /// Deviation of where a silhouette's edge is seen with all findings repaired, pixels.
    pub noise_px: f64,
    /// The same of keypoints; `None` without any.
    pub keypoint_noise_px: Option<f64>,
}

/// How far two cameras agree on the half-planes that touch the subject.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairAgreement {
    /// Their indices.
    pub cameras: [usize; 2],
    /// Median size of what they are apart, pixels: as the take is, and with all findings repaired. `None` where no half-plane
    /// touches both silhouettes.
    pub apart_px: [Option<f64>; 2],
    /// The same of the half-planes through joints that keypoints show; `None` without any.
    pub keypoints_apart_px: [Option<f64>; 2],
    /// Share of frames that say something.
    pub share: f64,
}

/// A fault.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// The camera; `None` if all have it.
    pub camera: Option<usize>,
    /// The camera that it is exchanged with.
    pub with: Option<usize>,
    /// What is wrong with it.
    pub kind: FaultKind,
    /// How wrong.
    pub sizes: Vec<Size>,
    /// From when on, seconds; `None` if all the time.
    pub since_s: Option<f64>,
    /// By how much it explains the silhouettes better than no fault, nats.
    pub evidence: f64,
    /// Median distance of what this camera and the others see from what would agree, pixels: before and after the repair. For a
    /// unit that all have, `None`.
    pub apart_px: Option<[f64; 2]>,
    /// The same of keypoints; `None` without any.
    pub keypoints_apart_px: Option<[f64; 2]>,
    /// Share of its silhouette's edges that the hull of the others does not explain: before and after the repair. `None` with two
    /// cameras, and where all cameras have the fault.
    pub unexplained: Option<[f64; 2]>,
    /// Other explanations that are less likely by no more than a factor of a thousand, the best first.
    pub rivals: Vec<Rival>,
    /// All cameras with this and the findings before it repaired.
    pub cameras: Vec<Camera>,
    /// What is to be done with the camera's clock, if that is wrong.
    pub clock: Option<ClockChange>,
}

/// Another explanation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rival {
    /// The camera; `None` for all.
    pub camera: Option<usize>,
    /// What would be wrong with it.
    pub kind: FaultKind,
    /// By how much it explains less, nats.
    pub behind: f64,
}

/// Why cameras cannot be checked.
#[derive(Debug, Error, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum DiagnosisError {
    #[error("there is {count} camera; expected two or more, which are checked against one another")]
    Count { count: usize },
    #[error("there are {lenses} cameras for {recordings} recordings; expected one for each")]
    Lenses { lenses: usize, recordings: usize },
    #[error("the check of the cameras was stopped")]
    Cancelled,
}

/// Looks for faults. `lenses` are the cameras of the pictures as they were taken; those of the recordings may be without the lens.
///
/// The same bits for any number of threads. `on_progress` hears hypotheses that were tried, and of how many.
///
/// # Errors
/// Fewer than two cameras, or when cancelled.
pub fn diagnose(
    recordings: &[Recording],
    lenses: &[Camera],
    options: &DiagnosisOptions,
    cancel: &CancelToken,
    mut on_progress: impl FnMut(usize, usize),
) -> Result<Diagnosis, DiagnosisError> {
    let count = recordings.len();
    if count < 2 {
        return Err(DiagnosisError::Count { count });
    }
    if lenses.len() != count {
        return Err(DiagnosisError::Lenses { lenses: lenses.len(), recordings: count });
    }
    let mut state = State::new(recordings, lenses.to_vec());
    let before = state.full.residuals.clone();
    let mut findings = Vec::new();
    let mut noise_px = state.noise();
    while findings.len() < options.most_findings {
        let ranking = state.rank(cancel, &mut on_progress).ok_or(DiagnosisError::Cancelled)?;
        noise_px = ranking.noise_px;
        let Some((finding, repair)) = state.finding(&ranking, options) else { break };
        findings.push(finding);
        state.apply(&repair);
        if repair.after.is_some() {
            // A camera that was moved is two cameras, which the next round would not know.
            break;
        }
    }
    let subject_m = state.subject();
    if let Some(finding) = subject_m.and_then(|tall| state.unit_of_all(tall)) {
        findings.push(finding);
    }
    let agreement = |(at, cameras): (usize, &[usize; 2])| {
        let both: [&Residuals; 2] = [&before[at], &state.full.residuals[at]];
        let apart = |witness: usize| both.map(|residuals| median_px(residuals.by_witness()[witness]));
        let [silhouettes, _] = both[0].by_witness();
        let share = silhouettes.iter().flatten().count() as f64 / silhouettes.len().max(1) as f64;
        PairAgreement { cameras: *cameras, apart_px: apart(0), keypoints_apart_px: apart(1), share }
    };
    let pairs: Vec<PairAgreement> = state.pairs.iter().enumerate().map(agreement).collect();
    let [noise_px, keypoint_noise_px] = noise_px;
    let has_keypoints = pairs.iter().any(|pair| pair.keypoints_apart_px[0].is_some());
    let keypoint_noise_px = has_keypoints.then_some(keypoint_noise_px);
    Ok(Diagnosis { findings, pairs, subject_m, noise_px, keypoint_noise_px })
}
