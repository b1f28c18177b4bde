//! The camera views in the window.

use super::*;
use crate::app::testing::{TestWindow, open};
use crate::context::command::{Command, ViewCommand};

#[test]
fn linked_views_zoom_together_and_others_alone() {
    let mut app = open(Layout::Pose);
    let framed = |app: &TestWindow| {
        let tiles = app.features.camera_views.tiles(Layout::Pose);
        tiles.iter().filter(|tile| matches!(tile.framing, Framing::Free { .. })).count()
    };
    app.run(Command::View(ViewCommand::ZoomIn));
    assert_eq!(framed(&app), 1);
    app.run(Command::View(ViewCommand::FitSubject));
    app.run(Command::View(ViewCommand::LinkZoom));
    app.run(Command::View(ViewCommand::ZoomIn));
    assert_eq!(framed(&app), app.state.session.camera_count());
}

#[test]
fn each_layout_has_its_modes_and_asks_for_their_derivatives() {
    let mut app = open(Layout::Pose);
    let derivatives = |app: &TestWindow| app.context().derivatives;
    assert!(derivatives(&app).column.is_none());
    app.run(Command::View(ViewCommand::Mode(ViewMode::JacobianColumn)));
    let first = derivatives(&app).column;
    assert!(first.is_some());
    // Chosen again it goes on to its next axis.
    app.run(Command::View(ViewCommand::Mode(ViewMode::JacobianColumn)));
    assert_ne!(derivatives(&app).column, first);
    app.state.preferences.layout = Layout::Debug;
    assert!(derivatives(&app).column.is_none());
}

#[test]
fn a_comparison_is_of_two_different_modes() {
    let mut tile = TileView { mode: ViewMode::Footage, ..TileView::default() };
    tile.toggle(ModeComparison::Blink);
    assert_eq!((tile.mode, tile.other), (ViewMode::Footage, ViewMode::Tinted));
    tile.set_mode(ViewMode::Tinted);
    assert_eq!((tile.mode, tile.other), (ViewMode::Tinted, ViewMode::Footage));
    tile.compare_with(ViewMode::Tinted);
    assert_eq!((tile.mode, tile.other), (ViewMode::Footage, ViewMode::Tinted));
    tile.toggle(ModeComparison::Wipe);
    assert_eq!(tile.comparison, Some(ModeComparison::Wipe));
    tile.toggle(ModeComparison::Wipe);
    assert!(tile.comparison.is_none() && !tile.shows(ViewMode::Tinted));
    tile.compare_with(ViewMode::Residual);
    assert!(tile.comparison == Some(ModeComparison::Wipe) && tile.shows(ViewMode::Residual));
}
