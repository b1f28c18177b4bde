//! A window that is killed at any moment: what it was working on is offered at the next start, and files are whole.
//!
//! The test starts itself again as another process, which drives the real window without a display, and kills that.

#![cfg(unix)]
#![expect(clippy::unwrap_used, reason = "helpers of tests, where a panic is the answer")]

#[expect(dead_code, reason = "the take's files are all that is wanted here")]
#[path = "window/support/take.rs"]
mod take;

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use backlit::app::{App, AppOptions, Opening};
use backlit::features::recovery::Copies;
use backlit_document::Document;
use backlit_document::project::read_project;
use egui::{Event, Key, Modifiers, PointerButton, Pos2, pos2};
use egui_painter::Headless;

/// Names the folder in which the process that is going to be killed works.
const FOLDER: &str = "BACKLIT_TEST_KILLED_IN";
/// How often a window is killed.
const ROUNDS: u64 = 12;
/// So much work may be lost.
const MOST_LOST: Duration = Duration::from_secs(1);

/// What identifies a state of the work: everything that can be edited here.
fn digest(document: &Document) -> String {
    use std::hash::{DefaultHasher, Hash, Hasher};
    let mut hasher = DefaultHasher::new();
    format!("{:?} {:?} {:?}", document.keys, document.estimates, document.fit).hash(&mut hasher);
    format!("{:016x}", hasher.finish())
}

fn data(folder: &Path) -> PathBuf {
    folder.join("data")
}

fn options(folder: &Path) -> AppOptions {
    AppOptions {
        data_folder: Some(data(folder)),
        opening: Some(Opening::of(&folder.join("take"))),
        ..AppOptions::default()
    }
}

fn pointer(at: Pos2, pressed: bool) -> Event {
    Event::PointerButton { pos: at, button: PointerButton::Primary, pressed, modifiers: Modifiers::NONE }
}

fn pressed(key: Key, modifiers: Modifiers) -> Event {
    Event::Key { key, physical_key: None, pressed: true, repeat: false, modifiers }
}

/// Drags, tracks, undoes and saves until it is killed; writes down every state with its time.
#[test]
fn work_until_killed() {
    let Some(folder) = std::env::var_os(FOLDER).map(PathBuf::from) else { return };
    let mut window = Headless::new(1300.0, 800.0, 1.0);
    let mut app = App::new(window.ctx.clone(), options(&folder)).unwrap();
    let mut log = File::options().append(true).create(true).open(folder.join("log")).unwrap();
    let began = Instant::now();
    let mut last = digest(app.inspector.document());
    for turn in 0_u32.. {
        // Somewhere in the first view: a joint is grabbed now and then, else the view is clicked.
        let at =
            pos2(150.0 + f64::from(turn % 40) as f32 * 6.0, 150.0 + f64::from(turn * 7 % 31) as f32 * 6.0);
        let events = match turn % 12 {
            0 => vec![pressed(Key::K, Modifiers::NONE)],
            1 => vec![pressed(Key::X, Modifiers::NONE)],
            2 => vec![Event::PointerMoved(at), pointer(at, true)],
            3..=6 => vec![Event::PointerMoved(at)],
            7 => vec![pointer(at, false)],
            8 => vec![pressed(Key::Enter, Modifiers::COMMAND)],
            9 => vec![pressed(Key::ArrowRight, Modifiers::NONE)],
            10 => vec![pressed(Key::Backspace, Modifiers::SHIFT)],
            _ => vec![pressed(Key::Home, Modifiers::NONE)],
        };
        window.frames(1, events, |ui| app.frame(ui));
        let now = digest(app.inspector.document());
        if now != last {
            writeln!(log, "{} {now}", began.elapsed().as_millis()).unwrap();
            last = now;
        }
        if turn % 23 == 22 {
            app.save_to(&folder.join("work.backlit"));
        }
        if turn % 23 == 5 {
            // A longer drag goes on for a while without a file being touched.
            std::thread::sleep(Duration::from_millis(5));
        }
        writeln!(log, "{} -", began.elapsed().as_millis()).unwrap();
    }
}

/// The states of a log with the times at which they began, and the time of its last line.
fn states(folder: &Path) -> (Vec<(Duration, String)>, Duration) {
    let text = std::fs::read_to_string(folder.join("log")).unwrap_or_default();
    let lines: Vec<(Duration, &str)> = text
        .split_inclusive('\n')
        .filter(|line| line.ends_with('\n'))
        .filter_map(|line| {
            let (time, state) = line.trim_end().split_once(' ')?;
            Some((Duration::from_millis(time.parse().ok()?), state))
        })
        .collect();
    let end = lines.last().map_or(Duration::ZERO, |(time, _)| *time);
    (lines.into_iter().filter(|(_, s)| *s != "-").map(|(t, s)| (t, s.to_owned())).collect(), end)
}

#[test]
fn a_window_that_is_killed_loses_less_than_a_second_and_harms_no_file() {
    let mut restored = 0;
    for round in 0..ROUNDS {
        let folder = tempfile::tempdir().unwrap();
        take::write_to(&folder.path().join("take"));
        let mut child = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "work_until_killed", "--nocapture"])
            .env(FOLDER, folder.path())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let started = Instant::now();
        while states(folder.path()).0.is_empty() {
            assert!(started.elapsed() < Duration::from_secs(60), "nothing is being worked on");
            std::thread::sleep(Duration::from_millis(5));
        }
        // At some moment, another one every time.
        std::thread::sleep(Duration::from_millis(150 + round * 977 % 1400));
        child.kill().unwrap();
        child.wait().unwrap();
        restored += usize::from(check(folder.path(), round));
    }
    assert!(restored > 0, "no round had anything unsaved");
}

/// Whether something unsaved was offered; what is offered is new enough, and the project is one of the states.
fn check(folder: &Path, round: u64) -> bool {
    let (states, end) = states(folder);
    let is_state = |digest: &String| states.iter().any(|(_, state)| state == digest);
    let project = folder.join("work.backlit");
    if project.exists() {
        let saved = digest(&read_project(&project).unwrap().document);
        assert!(is_state(&saved) || states.is_empty(), "round {round}: the file is none of the states");
    }
    let (left, wrong) = Copies::new(data(folder)).left();
    assert!(wrong.is_empty(), "round {round}: {wrong:?}");
    let copies: Vec<String> =
        left.iter().map(|left| digest(&read_project(&left.path).unwrap().document)).collect();
    // The newest of what is in the file and what is offered.
    let known = copies
        .iter()
        .cloned()
        .chain(project.exists().then(|| digest(&read_project(&project).unwrap().document)));
    let until = known.filter_map(|known| {
        let last = states.iter().rposition(|(_, state)| *state == known)?;
        // It was lost when the next state took its place.
        Some(states.get(last + 1).map_or(end, |(time, _)| *time))
    });
    let kept = until.max().unwrap_or_else(|| states.first().map_or(end, |(time, _)| *time));
    let lost = end.saturating_sub(kept);
    assert!(lost <= MOST_LOST, "round {round}: {lost:?} of work is lost, of {end:?}");
    !copies.is_empty()
}
