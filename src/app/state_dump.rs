//! What matters of the window, as a JSON file that is written again whenever it changes: for tests that drive
//! the window from outside, and for looking into a window that misbehaves. `docs/formats.md` describes it.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};

use backlit_document::run::Run;
use backlit_take::source::TakeSource;
use backlit_ui::drawing::{Comparison, joint_name};
use backlit_ui::widgets::accessible::{Named, named};
use egui::{Context, FullOutput};
use serde::Serialize;
use serde_json::{Value, json};

use super::App;
use crate::context::notices::{Notice, Severity};
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

/// The file's content.
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
    /// Whether a button is down.
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

impl App {
    /// Hands the state of this frame to who writes it, if anybody does.
    pub(crate) fn export_state(&self) {
        let Some(path) = &self.state_file else { return };
        let state = self.exported_state();
        let writer = self.inspector.state.egui.plugin_opt::<StateWriter>().unwrap_or_else(|| {
            self.inspector.state.egui.enable_accesskit();
            let path = path.clone();
            let writer =
                StateWriter { path, state: Value::Null, written: None, serial: 0, has_failed: false };
            self.inspector.state.egui.add_plugin(writer);
            // The widgets are named from the next frame on.
            self.inspector.state.egui.request_repaint();
            self.inspector.state.egui.plugin::<StateWriter>()
        });
        writer.lock().state = state;
    }

    /// What matters of the window.
    fn exported_state(&self) -> Value {
        let (session, selection, document) =
            (&self.inspector.state.session, &self.inspector.state.selection, self.document());
        let model = &document.model;
        let pose = self.shown_pose();
        let rotations: BTreeMap<&str, [f64; 4]> = model
            .rotation_owners()
            .iter()
            .zip(&pose.rotations)
            .map(|(&owner, q)| (model.limbs()[owner].name.as_str(), [q.w, q.x, q.y, q.z]))
            .collect();
        let step = selection.step.map(|step| {
            let run = self.runs().iter().position(|run| run.number == step.run);
            json!({"run": run, "step": step.step})
        });
        json!({
            "idle": self.is_idle(),
            "busy": self.busy_lanes(),
            "take": self.exported_take(),
            "project": self.inspector.state.project,
            "unsaved": self.inspector.state.history.is_dirty(),
            "recovery": self.inspector.features.recovery.offered().iter().map(|left| format!("{}, {}", left.take, left.work())).collect::<Vec<_>>(),
            "undo": self.inspector.state.history.undo_text(),
            "redo": self.inspector.state.history.redo_text(),
            "frame": selection.frame,
            "camera": selection.camera,
            "joint": joint_name(model, selection.joint),
            "limb": model.limbs()[selection.limb(model)].name,
            "held": self.context().drag.is_dragging(),
            "step": step,
            "pose": {"root": pose.root.to_array(), "rotations": rotations},
            "cost": session.predicted.as_ref().map(|predicted| predicted.mismatch),
            "rms": session.predicted.as_ref().and_then(|predicted| predicted.rms),
            "iou": session.iou(),
            "stale": session.is_stale,
            "renderer": document.fit.renderer.name(),
            "runs": self.runs().iter().map(run).collect::<Vec<_>>(),
            "cameras": self.exported_cameras(),
            "layout": self.inspector.state.preferences.layout,
            "theme": self.inspector.state.preferences.theme,
            "panel": self.inspector.state.preferences.panel,
            "lanes": self.inspector.features.timeline.shows_lanes,
            "alone": self.inspector.shell.docking.alone.map(|pane| pane.title()),
            "playing": self.is_playing(),
            "track": self.exported_track(),
            "notices": self.inspector.state.notices.cards().map(notice).collect::<Vec<_>>(),
            "messages": self.inspector.state.notices.all().len(),
            "tour": self.inspector.features.tour.step(&self.context()),
            "over": self.inspector.shell.overlay.as_ref().map(overlay_name),
        })
    }

    fn busy_lanes(&self) -> Vec<&'static str> {
        let lanes = [
            ("predict", self.inspector.refresh.is_predicting()),
            ("open", self.files.open.is_busy()),
            ("load", self.inspector.refresh.is_reading()),
            ("save", self.files.save.is_busy()),
            ("fit", self.inspector.features.fit.is_running()),
            ("survey", self.inspector.refresh.is_surveying()),
            ("track", self.inspector.features.tracking.is_busy()),
        ];
        lanes.into_iter().filter(|lane| lane.1).map(|lane| lane.0).collect()
    }

    fn exported_take(&self) -> Value {
        let Some(take) = &self.inspector.state.session.take else { return Value::Null };
        let source = match &take.source {
            Some(TakeSource::BuiltIn) => json!("built-in"),
            Some(TakeSource::Demonstration(which)) => json!({"demonstration": which.name()}),
            Some(TakeSource::Path(path)) => json!({"path": path}),
            None => Value::Null,
        };
        json!({
            "name": take.name,
            "source": source,
            "frames": self.inspector.state.session.frame_count(),
            "cameras": self.inspector.state.session.camera_count(),
            "loaded": self.inspector.state.session.frames.get(self.inspector.state.selection.frame).is_some(),
        })
    }

    fn exported_cameras(&self) -> Vec<Value> {
        let predicted = self.inspector.state.session.predicted.as_ref();
        let tiles = self.inspector.features.camera_views.tiles(self.inspector.state.preferences.layout);
        let camera = |(index, camera): (usize, &backlit_document::CameraUse)| {
            let overlap = predicted.and_then(|predicted| predicted.cameras.get(index)?.overlap);
            let tile = tiles.get(index);
            let compared = |way| tile.filter(|tile| tile.comparison == Some(way));
            json!({
                "name": camera.name,
                "used": camera.used,
                "weight": camera.weight,
                "mode": tile.map(|tile| tile.mode),
                "wipe": compared(Comparison::Wipe).map(|tile| json!({"other": tile.other, "at": tile.wipe_at})),
                "blink": compared(Comparison::Blink).map(|tile| json!({"other": tile.other})),
                "iou": overlap.and_then(|overlap| overlap.iou()),
            })
        };
        self.document().cameras.iter().enumerate().map(camera).collect()
    }

    fn exported_track(&self) -> Value {
        let document = self.document();
        let lost = document.estimates.iter().filter(|(_, found)| found.lost).map(|(frame, _)| *frame);
        let running = self.inspector.features.tracking.progress().map(
            |tracking| json!({"done": tracking.done, "total": tracking.total, "backwards": tracking.backwards}),
        );
        json!({
            "frames": document.estimates.len(),
            "first": document.estimates.keys().next(),
            "last": document.estimates.keys().next_back(),
            "lost": lost.collect::<Vec<_>>(),
            "keys": document.keys.keys().collect::<Vec<_>>(),
            "running": running,
        })
    }
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
        Overlay::Export => "export",
        Overlay::NewTake => "new take",
        Overlay::Offsets => "offsets",
        Overlay::UnsavedWork => "unsaved work",
    }
}
