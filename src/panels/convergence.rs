//! The convergence plot: mismatch against step, one curve a run, rejected steps as ×.
//!
//! Curves are of one measure for all stages and runs, so that they can be compared. A click goes to a step.

use egui::{Align, Layout as Direction, RichText, Ui, UiBuilder, pos2, vec2};
use egui_plot::{GridMark, Line, LineStyle, MarkerShape, Plot, PlotPoint, PlotPoints, PlotUi, Points, VLine};

use super::command::button;
use super::{runs, steps};
use crate::action::Action;
use crate::format;
use crate::pane::HEADER_BUTTONS;
use crate::plot::marks::{decade_marks, even_marks};
use crate::selection::StepRef;
use crate::session::Run;
use crate::showing::{Intents, Request, Showing};
use crate::theme::data_colours::mark;
use crate::theme::{self, run_style, size};
use crate::widgets::{checkbox, segmented};

/// Height of the row above the plot.
const HEAD: f32 = 30.0;
/// Height of the row of steps.
const STEPS: f32 = 52.0;
/// The plot's list of runs folds below this width.
const LIST_FROM: f32 = 760.0;
/// Curves begin here on the logarithmic scale.
const LEAST: f64 = 1e-3;

/// The axis of steps is so much longer than the runs, in points: their names stand at their ends.
const LABEL_ROOM: f64 = 112.0;
/// Room of the axis of heights, and the least that is left for the curves.
const AXIS: f64 = 56.0;
const LEAST_CURVES: f64 = 120.0;
/// Marks of the axis of steps are so many of the plot's finest divisions apart, or their numbers are not written.
const MARK_SPACING: f64 = 10.0;

/// What is plotted.
#[derive(Clone, Copy, PartialEq)]
enum Height {
    Percent,
    Cost,
}

#[derive(Clone, Copy)]
struct Scale {
    height: Height,
    log: bool,
    rejected: bool,
}

impl Scale {
    /// Height in the plot of a mismatch; `start` is that of the run's first step.
    fn y(self, mismatch: f64, start: f64) -> f64 {
        let value = match self.height {
            Height::Percent => 100.0 * mismatch / start.max(f64::MIN_POSITIVE),
            Height::Cost => mismatch,
        };
        if self.log { value.max(LEAST).log10() } else { value }
    }

    fn text(self, y: f64) -> String {
        let value = if self.log { 10f64.powf(y) } else { y };
        match self.height {
            Height::Percent => format!("{} %", format::number(value, decimals(value))),
            Height::Cost => format::cost(value),
        }
    }
}

/// The panel, in all of the space that is left.
pub(crate) fn ui(ui: &mut Ui, showing: &Showing<'_>, intents: &mut Intents) {
    let rect = ui.available_rect_before_wrap();
    ui.painter().rect_filled(rect, 0.0, theme::palette(ui).panel);
    let inner = UiBuilder::new().max_rect(rect.shrink2(vec2(8.0, 0.0)));
    ui.scope_builder(inner, |ui| {
        let scale = head(ui, showing, intents);
        let list = ui.available_width() >= LIST_FROM;
        let plot_height = (ui.available_height() - STEPS).max(80.0);
        ui.horizontal_top(|ui| {
            let width = ui.available_width() - if list { size::RUN_LIST } else { 0.0 };
            plot(ui, showing, intents, scale, vec2(width - 8.0, plot_height));
            if list {
                let area = vec2(size::RUN_LIST - 8.0, plot_height);
                let down = Direction::top_down(Align::Min);
                ui.allocate_ui_with_layout(area, down, |ui| runs::ui(ui, showing, intents, plot_height));
            }
        });
        steps::ui(ui, showing, intents);
    });
}

fn head(ui: &mut Ui, showing: &Showing<'_>, intents: &mut Intents) -> Scale {
    let id = egui::Id::unique("convergence scale");
    let (mut percent, mut log, mut rejected) =
        ui.data(|data| data.get_temp(id)).unwrap_or((true, true, true));
    ui.allocate_ui_with_layout(
        vec2(ui.available_width(), HEAD),
        Direction::left_to_right(Align::Center),
        |ui| {
            ui.label(RichText::new("Convergence").size(14.0));
            ui.add_space(8.0);
            segmented(ui, &mut percent, &[(true, "% of start"), (false, "Cost")]);
            segmented(ui, &mut log, &[(true, "Log"), (false, "Linear")]);
            checkbox(ui, &mut rejected, "Rejected steps");
            ui.with_layout(Direction::right_to_left(Align::Center), |ui| {
                ui.add_space(HEADER_BUTTONS);
                button(ui, showing, intents, Action::ClearRuns);
            });
        },
    );
    ui.data_mut(|data| data.insert_temp(id, (percent, log, rejected)));
    Scale { height: if percent { Height::Percent } else { Height::Cost }, log, rejected }
}

