//! A track beside references, whatever files they are in: for the command line and the window.

use std::collections::BTreeMap;
use std::path::Path;

use backlit_formats::Take;
use backlit_formats::motion::Motion;
use backlit_formats::recording::{self, RecordingOptions};
use backlit_tracking::body::joint_names;
use backlit_tracking::metrics::Trajectories;
use backlit_tracking::metrics::comparison::{
    AngleAgreement, ClockOffset, ComparisonOptions, ErrorStatistics, PCK_MM, Posed, TrackComparison,
    WorldMap, WorldMatch, compare,
};
use backlit_tracking::statistics::Statistics;
use glam::DQuat;
use serde_json::{Value, json};

use crate::results::{is_ours, read_tracked};

mod overlap;

pub use overlap::{CameraOverlap, ComparedOverlap, compare_overlap};

/// What a track is compared with.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparedReference {
    /// What it is called: its file's name.
    pub name: String,
    /// Its joints or angles.
    pub trajectories: Trajectories,
    /// Its overlap by camera, of a track of ours.
    pub overlap: BTreeMap<String, f64>,
    /// Its poses, of a track or a project of ours.
    pub motion: Option<Motion>,
}

/// Reads a reference: a recording of any tool, a track of ours (its file or its folder), or a project.
///
/// # Errors
/// As [`recording::read`] and [`read_tracked`], and where no joint and no angle is known by its name.
pub fn read_reference(path: &Path, options: &RecordingOptions) -> anyhow::Result<ComparedReference> {
    let name = path
        .file_name()
        .map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned());
    if is_ours(path) {
        let tracked = read_tracked(path, None)?;
        let Motion { model, frame_rate, poses, .. } = &tracked.motion;
        let trajectories = Trajectories::of_poses(model, *frame_rate, poses);
        return Ok(ComparedReference {
            name,
            trajectories,
            overlap: tracked.overlap,
            motion: Some(tracked.motion),
        });
    }
    let trajectories = recording::read(path, options)?.trajectories(path, options)?;
    Ok(ComparedReference { name, trajectories, overlap: BTreeMap::new(), motion: None })
}

impl ComparedReference {
    /// A take's own reference keypoints; `None` without any. They lie in its world and have its clock.
    #[must_use]
    pub fn of_take(take: &Take) -> Option<Self> {
        let keypoints = take.reference()?;
        let joints = joint_names(take.model());
        let (mut times, mut points) = (Vec::new(), Vec::new());
        for frame in 0..take.frame_count() {
            let mut row = vec![None; joints.len()];
            for (limb, place) in keypoints.joints(frame) {
                if let Some(limb) = limb {
                    row[limb] = Some(place);
                }
            }
            if row.iter().any(Option::is_some) {
                times.push(frame as f64 / take.frame_rate());
                points.push(row);
            }
        }
        let trajectories = Trajectories { joints, times, points, angles: BTreeMap::new() };
        let name = "the take’s reference".to_owned();
        let overlap = BTreeMap::new();
        (!trajectories.times.is_empty()).then_some(Self { name, trajectories, overlap, motion: None })
    }
}

/// How a take's own reference is compared: its clock and its world are the take's.
pub const AS_IT_IS: ComparisonOptions =
    ComparisonOptions { offset_s: Some(0.0), most_offset_s: 0.0, same_world: true };

/// Compares a body's poses with a reference.
#[must_use]
pub fn compare_motion(
    motion: &Motion,
    reference: &ComparedReference,
    options: &ComparisonOptions,
) -> TrackComparison {
    let track = Posed { model: &motion.model, poses: &motion.poses, frame_rate: motion.frame_rate };
    compare(&track, &reference.trajectories, options)
}

/// How the clock was set, in words.
#[must_use]
pub fn clock_words(clock: ClockOffset) -> String {
    let ClockOffset { seconds, is_measured } = clock;
    match seconds {
        0.0 => "both start together".to_owned(),
        _ => {
            let by = if seconds > 0.0 { "late" } else { "early" };
            let how = if is_measured { "measured from the motion" } else { "as told" };
            format!("the reference is {:.3} s {by} ({how})", seconds.abs())
        }
    }
}

/// How the worlds were matched, in words.
#[must_use]
pub fn world_words(world: &WorldMap) -> String {
    let scale = match world.scale {
        1.0 => String::new(),
        scale => format!(", its unit is {} m", (scale * 1e6).round() / 1e6),
    };
    let axes = |rotation: &glam::DMat3| -> String {
        let letter = |axis: glam::DVec3| {
            let index = axis.abs().max_position();
            format!("{}{}", if axis[index] < 0.0 { "-" } else { "" }, ["x", "y", "z"][index])
        };
        let rows = rotation.transpose();
        [rows.x_axis, rows.y_axis, rows.z_axis].map(letter).join(", ")
    };
    match world.kind {
        WorldMatch::Same if world.rotation == glam::DMat3::IDENTITY => format!("the same axes{scale}"),
        WorldMatch::Same => format!("our x, y, z are its {}{scale}", axes(&world.rotation)),
        WorldMatch::Fitted => {
            let angle = DQuat::from_mat3(&world.rotation).to_axis_angle().1.to_degrees();
            let angle = angle.min(360.0 - angle);
            let moved = world.translation.length();
            format!("fitted to the joints: turned by {angle:.1}°, moved by {moved:.2} m{scale}")
        }
    }
}

