//! What matters of the window, as a JSON file that is written again whenever it changes: for tests that drive
//! the window from outside, and for looking into a window that misbehaves. `docs/formats.md` has an example.
//!
//! | `state` | meaning |
//! |---|---|
//! | `idle`, `busy` | whether the screen is whole; work under way, of `predict`, `open`, `load`, `save`, `fit`, `survey`, `track` |
//! | `take`, `project`, `unsaved`, `recovery` | the take, `loaded` with the frame's pictures; the project's file; unsaved work; copies that are offered |
//! | `undo`, `redo` | what they would do, or `null` |
//! | `frame`, `camera`, `joint`, `limb`, `held` | what is selected; whether the hand drags |
//! | `pose`, `cost`, `rms`, `iou`, `stale` | the pose on the screen; `stale` while figures are of an earlier one |
//! | `renderer`, `runs`, `step` | runs: `name`, `detail`, `frame`, `steps`, `rejected`, `cost`, `ending`, `shown`; `step` is `{"run", "step"}` while an earlier one is shown |
//! | `cameras` | `name`, `used`, `weight`, view `mode`, `wipe`, `blink`, `iou` |
//! | `layout`, `theme`, `panel`, `lanes`, `alone`, `playing` | the arrangement |
//! | `track` | `frames`, `first`, `last`, `lost`, `keys`, and what is `running`: `done`, `total`, `backwards` |
//! | `notices`, `messages`, `over` | cards, number of messages, what lies over the window |
//! | `tour` | step of the tour, 0 while it is offered, else `null` |

use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};

use backlit_document::run::Run;
use backlit_document::{CameraUse, Document};
use backlit_formats::Footage;
use backlit_take::source::TakeSource;
use backlit_ui::drawing::{ModeComparison, joint_name};
use backlit_ui::widgets::accessible::{Named, named};
use egui::{Context, FullOutput};
use serde::Serialize;
use serde_json::{Value, json};

use super::App;
use crate::context::FeatureCard;
use crate::context::activity::TrackingProgress;
use crate::context::notices::{Notice, Severity};
use crate::features::camera_views::TileView;
use crate::session::Session;
use crate::session::selection::Selection;
use crate::shell::Overlay;

/// Name and version of the file's format.
const FORMAT: &str = "backlit-state 1";

/// Writes the state after each frame in which it changed.
#[derive(Debug)]
struct StateWriter {
    path: PathBuf,
    /// What the app says of itself.
    state: Value,
    /// What was written last, without its serial number.
    written: Option<Exported>,
    serial: u64,
    has_failed: bool,
}

#[derive(Debug, Serialize, PartialEq)]
struct Exported {
    pixels_per_point: f32,
    pointer: Pointer,
    state: Value,
    widgets: Vec<Widget>,
}

/// What the window knows of the pointer: who drives it from outside waits until it has seen a move or a press.
#[derive(Debug, Serialize, PartialEq)]
struct Pointer {
    /// Points of the window; nothing where the pointer is outside.
    at: Option<[f32; 2]>,
    is_down: bool,
}

/// A widget that has a name.
#[derive(Debug, Serialize, PartialEq)]
struct Widget {
    name: String,
    role: String,
    /// Left, top, width, height in points of the window.
    rect: [f64; 4],
    #[serde(skip_serializing_if = "Option::is_none")]
    value: Option<Value>,
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    disabled: bool,
}

impl From<Named> for Widget {
    fn from(named: Named) -> Self {
        let (corner, size) = (named.rect.min, named.rect.size());
        let rect = [corner.x, corner.y, size.x, size.y].map(|x| (f64::from(x) * 10.0).round() / 10.0);
        let role = format!("{:?}", named.role);
        Self { name: named.name, role, rect, value: named.value, disabled: named.is_disabled }
    }
}