/// Enough decimals for the first figure of a percentage, up to four.
fn decimals(percent: f64) -> usize {
    if percent >= 1.0 || percent <= 0.0 { 0 } else { (-percent.log10()).ceil().clamp(1.0, 4.0) as usize }
}

fn plot(ui: &mut Ui, showing: &Showing<'_>, intents: &mut Intents, scale: Scale, area: egui::Vec2) {
    let palette = theme::palette(ui);
    let shown: Vec<(usize, &Run)> =
        showing.session.runs.iter().enumerate().filter(|(_, run)| run.is_shown).collect();
    if shown.is_empty() {
        return empty(ui, showing, area);
    }
    let current = showing.selection.step.or_else(|| newest(showing));
    let bounds = bounds(&shown, scale, f64::from(area.x));
    let response = Plot::new("convergence plot")
        .width(area.x)
        .height(area.y)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .allow_double_click_reset(false)
        .show_crosshair(false)
        .label_formatter(|_| None)
        .grid_color(palette.grid)
        .y_axis_min_width(44.0)
        .x_grid_spacer(step_marks)
        .y_grid_spacer(move |input| if scale.log { decade_marks(input) } else { even_marks(input) })
        .y_axis_formatter(move |mark, _| scale.text(mark.value))
        .x_axis_formatter(|mark, _| format::number(mark.value, 0))
        .show(ui, |plot| {
            plot.set_plot_bounds_x(bounds[0].0..=bounds[0].1);
            plot.set_plot_bounds_y(bounds[1].0..=bounds[1].1);
            for (index, run) in &shown {
                let is_current = current.is_some_and(|step| step.run == *index);
                curve(plot, run, scale, is_current);
            }
            if let Some((step, run)) =
                current.and_then(|step| Some((step, showing.session.runs.get(step.run)?)))
            {
                playhead(plot, run, step.step, scale, palette.accent_text);
            }
        });
    response.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "Convergence plot"));
    if response.response.clicked()
        && let Some(pointer) = response.response.interact_pointer_pos()
        && let Some(step) = nearest(&shown, scale, |at| response.transform.position_from_point(&at), pointer)
    {
        intents.request(Request::Step(step));
    }
}

fn empty(ui: &mut Ui, showing: &Showing<'_>, area: egui::Vec2) {
    let (rect, response) = ui.allocate_exact_size(area, egui::Sense::hover());
    let palette = theme::palette(ui);
    ui.painter().rect_filled(rect, f32::from(size::FIELD_RADIUS), palette.plot);
    let text = if showing.session.take.is_some() { "Press Space to step" } else { "No take, no steps" };
    let font = egui::TextStyle::Body.resolve(ui.style());
    ui.painter().text(rect.center(), egui::Align2::CENTER_CENTER, text, font, palette.text3);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, text));
}

/// The last step of the newest run of the frame.
fn newest(showing: &Showing<'_>) -> Option<StepRef> {
    let run = showing.session.run_of(showing.selection)?;
    Some(StepRef { run, step: showing.session.runs.get(run)?.steps.len().checked_sub(1)? })
}

fn step_marks(input: egui_plot::GridInput) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    let apart = input.base_step_size * MARK_SPACING;
    let step = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0].into_iter().find(|s| *s >= apart).unwrap_or(200.0);
    let first = (low / step).ceil() as i64;
    let last = (high / step).floor() as i64;
    (first..=last).map(|k| GridMark { value: k as f64 * step, step_size: step }).collect()
}

fn bounds(runs: &[(usize, &Run)], scale: Scale, width: f64) -> [(f64, f64); 2] {
    let mut last = 5.0_f64;
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for (_, run) in runs {
        last = last.max(run.accepted_until(run.steps.len()) as f64);
        let start = run.steps.first().map_or(1.0, |step| step.mismatch);
        for step in &run.steps {
            let y = scale.y(step.mismatch, start);
            (low, high) = (low.min(y), high.max(y));
        }
    }
    if !scale.log {
        low = 0.0;
    }
    let room = (width - AXIS).max(LABEL_ROOM + LEAST_CURVES);
    let last = last * room / (room - LABEL_ROOM);
    let pad = (0.08 * (high - low)).max(if scale.log { 0.05 } else { 0.08 * high.abs() }).max(1e-9);
    [(-0.4, last + 1.2), (low - pad, high + pad)]
}

