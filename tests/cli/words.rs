//! Help, and commands that make no sense.

use crate::scene::{FIT, RENDER, Scene};

#[test]
fn senseless_commands_are_explained() {
    let scene = Scene::new();
    scene.start();
    scene.fails(&format!("{RENDER} --renderer torus"), 2, &["torus", "capsule, cylinder or sphere-tree"]);
    scene.fails(&format!("{RENDER} --renderer capsule --spheres 3"), 2, &["--spheres", "sphere-tree"]);
    scene.fails(&format!("{RENDER} --ramp width=-1"), 2, &["width=-1", "pixels above 0"]);
    scene.fails(&FIT.replace("--masks masks", ""), 2, &["--masks"]);
    scene.fails(&format!("{FIT} --damping nan"), 2, &["--damping", "finite"]);
    scene.fails("dance", 2, &["dance"]);
}

#[test]
fn help_explains() {
    let scene = Scene::new();
    assert!(scene.ok("--help").contains("Examples:"));
    for (command, words) in [("render", "height × width"), ("fit", "white is the subject")] {
        let help = scene.ok(&format!("{command} --help"));
        assert!(help.contains("Example") && help.contains(words), "{help}");
    }
    assert!(scene.ok("--version").starts_with("backlit "));
}
