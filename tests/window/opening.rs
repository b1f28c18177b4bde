//! Motions without footage, and projects whose take is not what it was: moved, with other cameras, with fewer frames.

use std::path::Path;

use backlit_document::Document;
use backlit_document::project::{read_project, write_project};
use backlit_formats::motion::{self, Motion, MotionFormat, MotionOptions};
use backlit_take::source::TakeSource;
use backlit_tracking::body::{Kinematics, Pose, builtin};
use egui::accesskit::Role;
use egui::{Key, Modifiers, vec2};
use egui_kittest::kittest::Queryable;
use glam::DQuat;

use crate::support::take;
use crate::support::window::{Window, WindowState, at, click, drag, press, save, settle};

fn open(path: &Path) -> Window {
    at(path).sized(1200.0, 800.0).open()
}

/// A folder with a take `arm` and a project `work.backlit` about it, with poses in the first and the last frame.
fn project() -> (tempfile::TempDir, Document) {
    let folder = tempfile::tempdir().unwrap();
    take::write_to(&folder.path().join("arm"));
    let mut harness = open(&folder.path().join("arm"));
    drag(&mut harness, "right wrist, Camera 1", vec2(0.0, 20.0));
    press(&mut harness, Modifiers::NONE, Key::End);
    drag(&mut harness, "right wrist, Camera 1", vec2(0.0, 20.0));
    save(&mut harness, &folder.path().join("work.backlit"));
    let document = harness.document().clone();
    (folder, document)
}

/// Changes a file of the take.
fn change(path: &Path, from: &str, to: &str) {
    let text = std::fs::read_to_string(path).unwrap();
    assert!(text.contains(from), "{text}");
    std::fs::write(path, text.replace(from, to)).unwrap();
}

#[test]
fn a_take_that_has_moved_is_found_again() {
    let (folder, saved) = project();
    let (old, new) = (folder.path().join("arm"), folder.path().join("elsewhere"));
    std::fs::rename(&old, &new).unwrap();
    let path = folder.path().join("work.backlit");
    let mut harness = open(&path);
    let said = harness.last_said();
    assert!(said.contains("the project's take cannot be opened"), "{said}");
    assert!(said.contains(&old.display().to_string()) && said.contains("there is no such file"), "{said}");
    harness.get_by_role_and_label(Role::Button, "Find take…");
    harness.state_mut().find_take(&new);
    settle(&mut harness);
    let expected = Document { take: Some(TakeSource::Path(new.clone())), ..saved };
    assert_eq!(*harness.document(), expected);
    assert!(harness.state().inspector.state.history.is_dirty(), "the file still names the old place");
    press(&mut harness, Modifiers::COMMAND, Key::S);
    assert!(!harness.state().inspector.state.history.is_dirty());
    assert_eq!(read_project(&path).unwrap().document, expected);
}

#[test]
fn a_take_may_stand_beside_its_project() {
    let (folder, mut document) = project();
    document.take = Some(TakeSource::Path("arm".into()));
    let inner = folder.path().join("moved");
    std::fs::create_dir_all(&inner).unwrap();
    std::fs::rename(folder.path().join("arm"), inner.join("arm")).unwrap();
    write_project(&inner.join("work.backlit"), &document, &[]).unwrap();
    let harness = open(&inner.join("work.backlit"));
    assert_eq!(harness.document().take, Some(TakeSource::Path(inner.join("arm"))));
    assert!(!harness.state().inspector.state.history.is_dirty());
}

#[test]
fn a_take_with_other_cameras_is_refused_by_name() {
    let (folder, _) = project();
    let take = folder.path().join("arm/take.toml");
    let camera =
        "[[camera]]\nname = \"above\"\nframes = \"above/%d.png\"\nbackground = \"above/empty.png\"\n";
    change(&take, camera, "");
    let harness = open(&folder.path().join("work.backlit"));
    let said = harness.last_said();
    assert!(
        said.contains("work.backlit") && said.contains("the cameras front, above; the take has front"),
        "{said}"
    );
    assert!(harness.session().take.is_none());
}

#[test]
fn a_take_with_its_cameras_in_another_order_is_the_same() {
    let (folder, saved) = project();
    let take = folder.path().join("arm/take.toml");
    for (from, to) in [("front", "other"), ("above", "front"), ("other", "above")] {
        // Both words stand in the two tables of cameras only.
        change(&take, from, to);
    }
    let text = std::fs::read_to_string(&take).unwrap();
    assert!(text.find("above") < text.find("front"), "{text}");
    let harness = open(&folder.path().join("work.backlit"));
    let document = harness.document();
    let names: Vec<&str> = document.cameras.iter().map(|camera| camera.name.as_str()).collect();
    assert_eq!((names, &document.keys), (vec!["above", "front"], &saved.keys));
}