/// A figure with its digits behind the point.
pub type Figure = (Option<f64>, usize);

/// What [`error_figures`] are called.
#[must_use]
pub fn error_titles() -> [String; 9] {
    let [a, b, c] = PCK_MM.map(|mm| format!("{mm:.0} mm, %"));
    let [mean, median, p95, placed, root, shape] =
        ["mean", "median", "95 %", "placed", "root-aligned", "Procrustes"].map(str::to_owned);
    [mean, median, p95, placed, root, shape, a, b, c]
}

/// Errors as tables have them: millimetres, then the shares of the PCK in per cent.
#[must_use]
pub fn error_figures(errors: &ErrorStatistics) -> [Figure; 9] {
    let mean = |of: &Option<Statistics>| of.as_ref().map(|of| of.mean);
    let [a, b, c] = errors.pck.map(|share| (Some(100.0 * share), 0));
    let Statistics { mean: raw, median, p95, .. } = errors.raw;
    let mm = [
        Some(raw),
        Some(median),
        Some(p95),
        errors.placed,
        mean(&errors.root_aligned),
        mean(&errors.procrustes),
    ];
    let [raw, median, p95, placed, root, shape] = mm.map(|mm| (mm, 1));
    [raw, median, p95, placed, root, shape, a, b, c]
}

/// What [`angle_figures`] are called.
pub const ANGLE_TITLES: [&str; 4] = ["RMS", "mean difference", "RMS without it", "correlation"];

/// How an angle agrees, as tables have it: degrees, then the correlation.
#[must_use]
pub fn angle_figures(angle: &AngleAgreement) -> [Figure; 4] {
    let degrees = [angle.rms, angle.offset, angle.rms_without_offset].map(|degrees| (Some(degrees), 1));
    [degrees[0], degrees[1], degrees[2], (angle.correlation, 3)]
}

fn statistics(statistics: &Statistics) -> Value {
    let Statistics { mean, median, p95, max, count } = statistics;
    json!({"mean": mean, "median": median, "p95": p95, "max": max, "count": count})
}

fn errors(errors: &ErrorStatistics) -> Value {
    json!({
        "raw": statistics(&errors.raw),
        "placed": errors.placed,
        "root_aligned": errors.root_aligned.as_ref().map(statistics),
        "procrustes": errors.procrustes.as_ref().map(statistics),
        "pck": PCK_MM.iter().zip(errors.pck).map(|(mm, share)| json!({"mm": mm, "share": share})).collect::<Vec<_>>(),
    })
}

fn agreement(agreement: &AngleAgreement) -> Value {
    let AngleAgreement { angle, rms, offset, rms_without_offset, correlation, is_turned, curves } = agreement;
    let count = curves.iter().filter(|pair| pair.iter().all(Option::is_some)).count();
    json!({
        "angle": angle.label(), "rms": rms, "offset": offset, "rms_without_offset": rms_without_offset,
        "correlation": correlation, "turned": is_turned, "count": count,
    })
}

/// A comparison as JSON: millimetres, degrees, seconds. Overlaps are measured ones, or else as the reference was tracked.
#[must_use]
pub fn to_json(
    reference: &ComparedReference,
    found: &TrackComparison,
    measured: Option<&ComparedOverlap>,
) -> Value {
    let WorldMap { kind, scale, rotation, translation } = &found.world;
    let by_joint: BTreeMap<&String, Value> =
        found.by_joint.iter().map(|(joint, of_joint)| (joint, errors(of_joint))).collect();
    let of = |side: fn(&CameraOverlap) -> f64| -> Option<BTreeMap<String, f64>> {
        let cameras = measured?.cameras.iter();
        Some(cameras.map(|camera| (camera.camera.clone(), side(camera))).collect())
    };
    json!({
        "reference": reference.name,
        "frames": found.frames.len(),
        "clock": {"seconds": found.clock.seconds, "measured": found.clock.is_measured},
        "world": {
            "fitted": *kind == WorldMatch::Fitted, "scale": scale,
            "rotation": rotation.transpose().to_cols_array_2d(), "translation": translation.to_array(),
        },
        "joint_error_mm": found.overall.as_ref().map(errors),
        "by_joint": by_joint,
        "angles_degrees": found.angles.iter().map(agreement).collect::<Vec<_>>(),
        "overlap": of(|camera| camera.reference).unwrap_or_else(|| reference.overlap.clone()),
        "track_overlap": of(|camera| camera.track),
        "overlap_frames": measured.map(|measured| measured.frames),
    })
}
