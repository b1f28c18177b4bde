//! `backlit report`: a track as one page.

use std::fs;
use std::path::PathBuf;
use std::sync::Arc;

use backlit_document::Document;
use backlit_document::project::write_project;
use backlit_take::source::TakeSource;

/// The page's data, as its script reads them.
fn data_of(html: &str) -> serde_json::Value {
    let (_, data) = html.split_once("<script type=\"application/json\" id=\"data\">").unwrap();
    serde_json::from_str(data.split_once("</script>").unwrap().0).unwrap()
}

#[test]
fn a_track_becomes_a_page_with_pictures_of_the_take_that_it_names() {
    let scene = crate::track::take();
    scene.ok("track wave --out results");
    let made = &scene.read_json("results/summary.json")["made"];
    assert_eq!(made["take"], scene.path("wave").canonicalize().unwrap().to_str().unwrap());
    assert_eq!(made["command"], "backlit track wave --out results");
    assert_eq!(made["settings"]["preset"], "Robust");

    scene.ok("report results --out page.html --pictures 3 --steps-of 1");
    let page = fs::read_to_string(scene.path("page.html")).unwrap();
    let data = data_of(&page);
    let frames = data["frames"].as_array().unwrap().len();
    assert_eq!(frames, scene.read_json("results/track.json")["frames"].as_array().unwrap().len());
    let pictures = data["pictures"].as_array().unwrap();
    assert!((6..=8).contains(&pictures.len()), "three frames or four of two cameras: {}", pictures.len());
    assert!(
        pictures.iter().all(|one| one["source"].as_str().unwrap().starts_with("data:image/jpeg;base64,"))
    );
    assert_eq!(data["fits"].as_array().unwrap().len(), 1);
    for told in ["backlit track wave --out results", "backlit report results --out page.html", "Silhouettes"]
    {
        assert!(page.contains(told), "{told}");
    }
    // The take has moved.
    fs::rename(scene.path("wave"), scene.path("moved")).unwrap();
    let [_, told] = scene.told("report results --out alone.html");
    assert!(told.contains("cannot be opened") && told.contains("--take"), "{told}");
    let alone = fs::read_to_string(scene.path("alone.html")).unwrap();
    assert!(data_of(&alone)["pictures"].as_array().unwrap().is_empty());
    assert!(alone.contains("not at hand"));
    scene.ok("report results --take moved --out again.html");
    assert!(
        !data_of(&fs::read_to_string(scene.path("again.html")).unwrap())["pictures"]
            .as_array()
            .unwrap()
            .is_empty()
    );

    scene.fails("report results --take moved --out page.html --steps-of 99", 1, &["--steps-of", "frame 99"]);
    scene.fails("report nowhere --out page.html", 1, &["nowhere"]);
    scene.fails("report results --out nowhere/page.html", 1, &["nowhere/page.html", "no folder"]);
    scene.fails("report results", 2, &["--out"]);
    if cfg!(feature = "rrd") {
        scene.ok("report results --take moved --rrd track.rrd --pictures 1");
        assert!(fs::read(scene.path("track.rrd")).unwrap().starts_with(b"RRF2"));
    } else {
        scene.fails("report results --rrd track.rrd", 1, &["--rrd", "--features rrd"]);
    }
    scene.fails("report results --out a.html --pictures 2000", 2, &["--pictures", "1000"]);
    assert_eq!(fs::read_to_string(scene.path("page.html")).unwrap(), page, "the page stays as it was");
}

#[test]
fn the_poses_of_a_project_become_a_page_as_they_are() {
    let scene = crate::track::take();
    let mut document = Document::new(scene.model.clone());
    document.take = Some(TakeSource::Path(PathBuf::from("wave")));
    // The last one lies beyond the take.
    document.keys = Arc::new([1, 3, 99].map(|frame| (frame, scene.pose())).into());
    write_project(&scene.path("mine.backlit"), &document, &[]).unwrap();
    scene.ok("report mine.backlit --out page.html");
    let page = fs::read_to_string(scene.path("page.html")).unwrap();
    assert_eq!(data_of(&page)["frames"], serde_json::json!([1, 3]));
    assert!(page.contains("Poses set by hand"));
    scene.fails("report mine.backlit --model full_body --out page.html", 1, &["--model is for tracks"]);
}
