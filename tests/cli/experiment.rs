//! Experiments: a table or JSON on the screen, numbers and plots in files.

use backlit_formats::images;
use serde_json::Value;

use crate::scene::{BUILT_IN, Scene};

#[test]
fn the_single_limb_is_measured_plotted_and_told() {
    let scene = Scene::new();
    let said = scene.ok("experiment fig5.1 --out results");
    assert!(said.contains("10 m, cylinder") && said.contains("fig5.1-0.8m.png"), "{said}");
    let plot = images::read(&scene.path("results/fig5.1-10m.png")).unwrap();
    assert!(plot.width() > 600 && plot.height() > 300);
    let file = std::fs::read_to_string(scene.path("results/fig5.1.json")).unwrap();
    let printed = scene.ok("experiment fig5.1 --out again --json");
    assert_eq!(printed, file);
    let numbers: Value = serde_json::from_str(&file).unwrap();
    assert_eq!(numbers["format"], "backlit-experiment 1");
    let costs = numbers["report"]["parts"][0]["curves"][1]["costs"].as_array().unwrap();
    assert_eq!(costs.len(), 61);
}

#[test]
fn every_experiment_writes_its_numbers_and_plots() {
    let scene = Scene::new();
    let commands = [
        ("fig5.2", "--starts 2", "fig5.2-cost.png", "capsule, tangent LM"),
        ("fig5.3", "--starts 2 --start-noise 3deg,1cm --data mask", "fig5.3-joints.png", "2 of 2"),
        ("fig5.4", "", "fig5.4-report.png", "Robust, masks"),
        ("fig5.5", "--starts 1 --frames 3", "fig5.5-joints.png", "Robust, masks"),
        ("fig5.6", "--starts 1 --frames 3", "fig5.6-overlap.png", "Report 2004, masks"),
    ];
    for (name, options, plot, words) in commands {
        let said = scene.ok(&format!("experiment {name} {options} --out results"));
        assert!(said.contains(words) && said.contains(plot), "{name}: {said}");
        assert!(scene.path("results").join(plot).is_file(), "{name}");
        let read = || std::fs::read_to_string(scene.path(&format!("results/{name}.json"))).unwrap();
        let first = read();
        scene.ok(&format!("experiment {name} {options} --out results"));
        assert!(first == read(), "{name} gave other numbers the second time");
    }
}

/// The report's real sequence on a take: its own cameras in small pictures, errors where there are keypoints.
#[test]
fn sequences_run_on_a_take() {
    let scene = Scene::new();
    let said = scene.ok(&format!("experiment fig5.4 --take {BUILT_IN} --out one"));
    assert!(said.contains("fig5.4-robust.png"), "{said}");
    let sheet = images::read(&scene.path("one/fig5.4-report.png")).unwrap();
    assert!(sheet.width() > 4 * 144 && sheet.height() > 4 * 192, "{} × {}", sheet.width(), sheet.height());
    let ask = format!("experiment fig5.6 --take {BUILT_IN} --cameras cam2,cam4 --frames 9 --starts 1");
    let said = scene.ok(&format!("{ask} --out two"));
    assert!(!said.contains("own grey levels") && said.contains("fig5.6-report.png"), "{said}");
    let numbers = scene.read_json("two/fig5.6.json");
    assert_eq!(numbers["options"]["cameras"], serde_json::json!(["cam2", "cam4"]));
    assert_eq!(numbers["options"]["size_px"], serde_json::json!([36, 48]));
    assert!(numbers["report"]["ways"][0]["joint_error_mm"]["mean"].as_f64().unwrap() > 0.0);
    scene.fails(&format!("experiment fig5.5 --take {BUILT_IN} --frames 999"), 1, &["--frames 999", "60"]);
    scene.fails(&format!("experiment fig5.5 --take {BUILT_IN} --cameras cam9"), 1, &["cam9"]);
    scene.fails("experiment fig5.5 --cameras cam1", 2, &["--take"]);
}

#[test]
fn senseless_experiments_are_explained() {
    let scene = Scene::new();
    scene.fails("experiment fig9.9", 2, &["fig9.9"]);
    let help = scene.ok("experiment --help");
    assert!(help.contains("One limb seen from the side") && !help.contains("its files go"), "{help}");
    scene.fails("experiment fig5.1 --offset nan", 2, &["--offset", "from -10 to 10"]);
    scene.fails("experiment fig5.1 --distance 0", 2, &["--distance", "from 0.3 to 1000"]);
    scene.fails("experiment fig5.2 --starts 4294967296", 2, &["--starts", "from 1 to 1000"]);
    scene.fails("experiment fig5.5 --frames 0", 2, &["--frames", "from 1 to 1000"]);
    scene.fails("experiment fig5.4 --size 0x9", 2, &["--size", "WIDTHxHEIGHT"]);
    scene.fails("experiment sizes --widened 51", 2, &["--widened", "0 to 50"]);
}

