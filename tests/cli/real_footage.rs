//! The real footage, tracked end to end by the built program: how far the fitted joints are from the keypoints,
//! and how well the silhouettes agree.
//!
//! Looks for the footage in the folder that `BACKLIT_DATA` names, else in `../shared/data` beside the workspace, and
//! is skipped if it is not there.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

/// Largest mean distance of a joint from its keypoint, which is itself good to a few centimetres.
const MEAN_ERROR_MM: f64 = 40.0;
/// Largest distance of all.
const MAX_ERROR_MM: f64 = 250.0;
/// Smallest mean overlap.
const IOU: f64 = 0.82;

fn data_folder() -> Option<PathBuf> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data");
    let data = std::env::var_os("BACKLIT_DATA").map_or_else(beside, PathBuf::from);
    data.join("balancing").is_dir().then_some(data)
}

#[test]
fn a_real_person_is_followed_from_a_noisy_start() {
    let Some(data) = data_folder() else {
        println!("skipped: no footage (set BACKLIT_DATA)");
        return;
    };
    let out = tempfile::tempdir().unwrap();
    // Every fifth frame of 70: faster, and harder than all of them.
    let output = Command::new(env!("CARGO_BIN_EXE_backlit"))
        .env("BACKLIT_DATA", std::path::absolute(data).unwrap())
        .arg("track")
        .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/takes/balancing"))
        .args(["--every", "5", "--start", "reference", "--start-noise", "5deg,3cm", "--seed", "1", "--json"])
        .arg("--out")
        .arg(out.path())
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    // Nothing but JSON on standard output.
    let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((summary["frames"].as_u64(), summary["lost"].as_u64()), (Some(14), Some(0)), "{summary}");
    let number = |pointer: &str| summary.pointer(pointer).and_then(Value::as_f64).unwrap();
    assert!(number("/joint_error_mm/mean") <= MEAN_ERROR_MM, "{summary}");
    assert!(number("/joint_error_mm/max") <= MAX_ERROR_MM, "{summary}");
    assert!(number("/iou/mean") >= IOU, "{summary}");
    assert_eq!(summary["iou"]["by_camera"].as_object().unwrap().len(), 4);
    for name in ["median", "p95"] {
        assert!(number(&format!("/joint_error_mm/{name}")) <= number("/joint_error_mm/max"), "{summary}");
        assert!(number(&format!("/ms_per_frame/{name}")) > 0.0, "{summary}");
    }
    for (joint, errors) in summary["joint_error_mm"]["by_joint"].as_object().unwrap() {
        assert!(errors["mean"].as_f64().unwrap() <= MAX_ERROR_MM, "{joint}: {errors}");
    }
}
