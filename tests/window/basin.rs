//! The basin through the real window: tried in the background, the same as the core's, cancelled, its map clicked.

use std::path::Path;

use backlit::context::command::BasinView;
use backlit::context::preferences::Layout;
use backlit::features::basin::{Basin, BasinResults, BasinSettings, FileKind, MapDirection, Reference};
use backlit_runs::basin::{
    Angle, BasinOptions, BasinResult, ComparedFit, ComparedMethod, FitChoice, RandomStarts, Starts, Subject,
    Target,
};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::Preset;
use backlit_tracking::render::RendererKind;
use backlit_tracking::search::start::Level;
use backlit_ui::style::theme::Theme;
use egui::accesskit::Role;
use egui::{Key, Modifiers, Rect, pos2};
use egui_kittest::kittest::Queryable;

use crate::readable::{SIZES, assert_readable, look};
use crate::support::snapshots::{Snapshots, theme_name};
use crate::support::window::{
    Setup, Window, WindowState, arm, built_in, choose, click, freeze, press, settle, undo, wait_until,
};

/// A window whose panel shows the section alone.
fn open(setup: Setup) -> Window {
    let mut harness = setup.layout(Layout::Pose).open();
    for section in ["Pose", "Refit", "Basin"] {
        click(&mut harness, section);
    }
    harness
}

fn open_arm() -> Window {
    open(arm().sized(1500.0, 1000.0))
}

fn chosen(harness: &Window) -> BasinSettings {
    harness.settings().basin.settings
}

/// Changes what is chosen.
fn choose_by(harness: &mut Window, change: impl FnOnce(&mut BasinSettings)) {
    let mut settings = chosen(harness);
    change(&mut settings);
    harness.state_mut().inspector.features.basin.set(settings);
}

fn basin(harness: &Window) -> &Basin {
    &harness.state().inspector.features.basin
}

fn results(harness: &Window) -> &BasinResults {
    &basin(harness).results
}

/// What there is of the curves.
fn angles(harness: &Window) -> &BasinResult {
    results(harness).angles.as_ref().unwrap()
}

fn begin(harness: &Window) {
    harness.get_all_by_role_and_label(Role::Button, "Run starts").next().unwrap().click();
}

/// Writes a file of what is shown.
fn write(harness: &mut Window, kind: FileKind, path: &Path) {
    let app = harness.state_mut();
    app.inspector.ask(|features, context, requests| features.basin.write(kind, path, context, requests));
    settle(harness);
}

/// Types into a field of the section.
fn type_into(harness: &mut Window, label: &str, text: &str) {
    harness.get_by_role_and_label(Role::TextInput, label).focus();
    harness.step();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.step();
    harness.get_by_role_and_label(Role::TextInput, label).type_text(text);
    harness.run_steps(2);
    press(harness, Modifiers::NONE, Key::Enter);
}

fn set_starts(harness: &mut Window, angles: &str, root: &str) {
    type_into(harness, "Angles", angles);
    type_into(harness, "Moves of the root", root);
}

#[test]
fn the_window_finds_the_same_as_the_core_on_the_built_in_take() {
    let mut harness = open(built_in().sized(1500.0, 1000.0));
    set_starts(&mut harness, "5 40", "0 20");
    choose_by(&mut harness, |settings| (settings.starts, settings.seed) = (2, 7));
    let fit = (*harness.document().fit).clone();
    click(&mut harness, "Run starts");
    let found = angles(&harness).report.clone();
    harness.get_by_label("The basin is done: 4 fits.");

    let footage = harness.session().take.as_ref().unwrap();
    let take = backlit_formats::Footage::new(backlit_take::builtin::open().unwrap());
    let views = take.fit_views(&[0, 1, 2, 3], 0).unwrap();
    let subject = Subject { model: footage.take().model().clone(), views, reference: footage.start() };
    let level = |degrees, metres| Level { degrees, metres };
    let levels = vec![level(5, 0.0), level(40, 0.2)];
    let options = BasinOptions {
        choices: vec![FitChoice::downhill("Robust", fit)],
        starts: Starts::Random(RandomStarts { rotation: None, levels, starts: 2, seed: 7 }),
        target: Target::Fit,
        success_mm: 20.0,
    };
    let expected = BasinResult::new(0, String::new(), options, subject).run(&CancelToken::new(), |_| {});
    assert_eq!(found, expected.unwrap().report);
    assert!(found.choices[0].levels[0].rate.found == 2, "{found:?}");
}

