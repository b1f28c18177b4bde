//! The plot, on the screen and in a file: curves, dots, ×, the step on the screen.

use backlit_document::run::Run;
use backlit_document::runs::StepRef;
use backlit_plot::marks::{decade_marks, even_marks, step_marks};
use backlit_ui::style::theme::data_colours::mark;
use backlit_ui::style::theme::{Palette, run_style, space};
use backlit_ui::style::{format, theme};
use backlit_ui::widgets::{
    PointMark, apart, cut_off, end_with_room, grid_marks, mark_points, run_line, still_plot,
};
use egui::{Color32, Pos2, Ui, Vec2, pos2, vec2};
use egui_plot::{GridMark, PlotPoint, PlotResponse, PlotTransform, PlotUi, Span, VLine};

use super::{ConvergencePreferences, CurvePoint, Quantity, points, quantity};

/// Room of the axis of heights.
const AXIS: f64 = 56.0;
/// Room for what stands at the ends of the curves: figures, or names and figures.
const FIGURES: f32 = 64.0;
const NAMES: f32 = 190.0;
/// What stands at the ends of curves keeps so far apart.
const LABEL_SPACING: f32 = 14.0;
/// How strong every other stage's band is.
pub(super) const STAGE: f32 = 0.10;
/// What is clear without being no colour, for which a plot would choose one.
const CLEAR: Color32 = Color32::from_rgba_premultiplied(0, 0, 0, 1);
/// Room around the curves, as a part of the axis of heights; it holds the ×.
const BELOW: f64 = 0.05;
const ABOVE: f64 = 0.09;

pub(super) struct Plot<'a> {
    pub(super) curves: Vec<RunCurve<'a>>,
    scale: PlotScale,
    /// The step on the screen.
    current: Option<(&'a Run, usize)>,
}

pub(super) struct RunCurve<'a> {
    run: &'a Run,
    points: Vec<CurvePoint>,
    /// What was expected of its steps, where that is shown.
    predicted: Vec<CurvePoint>,
}

/// Which ends the axes have, and how heights lie on theirs.
#[derive(Clone, Copy)]
struct PlotScale {
    preferences: ConvergencePreferences,
    heights: [f64; 2],
    last_step: f64,
}

impl PlotScale {
    fn of(curves: &[RunCurve<'_>], preferences: ConvergencePreferences) -> Self {
        let all = || curves.iter().flat_map(|curve| curve.points.iter().chain(&curve.predicted));
        let steps = all().map(|point| point.x).fold(0.0, f64::max);
        let is_drawn = |point: &&CurvePoint| point.accepted || preferences.rejected;
        let values = all().filter(is_drawn).map(|point| point.y);
        // A logarithm of shares near to one tells nothing.
        let is_log = preferences.is_log && !preferences.quantity.is_without_zero();
        let heights = if preferences.quantity.is_without_zero() {
            quantity::shares(values)
        } else {
            quantity::heights(values, is_log)
        };
        Self {
            preferences: ConvergencePreferences { is_log, ..preferences },
            heights,
            last_step: quantity::last_step(steps),
        }
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
        let last = end_with_room(self.last_step, width, AXIS, label_room);
        let [low, high] = self.heights.map(|end| self.y(end));
        let high_room = ABOVE * (high - low);
        [[-0.02 * last, last], [low - BELOW * (high - low), high + high_room]]
    }
}

impl<'a> Plot<'a> {
    /// The plot of those of all runs that are shown, with a mark at the step on the screen.
    pub(super) fn of(
        runs: &'a [Run],
        preferences: ConvergencePreferences,
        current: Option<(&'a Run, usize)>,
    ) -> Self {
        let curve = |run: &'a Run| {
            let has_predicted = preferences.quantity == Quantity::Decrease;
            let predicted = if has_predicted { quantity::predicted(run, runs) } else { Vec::new() };
            RunCurve { run, points: points(run, runs, preferences.quantity), predicted }
        };
        let curves: Vec<RunCurve<'_>> = runs.iter().filter(|run| run.is_shown).map(curve).collect();
        let scale = PlotScale::of(&curves, preferences);
        Self { curves, scale, current }
    }

    /// Draws it. `names` says whether the runs' names stand at the ends of their curves.
    pub(super) fn show(&self, ui: &mut Ui, area: Vec2, names: bool) -> PlotResponse<()> {
        let palette = theme::palette(ui);
        let scale = self.scale;
        let bounds = scale.bounds(f64::from(area.x), f64::from(if names { NAMES } else { FIGURES }));
        let is_log = scale.preferences.is_log;
        let response = still_plot("convergence plot", area, palette)
            .y_axis_min_width(52.0)
            .x_grid_spacer(grid_marks(step_marks))
            .y_grid_spacer(grid_marks(if is_log { decade_marks } else { even_marks }))
            .y_axis_formatter(move |mark, _| scale.mark(mark))
            .x_axis_formatter(|mark, _| format::number(mark.value, 0))
            .show(ui, |plot| {
                plot.set_plot_bounds_x(bounds[0][0]..=bounds[0][1]);
                plot.set_plot_bounds_y(bounds[1][0]..=bounds[1][1]);
                self.stages(plot, palette, bounds[0][1]);
                for curve in &self.curves {
                    let is_current = self.current.is_some_and(|(run, _)| run.number == curve.run.number);
                    draw(plot, curve, scale, is_current);
                }
                self.playhead(plot, palette);
            });
        self.labels(ui, &response.transform, names);
        response
    }

