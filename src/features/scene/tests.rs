//! The scene in the window.

use super::*;
use crate::app::testing::{Breaks, open};

#[test]
fn a_picture_that_breaks_down_is_said_once_and_the_next_one_is_drawn() {
    let mut app = open(Layout::Debug);
    let before = app.features.scene.drawing.clone().unwrap();
    app.break_down(|all, pool| all.features.scene.draw.begin(pool, 0, |_| Breaks));
    let said = ["Drawing the 3-D scene broke down: thirteen. Your work is unharmed."];
    assert_eq!(app.errors(), said);
    app.features.scene.preferences.floor = false;
    app.settle();
    assert!(!Arc::ptr_eq(&before, app.features.scene.drawing.as_ref().unwrap()));
    assert_eq!(app.errors(), said);
}

#[test]
fn a_hull_that_breaks_down_is_said_once_and_not_tried_again() {
    let mut app = open(Layout::Debug);
    let session = &app.state.session;
    let cameras = session.take.as_ref().unwrap().cameras.clone();
    let inputs = HullInputs { cameras, frame: session.shown_frame(0).unwrap().clone() };
    app.features.scene.hulls = Default::default();
    app.break_down(|all, pool| all.features.scene.carve.begin(pool, inputs.clone(), |_| Breaks));
    assert_eq!(app.errors(), ["Carving the visual hull broke down: thirteen. Your work is unharmed."]);
    assert!(app.features.scene.hulls.get(&inputs.frame).is_none());
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
