//! The plot of all fits: percent of the start against the step. A click or a drag goes to that step.

use backlit_plot::marks::{decade_marks, even_marks, step_marks};
use backlit_ui::style::theme::data_colours::mark;
use backlit_ui::style::theme::{run_style, size};
use backlit_ui::style::{format, theme};
use backlit_ui::widgets::{
    PointMark, apart, end_with_room, grid_marks, mark_points, paint_text, run_line, segmented, still_plot,
};
use egui::{Align, Align2, Layout as Direction, Pos2, Rect, RichText, Role, Stroke, Ui, pos2, vec2};
use egui_plot::{PlotPoint, PlotTransform, PlotUi, VLine};

use super::{Bench, named};
use crate::context::Requests;
use crate::context::file_dialog::DialogKind;
use crate::features::laboratory::comparison::{LEAST_PERCENT, percent_text};
use crate::features::laboratory::{Contestant, LaboratoryChoices};

/// Height of the row above the plot.
const HEAD: f32 = 30.0;
/// With less room than this the hint behind the title is left out.
const HINT: f32 = 210.0;
/// Room right of the curves for their names.
const LABEL_ROOM: f64 = 168.0;
/// Names at the curves' ends keep so far apart.
const LABEL_SPACING: f32 = 17.0;
/// Steps that the axis has at least.
const LEAST_STEPS: f64 = 8.0;
/// Room of the axis of heights.
const AXIS: f64 = 52.0;

/// The plot with its head; the step that is to be looked at.
pub(crate) fn ui(
    ui: &mut Ui,
    bench: &Bench<'_>,
    choices: &mut LaboratoryChoices,
    requests: &mut Requests,
) -> Option<usize> {
    head(ui, bench, choices, requests);
    plot(ui, bench, choices.is_log)
}

fn head(ui: &mut Ui, bench: &Bench<'_>, choices: &mut LaboratoryChoices, requests: &mut Requests) {
    let palette = theme::palette(ui);
    let row = vec2(ui.available_width(), HEAD);
    ui.allocate_ui_with_layout(row, Direction::right_to_left(Align::Center), |ui| {
        let save = ui.button("Save PNG").on_hover_text("Save the plot as a picture…");
        if save.clicked() {
            let dialog = ("Save plot", DialogKind::NewFile("laboratory.png".to_owned(), &[]));
            let complain = |why| requests.complain(why);
            bench.laboratory.dialogs.ask(bench.context.egui, (), dialog, complain);
        }
        let copy = ui.button("Copy CSV").on_hover_text("Copy all curves as comma-separated values");
        if copy.clicked() {
            ui.ctx().copy_text(bench.comparison.csv());
            requests.status("Copied the curves as comma-separated values.");
        }
        segmented(ui, &mut choices.is_log, &[(false, "Percent"), (true, "Log")]);
        ui.with_layout(Direction::left_to_right(Align::Center), |ui| {
            let title = RichText::new("Cost, percent of start").text_style(theme::column_heading());
            ui.add(egui::Label::new(title.color(palette.text)).truncate());
            if ui.available_width() >= HINT {
                let hint = RichText::new("by step; a click goes to that step").color(palette.text3);
                ui.add(egui::Label::new(hint).truncate());
            }
        });
    });
}

fn y(percent: f64, is_log: bool) -> f64 {
    if is_log { percent.max(LEAST_PERCENT).log10() } else { percent }
}

fn bounds(bench: &Bench<'_>, is_log: bool, width: f64) -> [(f64, f64); 2] {
    let last = (bench.comparison.last() as f64).max(LEAST_STEPS);
    let last = end_with_room(last, width, AXIS, LABEL_ROOM);
    let values = bench.comparison.contestants.iter().flat_map(Contestant::percents);
    let (low, high) = values
        .fold((f64::INFINITY, 100.0_f64), |(low, high), value| (low.min(y(value, is_log)), high.max(value)));
    let heights = if is_log {
        let low = if low.is_finite() { low.min(1.0) } else { 0.0 };
        (low - 0.15, high.log10() + 0.15)
    } else {
        (-0.04 * high, 1.2 * high)
    };
    [(-0.25, last), heights]
}

