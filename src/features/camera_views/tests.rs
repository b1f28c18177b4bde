//! The camera views in the window.

use backlit_ui::drawing::ViewMode;
use backlit_ui::widgets::Framing;

use crate::app::testing::open;
use crate::context::command::{Command, ViewCommand};
use crate::context::preferences::Layout;

#[test]
fn linked_views_zoom_together_and_others_alone() {
    let (_window, mut app) = open(Layout::Pose);
    let egui = app.state.egui.clone();
    let framed = |app: &crate::app::App| {
        let tiles = app.features.camera_views.tiles(Layout::Pose);
        tiles.iter().filter(|tile| matches!(tile.framing, Framing::Free { .. })).count()
    };
    app.run(Command::View(ViewCommand::ZoomIn), &egui);
    assert_eq!(framed(&app), 1);
    app.run(Command::View(ViewCommand::FitSubject), &egui);
    app.run(Command::View(ViewCommand::LinkZoom), &egui);
    app.run(Command::View(ViewCommand::ZoomIn), &egui);
    assert_eq!(framed(&app), app.state.session.camera_count());
}

#[test]
fn each_layout_has_its_modes_and_asks_for_their_derivatives() {
    let (_window, mut app) = open(Layout::Pose);
    let egui = app.state.egui.clone();
    let derivatives = |app: &crate::app::App| app.context().derivatives;
    assert!(derivatives(&app).column.is_none());
    app.run(Command::View(ViewCommand::Mode(ViewMode::JacobianColumn)), &egui);
    let first = derivatives(&app).column;
    assert!(first.is_some());
    // Chosen again it goes on to its next axis.
    app.run(Command::View(ViewCommand::Mode(ViewMode::JacobianColumn)), &egui);
    assert_ne!(derivatives(&app).column, first);
    app.state.preferences.layout = Layout::Debug;
    assert!(derivatives(&app).column.is_none());
}
