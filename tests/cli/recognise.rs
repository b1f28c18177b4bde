//! `backlit recognise`: motions by name.

use std::fmt::Write;
use std::fs;
use std::path::PathBuf;

use serde_json::Value;

use crate::footage::footage;
use crate::scene::Scene;

/// Joints of a stick figure: name, place to the left, height.
const JOINTS: [(&str, f64, f64); 16] = [
    ("Neck", 0.0, 1.45),
    ("Head", 0.0, 1.65),
    ("LeftArm", 0.18, 1.42),
    ("LeftForeArm", 0.2, 1.15),
    ("LeftHand", 0.21, 0.9),
    ("RightArm", -0.18, 1.42),
    ("RightForeArm", -0.2, 1.15),
    ("RightHand", -0.21, 0.9),
    ("LeftUpLeg", 0.1, 0.95),
    ("LeftLeg", 0.1, 0.52),
    ("LeftFoot", 0.1, 0.1),
    ("LeftToeBase", 0.12, 0.03),
    ("RightUpLeg", -0.1, 0.95),
    ("RightLeg", -0.1, 0.52),
    ("RightFoot", -0.1, 0.1),
    ("RightToeBase", -0.12, 0.03),
];

/// A BVH file whose joints have places and no rotations: a figure that steps forward, or waves.
fn bvh(is_walking: bool, person: f64) -> String {
    let mut out = "HIERARCHY\nROOT Hips\n{\nOFFSET 0 0 0\nCHANNELS 0\n".to_owned();
    for (name, ..) in JOINTS {
        let _ = writeln!(out, "JOINT {name}\n{{\nOFFSET 0 0 0\nCHANNELS 3 Xposition Yposition Zposition\n}}");
    }
    out += "}\nMOTION\nFrames: 75\nFrame Time: 0.0333333\n";
    for frame in 0..75 {
        let t = f64::from(frame) / 30.0;
        let swing = (std::f64::consts::TAU * t * (1.0 + 0.1 * person)).sin();
        for (name, x, y) in JOINTS {
            let side = if name.starts_with("Left") { 1.0 } else { -1.0 };
            let mut place = [x, y, 0.0];
            if is_walking {
                place[2] = 1.2 * t;
                if ["Leg", "Foot", "ToeBase"].iter().any(|end| name.ends_with(end))
                    && !name.ends_with("UpLeg")
                {
                    place[2] += 0.3 * side * swing;
                    place[1] += 0.1 * (side * swing).max(0.0);
                }
            } else if name.ends_with("Hand") {
                place[1] += 0.6 + 0.2 * swing;
                place[2] += 0.2;
            }
            let [x, y, z] = place.map(|x| x * (1.0 + 0.05 * person) * 17.7);
            let _ = write!(out, "{x:.4} {y:.4} {z:.4} ");
        }
        out.push('\n');
    }
    out
}

fn small_folder(scene: &Scene) {
    fs::create_dir(scene.path("motions")).unwrap();
    let mut labels = "file,class,subject,description\n".to_owned();
    for person in 0..3 {
        for (class, is_walking) in [("walk", true), ("wave", false)] {
            let file = format!("{class}{person}.bvh");
            fs::write(scene.path("motions").join(&file), bvh(is_walking, f64::from(person))).unwrap();
            let _ = writeln!(labels, "{file},{class},p{person},\"a, b\"");
        }
    }
    fs::write(scene.path("motions/labels.csv"), labels).unwrap();
}

#[test]
fn names_are_learnt_and_given() {
    let scene = Scene::new();
    small_folder(&scene);
    let said = scene.ok("recognise --train motions --out model.json");
    assert!(said.contains("learnt walk, wave from 6 motions"), "{said}");
    let found = scene.json("recognise --model model.json --test motions --json --confusion matrix.svg");
    for method in ["hmm", "svm", "nearest", "combined"] {
        assert_eq!(found[method]["clips"], 1.0, "{found}");
        assert!(found[method]["windows"].as_f64().unwrap() > 0.95, "{found}");
        assert!(found[method]["joined"].as_f64().unwrap() > 0.8, "{found}");
    }
    assert_eq!(found["confusion"]["clips"], serde_json::json!([[3, 0], [0, 3]]));
    assert!(fs::read_to_string(scene.path("matrix.svg")).unwrap().contains(">100 %<"));
    let text = scene.ok("recognise --test motions --leave-subjects-out --noise 10");
    assert!(text.contains("combined"), "{text}");
    let found = scene.json("recognise --model model.json motions/walk1.bvh motions/wave2.bvh --json");
    for (index, class) in ["walk", "wave"].into_iter().enumerate() {
        let track = &found["tracks"][index];
        assert_eq!(track["frames"].as_array().unwrap().len(), 75);
        assert_eq!(track["frames"][40]["class"], class, "{found}");
        assert_eq!(track["stretches"][0]["first_frame"], 0);
    }
    let text = scene.ok("recognise motions/walk1.bvh");
    assert!(text.contains("confidence"), "{text}");
}

