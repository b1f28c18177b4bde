//! Cues in the window: keypoints where the tracker looks at them, and a lane of limbs that nothing holds.

use backlit::context::preferences::Layout;
use backlit_document::tracking_choices::CueChoice;
use backlit_take::demonstration::Demonstration;
use egui::accesskit::Role;
use egui::{Key, Modifiers};
use egui_kittest::kittest::{NodeT, Queryable};

use crate::support::window::{
    Window, WindowState, at, click, command, demonstration, press, save, settle, undo,
};

fn legends(window: &Window) -> Vec<String> {
    let nodes = window.query_all_by_label_contains("Legend: ");
    nodes.map(|node| node.accesskit_node().value().unwrap_or_default()).collect()
}

const RIVAL: &str = "Rival pose 1, ";

fn has_rival(window: &Window) -> bool {
    window.query_all_by_label_contains(RIVAL).next().is_some()
}

#[test]
fn keypoints_are_drawn_and_unsure_limbs_have_a_lane_where_cues_are_used() {
    // Opening it tracks it.
    let mut window = demonstration(Demonstration::Cues).layout(Layout::Pose).sized(1600.0, 1600.0).open();
    assert_eq!(window.document().tracking.cues, CueChoice::Keypoints);
    let here = window.selection().frame;
    assert!(window.document().estimates.contains_key(&here));
    let said = legends(&window);
    assert!(!said.is_empty() && said.iter().all(|legend| legend.contains("2-D keypoint")), "{said:?}");
    assert!(window.query_by_label_contains("Doubtful limbs: ").is_some());
    click(&mut window, "Solver");
    window.get_by_role_and_label(Role::ComboBox, "Cues").click();
    window.run_steps(3);
    window.get_by_label("None").click();
    settle(&mut window);
    assert_eq!(window.document().tracking.cues, CueChoice::None);
    let said = legends(&window);
    assert!(said.iter().all(|legend| !legend.contains("2-D keypoint")), "{said:?}");
    // Where nothing is tracked nothing is doubted.
    undo(&mut window);
    undo(&mut window);
    settle(&mut window);
    assert!(window.document().estimates.is_empty());
    assert!(window.query_by_label_contains("Doubtful limbs: ").is_none());
}

/// Where a track is not believed something else is offered, with what it costs; a click tracks again with it.
#[test]
fn what_could_help_is_offered_where_limbs_are_doubtful() {
    let mut window = demonstration(Demonstration::Cues).layout(Layout::Pose).sized(1600.0, 1600.0).open();
    click(&mut window, "Silhouettes alone");
    assert_eq!(window.document().tracking.cues, CueChoice::None);
    window.get_by_label_contains(" doubtful in ");
    click(&mut window, "Keypoints, up to 1.7× time");
    assert_eq!(window.document().tracking.cues, CueChoice::Keypoints);
    assert!(window.query_by_label_contains("Keypoints, up to").is_none(), "they are on already");
}

/// What a window shows of what the tracker told: rivals and doubtful limbs of this frame, and which one is worst.
fn told(window: &mut Window, frame: usize) -> (Vec<String>, usize) {
    press(window, Modifiers::NONE, Key::Home);
    command(window, "Worst frame");
    let worst = window.selection().frame;
    press(window, Modifiers::NONE, Key::Home);
    (0..frame).for_each(|_| press(window, Modifiers::NONE, Key::ArrowRight));
    let nodes = [RIVAL, "Doubtful limbs: "].map(|label| window.query_all_by_label_contains(label));
    let nodes = nodes.into_iter().flatten();
    let labels = nodes.filter_map(|node| {
        let node = node.accesskit_node();
        node.label().or_else(|| node.value())
    });
    (labels.chain(legends(window)).collect(), worst)
}

/// A click on how likely a rival pose is gives the frame that pose; one key takes it back. What the tracker told is saved.
#[test]
fn a_rival_pose_is_taken_by_a_click() {
    let mut window = demonstration(Demonstration::Cues).layout(Layout::Pose).sized(1600.0, 1600.0).open();
    command(&mut window, "Robust");
    command(&mut window, "Clear track");
    press(&mut window, Modifiers::NONE, Key::Home);
    command(&mut window, "Track forward");
    let mut rival = None;
    press(&mut window, Modifiers::NONE, Key::Home);
    for frame in 0..window.document().estimates.len() {
        let label = window.query_all_by_label_contains(RIVAL).next();
        rival = label.map(|node| (frame, node.accesskit_node().label().unwrap_or_default()));
        if rival.is_some() {
            break;
        }
        press(&mut window, Modifiers::NONE, Key::ArrowRight);
    }
    let (frame, label) = rival.expect("the tracker carries rivals where arms are hidden");
    let tracked = window.document().pose_at(frame).clone();
    click(&mut window, &label);
    assert!(window.document().keys.contains_key(&frame));
    assert_ne!(*window.document().pose_at(frame), tracked);
    assert!(has_rival(&window), "now it is the tracked one");
    undo(&mut window);
    assert_eq!(*window.document().pose_at(frame), tracked);
    let (folder, shown) = (tempfile::tempdir().unwrap(), told(&mut window, frame));
    assert!(shown.0.iter().any(|label| label.starts_with("Doubtful limbs: ")), "{shown:?}");
    save(&mut window, &folder.path().join("cues.backlit"));
    let mut again = at(&folder.path().join("cues.backlit")).layout(Layout::Pose).sized(1600.0, 1600.0).open();
    assert_eq!(told(&mut again, frame), shown);
    assert_eq!(*again.document().pose_at(frame), tracked);
    command(&mut window, "Rival poses");
    assert!(!has_rival(&window));
}
