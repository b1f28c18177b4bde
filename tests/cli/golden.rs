//! `backlit render` against values of an independent implementation, through files alone, as a stranger would.
//!
//! The cases are the core's `golden.json`: thesis ramp, λ to five decimals, the Jacobian in raw coefficients at
//! some pixels, in cameras one below the other.

use std::fmt::Write;

use serde_json::{Value, json};

use crate::render::read_npy;
use crate::scene::Scene;

/// Largest difference of λ, grey levels: the file's last decimal, and a margin.
const LEVEL_TOLERANCE: f64 = 1e-4;
/// Largest difference of a Jacobian entry, relative to the largest entry of its column.
const JACOBIAN_TOLERANCE: f64 = 1e-5;

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

/// The model as TOML.
fn body(limbs: &[Value]) -> String {
    let mut text = "format = \"backlit-body 1\"\nname = \"golden\"\n".to_owned();
    for limb in limbs {
        writeln!(text, "[[limb]]\nname = {}\ndirection = {}", limb["name"], limb["v"]).unwrap();
        writeln!(text, "length = {}\nradius = {}", limb["s"], limb["r"]).unwrap();
        if let Some(parent) = limb["parent"].as_u64() {
            writeln!(text, "parent = {}", limbs[parent as usize]["name"]).unwrap();
        }
        if limb["own"] == false {
            let leader = limbs.iter().find(|other| other["own"] == true && other["rot"] == limb["rot"]);
            writeln!(text, "rigid_with = {}", leader.unwrap()["name"]).unwrap();
        }
    }
    text
}

/// The cameras as JSON. There, pixel centres lie at halves and a camera has its centre instead of a translation.
fn cameras(values: &[Value]) -> Value {
    let camera = |(index, value): (usize, &Value)| {
        let centre = numbers(&value["c"]);
        let row = |row: &Value| -numbers(row).iter().zip(&centre).map(|(a, b)| a * b).sum::<f64>();
        let translation: Vec<f64> = value["R"].as_array().unwrap().iter().map(row).collect();
        let principal = |key: &str| value[key].as_f64().unwrap() - 0.5;
        json!({
            "name": format!("cam{index}"), "width": value["W"], "height": value["H"],
            "fx": value["f"], "fy": value["f"], "cx": principal("cx"), "cy": principal("cy"),
            "distortion": {"model": "none"}, "rotation": value["R"], "translation": translation,
        })
    };
    let cameras: Vec<Value> = values.iter().enumerate().map(camera).collect();
    json!({"format": "backlit-cameras 1", "cameras": cameras})
}

/// The pose as JSON, its quaternions as they are.
fn pose(limbs: &[Value], state: &[f64]) -> Value {
    let own = limbs.iter().filter(|limb| limb["own"] == true);
    let rotations = own.zip(state[3..].chunks_exact(4));
    let rotations = rotations.map(|(limb, wxyz)| (limb["name"].as_str().unwrap().to_owned(), json!(wxyz)));
    json!({
        "format": "backlit-pose 1", "root": &state[..3],
        "rotations": rotations.collect::<serde_json::Map<String, Value>>(),
    })
}

fn check(name: &str, renderer: &str) {
    let golden: Value =
        serde_json::from_str(include_str!("../../crates/tracking/tests/golden/golden.json")).unwrap();
    let case = golden["cases"].as_array().unwrap().iter().find(|case| case["name"] == name).unwrap();
    let limbs = golden["models"][case["model"].as_str().unwrap()]["limbs"].as_array().unwrap();
    let views = case["cameras"].as_array().unwrap();
    let state = numbers(&case["state"]);
    let scene = Scene::new();
    scene.write("body.toml", &body(limbs));
    scene.write("cameras.json", &cameras(views).to_string());
    scene.write("pose.json", &pose(limbs, &state).to_string());
    scene.ok(&format!(
        "render --model body.toml --cameras cameras.json --pose pose.json --renderer {renderer} --ramp thesis \
         --out out --npy --jacobian raw"
    ));

    let (mut levels, mut jacobian) = (Vec::new(), Vec::new());
    for (index, view) in views.iter().enumerate() {
        let (width, height) = (view["W"].as_u64().unwrap(), view["H"].as_u64().unwrap());
        let (shape, values) = read_npy(&scene.path(&format!("out/cam{index}.prediction.npy")));
        assert_eq!(shape, format!("{height}, {width}"));
        levels.extend(values);
        let (shape, values) = read_npy(&scene.path(&format!("out/cam{index}.jacobian.npy")));
        assert_eq!(shape, format!("{}, {}", height * width, state.len()));
        jacobian.extend(values);
    }
    let mut failures = Vec::new();
    let expected = numbers(&case["lam"]);
    assert_eq!(levels.len(), expected.len());
    for (pixel, (found, expected)) in levels.iter().zip(&expected).enumerate() {
        if (found - expected).abs() > LEVEL_TOLERANCE {
            failures.push(format!("pixel {pixel}: λ = {found}, expected {expected}"));
        }
    }
    let pixels = numbers(&case["jac_pixels"]);
    for (column, values) in case["jac"].as_object().unwrap() {
        let values = numbers(values);
        let scale = values.iter().fold(1.0_f64, |largest, value| largest.max(value.abs()));
        for (&pixel, expected) in pixels.iter().zip(&values) {
            let found = jacobian[pixel as usize * state.len() + column.parse::<usize>().unwrap()];
            if (found - expected).abs() > JACOBIAN_TOLERANCE * scale {
                failures.push(format!("pixel {pixel}, column {column}: {found}, expected {expected}"));
            }
        }
    }
    assert!(failures.is_empty(), "{name}, {} mismatches:\n{}", failures.len(), failures.join("\n"));
}

#[test]
fn an_arm_of_capsules_is_the_reference_s() {
    check("arm_hemi_2cam", "capsule");
}

#[test]
fn a_body_of_cylinders_is_the_reference_s() {
    check("body_cylinder_2cam", "cylinder");
}
