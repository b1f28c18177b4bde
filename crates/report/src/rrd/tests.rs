use std::collections::BTreeMap;
use std::io::Cursor;

use re_sdk::external::re_log_encoding::DecoderApp;
use re_sdk::log::{Chunk, LogMsg};
use re_sdk_types::components::Position3D;

use super::*;
use crate::tests::{HOSTILE, walk};
use crate::{Bookmark, FitStep};

/// What a recording holds, read from its bytes. The layout is left out.
fn chunks(rrd: Vec<u8>) -> Vec<Chunk> {
    let messages = DecoderApp::decode_eager(Cursor::new(rrd)).unwrap();
    let chunks = messages.filter_map(|message| match message.unwrap() {
        LogMsg::ArrowMsg(store, arrow) if store.is_recording() => {
            Some(Chunk::from_arrow_msg(&arrow).unwrap())
        }
        _ => None,
    });
    chunks.collect()
}

/// By path and timeline: all times at which something is logged there, in their order.
fn times(chunks: &[Chunk]) -> BTreeMap<(String, String), Vec<i64>> {
    let mut all: BTreeMap<_, Vec<i64>> = BTreeMap::new();
    for chunk in chunks {
        let path = chunk.entity_path().to_string();
        chunk.timelines().iter().for_each(|(name, column)| {
            all.entry((path.clone(), name.to_string())).or_default().extend(column.times_raw());
        });
        if chunk.is_static() {
            all.entry((path, "static".to_owned())).or_default().push(0);
        }
    }
    all.values_mut().for_each(|times| times.sort_unstable());
    all
}

fn told_page() -> Page {
    let mut page = walk(12);
    page.cameras[0].name = HOSTILE.to_owned();
    page.curves[0].values[5].1 = None;
    page.curves[1].camera = Some(2);
    let picture = |frame: usize| Picture {
        camera: 1,
        frame,
        media_type: "image/png",
        size: [136, 240],
        bytes: vec![1, 2, 3],
        subject: "M1 0h2v1h-2z".to_owned(),
        unknown: String::new(),
    };
    page.pictures = vec![picture(3), picture(4)];
    let step = |at: usize| FitStep {
        joints: page.frames[at].joints.clone(),
        cost: at as f64,
        trial_cost: 0.0,
        stage: 0,
        is_accepted: true,
    };
    let steps = (0..3).map(step).collect();
    page.fits = vec![FitSteps { frame: 4, start: String::new(), ending: String::new(), steps }];
    page.bookmarks = vec![Bookmark { frame: 7, camera: None, joint: None, text: HOSTILE.to_owned() }];
    page
}

#[test]
fn a_recording_has_every_part_of_its_page_at_its_time() {
    let page = told_page();
    let chunks = chunks(to_rrd(&page).unwrap());
    let times = times(&chunks);
    let at = |path: &str, timeline: &str| times.get(&(path.to_owned(), timeline.to_owned())).cloned();
    let all: Vec<i64> = (0..12).collect();
    for path in ["/world/body/limbs", "/world/body/axes", "/world/body/joints"] {
        assert_eq!(at(path, "frame").as_ref(), Some(&all), "{path}");
        // 60 frames a second, in nanoseconds.
        assert!((at(path, "time").unwrap()[6] - 100_000_000).abs() <= 1);
    }
    for path in ["/world", "/about"] {
        assert!(at(path, "static").is_some(), "{path}");
    }
    for camera in &page.cameras {
        assert!(at(&camera_path(camera).to_string(), "static").is_some(), "{}", camera.name);
    }
    // A picture is shown in its frame: it goes at the first frame that has none.
    for name in ["picture", "subject"] {
        assert_eq!(at(&format!("/world/cameras/cam1/{name}"), "frame"), Some(vec![3, 4, 5]), "{name}");
    }
    assert_eq!(at("/world/cameras/cam1/picture/encoded", "frame"), Some(vec![3, 4]));
    assert_eq!(at("/world/cameras/cam1/picture/encoded", "steps of frame 4"), Some(vec![0]));
    assert_eq!(at("/world/fits/4/limbs", "steps of frame 4"), Some(vec![0, 1, 2]));
    assert_eq!(at("/costs/4", "steps of frame 4"), Some(vec![0, 1, 2]));
    assert_eq!(at("/bookmarks", "frame"), Some(vec![7]));
    assert_eq!(at("/trust", "frame"), Some(vec![9]));
    let curve = |index: usize| at(&curve_path(&page, &page.curves[index]).to_string(), "frame").unwrap();
    assert_eq!([curve(0).len(), curve(1).len()], [11, 12]);
    assert!(curve_path(&page, &page.curves[1]).to_string().contains("cam2"));
    assert!(times.keys().all(|(_, timeline)| !timeline.starts_with("log_")), "{times:?}");
}

#[test]
fn joints_are_where_the_page_has_them() {
    let page = told_page();
    let all = chunks(to_rrd(&page).unwrap());
    let mut frames = 0;
    for chunk in all.iter().filter(|chunk| chunk.entity_path().to_string() == "/world/body/joints") {
        let numbers: Vec<i64> = chunk.timelines()[&"frame".into()].times_raw().to_vec();
        let positions = chunk.iter_component::<Position3D>(Points3D::descriptor_positions().component);
        for (number, positions) in numbers.into_iter().zip(positions) {
            let joints = page.frames[number as usize].joints.iter().map(|joint| point(*joint));
            let written =
                positions.as_slice().iter().map(|position| [position.x(), position.y(), position.z()]);
            assert!(joints.eq(written), "frame {number}");
            frames += 1;
        }
    }
    assert_eq!(frames, 12);
}

/// Rerun's cameras look along z, x to the right and y down, as ours do.
#[test]
fn a_camera_stands_where_the_page_has_it() {
    for camera in &told_page().cameras {
        let (at, axes) = place_in_world(camera);
        assert!((camera.rotation * at + camera.translation).length() < 1e-12);
        for (axis, unit) in [(axes.x_axis, DVec3::X), (axes.y_axis, DVec3::Y), (axes.z_axis, DVec3::Z)] {
            assert!((camera.rotation * (at + axis) + camera.translation - unit).length() < 1e-12);
        }
    }
}

#[test]
fn the_axis_that_points_up_most_is_up() {
    let is = |up: [f64; 3], expected: ViewCoordinates| upright(DVec3::from(up)) == expected;
    assert!(is([0.1, -0.9, 0.2], ViewCoordinates::RIGHT_HAND_Y_DOWN()));
    assert!(is([0.0, 0.8, -0.2], ViewCoordinates::RIGHT_HAND_Y_UP()));
    assert!(is([0.0, 0.1, 1.0], ViewCoordinates::RIGHT_HAND_Z_UP()));
    assert!(is([-1.0, 0.1, 0.0], ViewCoordinates::RIGHT_HAND_X_DOWN()));
}

#[test]
fn names_cannot_format_the_text_about_the_track() {
    let mut page = told_page();
    page.notes = vec!["# a | b\n* c".to_owned()];
    page.settings = vec![["renderer".to_owned(), "a|b".to_owned()]];
    let text = about::markdown(&page);
    assert!(text.contains("\\# a \\| b \\* c"), "{text}");
    assert!(text.contains("| renderer | a\\|b |"), "{text}");
}
