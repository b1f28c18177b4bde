//! Success over angle: one curve a choice of fit, with bars for how sure each point is, and the counts beside it.

use backlit_runs::basin::{BasinResult, LevelReport, RandomStarts};
use backlit_ui::style::theme::data_colours::mark;
use backlit_ui::style::theme::{run_style, size, space};
use backlit_ui::style::{format, theme};
use backlit_ui::widgets::{PointMark, hint, mark_points, paint_run_sample, paint_text, run_line, still_plot};
use egui::{
    Align, Layout as Direction, RichText, Role, ScrollArea, Sense, Stroke, Ui, Vec2, WidgetInfo, vec2,
};
use egui_plot::{GridMark, Line, PlotPoint, PlotPoints, PlotUi};

/// Width of the counts beside the plot; where there is less than `FOLD` in all they stand below it, if there is
/// `HIGH` enough.
const COUNTS: f32 = 250.0;
const FOLD: f32 = 560.0;
const HIGH: f32 = 320.0;
/// Height of a row of the counts.
const ROW: f32 = 19.0;
/// Width of the names of the levels, and of the counts of a choice of fit.
const LEVEL: f32 = 84.0;
const CHOICE: f32 = 44.0;
/// Width of the counts of a choice where there is no room for their unit.
const BARE_CHOICE: f32 = 30.0;
/// Choices of fit stand this many degrees beside each other, so that their bars do not cover each other.
const BESIDE: f64 = 0.5;
/// Half a bar's cap, degrees.
const CAP: f64 = 0.35;
/// A point is read out when the pointer is so near.
const REACH: f32 = 24.0;

pub(crate) fn ui(ui: &mut Ui, result: &BasinResult) {
    let Some(starts) = result.random() else { return };
    let area = ui.available_size() - vec2(0.0, space::WIDGET);
    if area.x < FOLD {
        let choices = result.report.choices.len() as f32;
        let wanted = choices * (size::ROW + 1.0) + (starts.levels.len() as f32) * (ROW + 1.0) + 60.0;
        let below = if area.y < HIGH { 0.0 } else { wanted.min(0.5 * area.y) };
        plot(ui, result, starts, area - vec2(space::ROW, below));
        if below > 0.0 {
            counts(ui, result, starts);
        }
        return;
    }
    ui.horizontal_top(|ui| {
        plot(ui, result, starts, area - vec2(COUNTS + space::WIDGET, 0.0));
        let place = vec2(COUNTS - space::WIDGET, area.y);
        ui.allocate_ui_with_layout(place, Direction::top_down(Align::Min), |ui| counts(ui, result, starts));
    });
}

/// Where a level of a choice stands across.
fn across(result: &BasinResult, choice: usize, level: &LevelReport) -> f64 {
    let middle = 0.5 * (result.report.choices.len() as f64 - 1.0);
    f64::from(level.level.degrees) + BESIDE * (choice as f64 - middle)
}

fn plot(ui: &mut Ui, result: &BasinResult, starts: &RandomStarts, area: Vec2) {
    let palette = theme::palette(ui);
    let degrees: Vec<f64> = starts.levels.iter().map(|level| f64::from(level.degrees)).collect();
    let last = degrees.iter().copied().fold(10.0, f64::max);
    let response = still_plot("basin plot", vec2(area.x, area.y.max(80.0)), palette)
        .y_axis_min_width(44.0)
        .x_grid_spacer(move |_| degrees.iter().map(|&value| GridMark { value, step_size: last }).collect())
        .y_grid_spacer(|_| {
            [0.0, 25.0, 50.0, 75.0, 100.0].map(|value| GridMark { value, step_size: 100.0 }).to_vec()
        })
        .x_axis_formatter(|mark, _| format!("{}°", format::number(mark.value, 0)))
        .y_axis_formatter(|mark, _| format!("{} %", format::number(mark.value, 0)))
        .show(ui, |plot| {
            plot.set_plot_bounds_x(0.0..=1.1 * last);
            plot.set_plot_bounds_y(-4.0..=106.0);
            for choice in 0..result.report.choices.len() {
                draw(plot, result, choice);
            }
        });
    let shown = response.response;
    shown.widget_info(|| WidgetInfo::labeled(Role::Image, true, "Basin plot"));
    let Some(pointer) = shown.hover_pos() else { return };
    let mut nearest: Option<(f32, usize, &LevelReport)> = None;
    for (index, choice) in result.report.choices.iter().enumerate() {
        for level in &choice.levels {
            let Some(success) = level.rate.success else { continue };
            let at = PlotPoint::new(across(result, index, level), 100.0 * success);
            let distance = response.transform.position_from_point(&at).distance(pointer);
            if distance < REACH && nearest.is_none_or(|(least, ..)| distance < least) {
                nearest = Some((distance, index, level));
            }
        }
    }
    if let Some((_, index, level)) = nearest {
        let name = &result.report.choices[index].name;
        shown.on_hover_ui_at_pointer(|ui| read_out(ui, name, level));
    }
}

