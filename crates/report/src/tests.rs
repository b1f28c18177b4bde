use std::time::Instant;

use backlit_tracking::body::{Pose, builtin};
use glam::{DMat3, DVec3};

use super::*;

/// What a user may call things to do harm.
pub(crate) const HOSTILE: &str = "</script><img src=x onerror=alert(1)>\"'&{{data}}\u{2028}<!--";

/// A body that walks, seen by four cameras.
pub(crate) fn walk(frames: usize) -> Page {
    let model = builtin::full_body();
    let pose = |frame: usize| {
        let mut pose = Pose::rest(&model);
        pose.root = DVec3::new((frame as f64 / 300.0).sin(), frame as f64 / 5000.0, 1.0);
        pose
    };
    let camera = |number: usize| PageCamera {
        name: format!("cam{number}"),
        size: [272, 480],
        intrinsics: [420.0, 420.0, 135.5, 239.5],
        rotation: DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y),
        translation: DVec3::new(0.0, 1.0, 3.0),
    };
    let curve = |label: &str, camera: Option<usize>| Curve {
        label: label.to_owned(),
        unit: String::new(),
        group: "Overlap (IoU)".to_owned(),
        camera,
        values: (0..frames).map(|frame| (frame, Some(0.85 + 0.1 * (frame as f64 / 40.0).sin()))).collect(),
    };
    let doubt = |frame: usize| DoubtedLimb {
        limb: 3,
        is_wrong: frame.is_multiple_of(2),
        reason: "it moves fast",
        wrong: 0.3,
    };
    let all = (0..frames).map(|frame| Frame {
        iou: Some(0.87),
        doubts: if frame % 10 == 9 { vec![doubt(frame)] } else { Vec::new() },
        lost: (frame % 1000 == 500).then(|| "nobody".to_owned()),
        ..Frame::of_pose(&model, frame, &pose(frame))
    });
    Page {
        title: "a walk".to_owned(),
        frame_rate: 60.0,
        up: DVec3::Z,
        limbs: PageLimb::all(&model),
        cameras: (0..4).map(camera).collect(),
        frames: all.collect(),
        pictures: Vec::new(),
        fits: Vec::new(),
        curves: (0..5).map(|curve_of| curve(&format!("curve {curve_of}"), None)).collect(),
        tables: Vec::new(),
        bookmarks: Vec::new(),
        settings: Vec::new(),
        commands: Vec::new(),
        notes: Vec::new(),
    }
}

/// The page's data as a browser's script gets them.
fn data_of(html: &str) -> serde_json::Value {
    let (_, data) = html.split_once("<script type=\"application/json\" id=\"data\">").unwrap();
    serde_json::from_str(data.split_once("</script>").unwrap().0).unwrap()
}

#[test]
fn ten_thousand_frames_are_a_few_megabytes_at_once() {
    let page = walk(10_000);
    let began = Instant::now();
    let html = to_html(&page);
    let (seconds, megabytes) = (began.elapsed().as_secs_f64(), html.len() as f64 / 1e6);
    println!("10000 frames of 30 limbs: {megabytes:.1} MB in {seconds:.2} s");
    assert!(megabytes < 6.0, "{megabytes} MB");
    assert!(seconds < 20.0, "{seconds} s");
    let data = data_of(&html);
    assert_eq!(data["frames"].as_array().unwrap().len(), 10_000);
    assert_eq!(data["doubts"]["frames"].as_object().unwrap().len(), 1000);
    assert_eq!(data["lost"]["500"], "nobody");
}

#[test]
fn names_of_users_stay_text() {
    let mut page = walk(3);
    let name = || HOSTILE.to_owned();
    page.title = name();
    (page.limbs[0].name, page.limbs[0].joint, page.cameras[0].name) = (name(), name(), name());
    page.frames[1].lost = Some(name());
    (page.curves[0].label, page.curves[0].unit, page.curves[0].group) = (name(), name(), name());
    page.bookmarks = vec![Bookmark { frame: 1, camera: Some(0), joint: Some(1), text: name() }];
    page.settings = vec![[name(), name()]];
    page.commands = vec![CommandLine { title: name(), line: name() }];
    page.notes = vec![name()];
    page.tables = vec![Table {
        title: name(),
        note: name(),
        is_folded: false,
        columns: vec![name()],
        rows: vec![vec![Cell { text: name(), frame: Some(1) }]],
    }];
    page.fits = vec![FitSteps { frame: 1, start: name(), ending: name(), steps: Vec::new() }];
    let html = to_html(&page);
    assert!(!html.contains("<img") && !html.contains("onerror=alert(1)>"), "an element was made of a name");
    // The data's script and the page's own; neither a name's nor one that a name ends.
    assert_eq!((html.matches("<script").count(), html.matches("</script").count()), (2, 2));
    assert!(html.contains("{{data}}"), "a name is not a place of the form");
    let data = data_of(&html);
    assert_eq!(data["title"], HOSTILE);
    assert_eq!(data["limbs"][0]["name"], HOSTILE);
    assert_eq!(data["bookmarks"][0]["text"], HOSTILE);
}

#[test]
fn nothing_is_loaded_from_elsewhere() {
    let html = to_html(&walk(2));
    for attribute in ["src=\"", "href=\"", "url(", "@import", "fetch(", "XMLHttpRequest", "import("] {
        for (at, _) in html.match_indices(attribute) {
            let rest = &html[at + attribute.len()..];
            assert!(attribute == "href=\"" && rest.starts_with('#'), "{attribute}{:.60}", rest);
        }
    }
    let policy = "content=\"default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'\"";
    assert!(html.contains(policy));
    // Only the name of a namespace looks like an address.
    let addresses: Vec<&str> =
        html.match_indices("http").map(|(at, _)| &html[at..(at + 30).min(html.len())]).collect();
    let is_known =
        |text: &&str| text.starts_with("http://www.w3.org/2000/svg") || text.starts_with("http-equiv");
    assert!(addresses.iter().all(is_known), "{addresses:?}");
}

#[test]
fn lists_and_tables_are_there_without_a_script() {
    let mut page = walk(12);
    for number in [4, 5, 6, 9] {
        page.frames[number].lost = Some("nobody".to_owned());
    }
    page.bookmarks =
        vec![Bookmark { frame: 7, camera: Some(1), joint: Some(0), text: "the knee".to_owned() }];
    page.tables = vec![Table {
        title: "Joint errors".to_owned(),
        note: String::new(),
        is_folded: true,
        columns: vec!["joint".to_owned(), "mean".to_owned()],
        rows: vec![vec!["root".into(), "12.5".into()], vec!["knee".into(), "–".into()]],
    }];
    let html = to_html(&page);
    for part in [
        "<h1>a walk</h1>",
        "12 frames (0 to 11) at 60 frames a second, 4 cameras",
        "<li><a href=\"#frame=4\">frame 4</a> to 6: nobody</li><li><a href=\"#frame=9\">frame 9</a>: nobody</li>",
        "<a href=\"#bookmark=0\">Frame 7, cam1, root</a> the knee",
        "<th scope=\"col\" class=\"number\">mean</th>",
        "<th scope=\"row\">root</th><td class=\"number\">12.5</td>",
    ] {
        assert!(html.contains(part), "{part}");
    }
    assert!(!html.contains("{{"), "a place of the form is left");
}