/// Starts about a known pose of a take's frame: the same numbers every time, and what is asked wrong is named.
#[test]
fn the_basin_of_a_frame_of_a_take() {
    let scene = Scene::new();
    let ask = format!("experiment basin --take {BUILT_IN} --downhill --unscaled --starts 2 --angles 3");
    let said = scene.ok(&format!("{ask} --joint neck --root 0 --within 60 --out one"));
    assert!(said.contains("3°, 0.0 cm") && said.contains("of 2"), "{said}");
    let printed = scene.ok(&format!("{ask} --frame 3 --json --out two"));
    let numbers: Value = serde_json::from_str(&printed).unwrap();
    assert_eq!(numbers["report"]["choices"][0]["levels"][0]["tried"], 2);
    assert_eq!(numbers["options"]["levels"][0]["metres"], 0.015);
    assert_eq!(printed, scene.ok(&format!("{ask} --frame 3 --json --out three")));
    scene.fails(&format!("{ask} --frame 999"), 1, &["no frame 999"]);
    scene.fails(&format!("{ask} --joint tail"), 1, &["no limb tail"]);
    scene.fails(&format!("{ask} --size 48x36"), 2, &["--size"]);
    scene.fails("experiment basin --joint neck", 2, &["--take"]);
    let table = std::fs::read_to_string(scene.path("one/basin.csv")).unwrap();
    assert!(table.starts_with("choice,angle_deg") && table.lines().count() == 3, "{table}");
}

/// A map of two angles by two fits: files, letters, and what is asked wrong.
#[test]
fn the_basin_map_of_a_frame_of_a_take() {
    let scene = Scene::new();
    let map = format!("experiment basin --take {BUILT_IN} --downhill --map neck.flexion,neck.twist");
    let said = scene.ok(&format!("{map} --cells 2 --farthest 10 --compare report --out map"));
    for part in ["Across: neck, flexion. Up: neck, twist", "Robust: ", "Report 2004: ", " of 4"] {
        assert!(said.contains(part), "{part}: {said}");
    }
    assert!(std::fs::read_to_string(scene.path("map/basin-map.csv")).unwrap().lines().count() == 9);
    let numbers = scene.read_json("map/basin-map.json");
    assert_eq!((numbers["partial"].as_bool(), numbers["fits"]["total"].as_u64()), (Some(false), Some(8)));
    scene.fails(&format!("{map} --cells 1"), 1, &["cells", "2 to 61"]);
    scene.fails(&format!("{map} --starts 3"), 2, &["--starts", "--map"]);
    scene.fails(&format!("{map} --compare best"), 2, &["--compare", "search:cylinder"]);
    scene.fails(&format!("experiment basin --take {BUILT_IN} --map neck.flexion"), 2, &["JOINT.AXIS"]);
    scene.fails(
        &format!("experiment basin --take {BUILT_IN} --map tail.twist,neck.twist"),
        1,
        &["no limb tail"],
    );
    scene.fails("experiment basin --map neck.flexion,neck.twist", 2, &["--take"]);
}

/// First bodies: a row a way, files, and what is asked wrong.
#[test]
fn first_bodies_are_compared() {
    let scene = Scene::new();
    let said = scene.ok("experiment acquire --people 1 --moments 8 --tracked 2 --out results");
    for part in
        ["child of six, slim: average, scaled", "grown from templates", "fitted from grown", "acquire.json"]
    {
        assert!(said.contains(part), "{part}: {said}");
    }
    let numbers = scene.read_json("results/acquire.json");
    let rows = numbers["report"]["rows"].as_array().unwrap();
    assert!(rows.len() == 6 && rows.iter().all(|row| row["iou"].as_f64().unwrap() > 0.3), "{numbers}");
    scene.fails("experiment acquire --people 7", 2, &["--people", "6"]);
    scene.fails("experiment acquire --take nowhere", 1, &["nowhere"]);
}

/// Ways to begin: a row a way, files, and what is asked wrong.
#[test]
fn ways_to_begin_are_compared() {
    let scene = Scene::new();
    let ask = "experiment begin --starts 1 --angles 10 --particles 30 --layers 2";
    let said = scene.ok(&format!("{ask} --out one"));
    for part in ["2, 10°: report", "ramp", "particles", "templates", "search", "of 1", "begin.png"] {
        assert!(said.contains(part), "{part}: {said}");
    }
    let numbers = scene.json(&format!("{ask} --no-start --methods ramp,templates --json --out two"));
    let rows = numbers["report"]["rows"].as_array().unwrap();
    assert_eq!((rows.len(), rows[1]["method"].as_str()), (2, Some("templates")));
    assert!(rows.iter().all(|row| row["degrees"].is_null() && row["evaluations"].as_f64().unwrap() > 10.0));
    scene.fails(&format!("{ask} --methods luck"), 2, &["luck", "particles, templates"]);
    scene.fails("experiment begin --starts 1 --layers 0", 2, &["--layers", "from 1 to 100"]);
    scene.fails("experiment begin --starts 1 --angles 7", 1, &["--angles"]);
    scene.fails("experiment begin --frames 3", 2, &["--take"]);
    let ask = format!("experiment begin --take {BUILT_IN} --methods ramp --cameras 4 --angles 10 --frames 3");
    let said = scene.ok(&format!("{ask} --out three"));
    assert!(said.contains("4, 10°: ramp") && said.contains("of 1"), "{said}");
}
