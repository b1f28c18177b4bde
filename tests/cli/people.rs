//! `track --people N`: everybody in view, each into a folder of its own.

use std::collections::BTreeMap;

use backlit_lab::synthetic::two_people;
use backlit_tracking::body::{Kinematics, builtin};
use glam::DVec3;

use crate::scene::Scene;

/// Where a track has the ends of limbs, by frame and name.
fn joints(scene: &Scene, folder: &str) -> BTreeMap<(usize, String), DVec3> {
    let text = std::fs::read_to_string(scene.path(&format!("{folder}/joints.csv"))).unwrap();
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        let number = |cell: usize| cells[cell].parse::<f64>().unwrap();
        ((cells[0].parse().unwrap(), cells[1].to_owned()), DVec3::new(number(2), number(3), number(4)))
    };
    text.lines().skip(1).map(row).collect()
}

/// Mean distance of a track from one of the two, metres.
fn off(found: &BTreeMap<(usize, String), DVec3>, who: usize) -> f64 {
    let body = builtin::full_body();
    let (mut sum, mut count) = (0.0, 0);
    for frame in 0..two_people::FRAMES {
        let truth = Kinematics::new(&body, &two_people::poses(&body, frame)[who]);
        for (limb, end) in body.limbs().iter().zip(truth.ends()) {
            if let Some(at) = found.get(&(frame, limb.name.clone())) {
                sum += at.distance(*end);
                count += 1;
            }
        }
    }
    assert!(count >= 10 * two_people::FRAMES, "{count} joints");
    sum / f64::from(i32::try_from(count).unwrap())
}

#[test]
fn two_people_who_pass_each_other_are_both_tracked() {
    let scene = Scene::new();
    std::fs::create_dir(scene.path("two")).unwrap();
    two_people::write(&scene.path("two"), &builtin::full_body(), [288, 288], &[0, 1]).unwrap();
    let [said, told] = scene.told("track two --out all --people 2");
    let mut seen = Vec::new();
    for person in 1..=2 {
        let found = joints(&scene, &format!("all/person-{person}"));
        let who = usize::from(off(&found, 1) < off(&found, 0));
        scene.ok(&format!("track two --out by-itself --person {person}"));
        let [together, by_itself] = [off(&found, who), off(&joints(&scene, "by-itself"), who)];
        println!("person {person}: {together:.4} m off, tracked by itself {by_itself:.4} m");
        assert!(together < 0.035, "person {person}: {together} m");
        assert!(together < by_itself, "person {person}: {together} m, tracked by itself {by_itself} m");
        assert!(scene.path(&format!("all/person-{person}/track.json")).exists());
        seen.push(who);
    }
    seen.sort_unstable();
    assert_eq!(seen, [0, 1], "each is tracked once");
    assert!(
        said.contains("all/person-2") && told.contains("without what the others' bodies cover"),
        "{said}"
    );
    assert!(!told.contains("follow one of them"), "{told}");
}

#[test]
fn people_who_are_not_there_are_not_tracked() {
    let scene = Scene::new();
    std::fs::create_dir(scene.path("two")).unwrap();
    two_people::write(&scene.path("two"), &builtin::full_body(), [96, 96], &[0, 1]).unwrap();
    let there = ["--people 3: there is no such person; in view are: person 1,", "; person 2, frames 0 to "];
    scene.fails("track two --out t --frames 0..=2 --people 3", 1, &there);
    scene.fails("track two --out t --people 1", 2, &["--people", "2 to 20"]);
    scene.fails("track two --out t --people 2 --person 1", 2, &["cannot be used with"]);
    let few = ["--people: 2 cameras cannot tell people apart; expected 3 or more"];
    scene.fails("track two --out t --cameras cam1,cam2 --people 2", 1, &few);
}