#[test]
fn what_is_typed_wrong_is_said_and_nothing_runs() {
    let mut harness = open_arm();
    set_starts(&mut harness, "5 many", "0");
    harness.get_by_label_contains("“many” is not a number");
    click(&mut harness, "Run starts");
    assert!(results(&harness).angles.is_none() && results(&harness).running.is_none());
    assert!(basin(&harness).problem.as_ref().unwrap().to_string().contains("many"));
}

#[test]
fn steps_go_on_beside_a_basin_and_cancelling_keeps_what_is_done() {
    let mut harness = open_arm();
    set_starts(&mut harness, "5 10 20 30 45", "0");
    choose_by(&mut harness, |settings| settings.starts = 500);
    begin(&harness);
    let running = |harness: &Window| results(harness).running;
    wait_until(&mut harness, "ten fits", |window| running(window).is_some_and(|running| running.done >= 10));
    harness.get_by_role_and_label(Role::Button, "Step").click();
    let is_stepped = |window: &Window| {
        window.runs().first().is_some_and(|run| run.steps.len() >= 2 && run.ending.is_none())
    };
    wait_until(&mut harness, "the step", is_stepped);
    assert!(running(&harness).is_some(), "the basin goes on");
    harness.get_all_by_role_and_label(Role::Button, "Cancel basin").next().unwrap().click();
    settle(&mut harness);
    let tried: usize = angles(&harness).report.choices[0].levels.iter().map(|level| level.rate.tried).sum();
    assert!((10..2500).contains(&tried), "{tried}");
    harness.get_by_label_contains("The basin was stopped after");
}

#[test]
fn esc_stops_a_basin_and_what_it_leaves_is_called_a_part_everywhere() {
    let mut harness = open_arm();
    set_starts(&mut harness, "5 45", "0");
    choose_by(&mut harness, |settings| settings.starts = 500);
    begin(&harness);
    let running = |harness: &Window| results(harness).running;
    wait_until(&mut harness, "three fits", |window| running(window).is_some_and(|running| running.done >= 3));
    harness.get_by_label_contains("Running the basin: ");
    assert!(running(&harness).unwrap().seconds_left.is_some());
    assert!(harness.query_by_label_contains("Partial: ").is_none(), "more is to come");
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(running(&harness).is_none());
    let done = angles(&harness).fits().done;
    assert!((3..1000).contains(&done), "{done}");
    let partial = format!("Partial: {done} of 1\u{2009}000 fits");
    harness.get_by_label(&partial);

    let folder = tempfile::tempdir().unwrap();
    let path = |kind: FileKind| folder.path().join(format!("part.{}", kind.extension()));
    for kind in FileKind::ALL {
        write(&mut harness, kind, &path(kind));
    }
    let numbers: serde_json::Value =
        serde_json::from_slice(&std::fs::read(path(FileKind::Json)).unwrap()).unwrap();
    assert_eq!(
        (numbers["partial"].as_bool(), numbers["fits"]["done"].as_u64()),
        (Some(true), Some(done as u64))
    );
    let table = std::fs::read_to_string(path(FileKind::Csv)).unwrap();
    assert_eq!(table.lines().count(), 1001);
    assert_eq!(table.lines().filter(|line| line.ends_with(",,")).count(), 1000 - done);
    let result = angles(&harness);
    let figure = result.figure(result.random().unwrap());
    assert!(figure.subtitle.starts_with(&partial), "{}", figure.subtitle);
}

