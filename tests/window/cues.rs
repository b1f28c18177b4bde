//! Cues in the window: keypoints where the tracker looks at them, and a lane of limbs that nothing holds.

use backlit::app::settings::Settings;
use backlit::app::{App, AppOptions, Opening};
use backlit::context::preferences::Layout;
use backlit_document::tracking_choices::CueChoice;
use backlit_take::demonstration::Demonstration;
use backlit_take::source::TakeSource;
use egui::accesskit::Role;
use egui::vec2;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};

use crate::support::app_window::{WindowState, click, open_sized, settle};

fn legends(window: &Harness<'_, App>) -> Vec<String> {
    let nodes = window.query_all_by_label_contains("Legend: ");
    nodes.map(|node| node.accesskit_node().value().unwrap_or_default()).collect()
}

#[test]
fn keypoints_are_drawn_and_unsure_limbs_have_a_lane_where_cues_are_used() {
    let settings = Settings { layout: Layout::Pose, ..Settings::default() };
    let opening = Some(Opening::Take(TakeSource::Demonstration(Demonstration::Cues)));
    // Opening it tracks it.
    let mut window =
        open_sized(AppOptions { settings, opening, ..AppOptions::default() }, vec2(1600.0, 1600.0));
    assert_eq!(window.document().tracking.cues, CueChoice::Keypoints);
    let here = window.selection().frame;
    assert!(window.document().estimates.contains_key(&here));
    let said = legends(&window);
    assert!(!said.is_empty() && said.iter().all(|legend| legend.contains("2-D keypoint")), "{said:?}");
    assert!(window.query_by_label_contains("Unsure limbs: ").is_some());
    click(&mut window, "Solver");
    window.get_by_role_and_label(Role::ComboBox, "Cues").click();
    window.run_steps(3);
    window.get_by_label("None").click();
    settle(&mut window);
    assert_eq!(window.document().tracking.cues, CueChoice::None);
    let said = legends(&window);
    assert!(said.iter().all(|legend| !legend.contains("2-D keypoint")), "{said:?}");
}