#[test]
fn what_cannot_be_named_is_answered_in_words() {
    let scene = Scene::new();
    small_folder(&scene);
    scene.fails("recognise", 2, &["TRACK"]);
    scene.fails("recognise --train motions", 2, &["--out"]);
    scene.fails("recognise nowhere.bvh", 1, &["nowhere.bvh", "no such file"]);
    scene.fails("recognise --test nowhere", 1, &["labels.csv", "no such file"]);
    scene.write("model.json", "{\"format\": \"backlit-motions 1\"}");
    scene.fails(
        "recognise --model model.json motions/walk1.bvh",
        1,
        &["model.json", "backlit-motions 4", "learnt again"],
    );
    scene.write("motions/labels.csv", "file,class,subject\nwalk1.bvh,walk,a\n");
    scene.fails("recognise --train motions --out model.json", 1, &["motions", "1 classes", "two at least"]);
    let text = bvh(true, 0.0).replace("LeftHand", "LeftPaw");
    scene.write("paw.bvh", &text);
    scene.fails("recognise paw.bvh", 1, &["paw.bvh", "LeftWrist", "LeftHand"]);
}

/// The corpus of the CMU recordings, where it is.
fn corpus() -> Option<PathBuf> {
    Some(footage()?.with_file_name("motions")).filter(|folder| folder.is_dir())
}

#[test]
fn the_model_that_comes_with_the_program_knows_real_motions() {
    let Some(corpus) = corpus() else { return };
    let scene = Scene::new();
    for (file, class) in [("16_35a", "run"), ("07_01a", "walk"), ("14_10a", "gesture")] {
        let path = corpus.join(format!("{file}.bvh"));
        let found = scene.json(&format!("recognise {} --json", path.display()));
        let frames = found["tracks"][0]["frames"].as_array().unwrap();
        let right = frames.iter().filter(|frame| frame["class"] == class).count();
        assert!(2 * right > frames.len(), "{file}: {right} of {}", frames.len());
    }
}

/// Where numbers of two JSON texts differ, by more than a thousandth; or how else.
fn difference(a: &Value, b: &Value, place: &str) -> Option<String> {
    match (a, b) {
        (Value::Object(a), Value::Object(b)) if a.keys().eq(b.keys()) => {
            a.iter().find_map(|(key, value)| difference(value, &b[key], &format!("{place}.{key}")))
        }
        (Value::Array(a), Value::Array(b)) if a.len() == b.len() => {
            let all = a.iter().zip(b).enumerate();
            all.into_iter().find_map(|(index, (a, b))| difference(a, b, &format!("{place}[{index}]")))
        }
        _ => {
            let same = match (a.as_f64(), b.as_f64()) {
                (Some(a), Some(b)) => (a - b).abs() <= 1e-3 * (1.0 + a.abs()),
                _ => a == b,
            };
            (!same).then(|| format!("{place}: {a} and {b}"))
        }
    }
}

#[test]
fn the_model_that_comes_with_the_program_is_what_the_command_learns() {
    let Some(corpus) = corpus() else { return };
    let scene = Scene::new();
    scene.ok(&format!("recognise --train {} --out model.json --statistics-only", corpus.display()));
    let shipped = concat!(env!("CARGO_MANIFEST_DIR"), "/crates/recognition/assets/motions.json");
    let [learnt, shipped] = [scene.path("model.json"), PathBuf::from(shipped)]
        .map(|path| serde_json::from_str::<Value>(&fs::read_to_string(path).unwrap()).unwrap());
    assert_eq!(difference(&learnt, &shipped, "model"), None);
}