#[test]
fn what_is_chosen_is_there_at_the_next_start() {
    let mut harness = open_arm();
    set_starts(&mut harness, "7 21", "3");
    click(&mut harness, "Compare with…");
    let mut settings = chosen(&harness);
    settings.directions[1].joint = Some("right forearm".to_owned());
    (settings.starts, settings.seed, settings.cells, settings.only_held) = (33, 9, 7, true);
    harness.state_mut().inspector.features.basin.set(settings.clone());
    harness.step();
    let kept = serde_json::to_string(&harness.settings()).unwrap();
    drop(harness);

    let harness = open(arm().sized(1500.0, 1000.0).settings(serde_json::from_str(&kept).unwrap()));
    assert_eq!(chosen(&harness), settings);
    assert_eq!(harness.get_by_role_and_label(Role::TextInput, "Angles").value().as_deref(), Some("7 21"));
    harness.get_by_role_and_label(Role::ComboBox, "Compared fit 1");
}

/// The window's map and the command line's, of the same take, about its truth.
#[test]
fn the_windows_map_is_the_commands() {
    let mut harness = open(built_in().sized(1500.0, 1000.0));
    let mut settings = chosen(&harness);
    let report =
        ComparedFit { method: ComparedMethod::Preset(Preset::Report), renderer: RendererKind::Cylinder };
    settings.compared = vec![report];
    settings.reference = Reference::Truth;
    (settings.cells, settings.map_degrees) = (2, 30.0);
    let direction = |joint: &str, angle| MapDirection { joint: Some(joint.to_owned()), angle };
    settings.directions =
        [direction("right forearm", Angle::Flexion), direction("right upper arm", Angle::Sideways)];
    harness.state_mut().inspector.features.basin.set(settings);
    click(&mut harness, "Run map");
    let map = results(&harness).map.clone().unwrap();
    assert!(map.fits().is_whole());

    let folder = tempfile::tempdir().unwrap();
    let words = [
        "experiment",
        "basin",
        "--take",
        concat!(env!("CARGO_MANIFEST_DIR"), "/assets/take"),
        "--downhill",
        "--map",
        "right forearm.flexion,right upper arm.sideways",
        "--farthest",
        "30",
        "--cells",
        "2",
        "--compare",
        "report:cylinder",
        "--json",
        "--out",
    ];
    let said = std::process::Command::new(env!("CARGO_BIN_EXE_backlit"))
        .args(words)
        // As the window of the tests does.
        .env("BACKLIT_VECTORS", "256")
        .arg(folder.path())
        .output()
        .unwrap();
    assert!(said.status.success(), "{}", String::from_utf8_lossy(&said.stderr));
    let numbers: serde_json::Value = serde_json::from_slice(&said.stdout).unwrap();
    let own: serde_json::Value = serde_json::from_slice(&map.json().unwrap()).unwrap();
    for part in ["format", "experiment", "partial", "fits", "options", "report"] {
        assert_eq!(numbers[part], own[part], "{part}");
    }
    let read = |ending: &str| std::fs::read(folder.path().join(format!("basin-map.{ending}"))).unwrap();
    assert_eq!(read("json"), said.stdout);
    assert_eq!(read("csv"), map.csv().unwrap());
    assert!(image::load_from_memory(&read("png")).unwrap().width() > 600);
}

/// Runs a small map about the take's start.
fn run_map(harness: &mut Window) {
    choose_by(harness, |settings| settings.cells = 7);
    click(harness, "Run map");
}

#[test]
fn a_click_on_a_cell_takes_its_start_and_undo_brings_the_pose_back() {
    let mut harness = open_arm();
    choose_by(&mut harness, |settings| {
        settings
            .directions
            .iter_mut()
            .for_each(|direction| direction.joint = Some("right forearm".to_owned()));
    });
    run_map(&mut harness);
    let map = results(&harness).map.clone().unwrap();
    let grid = map.grid().unwrap();
    assert_eq!(map.directions(grid)[0], "right forearm, flexion");
    assert_eq!(map.fits().done, 49);
    assert_eq!(map.trial(0, [3, 3]).unwrap().error_mm, 0.0);
    let before = harness.document().pose_at(0).clone();
    let cell = harness.get_by_label_contains("Start 20°, 40°: from");
    cell.click();
    settle(&mut harness);
    let taken = harness.document().pose_at(0).clone();
    assert_eq!(taken, grid.pose(&map.subject, [4, 5]).normalized());
    undo(&mut harness);
    assert_eq!(*harness.document().pose_at(0), before);
}

