//! Pictures without a display: of one view, and many.

use std::path::PathBuf;
use std::sync::Arc;

use backlit_document::project::write_project;
use backlit_document::{CameraUse, Document};
use backlit_take::source::TakeSource;
use backlit_tracking::segment::SegmentOptions;

use crate::scene::Scene;

#[test]
fn one_view_and_many_are_written() {
    let scene = Scene::new();
    scene.ok("screenshot --camera 2 --mode residual --width 120 --no-legend --frame 3 --out view.png");
    let view = image::open(scene.path("view.png")).unwrap();
    assert_eq!(view.width(), 120);
    scene.ok("screenshot --camera 1 --scale 0.5 --sequence iterations --iteration 2 --delay 50 --out a.gif");
    assert_eq!(&std::fs::read(scene.path("a.gif")).unwrap()[..6], b"GIF89a");
    scene.ok("screenshot --camera 1 --scale 0.5 --no-marks --sequence frames --frames 4..6 --out frames");
    let mut names: Vec<_> =
        std::fs::read_dir(scene.path("frames")).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["frame_0004.png", "frame_0005.png", "frame_0006.png"]);
    scene.ok("screenshot --size 300x250 --sequence frames --frames 0..1 --out window.png");
    let window = image::open(scene.path("window.png")).unwrap();
    assert_eq!((window.width(), window.height()), (300, 250));
}

#[test]
fn what_makes_no_sense_is_said() {
    let scene = Scene::new();
    scene.fails("screenshot --camera 0 --out a.png", 1, &["--camera", "counted from 1"]);
    scene.fails("screenshot --camera 9 --out a.png", 1, &["no camera 9", "has 4"]);
    scene.fails("screenshot --camera 1 --scale 99 --out a.png", 1, &["--scale is 99", "0.25 to 8"]);
    scene.fails("screenshot --sequence frames --out a.mp4", 1, &["a.mp4", ".gif", "folder"]);
    scene.fails("screenshot --sequence frames --frames 5..2 --out a", 2, &["5..2", "FIRST..LAST"]);
    scene.fails("screenshot --sequence frames --frames 99..120 --out a", 1, &["no frame 99", "60"]);
    scene.fails("screenshot --width 100 --out a.png", 2, &["--camera"]);
    scene.fails("screenshot --sequence frames --delay 1 --out a.gif", 1, &["--delay is 1", "milliseconds"]);
    scene.fails("screenshot --sequence iterations --iteration 0 --camera 1 --out a", 1, &["--iteration"]);
}

/// A silhouette of a project that is not there is missing in the picture: that is an error.
#[test]
fn a_missing_mask_is_an_error() {
    let scene = crate::track::take();
    let mut document = Document::new(scene.model.clone());
    document.take = Some(TakeSource::Path(PathBuf::from("wave")));
    let camera = |name: &str| CameraUse { name: name.to_owned(), used: true, weight: 1.0 };
    document.cameras = Arc::new(vec![camera("front"), camera("side")]);
    document.measurement = Arc::new(vec![SegmentOptions::default(); 2]);
    document.masks = Arc::new([(0, [(1, PathBuf::from("gone.png"))].into())].into());
    write_project(&scene.path("mine.backlit"), &document, &[]).unwrap();
    let picture = "screenshot mine.backlit --size 640x480 --out a.png";
    scene.fails(picture, 1, &["a.png is written", "camera 2", "gone.png"]);
}
