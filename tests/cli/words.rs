//! Help, and commands that are wrong.

use crate::scene::{FIT, RENDER, Scene};

#[test]
fn senseless_commands_are_explained() {
    let scene = Scene::new();
    scene.start();
    scene.fails(&format!("{RENDER} --renderer torus"), 2, &["torus", "capsule, cylinder or sphere-tree"]);
    scene.fails(&format!("{RENDER} --renderer capsule --spheres 3"), 2, &["--spheres", "sphere-tree"]);
    scene.fails(&format!("{RENDER} --ramp width=-1"), 2, &["width=-1", "pixels above 0"]);
    scene.fails(&FIT.replace("--masks masks", ""), 2, &["--masks"]);
    scene.fails(&format!("{FIT} --damping nan"), 2, &["--damping", "a number from 0 to"]);
    scene.fails(&FIT.replace("fit", "fit --iterations -1"), 2, &["--iterations", "-1", "invalid"]);
    scene.fails("track wave --out out --frames -3..5", 2, &["--frames", "-3..5", "A..B"]);
    scene.fails("screenshot --layout party --out a.png", 2, &["party", "pose", "debug"]);
}

#[test]
fn a_word_that_is_no_command_is_not_taken_for_a_file() {
    let scene = Scene::new();
    for arguments in ["dance", "dance wave", "dance --out x"] {
        scene.fails(arguments, 2, &["\"dance\" is neither a command", "track", "--help"]);
    }
    scene.fails("no/take.toml", 1, &["no/take.toml", "no such file"]);
}

#[test]
fn results_that_cannot_be_written_are_refused_before_the_work() {
    let scene = Scene::new();
    scene.start();
    // There are no masks yet: the file to write is looked at first.
    scene.fails(&format!("{FIT} --out no/fitted.json"), 1, &["no/fitted.json", "no folder no"]);
    scene.fails("screenshot --out no/window.png", 1, &["no/window.png", "no folder no"]);
    scene.fails(&RENDER.replace("--out out", "--out pose.json/out"), 1, &["pose.json/out", "cannot be made"]);
}

#[test]
fn help_explains() {
    let scene = Scene::new();
    assert!(scene.ok("--help").contains("Examples:"));
    for (command, words) in [
        ("render", "height × width"),
        ("fit", "white is the subject"),
        ("fit-body", "--without-keypoints"),
        ("fit-body", "person.toml"),
    ] {
        let help = scene.ok(&format!("{command} --help"));
        assert!(help.contains("Example") && help.contains(words), "{help}");
    }
    assert!(scene.ok("--version").starts_with("backlit "));
}
