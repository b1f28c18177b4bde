//! The check of a take's cameras against one another: how it is done, what it says, and the cameras that repair what it finds.

use backlit_formats::synchronise::{TakeClocksError, add_keypoints, record};
use backlit_formats::{Footage, FootageError, Take};
use backlit_tracking::camera::{Camera, Rig};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::diagnosis::{
    Diagnosis, DiagnosisError, DiagnosisOptions, FaultKind, Finding, Rival, Size, diagnose,
};
use backlit_tracking::segment::changes::BackgroundChange;
use backlit_words::format::number;
use glam::DVec2;
use thiserror::Error;

/// What is said where no fault is found.
pub const NOTHING_WRONG: &str = "nothing is wrong with the cameras, as far as the recording tells";

/// From this factor on, how much less likely a rival is stands as a number.
const TELLS_FACTOR_FROM: f64 = 1.5;

/// From this share of edges on, those that the hull of the others does not explain are told.
const LEAST_UNEXPLAINED: f64 = 0.01;

/// What a check is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CheckStage {
    /// Silhouettes of frames are made.
    Frames,
    /// Faults are tried.
    Faults,
    /// Backgrounds that change are looked for.
    Backgrounds,
}

impl CheckStage {
    /// "Silhouettes: 3 of 48 frames".
    #[must_use]
    pub fn text(self, [done, all]: [usize; 2]) -> String {
        match self {
            Self::Frames => format!("Silhouettes: {done} of {all} frames"),
            Self::Faults => format!("Faults: {done} of {all} tried"),
            Self::Backgrounds => format!("Backgrounds: {done} of {all} frames"),
        }
    }
}

/// What a check has found.
#[derive(Debug, Clone)]
pub struct CheckedCameras {
    /// What is wrong with calibrations and clocks.
    pub diagnosis: Diagnosis,
    /// Backgrounds that change while the take is filmed.
    pub changes: Vec<BackgroundChange>,
}

