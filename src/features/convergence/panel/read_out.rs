//! The card beside a step under the pointer: all its figures.

use backlit_document::run::{Run, RunStep};
use backlit_document::runs::StepRef;
use backlit_ui::style::format;
use backlit_ui::style::theme;
use backlit_ui::style::theme::{run_style, size};
use egui::{Align, Area, Frame, Id, Layout as Direction, Margin, Order, Pos2, Rect, RichText, Ui, vec2};

use crate::context::Context;

/// Width of the card, and its usual height.
const CARD: egui::Vec2 = vec2(216.0, 168.0);
/// How far it stands from the step.
const AWAY: f32 = 18.0;

/// Shows the card beside the step's mark at `at`; it keeps inside the window and never under the pointer.
pub(crate) fn show(ui: &Ui, context: &Context<'_>, step: StepRef, at: Pos2, ground: Rect) {
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
            Frame::NONE
                .fill(palette.raised)
                .stroke(palette.edge())
                .corner_radius(size::BUTTON_RADIUS)
                .inner_margin(Margin::same(10))
                .show(ui, |ui| {
                    ui.set_width(CARD.x - 20.0);
                    ui.spacing_mut().item_spacing.y = 2.0;
                    ui.spacing_mut().interact_size.y = 17.0;
                    ui.add(
                        egui::Label::new(RichText::new(&run.name).color(run_style_text(ui, run))).truncate(),
                    );
                    ui.horizontal(|ui| {
                        ui.label(step_title(run, step.step).color(palette.text));
                        ui.with_layout(Direction::right_to_left(Align::Center), |ui| {
                            ui.label(RichText::new(kind(step.step, record)).small().color(palette.text3));
                        });
                    });
                    for (name, value) in rows(run, step.step, record) {
                        row(ui, name, &value);
                    }
                });
        });
}

/// The run's colour where it can be read as text; else the text's own.
fn run_style_text(ui: &Ui, run: &Run) -> egui::Color32 {
    let colour = run_style(run.colour).colour;
    if run_style(run.colour).width > 1.0 { colour } else { theme::palette(ui).text }
}

fn kind(index: usize, step: &RunStep) -> &'static str {
    match (index, step.iteration.accepted) {
        (0, _) => "start",
        (_, true) => "accepted",
        (_, false) => "rejected",
    }
}

fn rows(run: &Run, index: usize, step: &RunStep) -> Vec<(&'static str, String)> {
    let share = |value: Option<f64>| value.map_or_else(|| format::MISSING.to_owned(), format::percent);
    let mut rows = vec![
        ("Cost", format!("{}  {}", format::cost(step.mismatch), share(run.fraction(index)))),
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

/// The number of a step's run and its place, as the read-out has it.
fn step_title(run: &Run, step: usize) -> RichText {
    let stage = run.steps.get(step).and_then(|record| run.stages.get(record.iteration.stage));
    let stage = stage.filter(|_| run.stages.len() > 1).map_or_else(String::new, |s| format!(", ramp {s} px"));
    RichText::new(format!("Step {step}{stage}"))
}
