//! The real footage, tracked end to end by the built program: how far the fitted joints are from the keypoints,
//! and how well the silhouettes agree.

use serde_json::Value;

use crate::footage::footage;
use crate::scene::Scene;

/// Largest mean distance of a joint from its keypoint, which is itself good to a few centimetres. The robust preset has
/// 30.1 mm, the report's 34 to 35.
const MEAN_ERROR_MM: f64 = 31.0;
/// 95 % lie below: 53.7, the report's 63.
const P95_ERROR_MM: f64 = 57.0;
/// Largest distance of all: 67.3.
const MAX_ERROR_MM: f64 = 80.0;
/// Smallest mean overlap: 0.869, the report's 0.857.
const IOU: f64 = 0.865;

/// What the program prints of the real take; `None` where there is no footage.
fn json(command: &str, options: &str) -> Option<Value> {
    const TAKE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/takes/balancing");
    let footage = std::path::absolute(footage()?.parent().unwrap()).unwrap();
    let scene = Scene::new();
    let mut command = scene.command(&format!("{command} {TAKE} {options} --json --out results"));
    let output = command.env("BACKLIT_DATA", footage).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    // Nothing but JSON on standard output.
    Some(serde_json::from_slice(&output.stdout).unwrap())
}

/// Four cameras, with the person's own sizes.
#[test]
fn the_real_person_is_found_without_a_start() {
    let options = "--no-start --methods search --cameras 4";
    let Some(found) = json("experiment begin --take", options) else { return };
    assert_eq!(found["report"]["rows"][0]["found"], 1, "{found}");
}

/// Every other camera's clock is shifted by whole frames; all four cameras together are the last case.
#[test]
fn a_shift_of_real_footage_is_found() {
    let Some(found) = json("experiment sync", "--shifts 0,7,-12") else { return };
    let cases = found["report"]["cases"].as_array().unwrap();
    let offsets = cases.last().unwrap()["found"].as_array().unwrap();
    assert_eq!(offsets.len(), 9);
    for offset in offsets {
        let (error, period) = (offset["error_s"].as_f64().unwrap(), offset["period_s"].as_f64().unwrap());
        assert!(error.abs() <= 0.5 * period, "{offset}");
    }
}

#[test]
fn a_real_person_is_followed_from_a_noisy_start() {
    // Every fifth frame of 70: faster, and harder than all of them.
    let Some(summary) = json("track", "--every 5 --start reference --start-noise 5deg,3cm --seed 1") else {
        return;
    };
    assert_eq!((summary["frames"].as_u64(), summary["lost"].as_u64()), (Some(14), Some(0)), "{summary}");
    let number = |pointer: &str| summary.pointer(pointer).and_then(Value::as_f64).unwrap();
    assert!(number("/joint_error_mm/mean") <= MEAN_ERROR_MM, "{summary}");
    assert!(number("/joint_error_mm/p95") <= P95_ERROR_MM, "{summary}");
    assert!(number("/joint_error_mm/max") <= MAX_ERROR_MM, "{summary}");
    assert!(number("/iou/mean") >= IOU, "{summary}");
    assert_eq!(summary["iou"]["by_camera"].as_object().unwrap().len(), 4);
    for name in ["median", "p95"] {
        assert!(number(&format!("/joint_error_mm/{name}")) <= number("/joint_error_mm/max"), "{summary}");
        assert!(number(&format!("/ms_per_frame/{name}")) > 0.0, "{summary}");
    }
    assert_eq!(summary["joint_error_mm"]["by_joint"].as_object().unwrap().len(), 12);
}
