//! `backlit synth`: a motion of a file becomes a take whose truth is known.

use std::fs;

use serde_json::Value;

use crate::scene::Scene;

/// A BVH of ten frames in centimetres, y up: a person of other lengths who walks on and swings the left arm.
fn walking() -> String {
    let leg = |side: &str, x: f64| {
        format!(
            "JOINT {side}UpLeg\n{{\nOFFSET {x} -4 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nJOINT {side}Leg\n{{\nOFFSET 0 -48 0\n\
             CHANNELS 3 Zrotation Xrotation Yrotation\nJOINT {side}Foot\n{{\nOFFSET 0 -46 0\nCHANNELS 3 Zrotation Xrotation Yrotation\n\
             End Site\n{{\nOFFSET 0 -5 14\n}}\n}}\n}}\n}}\n"
        )
    };
    let arm = |side: &str, x: f64| {
        format!(
            "JOINT {side}Arm\n{{\nOFFSET {x} 50 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nJOINT {side}ForeArm\n{{\nOFFSET 0 -31 0\n\
             CHANNELS 3 Zrotation Xrotation Yrotation\nJOINT {side}Hand\n{{\nOFFSET 0 -27 0\nCHANNELS 3 Zrotation Xrotation Yrotation\n\
             End Site\n{{\nOFFSET 0 -15 0\n}}\n}}\n}}\n}}\n"
        )
    };
    let mut text = format!(
        "HIERARCHY\nROOT Hips\n{{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n{}{}{}{}}}\n\
         MOTION\nFrames: 10\nFrame Time: 0.05\n",
        leg("Left", 10.0),
        leg("Right", -10.0),
        arm("Left", 19.0),
        arm("Right", -19.0)
    );
    for frame in 0..10 {
        let swing = 30.0 * (0.6 * frame as f64).sin();
        let mut row = vec![0.0, 103.0, 6.0 * frame as f64, 0.0, 0.0, 0.0];
        for joint in 0..12 {
            let turn = match joint {
                0 => swing,  // left thigh
                3 => -swing, // right thigh
                6 => -swing, // left arm
                7 => -25.0,  // left forearm
                _ => 0.0,
            };
            row.extend([0.0, turn, 0.0]);
        }
        let row: Vec<String> = row.iter().map(f64::to_string).collect();
        text += &format!("{}\n", row.join(" "));
    }
    text
}

#[test]
fn a_motion_is_filmed_and_its_truth_is_found_again() {
    let scene = Scene::new();
    fs::write(scene.path("walk.bvh"), walking()).unwrap();
    scene.ok("synth --motion walk.bvh --masks --cameras 3 --size 200x200 --out take");
    // The truth is the motion: its angles and its shape are the file's, and its size is the body's.
    let compared: Value = serde_json::from_str(&scene.ok("compare take/truth walk.bvh --json")).unwrap();
    let reference = &compared["references"][0];
    assert_eq!(reference["frames"], 10);
    let angles = reference["angles_degrees"].as_array().unwrap();
    let knee = angles.iter().find(|angle| angle["angle"] == "left hip flexion").unwrap();
    assert!(knee["rms"].as_f64().unwrap() < 6.0 && knee["correlation"].as_f64().unwrap() > 0.98, "{knee}");
    let shape = reference["joint_error_mm"]["procrustes"]["mean"].as_f64().unwrap();
    assert!(shape < 40.0, "{shape}");
    // The truth covers the silhouettes as well as clothes let it; the file's person, who is of another size, does so less.
    let covered: Value =
        serde_json::from_str(&scene.ok("compare take/truth walk.bvh --take take --json")).unwrap();
    let reference = &covered["references"][0];
    assert_eq!(reference["overlap_frames"], 10);
    let iou = |of: &str| reference[of]["cam02"].as_f64().unwrap();
    assert!(iou("track_overlap") > 0.75 && (0.5..0.75).contains(&iou("overlap")), "{reference}");
    let text = scene.ok("compare take/truth walk.bvh --take take");
    assert!(text.contains("mean of 10 frames"), "{text}");
    // A fit from the true start finds the true poses.
    let summary: Value = serde_json::from_str(&scene.ok("track take --out results --json")).unwrap();
    let mean = summary["joint_error_mm"]["mean"].as_f64().unwrap();
    assert!(summary["lost"] == 0 && mean < 60.0, "{summary}");

    let told = scene.ok(
        "synth --motion take/truth --frames 2..4 --cameras 2 --size 48x64 --no-shadows --clothes loose --occluder 0.3 --out again",
    );
    assert!(told.contains("the posts hide") && told.contains("% of the person"), "{told}");
    let take = fs::read_to_string(scene.path("again/take.toml")).unwrap();
    assert!(
        take.contains("background = \"plates/cam02/%d.png\"") && scene.path("again/cam01/1.png").is_file(),
        "{take}"
    );
}

#[test]
fn what_cannot_be_filmed_is_told() {
    let scene = Scene::new();
    fs::write(scene.path("walk.bvh"), walking()).unwrap();
    fs::create_dir(scene.path("full")).unwrap();
    fs::write(scene.path("full/notes.txt"), "mine").unwrap();
    scene.fails("synth --motion walk.bvh --masks --out full", 1, &["--out", "not empty"]);
    scene.fails("synth --motion none.bvh --out take", 1, &["none.bvh", "no such file"]);
    scene.fails("synth --motion walk.bvh --size 5x5 --out take", 2, &["--size", "640x480"]);
    scene.fails("synth --motion walk.bvh --wide 3 --out take", 2, &["--masks"]);
    scene.fails("synth --motion walk.bvh --frames 50.. --masks --out take", 1, &["--frames"]);
    let headless = walking().replace("LeftArm", "Tail").replace("LeftForeArm", "Tip");
    fs::write(scene.path("tail.bvh"), headless).unwrap();
    scene.fails("synth --motion tail.bvh --masks --out take", 1, &["tail.bvh", "shoulders"]);
}