/// Why the cameras of a take cannot be checked.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the messages say what each variant is")]
pub enum CameraCheckError {
    #[error(transparent)]
    Recordings(#[from] TakeClocksError),
    #[error(transparent)]
    Diagnosis(#[from] DiagnosisError),
    #[error("looking for backgrounds that change: {0}")]
    Backgrounds(#[from] FootageError),
}

/// Checks the cameras by at most `most_frames` frames. `tell` hears the stage, and how much of it is done, of how much.
///
/// # Errors
/// Silhouettes cannot be made, there are too few cameras, or it is cancelled.
pub fn check(
    footage: &Footage,
    most_frames: usize,
    cancel: &CancelToken,
    mut tell: impl FnMut(CheckStage, [usize; 2]),
) -> Result<CheckedCameras, CameraCheckError> {
    let take = footage.take();
    let every = take.frame_count().div_ceil(most_frames.max(1));
    let mut recordings = record(footage, every, cancel, |done, all| tell(CheckStage::Frames, [done, all]))?;
    add_keypoints(footage, every, &mut recordings).map_err(TakeClocksError::from)?;
    let at_fault = |done, all| tell(CheckStage::Faults, [done, all]);
    let options = DiagnosisOptions::default();
    let diagnosis = diagnose(&recordings, take.rig().cameras(), &options, cancel, at_fault)?;
    let (cameras, frames): (Vec<_>, Vec<_>) =
        ((0..take.rig().count()).collect(), (0..take.frame_count()).collect());
    let survey = footage.change_survey(&cameras, &frames);
    let changes = survey.changes(cancel, |done| tell(CheckStage::Backgrounds, done))?;
    let changes = changes.ok_or(DiagnosisError::Cancelled)?;
    Ok(CheckedCameras { diagnosis, changes })
}

/// Whether other cameras repair such a fault: not where a clock is wrong, or a camera was moved while it filmed.
pub const fn is_repairable(kind: FaultKind) -> bool {
    !kind.is_clock() && !matches!(kind, FaultKind::Bumped)
}

/// All cameras with this fault and those found before it repaired, for pictures as large as on the disk. `None` where other
/// cameras repair nothing.
pub fn repaired(take: &Take, finding: &Finding) -> Option<Rig> {
    if !is_repairable(finding.kind) {
        return None;
    }
    let scale = DVec2::splat(f64::from(take.reduction()));
    let enlarge = |(camera, full): (&Camera, &Camera)| {
        camera.remapped([full.width() as u64, full.height() as u64], scale, DVec2::ZERO).ok()
    };
    let cameras: Option<_> = finding.cameras.iter().zip(take.full_rig().cameras()).map(enlarge).collect();
    Rig::new(cameras?).ok()
}

/// What is said of a fault.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FindingWords {
    /// "cam3 has a wrong focal length".
    pub what: String,
    /// "turn 0.520 ± 0.040 °, since 6.80 s"; may be empty.
    pub sizes: String,
    /// How far what it sees is from what the others see, before and after.
    pub apart: Option<String>,
    /// "or, 20 times less likely: cam1 is shifted".
    pub rivals: Vec<String>,
    /// What to do where other cameras repair nothing.
    pub advice: Option<&'static str>,
}

impl FindingWords {
    /// The words for a finding among these cameras.
    pub fn of(finding: &Finding, cameras: &[Camera]) -> Self {
        let name = |camera: Option<usize>| {
            camera.map_or("every camera", |camera| cameras.get(camera).map_or("a camera", Camera::name))
        };
        let with = finding.with.map_or_else(String::new, |with| format!(" ({})", name(Some(with))));
        let apart = |[before, after]: [f64; 2]| {
            let both = |[before, after]: [f64; 2]| [number(before, 2), number(after, 2)];
            let [before, after] = both([before, after]);
            let keypoints =
                finding.keypoints_apart_px.map(both).map_or_else(String::new, |[before, after]| {
                    format!("; by keypoints {before} and {after} px")
                });
            let unexplained = finding.unexplained.filter(|shares| shares[0] >= LEAST_UNEXPLAINED);
            let hull = unexplained.map_or_else(String::new, |shares| {
                let [before, after] = shares.map(|share| number(100.0 * share, 0));
                format!("; {before} % and {after} % of its edges lie outside the hull of the others")
            });
            format!("it and the others are {before} px apart, {after} px with that repaired{keypoints}{hull}")
        };
        let rival = |rival: &Rival| {
            let times = rival.behind.exp();
            let less = match times < TELLS_FACTOR_FROM {
                true => "about as likely".to_owned(),
                false => format!("{} times less likely", number(times, 0)),
            };
            format!("or, {less}: {} {}", name(rival.camera), rival.kind.description())
        };
        Self {
            what: format!("{} {}{with}", name(finding.camera), finding.kind.description()),
            sizes: sizes(finding),
            apart: finding.apart_px.map(apart),
            rivals: finding.rivals.iter().map(rival).collect(),
            advice: advice(finding.kind),
        }
    }
}

fn sizes(finding: &Finding) -> String {
    let one = |size: &Size| {
        let digits = if size.value.abs() < 10.0 { 3 } else { 1 };
        let deviation =
            size.deviation.map_or_else(String::new, |deviation| format!(" ± {}", number(deviation, digits)));
        format!("{} {}{deviation} {}", size.what, number(size.value, digits), size.unit).trim_end().to_owned()
    };
    let mut all: Vec<String> = finding.sizes.iter().map(one).collect();
    all.extend(finding.since_s.map(|seconds| format!("since {} s", number(seconds, 2))));
    all.join(", ")
}

const fn advice(kind: FaultKind) -> Option<&'static str> {
    match kind {
        FaultKind::Bumped => Some("leave it out from then on, or calibrate it again"),
        FaultKind::Drift => Some(
            "cut the take into shorter ones, each with an offset of its own in take.toml, or leave the camera out",
        ),
        FaultKind::FrameRate => {
            Some("convert its footage to the frame_rate in take.toml, which all cameras share")
        }
        _ => None,
    }
}