    /// The stages of the run on the screen, or of the only one, as bands.
    fn stages(&self, plot: &mut PlotUi<'_>, palette: &Palette, last: f64) {
        let is_shown = |curve: &&RunCurve<'_>| match self.current {
            Some((run, _)) => run.number == curve.run.number,
            None => self.curves.len() == 1,
        };
        let Some(curve) = self.curves.iter().find(is_shown) else { return };
        let bands: Vec<&[CurvePoint]> = curve.points.chunk_by(|one, next| one.stage == next.stage).collect();
        // The slider below says their ramps.
        for (index, band) in bands.iter().enumerate().skip(1).step_by(2) {
            let to = if index + 1 == bands.len() { last } else { band[band.len() - 1].x };
            let fill = palette.text3.gamma_multiply(STAGE);
            plot.span(Span::new("", band[0].x - 1.0..=to).fill(fill).border_color(CLEAR));
        }
    }

    fn playhead(&self, plot: &mut PlotUi<'_>, palette: &Palette) {
        let Some((run, step)) = self.current else { return };
        let Some(curve) = self.curves.iter().find(|curve| curve.run.number == run.number) else { return };
        let Some(point) = curve.points.iter().find(|point| point.step == step) else { return };
        plot.vline(VLine::new("", point.x).color(palette.accent_text).width(1.5));
        let at = vec![[point.x, self.scale.y(point.y)]];
        mark_points(plot, at, PointMark::Ring, palette.accent_text, mark::CURRENT_STEP_RADIUS);
    }

    /// What stands at the end of each curve, moved apart where curves end together.
    fn labels(&self, ui: &Ui, transform: &PlotTransform, names: bool) {
        let frame = *transform.frame();
        let mut ends: Vec<(Pos2, String, Color32)> = self
            .curves
            .iter()
            .filter_map(|curve| {
                let last = curve.points.iter().rfind(|point| point.accepted)?;
                let at = transform.position_from_point(&PlotPoint::new(last.x, self.scale.y(last.y)));
                let value = self.scale.preferences.quantity.text_of(last.y);
                let text = if names { format!("{value}  {}", curve.run.name) } else { value };
                Some((at, text, run_style(curve.run.colour).colour))
            })
            .collect();
        ends.sort_by(|a, b| a.0.y.total_cmp(&b.0.y));
        let (wanted, half): (Vec<f32>, _) = (ends.iter().map(|(at, ..)| at.y).collect(), 0.5 * LABEL_SPACING);
        let heights = apart(&wanted, LABEL_SPACING, frame.top() + half, frame.bottom() - half);
        let painter = ui.painter().with_clip_rect(frame);
        for ((at, text, colour), y) in ends.iter().zip(heights) {
            let left = pos2(at.x + space::WIDGET + 2.0, y);
            let room = (frame.right() - left.x - 2.0).max(24.0);
            let galley = cut_off(ui, text, egui::TextStyle::Small, *colour, room);
            painter.galley(left - vec2(0.0, 0.5 * galley.size().y), galley, *colour);
        }
    }

    /// The step whose mark is nearest to the pointer, and where that is.
    pub(super) fn nearest(&self, transform: &PlotTransform, pointer: Pos2) -> Option<(StepRef, Pos2)> {
        let mut best: Option<(f32, StepRef, Pos2)> = None;
        for curve in &self.curves {
            let is_drawn = |point: &&CurvePoint| point.accepted || self.scale.preferences.rejected;
            for point in curve.points.iter().filter(is_drawn) {
                let at = transform.position_from_point(&PlotPoint::new(point.x, self.scale.y(point.y)));
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
}

fn draw(plot: &mut PlotUi<'_>, curve: &RunCurve<'_>, scale: PlotScale, is_current: bool) {
    let style = run_style(curve.run.colour);
    let place = |point: &CurvePoint| [point.x, scale.y(point.y)];
    let said = curve.predicted.iter().filter(|point| point.accepted).map(place).collect();
    mark_points(plot, said, PointMark::Ring, style.colour, mark::CURRENT_STEP_RADIUS - 1.0);
    let width = if is_current { style.width + 0.25 } else { style.width };
    let is_one = |one: &CurvePoint, next: &CurvePoint| {
        !scale.preferences.quantity.is_of_stages() || one.stage == next.stage || one.step == 0
    };
    for line in curve.points.chunk_by(is_one) {
        let line: Vec<[f64; 2]> = line.iter().filter(|point| point.accepted).map(place).collect();
        run_line(plot, line.clone(), curve.run.colour, width);
        mark_points(plot, line, PointMark::Dot, style.colour, mark::ACCEPTED_RADIUS);
    }
    if scale.preferences.rejected {
        let crosses = curve.points.iter().filter(|point| !point.accepted).map(place).collect();
        mark_points(plot, crosses, PointMark::Cross, style.colour, 0.5 * mark::REJECTED_SIZE);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_branch_begins_at_its_step() {
        let first = quantity::tests::run();
        let branch_of = |number: usize, from: &Run, step: usize| {
            let mut run = Run { number, ..first.clone() };
            run.choices.branched_from = Some(StepRef { run: from.number, step });
            run
        };
        let first = Run { number: 1, is_shown: true, ..first.clone() };
        let last = first.last_step();
        let second = branch_of(2, &first, last);
        let third = branch_of(3, &second, 1);
        let runs = [first, second, third];
        let plot = Plot::of(&runs, ConvergencePreferences::default(), None);
        let starts: Vec<(f64, f64)> =
            plot.curves.iter().map(|curve| (curve.points[0].x, curve.points[0].y)).collect();
        assert_eq!(starts, [(0.0, 100.0), (last as f64, 25.0), (last as f64 + 1.0, 12.5)]);
        assert!(plot.scale.last_step >= starts[2].0 + last as f64);
    }
}
