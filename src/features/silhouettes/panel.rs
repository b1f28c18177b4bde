//! The Silhouettes pane: what the pointer draws, the steps of the silhouette on the screen, the worst of the take, and tuning.

use std::sync::Arc;

use backlit_runs::silhouettes::SilhouetteQuality;
use backlit_tracking::silhouette::Label;
use backlit_ui::style::theme::space;
use backlit_ui::style::{format, theme};
use backlit_ui::widgets::{SliderRow, camera_badge, choice, hint, named_row, text_button, work_progress};
use egui::{RichText, ScrollArea, Ui};

use super::{BrushScope, SilhouetteSteering, steps};
use crate::context::command::{Command, SilhouetteCommand};
use crate::context::command_button;
use crate::context::marks::SilhouetteTool;
use crate::context::pane::{HEADER_BUTTONS, Pane};
use crate::context::{Context, Requests, SessionRequest, ShellRequest, pane_title};

/// Width of a choice's name, and of the choice.
const NAME: f32 = 60.0;
const CHOICE: f32 = 120.0;

/// What the pointer does in a camera's view.
#[rustfmt::skip]
const TOOLS: [(Option<SilhouetteTool>, &str, &str); 5] = [
    (None, "Poses the body", "Joints and limbs are dragged, as ever"),
    (Some(SilhouetteTool::Region), "Region of interest", "Draws a rectangle: outside it is background, in every frame"),
    (Some(SilhouetteTool::Brush(Label::Subject)), "Paints subject", "Pixels of the silhouette that are subject"),
    (Some(SilhouetteTool::Brush(Label::Background)), "Paints background", "Pixels of the silhouette that are background"),
    (Some(SilhouetteTool::Brush(Label::Unknown)), "Paints unknown", "Pixels of the silhouette that weigh nothing"),
];

/// In which frames a stroke is painted.
#[rustfmt::skip]
const SCOPES: [(BrushScope, &str, &str); 3] = [
    (BrushScope::Frame, "This frame", "Only in the frame on the screen"),
    (BrushScope::Range, "Same place", "In all marked frames, or in the whole take if none are marked"),
    (BrushScope::Body, "With the body", "In marked frames, or all, that have a pose: moved with the limb that the stroke lies on"),
];

