//! `backlit-track 1`: a track in one JSON (see `docs/formats.md`). What is not known or not finite is null.

use backlit_tracking::body::Kinematics;
use backlit_tracking::cues::LimbHold;
use backlit_tracking::track::FrameEstimate;
use serde_json::{Map, Value, json};

use super::trust_record::TrustRecord;
use super::{ROOT, TrackExport, ending_text};

/// Name and version of the format.
pub const FORMAT: &str = "backlit-track 1";

/// The content of a track file, one line a frame.
#[must_use]
pub fn to_text(export: &TrackExport<'_>) -> String {
    let head = [
        ("format", json!(FORMAT)),
        ("name", json!(export.name)),
        ("frame_rate", json!(export.frame_rate)),
        ("model", json!(export.model.name())),
        ("cameras", json!(export.cameras)),
    ];
    let mut out = "{\n".to_owned();
    for (key, value) in head {
        out.push_str(&format!("  \"{key}\": {value},\n"));
    }
    out.push_str("  \"frames\": [");
    for (index, (number, estimate)) in export.track.frames.iter().enumerate() {
        let comma = if index == 0 { "" } else { "," };
        out.push_str(&format!("{comma}\n    {}", frame(export, *number, estimate)));
    }
    out.push_str("\n  ]\n}\n");
    out
}

fn frame(export: &TrackExport<'_>, number: usize, estimate: &FrameEstimate) -> Value {
    let limbs = export.model.limbs();
    let rotations: Map<String, Value> = export
        .model
        .rotation_owners()
        .iter()
        .zip(&estimate.pose.rotations)
        .map(|(&limb, q)| (limbs[limb].name.clone(), json!([q.w, q.x, q.y, q.z])))
        .collect();
    let kinematics = Kinematics::new(export.model, &estimate.pose);
    let ends = limbs.iter().zip(kinematics.ends());
    let mut joints: Map<String, Value> =
        ends.map(|(limb, end)| (limb.name.clone(), json!(end.to_array()))).collect();
    joints.insert(ROOT.to_owned(), json!(estimate.pose.root.to_array()));
    let overlap = export.cameras.iter().enumerate().map(|(camera, name)| {
        let iou = estimate.overlap.get(camera).copied().flatten().and_then(|overlap| overlap.iou());
        ((*name).to_owned(), json!(iou))
    });
    let pixels = export.cameras.iter().enumerate().map(|(camera, name)| {
        let overlap = estimate.overlap.get(camera).copied().flatten();
        let counts =
            overlap.map(|counts| [counts.agreement, counts.missing, counts.spurious, counts.unknown]);
        ((*name).to_owned(), json!(counts))
    });
    let mut out = json!({
        "frame": number,
        "seconds": number as f64 / export.frame_rate,
        "root": estimate.pose.root.to_array(),
        "rotations": rotations,
        "joints": joints,
        "cost": estimate.cost,
        "rms": estimate.rms,
        "iou": overlap.collect::<Map<String, Value>>(),
        "pixels": pixels.collect::<Map<String, Value>>(),
        "iterations": estimate.iterations,
        "lost": estimate.is_lost(),
        "termination": estimate.termination.map(ending_text),
    });
    if let Some(why) = estimate.lost_because {
        out["lost_because"] = json!(why);
    }
    if !estimate.empty_cameras.is_empty() {
        out["left_out"] = json!(estimate.empty_cameras);
    }
    if !estimate.trust.is_empty() {
        out["trust"] = json!(TrustRecord::of(export.model, &estimate.trust));
    }
    if !estimate.holds.is_empty() {
        let name = |limb: usize| limbs[limb].name.clone();
        let by_cues = estimate.holds.iter().filter(|hold| !hold.by_silhouettes && !hold.is_unsure());
        let cues = |hold: &LimbHold| hold.cues.iter().map(|cue| cue.name()).collect::<Vec<_>>();
        out["held_by_cues"] =
            by_cues.map(|hold| (name(hold.limb), json!(cues(hold)))).collect::<Map<String, Value>>().into();
        let unsure = estimate.holds.iter().filter(|hold| hold.is_unsure());
        out["unsure"] = unsure.map(|hold| json!(name(hold.limb))).collect::<Vec<_>>().into();
    }
    out
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin;

    use super::super::tests::sample;
    use super::*;

    #[test]
    fn a_track_is_json_with_all_in_it() {
        let (model, track) = (builtin::single_limb(), sample());
        let cameras = ["left", "right"];
        let export =
            TrackExport { name: "a \"b\"", frame_rate: 8.0, model: &model, cameras: &cameras, track: &track };
        let text = to_text(&export);
        let read: Value = serde_json::from_str(&text).unwrap();
        assert_eq!((&read["format"], &read["name"]), (&json!(FORMAT), &json!("a \"b\"")));
        let [first, second] = &read["frames"].as_array().unwrap()[..] else { panic!("{text}") };
        assert_eq!((&first["frame"], &first["seconds"]), (&json!(4), &json!(0.5)));
        assert_eq!(first["root"], json!([0.1, -2.0, 3.0]));
        let limb = &model.limbs()[0].name;
        assert_eq!(first["rotations"][limb][0], json!(track.frames[&4].pose.rotations[0].w));
        assert_eq!(first["joints"].as_object().unwrap().len(), 2);
        assert_eq!(first["iou"], json!({"left": 0.75, "right": null}));
        assert_eq!(first["pixels"], json!({"left": [3, 1, 0, 0], "right": null}));
        assert_eq!((&second["cost"], &second["lost"]), (&Value::Null, &json!(true)));
        assert_eq!(second["lost_because"], json!({"reason": "nobody"}));
    }
}