impl egui::Plugin for StateWriter {
    fn debug_name(&self) -> &'static str {
        "exported state"
    }

    fn output_hook(&mut self, ctx: &Context, output: &mut FullOutput) {
        let Some(update) = &output.platform_output.accesskit_update else { return };
        let exported = Exported {
            pixels_per_point: output.pixels_per_point,
            pointer: ctx.input(|input| Pointer {
                at: input.pointer.latest_pos().map(|at| [at.x, at.y]),
                is_down: input.pointer.any_down(),
            }),
            state: self.state.clone(),
            widgets: named(update).into_iter().map(Widget::from).collect(),
        };
        if self.written.as_ref() != Some(&exported) {
            self.serial += 1;
            let result = write(&self.path, self.serial, &exported);
            if let (Err(error), false) = (&result, self.has_failed) {
                tracing::error!("{}: the state was not written: {error}", self.path.display());
            }
            self.has_failed = result.is_err();
            self.written = Some(exported);
        }
    }
}

/// Whole or not at all, and without waiting for the disk: who reads it reads it now.
fn write(path: &Path, serial: u64, exported: &Exported) -> std::io::Result<()> {
    let mut content = serde_json::to_value(exported)?;
    if let Some(fields) = content.as_object_mut() {
        fields.insert("format".to_owned(), json!(FORMAT));
        fields.insert("serial".to_owned(), json!(serial));
    }
    let mut part = path.as_os_str().to_owned();
    part.push(".part");
    let mut file = std::fs::File::create(&part)?;
    file.write_all(&serde_json::to_vec_pretty(&content)?)?;
    drop(file);
    std::fs::rename(&part, path)
}

/// Hands the state of this frame to the plugin that writes it.
pub(crate) fn export(app: &App, path: &Path) {
    let egui = &app.inspector.state.egui;
    let writer = egui.plugin_opt::<StateWriter>().unwrap_or_else(|| {
        egui.enable_accesskit();
        let path = path.to_owned();
        egui.add_plugin(StateWriter {
            path,
            state: Value::Null,
            written: None,
            serial: 0,
            has_failed: false,
        });
        // The widgets are named from the next frame on.
        egui.request_repaint();
        egui.plugin::<StateWriter>()
    });
    writer.lock().state = exported_state(app);
}

fn exported_state(app: &App) -> Value {
    let inspector = &app.inspector;
    let (state, features, shell) = (&inspector.state, &inspector.features, &inspector.shell);
    let (session, selection, preferences) = (&state.session, &state.selection, &state.preferences);
    let (context, document, pose) = (inspector.context(), inspector.document(), inspector.shown_pose());
    let model = &document.model;
    let rotations: BTreeMap<&str, [f64; 4]> = model
        .rotation_owners()
        .iter()
        .zip(&pose.rotations)
        .map(|(&owner, q)| (model.limbs()[owner].name.as_str(), [q.w, q.x, q.y, q.z]))
        .collect();
    let step = selection.step.map(|step| {
        let run = inspector.runs().iter().position(|run| run.number == step.run);
        json!({"run": run, "step": step.step})
    });
    let predicted = session.predicted.as_ref();
    let lanes = [
        ("predict", inspector.refresh.prediction.is_busy()),
        ("open", app.files.open.is_busy()),
        ("load", inspector.refresh.frame.is_busy()),
        ("save", app.files.save.is_busy()),
        ("fit", features.fit.is_running()),
        ("survey", inspector.refresh.survey.is_busy()),
        ("track", features.tracking.is_busy()),
    ];
    let busy: Vec<&str> = lanes.into_iter().filter(|lane| lane.1).map(|lane| lane.0).collect();
    let left = features.recovery.offered.iter();
    json!({
        "idle": inspector.is_idle(),
        "busy": busy,
        "take": session.take.as_ref().map(|take| exported_take(take, session, selection)),
        "project": state.project,
        "unsaved": state.history.is_dirty(),
        "recovery": left.map(|left| format!("{}, {}", left.take, left.work())).collect::<Vec<_>>(),
        "undo": state.history.undo_text(),
        "redo": state.history.redo_text(),
        "frame": selection.frame,
        "camera": selection.camera,
        "joint": joint_name(model, selection.joint),
        "limb": model.limbs()[selection.limb(model)].name,
        "held": context.drag.is_dragging(),
        "step": step,
        "pose": {"root": pose.root.to_array(), "rotations": rotations},
        "cost": predicted.map(|predicted| predicted.mismatch),
        "rms": predicted.and_then(|predicted| predicted.rms),
        "iou": session.iou(),
        "stale": session.is_stale,
        "renderer": document.fit.renderer.name(),
        "runs": inspector.runs().iter().map(run).collect::<Vec<_>>(),
        "cameras": exported_cameras(document, session, features.camera_views.tiles(preferences.layout)),
        "layout": preferences.layout,
        "theme": preferences.theme,
        "panel": preferences.panel,
        "lanes": features.timeline.shows_lanes,
        "alone": shell.docking.alone.map(|pane| pane.title()),
        "playing": state.playback.is_playing(),
        "track": exported_track(document, features.tracking.progress()),
        "notices": state.notices.cards().map(notice).collect::<Vec<_>>(),
        "messages": state.notices.all().len(),
        "tour": features.tour.step(&context),
        "over": shell.overlay.as_ref().map(overlay_name),
    })
}

