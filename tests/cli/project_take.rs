//! A project in the place of a take: its body, its start and its silhouettes count.

use std::sync::Arc;

use backlit_document::project::write_project;
use backlit_document::{CameraUse, Document};
use backlit_formats::footage::BrushStroke;
use backlit_formats::{Take, model_file};
use backlit_take::source::TakeSource;
use backlit_tracking::camera::Camera;
use backlit_tracking::silhouette::{Label, Stroke};

/// Strokes, sizes and key poses of the window reach the command line.
#[test]
fn a_project_is_tracked_with_its_own_silhouettes_and_body() {
    let scene = crate::track::take();
    scene.ok("track wave --out plain");
    let take = Take::open(&scene.path("wave")).unwrap();
    let mut document = Document::new(take.model().scaled(1.01).unwrap());
    document.take = Some(TakeSource::Path("wave".into()));
    document.start = Arc::new(take.start().unwrap().clone());
    let stroke = Stroke { label: Label::Background, radius_px: 1000.0, points: vec![[0.0, 0.0]] };
    let camera = take.rig().cameras()[1].name();
    let used = |camera: &Camera| CameraUse { name: camera.name().to_owned(), used: true, weight: 1.0 };
    document.cameras = Arc::new(take.rig().cameras().iter().map(used).collect());
    document.brush = Arc::new(vec![BrushStroke { camera: 1, frames: [0, 1000], stroke }]);
    write_project(&scene.path("mine.backlit"), &document, &[]).unwrap();

    scene.ok("track mine.backlit --out mine");
    let iou = |results: &str| {
        scene.read_json(&format!("{results}/summary.json"))["iou"]["by_camera"][camera].clone()
    };
    assert!(iou("plain").as_f64().unwrap() > 0.5, "{}", iou("plain"));
    assert!(iou("mine").as_f64().is_none_or(|iou| iou < 0.01), "all of it is background: {}", iou("mine"));
    let body = model_file::read(&scene.path("mine/body.toml")).unwrap();
    assert!((body.limbs()[0].length / take.model().limbs()[0].length - 1.01).abs() < 1e-9);
    scene.ok("report mine --out page.html --pictures 2");
    scene.ok("silhouettes mine.backlit --frames 0 --out masks");

    scene.fails("track mine.backlit --model full_body --out other", 1, &["mine.backlit", "other limbs"]);
    document.take = Some(TakeSource::Path("gone".into()));
    write_project(&scene.path("lost.backlit"), &document, &[]).unwrap();
    scene.fails("track lost.backlit --out other", 1, &["the project's take", "gone"]);
}
