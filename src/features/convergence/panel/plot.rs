//! The plot: curves, dots, ×, the step on the screen, and what a click goes to.

use backlit_ui::drawing::plot::marks::{decade_marks, even_marks, step_marks};
use backlit_ui::style::format;
use backlit_ui::style::theme;
use backlit_ui::style::theme::data_colours::mark;
use backlit_ui::style::theme::{Palette, run_style, size, space};
use backlit_ui::widgets::still_plot;
use egui::{Pos2, Rect, RichText, Role, Ui, Vec2, WidgetInfo, pos2, vec2};
use egui_plot::{
    GridMark, Line, LineStyle, MarkerShape, PlotPoint, PlotPoints, PlotTransform, PlotUi, Points, VLine,
};

use super::read_out;
use crate::context::{Context, Request, Requests};
use crate::document::run::Run;
use crate::document::runs::StepRef;
use crate::features::convergence::{
    ConvergencePreferences, CurvePoint, Quantity, axis, picture, points, quantity,
};

/// Room of the axis of heights, and the least that is left for the curves.
const AXIS: f64 = 56.0;
const LEAST_CURVES: f64 = 120.0;
/// Room for what stands at the ends of the curves: figures, or names and figures.
const FIGURES: f32 = 64.0;
const NAMES: f32 = 190.0;
/// What stands at the ends of curves keeps so far apart.
const LABEL_SPACING: f32 = 14.0;
/// Room around the curves, as a part of the axis of heights; it holds the ×.
const BELOW: f64 = 0.05;
const ABOVE: f64 = 0.09;
/// A step is read out when the pointer is so near to its dot.
const REACH: f32 = 40.0;

/// A run's curve, ready to be drawn.
struct Curve<'a> {
    run: &'a Run,
    points: Vec<CurvePoint>,
}

/// Which ends the axes have, and how heights lie on theirs.
#[derive(Clone, Copy)]
struct Scale {
    preferences: ConvergencePreferences,
    heights: [f64; 2],
    last_step: f64,
}

impl Scale {
    fn of(runs: &[&Run], preferences: ConvergencePreferences) -> Self {
        let last_step = axis::last_step(picture::most_steps(runs));
        Self { preferences, heights: picture::heights(runs, preferences), last_step }
    }

    /// Height in the plot of a value; what is too small for a logarithmic axis lies at its end.
    fn y(&self, value: f64) -> f64 {
        if self.preferences.is_log { value.max(self.heights[0]).log10() } else { value }
    }

    /// What stands at a mark of the axis.
    fn mark(&self, mark: GridMark) -> String {
        let unit = if matches!(self.preferences.quantity, Quantity::Percent | Quantity::Decrease) {
            " %"
        } else {
            ""
        };
        if self.preferences.quantity == Quantity::Cost {
            let value = if self.preferences.is_log { 10f64.powf(mark.value) } else { mark.value };
            self.preferences.quantity.text_of(value)
        } else if self.preferences.is_log {
            format!("{}{unit}", format::short(10f64.powf(mark.value)))
        } else {
            let decimals = (-mark.step_size.log10().floor()).clamp(0.0, 6.0) as usize;
            format!("{}{unit}", format::number(mark.value, decimals))
        }
    }

    fn bounds(&self, width: f64, label_room: f64) -> [[f64; 2]; 2] {
        let room = (width - AXIS).max(label_room + LEAST_CURVES);
        let last = self.last_step * room / (room - label_room);
        let [low, high] = self.heights.map(|end| self.y(end));
        let high_room = ABOVE * (high - low);
        [[-0.02 * last, last], [low - BELOW * (high - low), high + high_room]]
    }
}

