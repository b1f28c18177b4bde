//! The scene in the window.

use super::*;
use crate::app::testing::{Breaks, errors, open, settle};

#[test]
fn a_picture_that_breaks_down_is_said_once_and_the_next_one_is_drawn() {
    let (mut window, mut app) = open(Layout::Debug);
    let pool = app.inspector.state.pool.clone();
    let before = app.inspector.features.scene.drawing.clone().unwrap();
    app.inspector.features.scene.draw.begin(&pool, 0, |_| Breaks);
    settle(&mut window, &mut app);
    let said = ["Drawing the 3-D scene broke down: thirteen. Your work is unharmed."];
    assert_eq!(errors(&app), said);
    app.inspector.features.scene.preferences.floor = false;
    settle(&mut window, &mut app);
    assert!(!Arc::ptr_eq(&before, app.inspector.features.scene.drawing.as_ref().unwrap()));
    assert_eq!(errors(&app), said);
}

#[test]
fn a_hull_that_breaks_down_is_said_once_and_not_tried_again() {
    let (mut window, mut app) = open(Layout::Debug);
    let pool = app.inspector.state.pool.clone();
    let session = &app.inspector.state.session;
    let cameras = session.take.as_ref().unwrap().cameras.clone();
    let inputs = HullInputs { cameras, frame: session.shown_frame(0).unwrap().clone() };
    app.inspector.features.scene.hulls = Default::default();
    app.inspector.features.scene.carve.begin(&pool, inputs.clone(), |_| Breaks);
    settle(&mut window, &mut app);
    assert_eq!(errors(&app), ["Carving the visual hull broke down: thirteen. Your work is unharmed."]);
    assert!(app.inspector.features.scene.hulls.get(&inputs.frame).is_none());
}

#[test]
fn a_hull_is_of_the_very_frame() {
    let frame = |frame| Arc::new(FrameData { frame, cameras: Vec::new(), made_with: Default::default() });
    let mut cache = HullCache::default();
    let (first, again) = (frame(3), frame(3));
    cache.insert(first.clone(), None);
    assert_eq!(cache.get(&first), Some(None));
    assert_eq!(cache.get(&again), None, "segmented again, it is another one");
    cache.insert(again.clone(), None);
    assert_eq!(cache.get(&first), None);
    for other in 10..10 + CAPACITY {
        cache.insert(frame(other), None);
    }
    assert_eq!(cache.get(&again), None, "the oldest goes");
}
