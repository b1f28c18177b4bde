//! The files that `backlit track` writes.

use std::fmt::Write;
use std::path::Path;

use anyhow::Context;
use backlit_tracking::body::{Kinematics, Model, Pose};
use backlit_tracking::io::{Take, atomic};
use serde_json::{Map, Value, json};

use super::track_report::TrackReport;

/// Writes all files, each whole or not at all.
///
/// # Errors
/// The folder is not writable; the message names the file.
pub fn write(folder: &Path, take: &Take, report: &TrackReport) -> anyhow::Result<()> {
    let summary = serde_json::to_string_pretty(&report.summary())? + "\n";
    for (name, content) in [
        ("poses.json", poses(take, report)?),
        ("joints.json", joints_json(take, report)?),
        ("joints.csv", joints_csv(take, report)),
        ("frames.csv", frames_csv(report)),
        ("summary.json", summary),
    ] {
        atomic::write(&folder.join(name), content.as_bytes())?;
    }
    Ok(())
}

/// Every joint's name and place: the root, then each limb's second joint.
fn joints<'a>(model: &'a Model, pose: &Pose) -> Vec<(&'a str, [f64; 3])> {
    let kinematics = Kinematics::new(model, pose);
    let ends = model.limbs().iter().zip(kinematics.ends());
    let root = std::iter::once(("root", pose.root.to_array()));
    root.chain(ends.map(|(limb, end)| (limb.name.as_str(), end.to_array()))).collect()
}

/// A frame a line, so that files can be compared.
fn lines_json(format: &str, take: &Take, frames: &[Value]) -> anyhow::Result<String> {
    let name = serde_json::to_string(take.name())?;
    let rate = take.frame_rate();
    let mut out =
        format!("{{\n  \"format\": \"{format}\",\n  \"take\": {name},\n  \"frame_rate\": {rate},\n");
    out.push_str("  \"frames\": [\n");
    for (index, frame) in frames.iter().enumerate() {
        let comma = if index + 1 < frames.len() { "," } else { "" };
        writeln!(out, "    {frame}{comma}")?;
    }
    out.push_str("  ]\n}\n");
    Ok(out)
}

fn poses(take: &Take, report: &TrackReport) -> anyhow::Result<String> {
    let model = take.model();
    let frame = |frame: &super::track_report::ReportedFrame| {
        let estimate = &frame.estimate;
        let rotations: Map<String, Value> = model
            .rotation_owners()
            .iter()
            .zip(&estimate.pose.rotations)
            .map(|(&owner, q)| (model.limbs()[owner].name.clone(), json!([q.w, q.x, q.y, q.z])))
            .collect();
        json!({
            "frame": estimate.frame,
            "lost": estimate.lost,
            "root": estimate.pose.root.to_array(),
            "rotations": rotations,
        })
    };
    let frames: Vec<Value> = report.frames().iter().map(frame).collect();
    lines_json("backlit-track 1", take, &frames).context("poses.json")
}

fn joints_json(take: &Take, report: &TrackReport) -> anyhow::Result<String> {
    let frame = |frame: &super::track_report::ReportedFrame| {
        let positions = joints(take.model(), &frame.estimate.pose).into_iter();
        let positions: Map<String, Value> =
            positions.map(|(name, position)| (name.to_owned(), json!(position))).collect();
        json!({"frame": frame.estimate.frame, "joints": positions})
    };
    let frames: Vec<Value> = report.frames().iter().map(frame).collect();
    lines_json("backlit-joints 1", take, &frames).context("joints.json")
}

fn joints_csv(take: &Take, report: &TrackReport) -> String {
    let mut out = "frame,joint,x,y,z\n".to_owned();
    for frame in report.frames() {
        for (name, [x, y, z]) in joints(take.model(), &frame.estimate.pose) {
            out.push_str(&format!("{},{},{x},{y},{z}\n", frame.estimate.frame, quoted(name)));
        }
    }
    out
}

fn frames_csv(report: &TrackReport) -> String {
    let mut out = "frame,cost,rms,iou".to_owned();
    for camera in report.cameras() {
        out.push_str(&format!(",{}", quoted(&format!("iou {camera}"))));
    }
    out.push_str(",iterations,lost,termination,ms,joint_error_mm\n");
    let errors = report.error_by_frame();
    // An empty cell where there is no number.
    let number = |value: Option<f64>| value.map(|value| value.to_string()).unwrap_or_default();
    for frame in report.frames() {
        let estimate = &frame.estimate;
        out.push_str(&format!(
            "{},{},{},{}",
            estimate.frame,
            estimate.cost,
            estimate.rms,
            number(estimate.iou())
        ));
        for overlap in &estimate.overlap {
            out.push_str(&format!(",{}", number(overlap.and_then(|overlap| overlap.iou()))));
        }
        let termination = estimate.termination.map_or("no-data", |termination| termination.name());
        let error = number(errors.get(&estimate.frame).copied());
        let (iterations, lost, ms) = (estimate.iterations, estimate.lost, frame.milliseconds);
        out.push_str(&format!(",{iterations},{lost},{termination},{ms:.2},{error}\n"));
    }
    out
}

/// A cell of a table of comma-separated values.
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}
