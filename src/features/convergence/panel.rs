//! The convergence panel: a quantity of the fit against its steps, one curve a run, rejected steps as ×; the list of
//! runs beside it, the steps of the run on the screen below, and a card beside the step under the pointer.

use backlit_document::run::RunStep;
use backlit_document::runs::StepRef;
use backlit_ui::style::theme::data_colours::mark;
use backlit_ui::style::theme::{run_style, size, space};
use backlit_ui::style::{format, theme};
use backlit_ui::widgets::{checkbox, choice, hint, paint_text, segmented};
use egui::{
    Align, Align2, Area, Id, Layout as Direction, Margin, Order, Pos2, Rect, RichText, Role, Ui, Vec2,
    WidgetInfo, vec2,
};
use egui_plot::PlotResponse;

use super::plot::Plot;
use super::{Convergence, ConvergencePreferences, Quantity, steps};
use crate::context::command::{Command, ConvergenceCommand, FitCommand, Variants};
use crate::context::command_button::{button, menu_row};
use crate::context::pane::{HEADER_BUTTONS, Pane};
use crate::context::{Context, Requests, SessionRequest, pane_title};

const STEPS: f32 = 52.0;
/// The plot's list of runs folds below this width.
const LIST_FROM: f32 = 760.0;
/// The list takes no more than this part of the width.
const LIST_SHARE: f32 = 0.4;
/// A step is read out when the pointer is so near to its dot.
const REACH: f32 = 40.0;
const QUANTITY: f32 = 124.0;
/// Below this width of the header what is done with all runs is in a menu.
const FOLDED_BELOW: f32 = 680.0;

impl Convergence {
    pub(super) fn show(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        siblings: &[Pane],
        requests: &mut Requests,
    ) {
        pane_title::ground(ui, |ui| {
            // What is chosen now is seen from the next frame on.
            let preferences = self.preferences;
            self.head(ui, context, siblings, requests);
            let list = ui.available_width() >= LIST_FROM;
            let list_width = if list { size::RUN_LIST.min(LIST_SHARE * ui.available_width()) } else { 0.0 };
            let plot_height = (ui.available_height() - STEPS).max(80.0);
            ui.horizontal_top(|ui| {
                let width = ui.available_width() - list_width;
                curves(ui, context, preferences, requests, vec2(width - space::WIDGET, plot_height), !list);
                if list {
                    let area = vec2(list_width - space::WIDGET, plot_height);
                    let down = Direction::top_down(Align::Min);
                    ui.allocate_ui_with_layout(area, down, |ui| {
                        self.list(ui, context, requests, plot_height);
                    });
                }
            });
            steps::ui(ui, context, requests);
        });
    }

    fn head(&mut self, ui: &mut Ui, context: &Context<'_>, siblings: &[Pane], requests: &mut Requests) {
        let row = vec2(ui.available_width(), size::TILE_HEADER);
        ui.allocate_ui_with_layout(row, Direction::left_to_right(Align::Center), |ui| {
            pane_title::show(ui, Pane::Convergence, siblings, requests);
            ui.add_space(space::ROW);
            let folded = ui.available_width() < FOLDED_BELOW;
            choices(ui, context, &mut self.preferences, folded);
            ui.with_layout(Direction::right_to_left(Align::Center), |ui| {
                ui.add_space(HEADER_BUTTONS);
                if folded {
                    ui.menu_button("More", |ui| {
                        rejected(ui, &mut self.preferences);
                        self.more(ui, context, requests);
                    });
                } else {
                    self.more(ui, context, requests);
                }
            });
        });
    }
}