/// The plot. `names` says whether the runs' names stand at the ends of their curves.
pub(super) fn ui(
    ui: &mut Ui,
    context: &Context<'_>,
    preferences: ConvergencePreferences,
    requests: &mut Requests,
    area: Vec2,
    names: bool,
) {
    let palette = theme::palette(ui);
    let runs: Vec<&Run> = context.runs().all().iter().filter(|run| run.is_shown).collect();
    if runs.is_empty() {
        return empty(ui, context, area);
    }
    let scale = Scale::of(&runs, preferences);
    let curves: Vec<Curve<'_>> =
        runs.iter().map(|run| Curve { run, points: points(run, preferences.quantity) }).collect();
    let current = context.selection.step.or_else(|| newest(context));
    let bounds = scale.bounds(f64::from(area.x), f64::from(if names { NAMES } else { FIGURES }));
    let response = still_plot("convergence plot", area, palette)
        .y_axis_min_width(52.0)
        .x_grid_spacer(step_marks)
        .y_grid_spacer(move |input| if preferences.is_log { decade_marks(input) } else { even_marks(input) })
        .y_axis_formatter(move |mark, _| scale.mark(mark))
        .x_axis_formatter(|mark, _| format::number(mark.value, 0))
        .show(ui, |plot| {
            plot.set_plot_bounds_x(bounds[0][0]..=bounds[0][1]);
            plot.set_plot_bounds_y(bounds[1][0]..=bounds[1][1]);
            for curve in &curves {
                let is_current = current.is_some_and(|step| step.run == curve.run.number);
                draw(plot, curve, scale, is_current);
            }
            if let Some(step) = current {
                playhead(plot, context, &curves, step, scale, palette);
            }
        });
    let ground = *response.transform.frame();
    labels(ui, &curves, scale, &response.transform, names);
    let response_of_plot = response.response;
    response_of_plot.widget_info(|| WidgetInfo::labeled(Role::Image, true, "Convergence plot"));
    let pointer = response_of_plot.hover_pos().or_else(|| response_of_plot.interact_pointer_pos());
    let Some(pointer) = pointer.filter(|pointer| ground.contains(*pointer)) else { return };
    let Some((step, at)) = nearest(&curves, scale, &response.transform, pointer) else { return };
    if response_of_plot.clicked() {
        requests.request(Request::Step(step));
    }
    if at.distance(pointer) <= REACH {
        let ring = egui::Stroke::new(1.5, palette.text);
        ui.painter().circle_stroke(at, mark::CURRENT_STEP_RADIUS, ring);
        read_out::show(ui, context, step, at, ground);
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
    let font = egui::TextStyle::Body.resolve(ui.style());
    ui.painter().text(rect.center(), egui::Align2::CENTER_CENTER, text, font, palette.text3);
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, text));
}

/// The last step of the newest run of the frame.
fn newest(context: &Context<'_>) -> Option<StepRef> {
    let run = context.run()?;
    Some(StepRef { run: run.number, step: run.steps.len().checked_sub(1)? })
}

fn draw(plot: &mut PlotUi<'_>, curve: &Curve<'_>, scale: Scale, is_current: bool) {
    let style = run_style(curve.run.colour);
    let dash = match style.dash {
        [] => LineStyle::Solid,
        [length, ..] => LineStyle::Dashed { length: *length },
    };
    let place = |point: &CurvePoint| [point.x, scale.y(point.y)];
    if scale.preferences.quantity == Quantity::Decrease {
        let said: Vec<[f64; 2]> =
            quantity::foretold(curve.run).iter().filter(|p| p.accepted).map(place).collect();
        let rings = Points::new("", PlotPoints::from(said)).color(style.colour).filled(false);
        plot.points(rings.radius(mark::CURRENT_STEP_RADIUS - 1.0).shape(MarkerShape::Circle));
    }
    let line: Vec<[f64; 2]> = curve.points.iter().filter(|point| point.accepted).map(place).collect();
    let width = if is_current { style.width + 0.25 } else { style.width };
    plot.line(Line::new("", PlotPoints::from(line.clone())).color(style.colour).width(width).style(dash));
    let dots = Points::new("", PlotPoints::from(line)).color(style.colour).radius(mark::ACCEPTED_RADIUS);
    plot.points(dots.shape(MarkerShape::Circle).filled(true));
    if scale.preferences.rejected {
        let frame = plot.response().rect;
        let crosses: Vec<[f64; 2]> = curve
            .points
            .iter()
            .filter(|point| !point.accepted)
            .map(|point| {
                let screen = plot.screen_from_plot(PlotPoint::new(point.x, scale.y(point.y)));
                let at = plot.plot_from_screen(cross_at(point, scale, screen, frame));
                [at.x, at.y]
            })
            .collect();
        let points = Points::new("", PlotPoints::from(crosses)).color(style.colour);
        plot.points(points.radius(0.5 * mark::REJECTED_SIZE).shape(MarkerShape::Cross));
    }
}

/// Where a rejected step's × stands: stacked upwards above the last accepted dot, unless it has a value of its own.
fn cross_at(point: &CurvePoint, scale: Scale, on_screen: Pos2, frame: Rect) -> Pos2 {
    if scale.preferences.quantity.is_of_trials() {
        return on_screen;
    }
    let y = on_screen.y - mark::REJECTED_SPACING * point.stacked as f32;
    pos2(on_screen.x, y.max(frame.top() + 0.5 * mark::REJECTED_SIZE))
}

