//! The background learnt again without the tracked body, through the real window, and taken back.

use std::path::Path;

use backlit_document::project::read_project;
use backlit_tracking::silhouette::Label;
use egui::{Key, Modifiers};
use egui_kittest::kittest::{NodeT, Queryable};
use image::{Rgba, RgbaImage};

use crate::support::take;
use crate::support::window::{Window, WindowState, at, click, command, press, save, type_into_palette, undo};

/// Frames of the take: enough for the forearm to leave every pixel.
const FRAMES: usize = 24;
const NAME: &str = "Learn background again";

/// The arm's take on the disk; what lies behind the forearm at first is not known of the front camera's plate.
fn write_take(folder: &Path) {
    take::write_frames_to(folder, FRAMES);
    let path = folder.join("front/empty.png");
    let plate = image::open(&path).unwrap().to_rgba8();
    let hole = |x: u32, y: u32| (30..60).contains(&x) && (8..24).contains(&y);
    let cut = RgbaImage::from_fn(plate.width(), plate.height(), |x, y| {
        if hole(x, y) { Rgba([0, 0, 0, 0]) } else { *plate.get_pixel(x, y) }
    });
    cut.save(&path).unwrap();
}

/// How many pixels of the front camera's silhouette are unknown.
fn unknown(harness: &Window) -> usize {
    let session = harness.session();
    let frame = session.frames.get(harness.selection().frame).unwrap();
    let mask = frame.cameras[0].mask.as_ref().unwrap();
    mask.labels().iter().filter(|label| **label == Label::Unknown).count()
}

/// What the palette says beside the command, which it does not do.
fn why_not(harness: &mut Window) -> String {
    type_into_palette(harness, NAME);
    let why = {
        let row = harness.get_by_label_contains(NAME);
        let node = row.accesskit_node();
        assert!(node.is_disabled());
        node.label().unwrap_or_default()
    };
    press(harness, Modifiers::NONE, Key::Escape);
    why
}

#[test]
fn the_background_is_learnt_without_the_body_and_the_silhouettes_follow() {
    let folder = tempfile::tempdir().unwrap();
    write_take(folder.path());
    let mut harness = at(folder.path()).open();
    let before = unknown(&harness);
    assert!(before > 300, "the hole is unknown: {before} pixels");
    let why = why_not(&mut harness);
    assert!(why.contains("There is no track yet"), "{why}");

    click(&mut harness, "Track forward");
    let tracked = harness.document().estimates.len();
    assert_eq!(tracked, FRAMES);
    press(&mut harness, Modifiers::NONE, Key::Home);
    let why = why_not(&mut harness);
    assert!(why.contains("Save the project first"), "nothing is written beside the take: {why}");
    let project_folder = tempfile::tempdir().unwrap();
    let project = project_folder.path().join("arm.backlit");
    save(&mut harness, &project);
    command(&mut harness, NAME);

    harness.get_by_label_contains("Learnt the background of 2 cameras without the body.");
    let plates = harness.document().plates.clone();
    let place = project_folder.path().join("background without body");
    assert_eq!(plates.values().collect::<Vec<_>>(), [&place.join("front.png"), &place.join("above.png")]);
    assert!(plates.values().all(|path| path.is_file()));
    let after = unknown(&harness);
    // Half of the hole is behind the arm in nearly all frames.
    assert!(3 * after < 2 * before, "{after} of {before} pixels are still unknown");
    assert_eq!(harness.document().estimates.len(), tracked, "the track stays");

    // The project keeps them, and a further time does not write over them.
    save(&mut harness, &project);
    assert_eq!(read_project(&project).unwrap().document.plates, plates);
    command(&mut harness, NAME);
    let again = harness.document().plates.clone();
    assert_eq!(again[&0], project_folder.path().join("background without body 2/front.png"));

    undo(&mut harness);
    assert_eq!(harness.document().plates, plates);
    undo(&mut harness);
    assert!(harness.document().plates.is_empty());
    assert_eq!(unknown(&harness), before, "undone, the silhouettes are as they were");
}

#[test]
fn where_a_camera_cannot_be_learnt_nothing_changes() {
    let folder = tempfile::tempdir().unwrap();
    write_take(folder.path());
    let mut harness = at(folder.path()).open();
    click(&mut harness, "Track forward");
    save(&mut harness, &folder.path().join("arm.backlit"));
    // The footage is gone.
    std::fs::rename(folder.path().join("above"), folder.path().join("elsewhere")).unwrap();
    let document = harness.document().clone();
    command(&mut harness, NAME);
    harness.get_by_label_contains("The background cannot be learnt: ");
    assert_eq!(*harness.document(), document);
}