#[test]
fn a_take_with_fewer_frames_keeps_all_poses_and_says_so() {
    let (folder, saved) = project();
    for camera in ["front", "above"] {
        std::fs::remove_file(folder.path().join("arm").join(camera).join("2.png")).unwrap();
    }
    let mut harness = open(&folder.path().join("work.backlit"));
    let said = harness.last_said();
    assert!(said.contains("only 2 frames") && said.contains("up to frame 2"), "{said}");
    assert_eq!(*harness.document(), saved);
    for key in [Key::End, Key::N, Key::CloseBracket, Key::CloseBracket] {
        press(&mut harness, Modifiers::NONE, key);
    }
    click(&mut harness, "Track back");
    assert!(harness.selection().frame < 2);
}

#[test]
fn what_is_no_project_is_refused_in_words() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("work.backlit");
    for (content, expected) in [
        ("{\"format\": \"backlit-project 2\", \"new\": 1}", "a newer Backlit wrote this project"),
        ("{\"format\": \"backlit-project 1\", \"take\": ", "it was cut off"),
        ("", "it was cut off"),
        ("{\"format\": \"backlit-pose 1\"}", "expected \"backlit-project 1\""),
        ("{\"format\": \"backlit-project 1\", \"colour\": 1}", "unknown field `colour`"),
        ("\u{0}\u{1}", "expected value"),
    ] {
        std::fs::write(&path, content).unwrap();
        let harness = open(&path);
        let said = harness.last_said();
        assert!(said.contains("work.backlit") && said.contains(expected), "{said}");
        assert!(harness.session().take.is_none());
    }
}

#[test]
fn a_take_that_reads_outside_its_folder_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let take = folder.path().join("arm");
    take::write_to(&take);
    std::fs::rename(take.join("front"), folder.path().join("front")).unwrap();
    change(&take.join("take.toml"), "\"front/", "\"../front/");
    let harness = open(&take);
    let said = harness.last_said();
    assert!(said.starts_with("The take reads outside its own folder: "), "{said}");
    assert!(said.ends_with("front/0.png, and 1 more path that it names."), "{said}");
}

/// A motion of three frames on a body a fifth larger, with y up.
fn write_motion(path: &Path) {
    let usual = builtin::full_body();
    let larger = |limb: usize| [1.2 * usual.limbs()[limb].length, usual.limbs()[limb].radius];
    let model = usual.with_sizes(larger).unwrap();
    let bent = |frame: usize| {
        let mut pose = Pose::rest(&model);
        pose.rotations[0] = DQuat::from_rotation_x(0.2 * frame as f64) * pose.rotations[0];
        (frame, pose)
    };
    let motion = Motion::of_poses("bow", model.clone(), 25.0, (0..3).map(bent).collect());
    motion::write(path, MotionFormat::Bvh, &motion, &MotionOptions::default()).unwrap();
}

#[test]
fn a_motion_plays_on_the_body_without_footage() {
    let folder = tempfile::tempdir().unwrap();
    let (bow, project) = (folder.path().join("bow.bvh"), folder.path().join("bow.backlit"));
    write_motion(&bow);
    let mut harness = open(&bow);
    let poses: Vec<Pose> = harness.document().keys.values().cloned().collect();
    assert_eq!(poses.len(), 3);
    let model = harness.document().model.clone();
    let head = |pose: &Pose| Kinematics::new(&model, pose).ends()[model.limb_index("neck").unwrap()];
    assert!(head(&poses[0]).z > head(&poses[2]).z + 0.02, "it bows: {} {}", head(&poses[0]), head(&poses[2]));
    // The cameras see this body, in this frame.
    for (frame, pose) in poses.iter().enumerate() {
        let session = &harness.state().inspector.state.session;
        let predicted = session.predicted.as_ref().unwrap();
        assert_eq!(predicted.pose, *pose, "frame {frame}");
        harness.get_all_by_label("IoU 1.000").next().unwrap();
        press(&mut harness, Modifiers::NONE, Key::ArrowRight);
    }
    save(&mut harness, &project);
    assert_eq!(open(&project).document().keys, harness.document().keys);
    std::fs::write(&bow, "HIERARCHY\nROOT").unwrap();
    let said = open(&bow).last_said();
    assert!(said.contains("bow.bvh"), "{said}");
}
