//! The list of runs beside the convergence plot.

use egui::{
    Align, Layout as Direction, Rect, RichText, Role, ScrollArea, Sense, Stroke, Ui, WidgetInfo, vec2,
};

use crate::format;
use crate::selection::StepRef;
use crate::session::Run;
use crate::showing::{Intents, Request, Showing};
use crate::theme::{self, run_style};
use crate::widgets::{Icon, icon_button};

/// Height of a run's card.
const CARD: f32 = 62.0;
/// Width of the sample of a run's line.
const SAMPLE: f32 = 20.0;

/// The list.
pub(super) fn ui(ui: &mut Ui, showing: &Showing<'_>, intents: &mut Intents, height: f32) {
    ScrollArea::vertical().max_height(height).auto_shrink(false).show(ui, |ui| {
        let current = showing.session.run_of(showing.selection);
        for (index, run) in showing.session.runs.iter().enumerate().rev() {
            card(ui, intents, index, run, current == Some(index));
        }
        if showing.session.runs.is_empty() {
            let text = "Runs are kept here, each with all its steps.";
            ui.label(RichText::new(text).small().color(theme::palette(ui).text3));
        }
    });
}

fn card(ui: &mut Ui, intents: &mut Intents, index: usize, run: &Run, is_current: bool) {
    let palette = theme::palette(ui);
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), CARD), Sense::click());
    let name = format!("Run {}: {}", index + 1, run.name);
    response.widget_info(|| WidgetInfo::selected(Role::ListItem, true, is_current, &name));
    if response.clicked() {
        let step = run.steps.len().saturating_sub(1);
        intents.request(Request::Step(StepRef { run: index, step }));
    }
    if is_current {
        ui.painter().rect_filled(rect, 3.0, palette.select);
    } else if response.hovered() {
        ui.painter().rect_filled(rect, 3.0, palette.raised);
    }
    let style = run_style(run.colour);
    let y = rect.top() + 15.0;
    let from = egui::pos2(rect.left() + 8.0, y);
    let to = from + vec2(SAMPLE, 0.0);
    let stroke = Stroke::new(style.width, style.colour);
    match style.dash {
        [] => drop(ui.painter().line_segment([from, to], stroke)),
        [length, ..] => {
            ui.painter().extend(egui::Shape::dashed_line(&[from, to], stroke, *length, *length));
        }
    }
    let inner = Rect::from_min_max(rect.min + vec2(SAMPLE + 16.0, 5.0), rect.max - vec2(6.0, 4.0));
    let mut inside =
        ui.new_child(egui::UiBuilder::new().max_rect(inner).layout(Direction::top_down(Align::Min)));
    inside.spacing_mut().item_spacing.y = 1.0;
    inside.horizontal(|ui| {
        ui.set_height(20.0);
        ui.label(RichText::new(format!("{}, frame {}", run.name, run.frame)).color(palette.text));
        ui.with_layout(Direction::right_to_left(Align::Center), |ui| {
            let (icon, label) =
                if run.is_shown { (Icon::Eye, "Hide curve") } else { (Icon::EyeOff, "Show curve") };
            if icon_button(ui, icon, &format!("{label} of run {}", index + 1), label).clicked() {
                intents.request(Request::ShowRun(index, !run.is_shown));
            }
            let share = run.fraction(run.steps.len().saturating_sub(1));
            let text = share.map_or_else(|| format::MISSING.to_owned(), format::percent);
            ui.label(RichText::new(text).monospace().color(palette.text));
        });
    });
    for text in [run.detail.clone(), run.ending_text()] {
        ui_line(&mut inside, &text);
    }
}

fn ui_line(ui: &mut Ui, text: &str) {
    let colour = theme::palette(ui).text2;
    ui.add(egui::Label::new(RichText::new(text).small().color(colour)).truncate());
}