fn draw(plot: &mut PlotUi<'_>, result: &BasinResult, index: usize) {
    let style = run_style(index);
    let choice = &result.report.choices[index];
    let mut line = Vec::new();
    for level in choice.levels.iter().filter(|level| level.rate.tried > 0) {
        let (x, [low, high]) = (across(result, index, level), level.rate.interval.map(|end| 100.0 * end));
        let pale = style.colour.gamma_multiply(0.7);
        let bars =
            [[[x, low], [x, high]], [[x - CAP, low], [x + CAP, low]], [[x - CAP, high], [x + CAP, high]]];
        for ends in bars {
            plot.line(Line::new("", PlotPoints::from(ends.to_vec())).color(pale).width(1.0));
        }
        line.extend(level.rate.success.map(|success| [x, 100.0 * success]));
    }
    run_line(plot, line.clone(), index, style.width);
    mark_points(plot, line, PointMark::Dot, style.colour, mark::ACCEPTED_RADIUS + 0.7);
}

fn read_out(ui: &mut Ui, name: &str, level: &LevelReport) {
    let palette = theme::palette(ui);
    let off = format!("{}° and {} cm off", level.level.degrees, format::short(100.0 * level.level.metres));
    ui.label(RichText::new(format!("{name}, {off}")).color(palette.text));
    ui.label(format!("{} of {} found: {}", level.rate.found, level.rate.tried, share(level.rate.success)));
    let [low, high] = level.rate.interval.map(|end| format::number(100.0 * end, 0));
    ui.label(format!("95 % confidence interval: {low} to {high} %"));
    if let Some(median) = level.rate.median_mm {
        ui.label(format!("Median at the end: {} mm off", format::number(median, 1)));
    }
}

fn share(success: Option<f64>) -> String {
    success.map_or_else(|| format::MISSING.to_owned(), |share| percent(share) + " %")
}

fn percent(share: f64) -> String {
    format::number(100.0 * share, 0)
}

/// The counts of every level, as far as they have come: one column a choice.
fn counts(ui: &mut Ui, result: &BasinResult, starts: &RandomStarts) {
    let palette = theme::palette(ui);
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 1.0;
        for (index, choice) in result.report.choices.iter().enumerate() {
            ui.horizontal(|ui| {
                let style = run_style(index);
                let (rect, _) = ui.allocate_exact_size(vec2(20.0, size::ROW), Sense::hover());
                let ends = [rect.left_center(), rect.right_center()];
                let stroke = Stroke::new(style.width, style.colour);
                paint_run_sample(ui.painter(), ends, index, stroke, 1.0);
                ui.add(egui::Label::new(RichText::new(&choice.name).color(palette.text)).wrap());
            });
        }
        ui.add_space(space::ROW);
        for level in 0..starts.levels.len() {
            row(ui, result, starts, level);
        }
        ui.add_space(space::ROW);
        let limit = format::short(result.options.success_mm);
        let unit = if is_wide(ui, result) { "" } else { ", percent" };
        hint(ui, format!("Found{unit}: root and leaf joints end less than {limit} mm off on average."));
    });
}

/// Whether there is room for a column a choice with its unit.
fn is_wide(ui: &Ui, result: &BasinResult) -> bool {
    LEVEL + CHOICE * result.report.choices.len() as f32 <= ui.available_width()
}

/// One level: the share of each choice in its colour's order, with the counts where there is one choice alone.
fn row(ui: &mut Ui, result: &BasinResult, starts: &RandomStarts, level: usize) {
    let palette = theme::palette(ui);
    let choices = &result.report.choices;
    let (unit, column) = if is_wide(ui, result) { (" %", CHOICE) } else { ("", BARE_CHOICE) };
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
    let typed = &starts.levels[level];
    let name = format!("{}°, {} cm", typed.degrees, format::short(100.0 * typed.metres));
    let left = egui::Align2::LEFT_CENTER;
    paint_text(ui, rect.left_center(), left, &name, egui::TextStyle::Small, palette.text2);
    let mut said = name;
    for (index, choice) in choices.iter().enumerate() {
        let level = &choice.levels[level];
        let whole = level.rate.tried == starts.starts;
        let colour = if whole { palette.text } else { palette.text3 };
        let text = match (choices.len(), level.rate.tried) {
            (_, 0) => format::MISSING.to_owned(),
            (1, _) => format!("{}   {} of {}", share(level.rate.success), level.rate.found, level.rate.tried),
            _ => level.rate.success.map_or_else(|| format::MISSING.to_owned(), |share| percent(share) + unit),
        };
        said += &format!("; {}: {} of {}", choice.name, level.rate.found, level.rate.tried);
        let at = rect.left_center() + vec2(LEVEL + column * index as f32, 0.0);
        let (at, align) = if choices.len() == 1 {
            (at, left)
        } else {
            (at + vec2(column, 0.0), egui::Align2::RIGHT_CENTER)
        };
        paint_text(ui, at, align, text, egui::TextStyle::Monospace, colour);
    }
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, &said));
    response.on_hover_text(said.replace("; ", "\n"));
}
