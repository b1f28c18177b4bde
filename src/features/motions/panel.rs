//! The Motions pane: the plane of motions, and the probabilities of the frame on the screen.

pub(super) mod plane;
mod shares;

use backlit_recognition::Method;
use backlit_ui::style::theme;
use backlit_ui::style::theme::{size, space};
use backlit_ui::widgets::{choice, segmented};
use egui::{Align, Button, Layout as Direction, Rect, RichText, Ui, UiBuilder, vec2};

use super::job::{Missing, RecognisedMotions};
use super::preferences::Plane;
use super::{Motions, words};
use crate::context::command::{Command, TrackingCommand};
use crate::context::command_button as command;
use crate::context::pane::{HEADER_BUTTONS, Pane};
use crate::context::pane_title;
use crate::context::{Context, Requests};

/// A pane narrower than this has two rows above the plane.
const ONE_ROW: f32 = 500.0;
/// Width of the box of methods.
const METHODS: f32 = 110.0;
/// The plane is not made lower than this for the probabilities' sake.
const LEAST_PLANE: f32 = 110.0;

/// What is asked for in the pane, done when it is drawn.
enum MotionsAction {
    Plane(Plane),
    Method(Method),
    BuiltIn,
    ModelFile,
}

impl Motions {
    /// The pane, in all of the space that is left.
    pub(super) fn show(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        siblings: &[Pane],
        requests: &mut Requests,
    ) {
        let mut actions = Vec::new();
        pane_title::ground(ui, |ui| {
            self.head(ui, siblings, requests, &mut actions);
            match &self.found {
                Some(found) => self.shown(ui, found, context, requests),
                None => self.nothing(ui, context, requests, &mut actions),
            }
        });
        for wish in actions {
            match wish {
                MotionsAction::Plane(plane) => self.preferences.plane = plane,
                MotionsAction::Method(method) => self.preferences.method = method,
                MotionsAction::BuiltIn => self.model = None,
                MotionsAction::ModelFile => self.ask_for_model(context, requests),
            }
        }
    }

    /// The name and what can be chosen: in one row, or in two where the pane is a narrow column.
    fn head(
        &self,
        ui: &mut Ui,
        siblings: &[Pane],
        requests: &mut Requests,
        actions: &mut Vec<MotionsAction>,
    ) {
        let row = |ui: &mut Ui, add: &mut dyn FnMut(&mut Ui)| {
            let size = vec2(ui.available_width(), size::TILE_HEADER);
            ui.allocate_ui_with_layout(size, Direction::left_to_right(Align::Center), |ui| {
                ui.set_min_height(size::TILE_HEADER);
                add(ui);
            });
        };
        let is_narrow = ui.available_width() < ONE_ROW;
        row(ui, &mut |ui| {
            pane_title::show(ui, Pane::Motions, siblings, requests);
            ui.add_space(space::ROW);
            if !is_narrow {
                self.choices(ui, actions);
            }
            self.models(ui, actions);
            ui.add_space(HEADER_BUTTONS);
        });
        if is_narrow {
            ui.horizontal_wrapped(|ui| self.choices(ui, actions));
        }
    }

    fn choices(&self, ui: &mut Ui, actions: &mut Vec<MotionsAction>) {
        let mut shown = self.preferences.plane;
        let planes = [Plane::Apart, Plane::Principal].map(|plane| (plane, words::plane(plane).0));
        let tooltip = words::plane(shown).1;
        if segmented(ui, &mut shown, &planes).on_hover_text(tooltip).changed() {
            actions.push(MotionsAction::Plane(shown));
        }
        let is_there = |method: &Method| match &self.found {
            Some(found) => found.recognizer.methods().any(|other| other == *method),
            None => *method != Method::Nearest,
        };
        let methods =
            [Method::Combined, Method::Hmm, Method::Svm, Method::Nearest].into_iter().filter(is_there);
        let rows: Vec<_> = methods
            .map(|method| {
                let (text, tooltip) = words::method(method);
                (method, text, tooltip.to_owned())
            })
            .collect();
        let chosen = self.found.as_ref().map_or(self.preferences.method, |found| found.method);
        if let Some(method) = choice(ui, "Method", METHODS, words::method(chosen).0, &rows) {
            actions.push(MotionsAction::Method(method));
        }
    }

