//! The steps of a run as a slider: accepted ones are ticks, rejected ones ×, stages stand above.

use backlit_document::run::{Run, RunStep};
use backlit_document::runs::StepRef;
use backlit_ui::style::theme::{size, space};
use backlit_ui::style::{format, theme};
use backlit_ui::widgets::{Icon, fitting_label, hold_arrows, paint_text};
use egui::{
    Align, Align2, Layout as Direction, Rect, RichText, Sense, Stroke, TextStyle, Ui, WidgetInfo, pos2, vec2,
};

use super::plot::STAGE;
use crate::context::command::{Command, FitCommand};
use crate::context::command_button::{button, icon};
use crate::context::{Context, Requests, SessionRequest};
use crate::features::convergence::Quantity;

/// Room for the words about the step.
const WORDS: f32 = 380.0;
const HANDLE: f32 = 6.0;

pub(crate) fn ui(ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
    let row = vec2(ui.available_width(), 44.0);
    ui.allocate_ui_with_layout(row, Direction::left_to_right(Align::Center), |ui| {
        icon(ui, context, requests, Command::Fit(FitCommand::EarlierStep), Icon::Previous);
        icon(ui, context, requests, Command::Fit(FitCommand::LaterStep), Icon::Next);
        let Some(run) = context.run() else {
            ui.label(RichText::new("No step on this frame yet").color(theme::palette(ui).text3));
            return;
        };
        let last = run.last_step();
        let at = context.shown_step().map(|at| at.step);
        let text = match at {
            Some(at) => format!("Step {at} of {last}"),
            None => format!("{last} steps"),
        };
        let text = RichText::new(text).monospace();
        let (rect, _) = ui.allocate_exact_size(vec2(104.0, size::ROW), Sense::hover());
        ui.put(rect, egui::Label::new(text));
        let width = (ui.available_width() - WORDS).max(120.0);
        slider(ui, requests, run, at, width);
        words(ui, context, requests, run, at);
    });
}

fn slider(ui: &mut Ui, requests: &mut Requests, run: &Run, at: Option<usize>, width: f32) {
    let (rect, response) = ui.allocate_exact_size(vec2(width, 40.0), Sense::click_and_drag());
    let last = run.steps.len().saturating_sub(1).max(1);
    response.widget_info(|| WidgetInfo::slider(true, at.unwrap_or(last) as f64, "Step"));
    let rail = Rect::from_center_size(rect.center() + vec2(0.0, 2.0), vec2(rect.width() - 2.0 * HANDLE, 3.0));
    let x = |step: usize| rail.left() + rail.width() * step as f32 / last as f32;
    if let Some(pointer) = response.interact_pointer_pos() {
        let share = ((pointer.x - rail.left()) / rail.width()).clamp(0.0, 1.0);
        let step = (share * last as f32).round() as usize;
        if Some(step) != at && step < run.steps.len() {
            requests.request(SessionRequest::Step(StepRef { run: run.number, step }));
        }
    }
    if let Some(step) = step_by_key(ui, &response, at.unwrap_or(last), run.last_step()) {
        requests.request(SessionRequest::Step(StepRef { run: run.number, step }));
    }
    let palette = theme::palette(ui);
    let painter = ui.painter();
    // Stages as bands, as in the plot: every other one is shaded.
    let stages =
        run.steps.get(1..).unwrap_or_default().chunk_by(|a, b| a.iteration.stage == b.iteration.stage);
    let mut first = 1;
    for (index, stage) in stages.enumerate() {
        let band = Rect::from_x_y_ranges(x(first - 1)..=x(first + stage.len() - 1), rect.y_range());
        first += stage.len();
        if index % 2 == 1 {
            painter.rect_filled(band, 0.0, palette.text3.gamma_multiply(STAGE));
        }
    }
    painter.rect_filled(rail, 1.5, palette.widget);
    if let Some(at) = at {
        painter.rect_filled(Rect::from_x_y_ranges(rail.left()..=x(at), rail.y_range()), 1.5, palette.accent);
    }
    let colour = theme::run_style(run.colour).colour;
    let (mut stage, mut free_from) = (usize::MAX, f32::NEG_INFINITY);
    for (step, record) in run.steps.iter().enumerate() {
        let centre = pos2(x(step), rail.bottom() + 9.0);
        if record.iteration.accepted {
            painter.vline(centre.x, centre.y - 2.5..=centre.y + 2.5, Stroke::new(1.0, palette.text3));
        } else {
            let stroke = Stroke::new(1.3, colour);
            for turn in [vec2(2.6, 2.6), vec2(2.6, -2.6)] {
                painter.line_segment([centre - turn, centre + turn], stroke);
            }
        }
        if step > 0 && record.iteration.stage != stage {
            stage = record.iteration.stage;
            let label = run.stages.get(stage).map_or("", String::as_str);
            // A stage of a step or two leaves its neighbour no room for a word of its own.
            if x(step) >= free_from {
                let at = pos2(x(step), rail.top() - 4.0);
                let text = paint_text(ui, at, Align2::LEFT_BOTTOM, label, theme::tick(), palette.text2);
                free_from = text.right() + space::ROW;
            }
        }
    }
    let response =
        response.on_hover_text("Drag or click to look at a step; the arrow keys once it has the focus");
    let fill = if response.hovered() || response.has_focus() { palette.text } else { palette.text2 };
    if let Some(at) = at {
        painter.circle(pos2(x(at), rail.center().y), HANDLE, fill, Stroke::new(1.0, palette.panel));
    }
}