impl SilhouetteSteering {
    pub(super) fn show(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        siblings: &[Pane],
        requests: &mut Requests,
    ) {
        pane_title::row(ui, |ui| {
            pane_title::show(ui, Pane::Silhouettes, siblings, requests);
            ui.add_space(HEADER_BUTTONS);
        });
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            self.tools(ui, context, requests);
            self.steps(ui, context);
            self.worst(ui, context, requests);
            self.tuning(ui, context, requests);
        });
    }

    /// What the pointer draws in the camera views, and where.
    fn tools(&mut self, ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
        heading(ui, "By hand");
        named_row(ui, "Pointer", NAME, |ui| {
            let now = TOOLS.iter().find(|tool| tool.0 == self.tool).map_or("", |tool| tool.1);
            let rows = TOOLS.map(|(tool, name, what)| (tool, name, what.to_owned()));
            if let Some(tool) = choice(ui, "Pointer", CHOICE, now, &rows) {
                let command = tool.map_or(SilhouetteCommand::PutAway, SilhouetteCommand::Draw);
                requests.run(Command::Silhouettes(command));
            }
        });
        if let Some(SilhouetteTool::Brush(_)) = self.tool {
            named_row(ui, "Where", NAME, |ui| {
                let now = SCOPES.iter().find(|scope| scope.0 == self.scope).map_or("", |scope| scope.1);
                let rows = SCOPES.map(|(scope, name, what)| (scope, name, what.to_owned()));
                if let Some(scope) = choice(ui, "Where", CHOICE, now, &rows) {
                    self.scope = scope;
                }
            });
            let radius = SliderRow::new(
                "Radius",
                " px",
                1,
                0.5..=60.0,
                "The brush’s radius, in pixels of the picture",
            );
            radius.show(ui, &mut self.radius_px);
        }
        let says = match self.tool {
            None => "Nothing is drawn: the pointer poses the body.",
            Some(SilhouetteTool::Region) => {
                "Draw a rectangle in a camera’s view: outside it is background, in every frame."
            }
            Some(SilhouetteTool::Brush(_)) => {
                "Paint in a camera’s view. What is painted counts over all that is measured."
            }
        };
        hint_wrapped(ui, says);
        let camera = context.selection.camera;
        let has_region = context.document().measurement.get(camera).is_some_and(|own| own.region.is_some());
        if has_region || !context.document().brush.is_empty() {
            ui.horizontal_wrapped(|ui| {
                for command in [SilhouetteCommand::Erase, SilhouetteCommand::RemoveRegion] {
                    command_button::button(ui, context, requests, Command::Silhouettes(command));
                }
            });
        }
    }

    /// How the silhouette of the active camera's frame comes about.
    fn steps(&mut self, ui: &mut Ui, context: &Context<'_>) {
        let (camera, frame) = (context.selection.camera, context.selection.frame);
        ui.add_space(space::WIDGET);
        ui.horizontal(|ui| {
            ui.label(RichText::new("Step by step").color(theme::palette(ui).text2));
            camera_badge(ui, camera);
            hint(ui, format!("frame {}", format::count(frame as i64)));
        });
        let shown = self.shown.clone().filter(|shown| (shown.camera, shown.frame) == (camera, frame));
        match shown.as_deref().map(|shown| &shown.steps) {
            None => hint(ui, "…"),
            Some(Err(why)) => hint_wrapped(ui, format!("{why}.")),
            Some(Ok(found)) => {
                let key = shown.as_ref().map_or(0, |shown| Arc::as_ptr(shown) as u64);
                steps::show(ui, found, key, &mut self.enlarged);
            }
        }
    }

    fn worst(&mut self, ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
        heading(ui, "Worst silhouettes");
        self.work_button(ui, context, requests, SilhouetteCommand::FindWorst);
        let Some(found) = &self.worst else {
            return hint_wrapped(
                ui,
                "Those that other cameras, the frames around them or the body contradict.",
            );
        };
        if found.is_empty() {
            return hint_wrapped(ui, "Nothing speaks against any silhouette.");
        }
        for one in found.iter() {
            listed(ui, one, requests);
        }
    }

    fn tuning(&mut self, ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
        heading(ui, "Settings");
        self.work_button(ui, context, requests, SilhouetteCommand::Tune);
        let text = "Tries z-score, shadow test, hysteresis, chroma, opening and closing by how well cameras and the tracked body agree.";
        hint_wrapped(ui, self.tuned.clone().unwrap_or_else(|| text.to_owned()));
        ui.add_space(space::WIDGET);
    }

    /// The command, or how far what is going on has come.
    fn work_button(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        requests: &mut Requests,
        command: SilhouetteCommand,
    ) {
        match self.progress.filter(|_| self.is_working_on(command)) {
            Some((doing, done)) => {
                work_progress(ui, doing, done);
                if text_button(ui, "Stop").clicked() {
                    self.stop();
                }
            }
            None => {
                command_button::button(ui, context, requests, Command::Silhouettes(command));
            }
        }
    }
}

/// A hint in as many lines as it needs.
fn hint_wrapped(ui: &mut Ui, text: impl Into<String>) {
    let text = RichText::new(text).small().color(theme::palette(ui).text3);
    ui.add(egui::Label::new(text).wrap());
}

fn heading(ui: &mut Ui, text: &str) {
    ui.add_space(space::WIDGET);
    ui.label(RichText::new(text).color(theme::palette(ui).text2));
}

/// A silhouette of the list; a click goes to it.
fn listed(ui: &mut Ui, one: &SilhouetteQuality, requests: &mut Requests) {
    ui.horizontal(|ui| {
        camera_badge(ui, one.camera);
        let text = format!("Frame {}", format::count(one.frame as i64));
        if ui.link(text).on_hover_text("Go to this frame and camera").clicked() {
            requests.request(ShellRequest::Camera(one.camera));
            requests.request(SessionRequest::Frame(one.frame));
        }
        hint_wrapped(ui, one.reason());
    });
}
