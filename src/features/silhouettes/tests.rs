//! Silhouettes steered by hand, in the window.

use backlit_document::edit::Edit;
use backlit_take::source::TakeSource;
use backlit_tracking::silhouette::{Label, Mask, Region};

use super::BrushScope;
use crate::app::testing::{TestWindow, open_source};
use crate::context::command::{Command, HistoryCommand, SilhouetteCommand};
use crate::context::marks::SilhouetteTool;
use crate::context::pane::Pane;
use crate::context::preferences::Layout;
use crate::context::{FeatureRequest, PaneEvent, ShellRequest};

const CAMERA: usize = 1;

fn open() -> TestWindow {
    open_source(TakeSource::BuiltIn, Layout::Pose)
}

fn does(app: &mut TestWindow, command: SilhouetteCommand) {
    app.does(Command::Silhouettes(command));
}

/// The silhouette of the frame on the screen.
fn mask(app: &TestWindow) -> Mask {
    let frame = app.state.selection.frame;
    let data = app.state.session.frames.get(frame).unwrap();
    data.cameras[CAMERA].mask.as_deref().unwrap().clone()
}

/// Draws a line as the pointer would.
fn draw(app: &mut TestWindow, points: &[[f32; 2]]) {
    let line = points.to_vec();
    app.ask(|_, _, requests| requests.request(FeatureRequest::DrawSilhouette(CAMERA, line)));
    app.settle();
}

#[test]
fn what_is_painted_is_in_the_silhouette_and_undone_in_one_step() {
    let mut app = open();
    let before = mask(&app);
    let line = [[3.0, 3.0], [20.0, 3.0]];
    assert_eq!(before.get(10, 4), Some(Label::Background));
    does(&mut app, SilhouetteCommand::Draw(SilhouetteTool::Brush(Label::Subject)));
    draw(&mut app, &line);
    assert_eq!(
        mask(&app).get(10, 4),
        Some(Label::Subject),
        "no other camera sees it: it was painted all the same"
    );
    app.does(Command::History(HistoryCommand::Undo));
    app.settle();
    assert_eq!(mask(&app), before);
    does(&mut app, SilhouetteCommand::PutAway);
    draw(&mut app, &line);
    assert_eq!(mask(&app), before, "without a brush nothing is painted");
}

#[test]
fn a_stroke_goes_along_with_the_body_and_marked_frames_are_cleaned() {
    let mut app = open();
    let count = app.state.session.frame_count();
    does(&mut app, SilhouetteCommand::Draw(SilhouetteTool::Brush(Label::Unknown)));
    app.features.silhouettes.scope = BrushScope::Range;
    draw(&mut app, &[[3.0, 3.0]]);
    let strokes = app.document().brush.clone();
    assert_eq!((strokes.len(), strokes[0].frames), (1, [0, count - 1]));
    app.features.silhouettes.scope = BrushScope::Body;
    let pose = app.shown_pose().clone();
    for frame in [2, 5] {
        let what = "Move".to_owned();
        app.state.edit(Edit::SetPose { frame, pose: pose.clone(), what }, None);
    }
    draw(&mut app, &[[40.0, 40.0]]);
    let frames: Vec<_> = app.document().brush.iter().skip(1).map(|one| one.frames[0]).collect();
    assert_eq!(frames, [app.state.selection.frame, 2, 5]);
    let camera = ShellRequest::Camera(CAMERA);
    app.ask(|_, _, requests| requests.request(camera));
    does(&mut app, SilhouetteCommand::Erase);
    let shown = app.state.selection.frame;
    assert!(app.document().brush.iter().all(|one| !one.is_of(CAMERA, shown)));
}

#[test]
fn outside_the_region_is_background() {
    let mut app = open();
    does(&mut app, SilhouetteCommand::Draw(SilhouetteTool::Region));
    draw(&mut app, &[[0.0, 0.0], [30.0, 20.0]]);
    let region = app.document().measurement[CAMERA].region;
    assert_eq!(region, Some(Region { x: 0, y: 0, width: 30, height: 20 }));
    assert_eq!(mask(&app).count(Label::Subject), 0);
    app.ask(|_, _, requests| requests.request(ShellRequest::Camera(CAMERA)));
    does(&mut app, SilhouetteCommand::RemoveRegion);
    app.settle();
    assert!(mask(&app).count(Label::Subject) > 100);
}

#[test]
fn the_pane_tells_how_the_silhouette_came_about() {
    let mut app = open();
    app.ask(|_, _, requests| requests.request(ShellRequest::Pane(Pane::Silhouettes, PaneEvent::Open)));
    app.settle();
    let shown = app.features.silhouettes.shown.clone().unwrap();
    let steps = shown.steps.as_ref().unwrap();
    let frame = app.state.session.frames.get(shown.frame).unwrap();
    assert_eq!(steps.mask(), frame.cameras[shown.camera].mask.as_deref());
    assert!(steps.stages.len() > 4);
}

#[test]
fn the_worst_silhouettes_are_those_that_were_spoilt() {
    let mut app = open();
    app.state.selection.frame = 7;
    app.settle();
    does(&mut app, SilhouetteCommand::Draw(SilhouetteTool::Brush(Label::Background)));
    app.features.silhouettes.radius_px = 60.0;
    let bounds = mask(&app).bounds().unwrap();
    let middle = [(bounds.x_min + bounds.x_max) as f32 / 2.0, (bounds.y_min + bounds.y_max) as f32 / 2.0];
    draw(&mut app, &[middle]);
    does(&mut app, SilhouetteCommand::FindWorst);
    app.settle();
    let worst = app.features.silhouettes.worst.clone().unwrap();
    assert_eq!((worst[0].camera, worst[0].frame), (CAMERA, 7), "{}", worst[0].reason());
    let marked = &app.state.published.silhouettes.worst;
    assert_eq!((marked.len(), marked[0].camera, marked[0].frame), (worst.len(), CAMERA, 7));
}