/// The plot, or why there is none. A click goes to a step, the pointer over one reads it out.
fn curves(
    ui: &mut Ui,
    context: &Context<'_>,
    preferences: ConvergencePreferences,
    requests: &mut Requests,
    area: Vec2,
    names: bool,
) {
    let current = context.shown_step();
    let current = current.and_then(|step| Some((context.runs().get(step.run)?, step.step)));
    let plot = Plot::of(context.runs().all(), preferences, current);
    if plot.curves.is_empty() {
        return empty(ui, context, area);
    }
    let PlotResponse { response, transform, .. } = plot.show(ui, area, names);
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, "Convergence plot"));
    let pointer = response.hover_pos().or_else(|| response.interact_pointer_pos());
    let Some(pointer) = pointer.filter(|pointer| transform.frame().contains(*pointer)) else { return };
    let Some((step, at)) = plot.nearest(&transform, pointer) else { return };
    if response.clicked() {
        requests.request(SessionRequest::Step(step));
    }
    if at.distance(pointer) <= REACH {
        let ring = egui::Stroke::new(1.5, theme::palette(ui).text);
        ui.painter().circle_stroke(at, mark::CURRENT_STEP_RADIUS, ring);
        show_read_out(ui, context, step, at, *transform.frame());
    }
}

fn empty(ui: &mut Ui, context: &Context<'_>, area: Vec2) {
    let (rect, response) = ui.allocate_exact_size(area, egui::Sense::hover());
    let palette = theme::palette(ui);
    ui.painter().rect_filled(rect, f32::from(size::FIELD_RADIUS), palette.plot);
    let text = match (context.session.take.is_some(), context.runs().all().is_empty()) {
        (false, _) => "No take, no steps",
        (true, true) => "Press Space to step",
        (true, false) => "All curves are hidden",
    };
    paint_text(ui, rect.center(), Align2::CENTER_CENTER, text, egui::TextStyle::Body, palette.text3);
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, text));
}

fn choices(ui: &mut Ui, context: &Context<'_>, preferences: &mut ConvergencePreferences, folded: bool) {
    let has_truth = context.session.take.as_ref().is_some_and(|take| take.take().reference().is_some());
    let offered = Quantity::ALL.into_iter().filter(|quantity| has_truth || *quantity != Quantity::JointError);
    let row = |quantity: Quantity| (quantity, quantity.words().name, quantity.words().explanation.to_owned());
    let (all, chosen): (Vec<_>, _) = (offered.map(row).collect(), preferences.quantity);
    preferences.quantity = choice(ui, "Quantity", QUANTITY, chosen.words().name, &all).unwrap_or(chosen);
    segmented(ui, &mut preferences.is_log, &[(true, "Log"), (false, "Linear")])
        .on_hover_text("How the axis of heights runs");
    if !folded {
        rejected(ui, preferences);
    }
}

fn rejected(ui: &mut Ui, preferences: &mut ConvergencePreferences) {
    checkbox(ui, &mut preferences.rejected, "Rejected steps")
        .on_hover_text("A × for each step that would have raised the cost and was taken back");
}

impl Convergence {
    /// What is done with all runs.
    fn more(&mut self, ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
        button(ui, context, requests, Command::Convergence(ConvergenceCommand::ClearRuns));
        ui.menu_button("Run again with…", |ui| {
            let variants =
                [Variants::Renderers, Variants::Presets, Variants::Ramps].map(FitCommand::RunAgain);
            for command in variants.into_iter().chain([FitCommand::RunAgainWithCameras]) {
                let command = Command::Fit(command);
                menu_row(ui, context, requests, command, command.text());
            }
        })
        .response
        .on_hover_text("From the same start with each renderer, preset or ramp, to compare their curves");
        let has_runs = !context.runs().all().is_empty();
        ui.add_enabled_ui(has_runs, |ui| {
            ui.menu_button("Export", |ui| {
                for command in [ConvergenceCommand::ExportCurves, ConvergenceCommand::ExportPlot] {
                    let command = Command::Convergence(command);
                    menu_row(ui, context, requests, command, command.text());
                }
                checkbox(ui, &mut self.preferences.exports_light, "Plot in light colours")
                    .on_hover_text("For papers; otherwise in the colours of the window");
            })
            .response
            .on_hover_text("Write the curves to a CSV file, or the plot to a PNG or SVG file")
            .on_disabled_hover_text("There are no runs");
        });
    }
}

