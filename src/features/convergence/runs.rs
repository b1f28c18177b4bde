//! The list of runs beside the convergence plot: named by what differs, shown or hidden, renamed, removed.

use backlit_document::run::Run;
use backlit_document::runs::{RunChange, StepRef};
use backlit_ui::style::theme::{run_style, size};
use backlit_ui::style::{format, theme};
use backlit_ui::widgets::{Icon, hint, icon_button, paint_run_sample};
use egui::{
    Align, Key, Layout as Direction, Rect, Response, RichText, Role, ScrollArea, Sense, Stroke, TextEdit, Ui,
    WidgetInfo, vec2,
};

use super::Convergence;
use super::remove;
use crate::context::{Context, Requests, SessionRequest};

const CARD: f32 = 64.0;
/// Width of the sample of a run's line.
const SAMPLE: f32 = 20.0;
/// Room of the figure and the buttons at the right of a card.
const RIGHT: f32 = 62.0 + 3.0 * (size::BUTTON + 2.0);

impl Convergence {
    pub(super) fn list(&mut self, ui: &mut Ui, context: &Context<'_>, requests: &mut Requests, height: f32) {
        ScrollArea::vertical().max_height(height).auto_shrink(false).show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 2.0;
            for run in context.runs().all().iter().rev() {
                self.card(ui, context, requests, run);
            }
            if context.runs().all().is_empty() {
                hint(ui, "Runs are kept here, each with all its steps.");
            }
        });
    }

    fn card(&mut self, ui: &mut Ui, context: &Context<'_>, requests: &mut Requests, run: &Run) {
        let is_current = context.run().is_some_and(|current| current.number == run.number);
        let palette = theme::palette(ui);
        let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), CARD), Sense::click());
        let name = format!("Run {}: {}", run.number, run.name);
        response.widget_info(|| WidgetInfo::selected(Role::ListItem, true, is_current, &name));
        if response.clicked() {
            requests.request(SessionRequest::Step(StepRef { run: run.number, step: run.last_step() }));
        }
        if response.has_focus() && ui.input_mut(|input| input.consume_key(egui::Modifiers::NONE, Key::Delete))
        {
            remove(run, context, requests);
        }
        if is_current {
            ui.painter().rect_filled(rect, 3.0, palette.select);
        } else if response.hovered() || response.has_focus() {
            ui.painter().rect_filled(rect, 3.0, palette.raised);
        }
        sample(ui, rect, run);
        let inner = Rect::from_min_max(rect.min + vec2(SAMPLE + 16.0, 4.0), rect.max - vec2(4.0, 4.0));
        let mut inside =
            ui.new_child(egui::UiBuilder::new().max_rect(inner).layout(Direction::top_down(Align::Min)));
        inside.spacing_mut().item_spacing.y = 1.0;
        inside.horizontal(|ui| {
            ui.set_height(size::ROW);
            ui.spacing_mut().item_spacing.x = 2.0;
            self.title(ui, requests, run, &response);
            ui.with_layout(Direction::right_to_left(Align::Center), |ui| {
                self.buttons(ui, context, requests, run);
                let share = run.fraction_among(context.runs().all(), run.last_step());
                let text = share.map_or_else(|| format::MISSING.to_owned(), format::percent);
                ui.label(RichText::new(text).monospace().color(palette.text));
            });
        });
        let detail = format!("{}, frame {}", run.detail, run.frame);
        let full =
            format!("{name}\n{detail}\n{}: {}", run.reached_text(context.runs().all()), run.ending_text());
        for text in [detail, run.ending_text()] {
            line(&mut inside, &text);
        }
        response.on_hover_text(full);
    }

    fn buttons(&mut self, ui: &mut Ui, context: &Context<'_>, requests: &mut Requests, run: &Run) {
        let number = run.number;
        let button = |ui: &mut Ui, icon, what: &str, tooltip: &str| {
            icon_button(ui, icon, &format!("{what} run {number}"), tooltip).clicked()
        };
        if button(ui, Icon::Close, "Remove", "Remove the run; a notice offers to undo it") {
            remove(run, context, requests);
        }
        let (icon, what, tooltip) = if run.is_shown {
            (Icon::Eye, "Hide curve of", "Hide the curve. With Shift: hide all others")
        } else {
            (Icon::EyeOff, "Show curve of", "Show the curve. With Shift: hide all others")
        };
        if button(ui, icon, what, tooltip) {
            let is_alone = ui.input(|input| input.modifiers.shift);
            let alone = RunChange::ShowOnly(number);
            let change = if is_alone { alone } else { RunChange::Show(number, !run.is_shown) };
            requests.request(SessionRequest::Runs(change));
        }
        if button(ui, Icon::Pencil, "Rename", "Rename; an empty name says again what differs") {
            self.typing = Some((number, run.name.clone()));
        }
    }

    /// The name, or the field in which it is typed; a double click on the card begins that too.
    fn title(&mut self, ui: &mut Ui, requests: &mut Requests, run: &Run, card: &Response) {
        let palette = theme::palette(ui);
        let width = (ui.available_width() - RIGHT).max(60.0);
        let Some((_, text)) = self.typing.as_mut().filter(|(number, _)| *number == run.number) else {
            let colour = if run.is_shown { palette.text } else { palette.text3 };
            let label = egui::Label::new(RichText::new(&run.name).color(colour)).truncate().selectable(false);
            let row = vec2(width, size::ROW);
            ui.allocate_ui_with_layout(row, Direction::left_to_right(Align::Center), |ui| {
                ui.set_min_width(width);
                ui.add(label);
            });
            if card.double_clicked() {
                self.typing = Some((run.number, run.name.clone()));
            }
            return;
        };
        let id = ui.make_persistent_id(("rename", run.number));
        let field = TextEdit::singleline(text).id(id).desired_width(width - 8.0).char_limit(60);
        let response = ui.name_inputs(format!("Name of run {}", run.number), |ui| ui.add(field));
        let cancelled = ui.input(|input| input.key_pressed(Key::Escape));
        if response.lost_focus() {
            if !cancelled && *text != run.name {
                requests.request(SessionRequest::Runs(RunChange::Rename(run.number, text.clone())));
            }
            self.typing = None;
        } else if !response.has_focus() {
            response.request_focus();
        }
    }
}

/// A piece of the run's line; pale while it is hidden.
fn sample(ui: &Ui, rect: Rect, run: &Run) {
    let style = run_style(run.colour);
    let from = egui::pos2(rect.left() + 8.0, rect.top() + 15.0);
    let to = from + vec2(SAMPLE, 0.0);
    let colour = if run.is_shown { style.colour } else { style.colour.gamma_multiply(0.35) };
    paint_run_sample(ui.painter(), [from, to], run.colour, Stroke::new(style.width, colour), 1.0);
}

fn line(ui: &mut Ui, text: &str) {
    let colour = theme::palette(ui).text2;
    ui.add(egui::Label::new(RichText::new(text).small().color(colour)).truncate().selectable(false));
}