#[test]
fn results_are_written_as_tables_pictures_and_numbers() {
    let mut harness = open_arm();
    set_starts(&mut harness, "10", "2");
    click(&mut harness, "Run starts");
    let folder = tempfile::tempdir().unwrap();
    run_map(&mut harness);
    for (view, rows) in [("Angles", 21), ("Map", 50)] {
        choose(&mut harness, Role::RadioButton, view);
        for kind in FileKind::ALL {
            let path = folder.path().join(format!("{view}.{}", kind.extension()));
            write(&mut harness, kind, &path);
            assert!(path.is_file(), "{}", path.display());
        }
        let table = std::fs::read_to_string(folder.path().join(format!("{view}.csv"))).unwrap();
        assert_eq!(table.lines().count(), rows);
        let numbers = std::fs::read_to_string(folder.path().join(format!("{view}.json"))).unwrap();
        assert!(numbers.starts_with("{\n  \"format\": \"backlit-experiment 1\""), "{numbers:.80}");
        assert!(image::open(folder.path().join(format!("{view}.png"))).unwrap().width() > 400);
    }
    assert_eq!(harness.settings().basin.view, BasinView::Map);
}

/// The pane alone.
fn pane(snapshots: &mut Snapshots, harness: &mut Window, name: &str) {
    harness.state_mut().inspector.state.notices.close_all();
    freeze(harness);
    let header = harness.get_by_label("Basin header").rect();
    let lower = harness.get_by_label_contains("Play").rect().top();
    let rect = Rect::from_min_max(header.min, pos2(header.right(), lower - 12.0));
    snapshots.part(harness, rect, name);
}

#[test]
fn the_pane_as_a_plot_and_as_a_map() {
    let mut snapshots = Snapshots::default();
    for theme in Theme::ALL {
        let mut harness = open(arm().sized(1180.0, 900.0).theme(theme));
        set_starts(&mut harness, "10 30 60 90", "2 5 10 20");
        click(&mut harness, "Compare with…");
        click(&mut harness, "Run starts");
        pane(&mut snapshots, &mut harness, &format!("basin_angles_{}", theme_name(theme)));
        run_map(&mut harness);
        pane(&mut snapshots, &mut harness, &format!("basin_map_{}", theme_name(theme)));
    }
}

#[test]
fn every_word_of_the_results_can_be_read() {
    let mut wrong = Vec::new();
    for size in SIZES {
        let mut harness = open(arm().sized(size.x, size.y));
        choose_by(&mut harness, |settings| {
            let compared = |(method, renderer)| ComparedFit { method, renderer };
            let spheres = RendererKind::SphereTree { spheres: Some(64) };
            let renderers = [RendererKind::Cylinder, spheres, RendererKind::Capsule];
            settings.compared = ComparedMethod::ALL.into_iter().zip(renderers).map(compared).collect();
            settings.starts = 1;
        });
        set_starts(&mut harness, "10 30 60 90", "2 5 10 20");
        click(&mut harness, "Run starts");
        choose_by(&mut harness, |settings| settings.cells = 3);
        click(&mut harness, "Run map");
        for view in ["Angles", "Map"] {
            choose(&mut harness, Role::RadioButton, view);
            harness.state_mut().inspector.state.notices.close_all();
            harness.run_steps(2);
            let place = format!("{view} at {} × {}", size.x.round(), size.y.round());
            look(&harness, &place, &mut wrong);
        }
    }
    assert_readable(&wrong);
}

#[test]
fn the_section_does_not_widen_the_panel() {
    for width in [1100.0, 1600.0] {
        let mut harness = built_in().layout(Layout::Pose).sized(width, 900.0).open();
        let left =
            |harness: &Window| harness.get_by_role_and_label(Role::Button, "Camera subsets").rect().left();
        for section in ["Pose", "Refit"] {
            click(&mut harness, section);
        }
        let before = left(&harness);
        click(&mut harness, "Basin");
        for _ in 0..2 {
            click(&mut harness, "Compare with…");
        }
        choose_by(&mut harness, |settings| settings.directions[0].joint = Some("right upper arm".to_owned()));
        settle(&mut harness);
        assert_eq!(left(&harness), before, "{width}");
    }
}
