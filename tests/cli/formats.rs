//! The examples of `docs/formats.md` are what the program reads, and its tables name what there is.

use std::collections::BTreeSet;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use backlit::app::settings_file as settings;
use backlit::context::preferences::Layout;
use backlit_document::Origin;
use backlit_document::project::{Project, read_project};
use backlit_formats::calibration::{self, CalibrationOptions};
use backlit_formats::pose_file::{self, Quaternions};
use backlit_formats::{MemoryFiles, Take, model_file, placement_file};
use backlit_take::source::TakeSource;
use backlit_tracking::body::{Model, builtin};
use backlit_tracking::fit::FitOptions;
use backlit_tracking::segment::SegmentOptions;
use backlit_ui::style::theme::Theme;
use image::{DynamicImage, ImageFormat};
use serde_json::Value;

fn page() -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/formats.md")).unwrap()
}

/// What stands under a heading.
fn section(heading: &str) -> String {
    let page = page();
    let (_, after) = page.split_once(&format!("\n## {heading}\n")).unwrap();
    after.split("\n## ").next().unwrap().to_owned()
}

/// The first example under a heading.
fn example(heading: &str) -> String {
    let section = section(heading);
    let (_, after) = section.split_once("\n```").unwrap();
    let (_, text) = after.split_once('\n').unwrap();
    text.split("\n```").next().unwrap().to_owned()
}

/// All examples in JSON under a heading.
fn examples(heading: &str) -> Vec<Value> {
    let section = section(heading);
    let blocks = section.split("\n```json\n").skip(1).map(|block| block.split("\n```").next().unwrap());
    blocks.map(|text| serde_json::from_str(text).unwrap()).collect()
}

/// The words in code in the first columns of the tables under a heading.
fn rows(section: &str) -> BTreeSet<String> {
    let firsts =
        section.lines().filter(|line| line.starts_with("| `")).map(|line| line.split('|').nth(1).unwrap());
    firsts.flat_map(|cell| cell.split('`').skip(1).step_by(2).map(str::to_owned)).collect()
}

/// The keys of an object.
fn keys(value: &Value) -> BTreeSet<String> {
    value.as_object().unwrap().keys().cloned().collect()
}

fn missing(of: &BTreeSet<String>, from: &BTreeSet<String>) -> Vec<String> {
    of.difference(from).cloned().collect()
}

#[test]
fn the_take_with_its_cameras_and_keypoints_is_opened() {
    let take = example("Take");
    let mut files: Vec<(PathBuf, Vec<u8>)> = vec![
        ("t/take.toml".into(), take.into()),
        ("t/body.toml".into(), model_file::to_text(&builtin::full_body()).into()),
        ("t/start.json".into(), example("Pose").into()),
        ("footage/balancing/calib/cameras.json".into(), example("Cameras").into()),
        ("footage/balancing/keypoints.csv".into(), example("Keypoints").into()),
        ("footage/balancing/background/cam01.png".into(), Vec::new()),
    ];
    let picture = DynamicImage::new_luma8(272, 480);
    let mut bytes = Cursor::new(Vec::new());
    picture.write_to(&mut bytes, ImageFormat::Png).unwrap();
    let bytes = bytes.into_inner();
    files
        .extend((0..70).map(|k| (format!("footage/balancing/cam01/frame_{k:03}.jpg").into(), bytes.clone())));
    let take = Take::from_files(Arc::new(MemoryFiles::new(files)), Path::new("t/take.toml")).unwrap();
    assert_eq!((take.name(), take.frame_count(), take.rig().count()), ("balancing", 70, 1));
    assert_eq!(take.rig().cameras()[0].name(), "cam01");
    assert_eq!(take.reference().unwrap().joints(0).len(), 2);
    assert!(take.start().is_some());
    let options = &take.measurement()[0];
    assert_eq!((options.shadow, options.region.map(|region| region.width)), (None, Some(200)));
}

#[test]
fn body_cameras_and_pose_are_read() {
    let path = Path::new("example");
    let model = model_file::parse(path, example("Body").as_bytes()).unwrap();
    assert_eq!((model.limbs().len(), model.rotation_count()), (3, 2));
    assert_eq!(model.limbs()[2].spheres.len(), 2);
    let cameras = example("Cameras");
    let rig = calibration::parse(path, cameras.as_bytes(), CalibrationOptions::default()).unwrap();
    assert_eq!((rig.cameras()[0].name(), rig.cameras()[0].width()), ("cam01", 272));
    let full = builtin::full_body();
    pose_file::parse(path, example("Pose").as_bytes(), &full, Quaternions::Normalised).unwrap();
    let placement = examples("Keypoints")[0].to_string();
    let placement = placement_file::parse(path, placement.as_bytes(), &full).unwrap();
    assert!(placement.offsets["right lower calf"].spread > 0.0);
}