/// The step that the arrow keys go to while the slider has the focus.
fn step_by_key(ui: &Ui, response: &egui::Response, at: usize, last: usize) -> Option<usize> {
    if response.clicked() || response.dragged() {
        response.request_focus();
    }
    if !response.has_focus() {
        return None;
    }
    hold_arrows(ui, response);
    let pressed = |key| ui.input_mut(|input| input.consume_key(egui::Modifiers::NONE, key));
    let step = if pressed(egui::Key::ArrowLeft) {
        at.saturating_sub(1)
    } else if pressed(egui::Key::ArrowRight) {
        (at + 1).min(last)
    } else {
        return None;
    };
    (step != at).then_some(step)
}

fn words(ui: &mut Ui, context: &Context<'_>, requests: &mut Requests, run: &Run, at: Option<usize>) {
    ui.with_layout(Direction::right_to_left(Align::Center), |ui| {
        button(ui, context, requests, Command::Fit(FitCommand::Branch));
        let text = at.map_or_else(
            || "The body has moved since.".to_owned(),
            |at| run.steps.get(at).map_or_else(String::new, |step| sentence(step, at)),
        );
        let colour = theme::palette(ui).text2;
        // The first sentence says most.
        let short = text.split_once(": ").map_or(&text[..], |(first, _)| first);
        fitting_label(ui, &[&text, short], TextStyle::Small, colour);
    });
}

fn sentence(step: &RunStep, index: usize) -> String {
    if index == 0 {
        return "The start of the run.".to_owned();
    }
    let share = |value: Option<f64>| {
        value.map_or_else(|| format::MISSING.to_owned(), |share| Quantity::Percent.text_of(100.0 * share))
    };
    let fell = step.actual_share().map(f64::abs);
    let predicted = share(step.predicted_share());
    if step.iteration.accepted && step.iteration.actual_decrease >= 0.0 {
        format!("Accepted. Cost fell by {}, {predicted} expected.", share(fell))
    } else if step.iteration.accepted {
        format!("Taken, though the cost rose by {}; a fall of {predicted} was expected.", share(fell))
    } else {
        let damping = format::short(step.iteration.damping);
        format!("Rejected: the cost would have risen by {}. Damping {damping}.", share(fell))
    }
}