fn exported_take(take: &Footage, session: &Session, selection: &Selection) -> Value {
    let source = match &session.source {
        Some(TakeSource::BuiltIn) => json!("built-in"),
        Some(TakeSource::Demonstration(which)) => json!({"demonstration": which.name()}),
        Some(TakeSource::Path(path)) => json!({"path": path}),
        None => Value::Null,
    };
    json!({
        "name": take.take().name(),
        "source": source,
        "frames": session.frame_count(),
        "cameras": session.camera_count(),
        "loaded": session.frames.get(selection.frame).is_some(),
    })
}

fn exported_cameras(document: &Document, session: &Session, tiles: &[TileView]) -> Vec<Value> {
    let camera = |(index, camera): (usize, &CameraUse)| {
        let overlap = session.predicted.as_ref().and_then(|predicted| predicted.cameras.get(index)?.overlap);
        let tile = tiles.get(index);
        let compared = |by| tile.filter(|tile| tile.comparison == Some(by));
        json!({
            "name": camera.name,
            "used": camera.used,
            "weight": camera.weight,
            "mode": tile.map(|tile| tile.mode),
            "wipe": compared(ModeComparison::Wipe).map(|tile| json!({"other": tile.other, "at": tile.wipe_at})),
            "blink": compared(ModeComparison::Blink).map(|tile| json!({"other": tile.other})),
            "iou": overlap.and_then(|overlap| overlap.iou()),
        })
    };
    document.cameras.iter().enumerate().map(camera).collect()
}

fn exported_track(document: &Document, progress: Option<TrackingProgress>) -> Value {
    let estimates = &document.estimates;
    let lost = estimates.iter().filter(|(_, estimate)| estimate.lost).map(|(frame, _)| *frame);
    let running = progress.map(
        |progress| json!({"done": progress.done, "total": progress.total, "backwards": progress.backwards}),
    );
    json!({
        "frames": estimates.len(),
        "first": estimates.keys().next(),
        "last": estimates.keys().next_back(),
        "lost": lost.collect::<Vec<_>>(),
        "keys": document.keys.keys().collect::<Vec<_>>(),
        "running": running,
    })
}

fn run(run: &Run) -> Value {
    json!({
        "name": run.name,
        "detail": run.detail,
        "frame": run.frame,
        "steps": run.steps.len().saturating_sub(1),
        "rejected": run.steps.iter().filter(|step| !step.iteration.accepted).count(),
        "cost": run.steps.last().map(|step| step.mismatch),
        "ending": run.ending.as_ref().map(|_| run.ending_text()),
        "shown": run.is_shown,
    })
}

fn notice(notice: &Notice) -> Value {
    json!({
        "text": notice.text,
        "error": notice.severity == Severity::Error,
        "action": notice.command.map(|command| command.text()),
    })
}

fn overlay_name(overlay: &Overlay) -> &'static str {
    match overlay {
        Overlay::Palette(_) => "palette",
        Overlay::Shortcuts(_) => "keys",
        Overlay::Messages => "messages",
        Overlay::About => "about",
        Overlay::Card(FeatureCard::CameraCheck) => "camera check",
        Overlay::Card(FeatureCard::CameraPlan) => "camera plan",
        Overlay::Card(FeatureCard::CameraRefinement) => "camera refinement",
        Overlay::Card(FeatureCard::Export) => "export",
        Overlay::Card(FeatureCard::NewTake) => "new take",
        Overlay::Card(FeatureCard::Bookmarks) => "bookmarks",
        Overlay::Card(FeatureCard::Offsets) => "offsets",
        Overlay::Card(FeatureCard::UnsavedWork) => "unsaved work",
    }
}