fn playhead(
    plot: &mut PlotUi<'_>,
    context: &Context<'_>,
    curves: &[Curve<'_>],
    step: StepRef,
    scale: Scale,
    palette: &Palette,
) {
    let Some(run) = context.runs().get(step.run) else { return };
    let x = run.accepted_until(step.step) as f64;
    plot.vline(VLine::new("", x).color(palette.accent_text).width(1.5));
    let curve = curves.iter().find(|curve| curve.run.number == step.run);
    let Some(point) = curve.and_then(|curve| curve.points.iter().find(|p| p.step == step.step)) else {
        return;
    };
    let at = vec![[point.x, scale.y(point.y)]];
    let ring = Points::new("", PlotPoints::from(at)).color(palette.accent_text).filled(false);
    plot.points(ring.radius(mark::CURRENT_STEP_RADIUS));
}

/// What stands at the end of each curve, moved apart where curves end together.
fn labels(ui: &Ui, curves: &[Curve<'_>], scale: Scale, transform: &PlotTransform, names: bool) {
    let frame = *transform.frame();
    let mut ends: Vec<(Pos2, String, egui::Color32)> = curves
        .iter()
        .filter_map(|curve| {
            let last = curve.points.iter().rfind(|point| point.accepted)?;
            let at = transform.position_from_point(&PlotPoint::new(last.x, scale.y(last.y)));
            let value = scale.preferences.quantity.text_of(last.y);
            let text = if names { format!("{value}  {}", curve.run.name) } else { value };
            Some((at, text, run_style(curve.run.colour).colour))
        })
        .collect();
    ends.sort_by(|a, b| a.0.y.total_cmp(&b.0.y));
    let heights = apart(&ends.iter().map(|(at, ..)| at.y).collect::<Vec<_>>(), frame.y_range());
    let painter = ui.painter().with_clip_rect(frame);
    for ((at, text, colour), y) in ends.iter().zip(heights) {
        let left = pos2(at.x + space::WIDGET + 2.0, y);
        let font = egui::TextStyle::Small.resolve(ui.style());
        let mut job = egui::text::LayoutJob::simple_singleline(text.clone(), font, *colour);
        job.wrap = egui::text::TextWrapping::truncate_at_width((frame.right() - left.x - 2.0).max(24.0));
        let galley = painter.layout_job(job);
        painter.galley(left - vec2(0.0, 0.5 * galley.size().y), galley, *colour);
    }
}

/// The same heights in the same order, each at least a line from the one before.
fn apart(sorted: &[f32], range: egui::Rangef) -> Vec<f32> {
    let half = 0.5 * LABEL_SPACING;
    let mut heights: Vec<f32> = Vec::with_capacity(sorted.len());
    for &y in sorted {
        let least = heights.last().map_or(range.min + half, |above| above + LABEL_SPACING);
        heights.push(y.max(least));
    }
    let mut most = range.max - half;
    for y in heights.iter_mut().rev() {
        *y = y.min(most);
        most = *y - LABEL_SPACING;
    }
    heights
}

/// The step whose mark is nearest to the pointer, and where that is.
fn nearest(
    curves: &[Curve<'_>],
    scale: Scale,
    transform: &PlotTransform,
    pointer: Pos2,
) -> Option<(StepRef, Pos2)> {
    let mut best: Option<(f32, StepRef, Pos2)> = None;
    for curve in curves {
        for point in curve.points.iter().filter(|point| point.accepted || scale.preferences.rejected) {
            let mut at = transform.position_from_point(&PlotPoint::new(point.x, scale.y(point.y)));
            if !point.accepted {
                at = cross_at(point, scale, at, *transform.frame());
            }
            let away = at - pointer;
            // Time runs across: what lies beneath the pointer counts more than what lies beside it.
            let distance = away.x.abs() * 3.0 + away.y.abs();
            if best.is_none_or(|(least, ..)| distance < least) {
                best = Some((distance, StepRef { run: curve.run.number, step: point.step }, at));
            }
        }
    }
    best.map(|(_, step, at)| (step, at))
}

/// The number of a step's run and its place, as the read-out has it.
pub(crate) fn step_title(run: &Run, step: usize) -> RichText {
    let stage = run.steps.get(step).and_then(|record| run.stages.get(record.stage));
    let stage = stage.filter(|_| run.stages.len() > 1).map_or_else(String::new, |s| format!(", ramp {s} px"));
    RichText::new(format!("Step {step}{stage}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_keep_apart_and_inside() {
        let range = egui::Rangef::new(0.0, 100.0);
        assert_eq!(apart(&[20.0, 60.0], range), [20.0, 60.0]);
        assert_eq!(apart(&[20.0, 22.0, 23.0], range), [20.0, 34.0, 48.0]);
        assert_eq!(apart(&[92.0, 95.0], range), [79.0, 93.0]);
    }
}