fn plot(ui: &mut Ui, bench: &Bench<'_>, is_log: bool) -> Option<usize> {
    let (palette, area) = (theme::palette(ui), ui.available_size());
    let [across, up] = bounds(bench, is_log, f64::from(area.x));
    let percent = move |value: f64| {
        let value = if is_log { 10f64.powf(value) } else { value };
        let decimals = if value >= 1.0 || value <= 0.0 { 0 } else { (-value.log10()).ceil() as usize };
        format!("{} %", format::number(value, decimals.min(4)))
    };
    let response = still_plot("laboratory plot", area, palette)
        .y_axis_min_width(44.0)
        .x_grid_spacer(grid_marks(step_marks))
        .y_grid_spacer(grid_marks(if is_log { decade_marks } else { even_marks }))
        .y_axis_formatter(move |mark, _| percent(mark.value))
        .x_axis_formatter(|mark, _| format::number(mark.value, 0))
        .show(ui, |plot| {
            plot.set_plot_bounds_x(across.0..=across.1);
            plot.set_plot_bounds_y(up.0..=up.1);
            plot.vline(VLine::new("", bench.comparison.cursor as f64).color(palette.accent_text).width(1.5));
            for (index, fit) in bench.comparison.contestants.iter().enumerate() {
                curve(plot, index, fit, is_log);
            }
            for (index, fit) in bench.comparison.contestants.iter().enumerate() {
                ring(plot, index, fit, bench.comparison.cursor, is_log);
            }
        });
    named(&response.response, Role::Image, "Laboratory plot");
    labels(ui, bench, is_log, &response.transform);
    cursor_label(ui, bench, &response.transform);
    let pressed = response.response.is_pointer_button_down_on() || response.response.clicked();
    let pointer = response.response.interact_pointer_pos().filter(|_| pressed)?;
    let step = response.transform.value_from_position(pointer).x.round().max(0.0) as usize;
    let step = step.min(bench.comparison.last());
    (step != bench.comparison.cursor).then_some(step)
}

fn curve(plot: &mut PlotUi<'_>, index: usize, fit: &Contestant, is_log: bool) {
    let points: Vec<[f64; 2]> =
        fit.percents().into_iter().enumerate().map(|(step, value)| [step as f64, y(value, is_log)]).collect();
    let is_accepted =
        |at: &[f64; 2]| fit.steps.get(at[0] as usize).is_some_and(|step| step.iteration.accepted);
    let (accepted, rejected) = points.iter().copied().partition(is_accepted);
    let colour = run_style(index).colour;
    run_line(plot, points, index, size::CURVE_DEMONSTRATE);
    mark_points(plot, accepted, PointMark::Dot, colour, mark::ACCEPTED_RADIUS + 0.4);
    mark_points(plot, rejected, PointMark::Cross, colour, 0.5 * mark::REJECTED_SIZE);
}

/// A ring where the fit is at the step that is looked at.
fn ring(plot: &mut PlotUi<'_>, index: usize, fit: &Contestant, cursor: usize, is_log: bool) {
    let Some(percent) = fit.percent(cursor) else { return };
    let at = vec![[cursor.min(fit.last()) as f64, y(percent, is_log)]];
    mark_points(plot, at, PointMark::Ring, run_style(index).colour, mark::CURRENT_STEP_RADIUS);
}

/// Names at the curves' ends, kept apart; those that had to move are led back to their curve.
fn labels(ui: &Ui, bench: &Bench<'_>, is_log: bool, transform: &PlotTransform) {
    let frame = *transform.frame();
    let mut ends: Vec<(usize, Pos2, f64)> = Vec::new();
    for (index, fit) in bench.comparison.contestants.iter().enumerate() {
        let Some(percent) = fit.percent(fit.last()) else { continue };
        let at = PlotPoint::new(fit.last() as f64, y(percent, is_log));
        ends.push((index, transform.position_from_point(&at), percent));
    }
    ends.sort_by(|a, b| a.1.y.total_cmp(&b.1.y).then(a.0.cmp(&b.0)));
    let wanted: Vec<f32> = ends.iter().map(|(_, at, _)| at.y).collect();
    let heights = apart(&wanted, LABEL_SPACING, frame.top() + 8.0, frame.bottom() - 8.0);
    let x = ends.iter().map(|(_, at, _)| at.x).fold(frame.left(), f32::max) + 26.0;
    let painter = ui.painter_at(Rect::everything_right_of(frame.left()).intersect(ui.clip_rect()));
    let font = egui::TextStyle::Body.resolve(ui.style());
    for ((index, at, percent), height) in ends.into_iter().zip(heights) {
        let fit = &bench.comparison.contestants[index];
        let colour = run_style(index).colour;
        // After its end a fit stays where it is.
        let stroke = Stroke::new(1.0, colour.gamma_multiply(0.6));
        let last = pos2(x - 20.0, at.y);
        painter.line_segment([at + vec2(6.0, 0.0), last], stroke);
        painter.line_segment([last, pos2(x - 5.0, height)], stroke);
        let text = format!("{}  {} %", fit.entrant.name, percent_text(percent));
        painter.text(pos2(x, height), Align2::LEFT_CENTER, text, font.clone(), theme::palette(ui).text2);
        painter.circle_filled(pos2(x - 5.0, height), 2.5, colour);
    }
}

/// "Step 4" beside the line.
fn cursor_label(ui: &Ui, bench: &Bench<'_>, transform: &PlotTransform) {
    let step = bench.comparison.cursor;
    let at = transform.position_from_point(&PlotPoint::new(step as f64, 0.0));
    let frame = transform.frame();
    let (at, text) = (pos2(at.x + 6.0, frame.top() + 2.0), format!("Step {step}"));
    paint_text(ui, at, Align2::LEFT_TOP, text, egui::TextStyle::Small, theme::palette(ui).accent_text);
}
