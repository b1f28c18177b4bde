//! The cameras of a take refined by the silhouettes of a person.

use backlit_formats::{Footage, FootageError, Take};
use backlit_tracking::body::Pose;
use backlit_tracking::body_fit::{
    BodyProgress, CameraChoice, CameraRefinementError, CameraRefinementOptions, CameraRefinementProgress,
    CameraRefinementStep, CameraState, RefinedCamera, RefinedCameras, refine_cameras,
};
use backlit_tracking::camera::{CameraChange, CameraError, Rig, RigError};
use backlit_tracking::cancel::CancelToken;
use backlit_words::format::number;
use serde_json::json;
use thiserror::Error;

/// Why the cameras of a take cannot be refined.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the messages say what each variant is")]
pub enum TakeRefinementError {
    #[error(transparent)]
    Footage(#[from] FootageError),
    #[error(transparent)]
    Refinement(#[from] CameraRefinementError),
    #[error(transparent)]
    Camera(#[from] CameraError),
    #[error(transparent)]
    Rig(#[from] RigError),
}

/// Refines these cameras of a take by a person who begins the first of these frames in a pose. Returns what was found, and all cameras
/// of the take with it changed, for pictures as large as on the disk.
///
/// # Errors
/// Silhouettes that cannot be had or cannot be a person's, too few cameras or frames, or `cancel`.
pub fn refine(
    footage: &Footage,
    cameras: &[usize],
    (start, frames): (Pose, &[usize]),
    options: &CameraRefinementOptions,
    cancel: &CancelToken,
    tell: impl FnMut(CameraRefinementProgress),
) -> Result<(RefinedCameras, Rig), TakeRefinementError> {
    let take = footage.take();
    let views = |frame| -> Result<_, TakeRefinementError> { Ok(footage.single_views(cameras, frame)?) };
    let found = refine_cameras(take.model(), start, frames, options, cancel, views, tell)?;
    let rig = refined(take, cameras, &found)?;
    Ok((found, rig))
}

/// All cameras of the take as they are on the disk, with what was found changed.
fn refined(take: &Take, cameras: &[usize], found: &RefinedCameras) -> Result<Rig, TakeRefinementError> {
    let mut all = take.full_rig().cameras().to_vec();
    let pixels = f64::from(take.reduction());
    for (&camera, refined) in cameras.iter().zip(&found.cameras) {
        let change = refined.change.change;
        let change = CameraChange { principal_px: pixels * change.principal_px, ..change };
        all[camera] = all[camera].changed(&change)?;
    }
    Ok(Rig::new(all)?)
}

/// What is being done.
#[must_use]
pub fn progress_text(at: CameraRefinementProgress) -> String {
    let stage = |what: &str, at: BodyProgress| {
        format!("{what}: stage {} of {}, step {}", at.stage + 1, at.stages, at.iterations)
    };
    let step = match at.step {
        CameraRefinementStep::Following(_) => "following the person".to_owned(),
        CameraRefinementStep::Body(at) => stage("poses and sizes", at),
        CameraRefinementStep::Cameras(at) => stage("cameras", at),
        CameraRefinementStep::Judging(done, all) => return format!("{done} of {all} frames judged"),
    };
    format!("round {} of {}, {step}", at.round + 1, at.rounds)
}

/// What the calibration holds, because silhouettes cannot tell it.
pub const HELD: &str =
    "held as calibrated: where the whole rig stands, how it is turned, and how large it is";

/// What was changed of a camera: "turn, °", by how much, and the standard deviation of that.
pub type ChangeWords = (&'static str, [String; 2]);

/// Everything of a camera that was free.
#[must_use]
pub fn changes(camera: &RefinedCamera, choice: &CameraChoice) -> Vec<ChangeWords> {
    type Row = (bool, &'static str, usize, fn(&CameraState) -> f64);
    let rows: [Row; 6] = [
        (true, "turn, °", 2, |state| state.change.turn.length().to_degrees()),
        (true, "place, mm", 1, |state| 1e3 * state.change.shift.length()),
        (choice.focal_length, "focal length, %", 2, |state| 100.0 * state.change.zoom),
        (choice.principal_point, "principal point, px", 1, |state| state.change.principal_px.length()),
        (choice.offset, "clock late, ms", 2, |state| 1e3 * state.late_s),
        (choice.drift, "clock slow, ms a minute", 2, |state| 6e4 * state.drift),
    ];
    let free = rows.into_iter().filter(|row| row.0);
    let of = |state, digits, value: fn(&CameraState) -> f64| number(value(state), digits);
    free.map(|(_, what, digits, value)| {
        (what, [&camera.change, &camera.deviation].map(|state| of(state, digits, value)))
    })
    .collect()
}

/// What was found, for programs.
#[must_use]
pub fn to_json(found: &RefinedCameras) -> serde_json::Value {
    let numbers = |state: &CameraState| {
        let change = &state.change;
        json!({
            "turn_degrees": change.turn.to_array().map(f64::to_degrees),
            "place_m": change.shift.to_array(),
            "focal_length_percent": 100.0 * change.zoom,
            "principal_point_px": change.principal_px.to_array(),
            "late_seconds": state.late_s,
            "drift": state.drift,
        })
    };
    let cameras = found.cameras.iter().map(|camera| {
        json!({
            "camera": camera.camera.name(),
            "change": numbers(&camera.change),
            "deviation": numbers(&camera.deviation),
            "held_out_iou": camera.held_out_iou,
        })
    });
    json!({
        "cameras": cameras.collect::<Vec<_>>(),
        "frames": found.body.frames,
        "held_out": found.held_out,
        "iou": [found.before.iou[1], found.body.iou[1]],
        "rms": [found.before.rms[1], found.body.rms[1]],
        "held": ["place", "turn", "size"],
    })
}
