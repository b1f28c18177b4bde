//! Placements of markers: learnt by `backlit track`, kept as a file, and taken off again.

use std::fs;

use crate::track::take;

/// Markers a constant way off are brought back by what was learnt in other frames, by a file, and by a file that the take names.
#[test]
fn markers_are_placed_by_what_was_learnt() {
    let scene = take();
    // Every marker 50 mm above its joint.
    let truth = fs::read_to_string(scene.path("wave/truth.csv")).unwrap();
    let raise =
        |row: &str| match row.rsplit_once(',').and_then(|(rest, z)| Some((rest, z.parse::<f64>().ok()?))) {
            Some((rest, z)) => format!("{rest},{}", z + 0.05),
            None => row.to_owned(),
        };
    scene.write("raised.csv", &truth.lines().map(raise).collect::<Vec<_>>().join("\n"));
    let track = "track wave --out out --json --reference raised.csv";
    let errors = |options: &str| scene.json(&format!("{track} {options}"))["joint_error_mm"].clone();
    let learning = errors("--learn-placement own.json --tool raised");
    let [raw, by_file] = [&learning["mean"], &errors("--placement own.json")["placed"]["mean"]];
    assert!(by_file.as_f64().unwrap() < 0.6 * raw.as_f64().unwrap(), "{raw} {by_file}");
    // Five frames are too few to hold some of them out, or to tell noise.
    assert!(learning["placed"].is_null() && learning["reference_noise"].is_null(), "{learning}");
    let take = fs::read_to_string(scene.path("wave/take.toml")).unwrap();
    scene.write("wave/own.json", &fs::read_to_string(scene.path("own.json")).unwrap());
    scene.write("wave/take.toml", &take.replace("[reference]", "[reference]\nplacement = \"own.json\""));
    let named = scene.json("track wave --out out --json");
    assert_eq!(named["joint_error_mm"]["placement"], "raised");
    scene.write(
        "own.json",
        "{\"format\": \"backlit-placement 1\", \"tool\": \"a\", \"offsets\": {\"tail\": {}}}",
    );
    scene.fails(&format!("{track} --placement own.json"), 1, &["--placement", "own.json", "offset"]);
}