    fn models(&self, ui: &mut Ui, actions: &mut Vec<MotionsAction>) {
        let name = self.model.as_ref().and_then(|path| path.file_name()).map(|name| name.to_string_lossy());
        let menu = ui.menu_button("Model", |ui| {
            if ui.add_enabled(self.model.is_some(), Button::new("Built-in model")).clicked() {
                actions.push(MotionsAction::BuiltIn);
                ui.close();
            }
            if ui.add(Button::new("Open model…")).clicked() {
                actions.push(MotionsAction::ModelFile);
                ui.close();
            }
        });
        let name =
            name.as_deref().unwrap_or("the built-in one, learnt from 72 recordings of seven kinds of motion");
        menu.response.on_hover_text(format!(
            "What was learnt: {name}. `backlit recognise --train` makes one of recordings of yours"
        ));
    }

    /// The plane, and below it the probabilities.
    fn shown(&self, ui: &mut Ui, found: &RecognisedMotions, context: &Context<'_>, requests: &mut Requests) {
        let area = ui.available_rect_before_wrap().shrink2(vec2(0.0, space::ROW));
        let wanted = shares::height(found, area.width());
        let room = if area.height() >= LEAST_PLANE + wanted { wanted } else { shares::TITLE };
        let [above, below] =
            [area.top()..=area.bottom() - room - space::ROW, area.bottom() - room..=area.bottom()];
        let plane = Rect::from_x_y_ranges(area.x_range(), above);
        let is_stale = self.marks.is_stale;
        if let Some(frame) = plane::ui(ui, plane, found, self.preferences.plane, context, is_stale)
            && frame != context.selection.frame
        {
            requests.request(crate::context::SessionRequest::Frame(frame));
        }
        shares::ui(ui, Rect::from_x_y_ranges(area.x_range(), below), found, context.selection.frame);
        ui.advance_cursor_after_rect(area);
    }

    /// What is missing, and a button for it.
    fn nothing(
        &self,
        ui: &mut Ui,
        context: &Context<'_>,
        requests: &mut Requests,
        actions: &mut Vec<MotionsAction>,
    ) {
        let palette = theme::palette(ui);
        let area = ui.available_rect_before_wrap();
        let size = vec2(area.width().min(380.0), 150.0_f32.min(area.height()));
        let builder = UiBuilder::new()
            .max_rect(Rect::from_center_size(area.center(), size))
            .layout(Direction::top_down(Align::Center));
        ui.scope_builder(builder, |ui| {
            let text = match &self.missing {
                _ if context.session.take.is_none() => {
                    "Open a take first: its tracked motion gets names here.".to_owned()
                }
                _ if context.busy.tracking => {
                    "The tracker is at work. Names come when it has ended.".to_owned()
                }
                Some(missing) => words::missing(missing),
                None => "Naming the tracked motion…".to_owned(),
            };
            ui.label(RichText::new(text).color(palette.text3));
            ui.add_space(space::WIDGET);
            let is_idle = context.session.take.is_some() && !context.busy.tracking;
            match &self.missing {
                Some(Missing::Track | Missing::Short { .. }) if is_idle => {
                    command::button(ui, context, requests, Command::Tracking(TrackingCommand::Forward));
                }
                Some(Missing::Model(_)) if ui.add(Button::new("Built-in model")).clicked() => {
                    actions.push(MotionsAction::BuiltIn);
                }
                _ => {}
            }
        });
        ui.advance_cursor_after_rect(area);
    }
}