#[test]
fn the_project_is_read_and_its_tables_name_all_there_is() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("example.backlit");
    std::fs::write(&path, example("Project")).unwrap();
    let Project { document, runs } = read_project(&path).unwrap();
    assert_eq!((runs.len(), runs[0].number, runs[0].steps.len()), (1, 1, 1));
    assert_eq!(document.take, Some(TakeSource::Path("balancing".into())));
    assert_eq!((document.model.name(), document.keys.len()), ("arm", 1));
    let found = &document.estimates[&13];
    assert_eq!((found.origin, found.steps, found.iou), (Origin::Track, 21, Some(0.85)));
    assert_eq!((document.cameras[1].used, document.cameras[1].weight), (false, 0.5));
    assert_eq!(document.fit.stages.len(), 2);
    assert_eq!(document.fit.limit_weight, FitOptions::default().limit_weight, "left out");
    assert_eq!((document.measurement[0].z_threshold, document.measurement[1].shadow), (4.5, None));
    assert_eq!(document.masks[&12][&1], Path::new("/masks/cam02.png"));
    assert_eq!(document.pins.len(), 1);

    // What is written has no field that is not in the tables, and the tables have none besides.
    let written = folder.path().join("written.backlit");
    backlit_document::project::write_project(&written, &document, &runs).unwrap();
    let written: Value = serde_json::from_slice(&std::fs::read(&written).unwrap()).unwrap();
    let section = section("Project");
    let (project, fit) = section.split_once("| `fit` | unit |").unwrap();
    let mut fields = rows(project);
    fields.remove("field");
    let optional = ["calibration", "person", "told"].map(str::to_owned);
    let expected: BTreeSet<String> =
        keys(&written).into_iter().chain(optional).filter(|key| key != "format").collect();
    assert_eq!(missing(&expected, &fields), [""; 0]);
    assert_eq!(missing(&fields, &expected), [""; 0]);
    let fit: BTreeSet<String> = rows(fit.split("**Copies").next().unwrap());
    assert_eq!(missing(&keys(&written["fit"]), &fit), [""; 0]);
    assert_eq!(missing(&keys(&written["fit"]["stages"][0]), &rows_and_words(&section)), [""; 0]);

    // As short as the page says that it may be.
    let minimal = serde_json::json!({
        "format": "backlit-project 1", "take": "built-in", "model": written["model"], "start": {"root": [0, 0, 0]}
    });
    std::fs::write(&path, minimal.to_string()).unwrap();
    assert!(read_project(&path).unwrap().document.cameras.is_empty());
}

/// Every word in code of a section.
fn rows_and_words(section: &str) -> BTreeSet<String> {
    section.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

#[test]
fn the_settings_are_read_and_the_table_names_all_there_is() {
    let folder = tempfile::tempdir().unwrap();
    let text = example("Settings");
    std::fs::write(settings::path_in(folder.path()), &text).unwrap();
    let (look, unread) = settings::read(folder.path());
    assert_eq!(unread, None);
    assert_eq!((look.theme, look.layout, look.tour_offered), (Theme::Light, Layout::Debug, true));
    settings::write(folder.path(), &look).unwrap();
    let written = std::fs::read_to_string(settings::path_in(folder.path())).unwrap();
    let mut written = keys(&serde_json::from_str(&written).unwrap());
    assert_eq!(missing(&keys(&serde_json::from_str(&text).unwrap()), &written), [""; 0], "of the example");
    written.remove("format");
    assert_eq!(
        rows(&section("Settings")).into_iter().filter(|row| row != "field").collect::<BTreeSet<_>>(),
        written
    );
}

#[test]
fn the_table_of_measurement_names_all_there_is() {
    let options = serde_json::to_value(SegmentOptions::default()).unwrap();
    let section = section("Take");
    let (_, table) = section.split_once("| `[measurement]` |").unwrap();
    assert_eq!(rows(table), keys(&options));
    for test in ["shadow", "dont_know"] {
        assert_eq!(missing(&keys(&options[test]), &rows_and_words(table)), [""; 0], "{test}");
    }
}

#[test]
fn the_limbs_table_names_all_there_is() {
    let model: &Model = &builtin::full_body();
    let spec = serde_json::to_value(model.to_spec()).unwrap();
    let mut written: BTreeSet<String> = spec["limb"].as_array().unwrap().iter().flat_map(keys).collect();
    written.extend(["spheres", "coarser"].map(str::to_owned));
    let section = section("Body");
    let (_, table) = section.split_once("| `[[limb]]` |").unwrap();
    let words = rows(table);
    assert_eq!(words, written);
}

#[test]
fn all_other_examples_are_whole_json_of_their_format() {
    for (heading, format) in [
        ("Track", Some("backlit-track 1")),
        ("Experiment", Some("backlit-experiment 1")),
        ("Window state", Some("backlit-state 1")),
    ] {
        let examples = examples(heading);
        assert_eq!(examples[0]["format"].as_str(), format, "{heading}");
    }
}
