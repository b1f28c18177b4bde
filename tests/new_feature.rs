//! A panel with a background job is added to a copy of the sources: it is a folder of its own and a few lines in at most four other
//! files, and it compiles.

#![expect(clippy::unwrap_used, reason = "a panic is a test's answer")]

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Command;

/// Most files outside the feature's own folder that may have to be edited.
const MOST_FILES: usize = 4;

/// The feature itself.
const FEATURE: &str = r#"//! How much of each camera's picture the subject covers.

use backlit_jobs::{TaskEvent, Task, once};
use backlit_tracking::silhouette::Label;
use backlit_ui::style::format;
use egui::Ui;

use crate::context::feature::Feature;
use crate::context::pane::Pane;
use crate::context::{Context, Requests, pane_title, priority};
use crate::session::FrameData;

/// The feature.
#[derive(Debug, Default)]
pub(crate) struct Coverage {
    shares: Vec<f64>,
    task: Task<usize, Vec<f64>, { priority::SURVEY }>,
}

impl Feature for Coverage {
    fn update(&mut self, context: &Context<'_>, requests: &mut Requests) {
        for news in self.task.poll() {
            match news {
                TaskEvent::Output(shares) => self.shares = shares,
                TaskEvent::Ended => {}
                TaskEvent::Failed(failure) => requests.failed("Counting pixels", &failure),
            }
        }
        if let Some(frame) = context.session.frames.get(context.selection.frame) {
            let frame = frame.clone();
            self.task.ask(context.pool, frame.frame, |_| once(move |_| shares(&frame)));
        }
    }

    fn fills(&self) -> Option<Pane> {
        Some(Pane::Coverage)
    }

    fn pane(&mut self, ui: &mut Ui, _: &Context<'_>, siblings: &[Pane], requests: &mut Requests) {
        pane_title::show(ui, Pane::Coverage, siblings, requests);
        for (camera, share) in self.shares.iter().enumerate() {
            ui.label(format!("Camera {}: {} %", camera + 1, format::number(100.0 * share, 1)));
        }
    }
}

fn shares(frame: &FrameData) -> Vec<f64> {
    let masks = frame.cameras.iter().filter_map(|camera| camera.mask.as_deref());
    let share = |mask: &backlit_tracking::silhouette::Mask| {
        mask.count(Label::Subject) as f64 / mask.labels().len().max(1) as f64
    };
    masks.map(share).collect()
}
"#;

/// Where the feature is made known: a file, a line that is in it once, and what comes after that line.
const WIRING: [(&str, &str, &str); 5] = [
    ("src/features.rs", "pub mod convergence;", "pub(crate) mod coverage;"),
    (
        "src/features.rs",
        "    pub convergence: convergence::Convergence,",
        "    pub(crate) coverage: coverage::Coverage,",
    ),
    (
        "src/context/pane.rs",
        "    /// The basin of the frame: success over angle, or a map.",
        "    Coverage,\n    /// The basin of the frame.",
    ),
    (
        "src/context/pane.rs",
        "        (Self::Scene, \"Scene\", PaneSide::Right, Some(Layout::Debug), \"Body, cameras and their pictures in three dimensions\"),",
        "        (Self::Coverage, \"Coverage\", PaneSide::Right, None, \"How much of each picture the subject covers\"),",
    ),
    (
        "src/context/command/table.rs",
        "    row(Menu::View, Window(WindowCommand::TogglePane(Pane::Convergence)), \"Show or hide convergence\", \"The plot of the runs, and their steps\", &[]),",
        "    row(Menu::View, Window(WindowCommand::TogglePane(Pane::Coverage)), \"Show or hide coverage\", \"How much of each picture the subject covers\", &[]),",
    ),
];

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        let target = to.join(path.file_name().unwrap());
        if path.is_dir() {
            copy(&path, &target);
        } else {
            fs::copy(&path, &target).unwrap();
        }
    }
}

#[test]
fn a_panel_with_a_job_touches_few_files() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let house = tempfile::tempdir().unwrap();
    copy(&root.join("src"), &house.path().join("src"));
    for folder in ["assets", "tests/takes"] {
        copy(&root.join(folder), &house.path().join(folder));
    }
    for name in ["Cargo.lock", "README.md", "clippy.toml"] {
        fs::copy(root.join(name), house.path().join(name)).unwrap();
    }
    // The crates stay where they are, and are not built again.
    let manifest = fs::read_to_string(root.join("Cargo.toml")).unwrap();
    let crates = format!("path = \"{}/crates/", root.display());
    let manifest = manifest.replace("path = \"crates/", &crates);
    let is_member = |line: &&str| !line.starts_with("members =") && !line.starts_with("default-members =");
    let manifest: Vec<&str> = manifest.lines().filter(is_member).collect();
    let manifest = manifest.join("\n").split("[[bench]]").next().unwrap().to_owned();
    let profiles = fs::read_to_string(root.join("Cargo.toml")).unwrap();
    let profiles = &profiles[profiles.find("[profile.release]").unwrap()..];
    fs::write(house.path().join("Cargo.toml"), format!("{manifest}\n{profiles}")).unwrap();

    fs::write(house.path().join("src/features/coverage.rs"), FEATURE).unwrap();
    for (file, after, added) in WIRING {
        let path = house.path().join(file);
        let text = fs::read_to_string(&path).unwrap();
        assert_eq!(text.lines().filter(|line| *line == after).count(), 1, "{file}: `{}` once", after.trim());
        let text = text
            .replace(&format!("{after}\n"), &format!("{after}\n{added}\n"))
            .replace("&'static str); 7] = [", "&'static str); 8] = [");
        fs::write(&path, text).unwrap();
    }
    let files: BTreeSet<&str> = WIRING.iter().map(|row| row.0).collect();
    assert!(files.len() <= MOST_FILES, "{files:?}");

    let target = std::env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| root.join("target").into());
    let check = Command::new(env!("CARGO"))
        .args(["check", "--lib", "--offline", "--quiet"])
        .current_dir(house.path())
        .env("CARGO_TARGET_DIR", target)
        .output()
        .unwrap();
    assert!(check.status.success(), "{}", String::from_utf8_lossy(&check.stderr));
}