/// Width of the card, and its usual height.
const CARD: Vec2 = vec2(216.0, 168.0);
/// How far it stands from the step.
const AWAY: f32 = 18.0;

/// Shows the card beside the step's mark at `at`; it keeps inside the window and never under the pointer.
fn show_read_out(ui: &Ui, context: &Context<'_>, step: StepRef, at: Pos2, ground: Rect) {
    let Some(run) = context.runs().get(step.run) else { return };
    let Some(record) = run.steps.get(step.step) else { return };
    let palette = theme::palette(ui);
    let left = if at.x + AWAY + CARD.x > ground.right() { at.x - AWAY - CARD.x } else { at.x + AWAY };
    let window = ui.ctx().content_rect();
    let top = (at.y - 0.5 * CARD.y).min(ground.bottom() - CARD.y).max(window.top() + 4.0);
    Area::new(Id::unique("step read-out"))
        .order(Order::Tooltip)
        .interactable(false)
        .fixed_pos(egui::pos2(left.max(window.left() + 4.0), top))
        .show(ui.ctx(), |ui| {
            palette.raised_frame(size::BUTTON_RADIUS, Margin::same(10)).show(ui, |ui| {
                ui.set_width(CARD.x - 20.0);
                ui.spacing_mut().item_spacing.y = 2.0;
                ui.spacing_mut().interact_size.y = 17.0;
                // The run's colour where it can be read as text.
                let style = run_style(run.colour);
                let colour = if style.width > 1.0 { style.colour } else { palette.text };
                ui.add(egui::Label::new(RichText::new(&run.name).color(colour)).truncate());
                ui.horizontal(|ui| {
                    let stage = run.stages.get(record.iteration.stage).filter(|_| run.stages.len() > 1);
                    let stage = stage.map_or_else(String::new, |stage| format!(", ramp {stage} px"));
                    let title = format!("Step {}{stage}", step.step);
                    ui.label(RichText::new(title).color(palette.text));
                    ui.with_layout(Direction::right_to_left(Align::Center), |ui| {
                        hint(ui, kind(step.step, record));
                    });
                });
                let left = run.fraction_among(context.runs().all(), step.step);
                for (name, value) in rows(left, step.step, record) {
                    row(ui, name, &value);
                }
            });
        });
}

fn kind(index: usize, step: &RunStep) -> &'static str {
    match (index, step.iteration.accepted) {
        (0, _) => "start",
        (_, true) => "accepted",
        (_, false) => "rejected",
    }
}

fn rows(left: Option<f64>, index: usize, step: &RunStep) -> Vec<(&'static str, String)> {
    let share = |value: Option<f64>| value.map_or_else(|| format::MISSING.to_owned(), format::percent);
    let mut rows = vec![
        ("Cost", format!("{}  {}", format::cost(step.iteration.cost), share(left))),
        ("RMS", format::number(step.rms, 2)),
    ];
    if index > 0 {
        let fell = if step.iteration.accepted { "Cost fell" } else { "Would fall" };
        rows.push((fell, share(step.actual_share())));
        rows.push(("Expected", share(step.predicted_share())));
        rows.push(("Step norm", figures(step.iteration.step_norm)));
        rows.push(("Damping", figures(step.iteration.damping)));
    }
    rows
}

/// A number to three figures.
fn figures(value: f64) -> String {
    let power = if value > 0.0 { 10f64.powf(2.0 - value.log10().floor()) } else { 1.0 };
    format::short((value * power).round() / power)
}

fn row(ui: &mut Ui, name: &str, value: &str) {
    let palette = theme::palette(ui);
    ui.horizontal(|ui| {
        ui.label(RichText::new(name).small().color(palette.text2));
        ui.with_layout(Direction::right_to_left(Align::Center), |ui| {
            ui.label(RichText::new(value).monospace().color(palette.text));
        });
    });
}