/// The points of accepted steps, each with the index of its step.
fn accepted(run: &Run, scale: Scale) -> Vec<(usize, [f64; 2])> {
    let start = run.steps.first().map_or(1.0, |step| step.mismatch);
    let mut x = 0.0;
    let mut points = Vec::new();
    for (index, step) in run.steps.iter().enumerate() {
        if index == 0 || step.accepted {
            points.push((index, [x, scale.y(step.mismatch, start)]));
            x += 1.0;
        }
    }
    points
}

fn curve(plot: &mut PlotUi<'_>, run: &Run, scale: Scale, is_current: bool) {
    let style = run_style(run.colour);
    let points = accepted(run, scale);
    let line: Vec<[f64; 2]> = points.iter().map(|(_, point)| *point).collect();
    let dash = match style.dash {
        [] => LineStyle::Solid,
        [length, ..] => LineStyle::Dashed { length: *length },
    };
    let width = if is_current { style.width + 0.25 } else { style.width };
    plot.line(Line::new("", PlotPoints::from(line.clone())).color(style.colour).width(width).style(dash));
    let dots = Points::new("", PlotPoints::from(line)).color(style.colour).radius(mark::ACCEPTED_RADIUS);
    plot.points(dots.shape(MarkerShape::Circle).filled(true));
    if scale.rejected {
        rejected(plot, run, scale);
    }
    if let Some((_, [x, y])) = points.last() {
        let at = plot.plot_from_screen(plot.screen_from_plot(PlotPoint::new(*x, *y)) + vec2(10.0, 0.0));
        let text = RichText::new(format!("{}  {}", run.name, scale.text(*y))).small();
        plot.text(egui_plot::Text::new("", at, text).color(style.colour).anchor(egui::Align2::LEFT_CENTER));
    }
}

/// A × for each rejected step, stacked upwards above the last accepted dot.
fn rejected(plot: &mut PlotUi<'_>, run: &Run, scale: Scale) {
    let style = run_style(run.colour);
    let start = run.steps.first().map_or(1.0, |step| step.mismatch);
    let (mut x, mut y, mut stacked) = (0.0, scale.y(start, start), 0.0);
    let mut crosses = Vec::new();
    for step in run.steps.iter().skip(1) {
        if step.accepted {
            (x, y, stacked) = (x + 1.0, scale.y(step.mismatch, start), 0.0);
        } else {
            stacked += 1.0;
            let screen = plot.screen_from_plot(PlotPoint::new(x, y));
            let above = screen - vec2(0.0, mark::REJECTED_SPACING * stacked);
            let at = plot.plot_from_screen(pos2(above.x, above.y));
            crosses.push([at.x, at.y]);
        }
    }
    let points = Points::new("", PlotPoints::from(crosses)).color(style.colour);
    plot.points(points.radius(0.5 * mark::REJECTED_SIZE).shape(MarkerShape::Cross));
}

fn playhead(plot: &mut PlotUi<'_>, run: &Run, step: usize, scale: Scale, colour: egui::Color32) {
    let x = run.accepted_until(step) as f64;
    plot.vline(VLine::new("", x).color(colour).width(1.5));
    let start = run.steps.first().map_or(1.0, |step| step.mismatch);
    if let Some(step) = run.steps.get(step) {
        let at = vec![[x, scale.y(step.mismatch, start)]];
        let ring = Points::new("", PlotPoints::from(at)).color(colour).filled(false);
        plot.points(ring.radius(mark::CURRENT_STEP_RADIUS));
    }
}

/// The step whose dot is nearest to the pointer.
fn nearest(
    runs: &[(usize, &Run)],
    scale: Scale,
    screen: impl Fn(PlotPoint) -> egui::Pos2,
    pointer: egui::Pos2,
) -> Option<StepRef> {
    let mut best: Option<(f32, StepRef)> = None;
    for (index, run) in runs {
        for (step, [x, y]) in accepted(run, scale) {
            let away = screen(PlotPoint::new(x, y)) - pointer;
            // Time runs across: what lies beneath the pointer counts more than what lies beside it.
            let distance = away.x.abs() * 3.0 + away.y.abs();
            if best.is_none_or(|(least, _)| distance < least) {
                best = Some((distance, StepRef { run: *index, step }));
            }
        }
    }
    best.map(|(_, step)| step)
}
