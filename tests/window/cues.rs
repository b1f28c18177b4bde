//! Cues in the window: keypoints where the tracker looks at them, and a lane of limbs that nothing holds.

use backlit::context::preferences::Layout;
use backlit_document::tracking_choices::CueChoice;
use backlit_take::demonstration::Demonstration;
use egui::accesskit::Role;
use egui_kittest::kittest::{NodeT, Queryable};

use crate::support::window::{Window, WindowState, click, demonstration, settle, undo};

fn legends(window: &Window) -> Vec<String> {
    let nodes = window.query_all_by_label_contains("Legend: ");
    nodes.map(|node| node.accesskit_node().value().unwrap_or_default()).collect()
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
