//! The convergence plot as a picture.

use backlit_ui::drawing::plot::{Axis, Figure, Line};

use super::quantity::foretold;
use super::{ConvergencePreferences, CurvePoint, Quantity, axis, points};
use crate::document::run::Run;

/// A rejected step's × stands so much above the one below it: a factor on a logarithmic axis, a part of the axis on
/// an even one.
const STACK: f64 = 0.035;

/// The plot of the runs that are shown, as the window has it.
pub(crate) fn figure(runs: &[Run], preferences: ConvergencePreferences, title: &str) -> Figure {
    let shown: Vec<&Run> = runs.iter().filter(|run| run.is_shown).collect();
    let quantity = preferences.quantity;
    let ends = heights(&shown, preferences);
    let mut lines: Vec<Line> = Vec::with_capacity(shown.len());
    for run in &shown {
        let (accepted, rejected): (Vec<CurvePoint>, Vec<CurvePoint>) =
            points(run, quantity).into_iter().partition(|point| point.accepted);
        let place = |point: &CurvePoint| [point.x, point.y];
        let name = format!("{}: {}", run.name, run.reached_text());
        let mut line = Line::of_points(&name, run.colour, accepted.iter().map(place).collect());
        if preferences.rejected {
            line = line.with_crosses(
                rejected.iter().map(|point| stacked(point, ends, preferences.is_log)).collect(),
            );
        }
        lines.push(line);
        if quantity == Quantity::Decrease {
            lines.push(Line::of_points("", run.colour, foretold(run).iter().map(place).collect()).faint());
        }
    }
    let axis = if preferences.is_log { Axis::log(&label(quantity)) } else { Axis::linear(&label(quantity)) };
    let subtitle =
        if preferences.rejected { "accepted steps are dots, rejected ones ×" } else { "accepted steps" };
    Figure {
        title: title.to_owned(),
        subtitle: subtitle.to_owned(),
        x: Axis::linear("accepted step").within(0.0, axis::last_step(most_steps(&shown))),
        y: axis.within(ends[0], ends[1]),
        lines,
    }
}

/// Most accepted steps of a run.
pub(crate) fn most_steps(runs: &[&Run]) -> f64 {
    runs.iter().map(|run| run.accepted_until(run.last_step()) as f64).fold(0.0, f64::max)
}

/// Ends of the axis of heights, of all that is plotted.
pub(crate) fn heights(runs: &[&Run], preferences: ConvergencePreferences) -> [f64; 2] {
    let own = runs.iter().flat_map(|run| points(run, preferences.quantity));
    let said =
        runs.iter().filter(|_| preferences.quantity == Quantity::Decrease).flat_map(|run| foretold(run));
    let is_drawn = |point: &CurvePoint| point.accepted || preferences.rejected;
    axis::heights(own.chain(said).filter(is_drawn).map(|point| point.y), preferences.is_log)
}

fn stacked(point: &CurvePoint, [low, high]: [f64; 2], is_log: bool) -> [f64; 2] {
    let up = STACK * point.stacked as f64;
    let y = if is_log { point.y * (high / low).powf(up) } else { point.y + up * (high - low) };
    // Those of a quantity of their own stand where they are.
    if point.x.fract() == 0.0 { [point.x, y.min(high)] } else { [point.x, point.y] }
}

fn label(quantity: Quantity) -> String {
    let text = match quantity {
        Quantity::Percent => "cost, % of the start",
        Quantity::Cost => "cost, squared grey levels",
        Quantity::Rms => "RMS, grey levels",
        Quantity::StepNorm => "step, m and rad",
        Quantity::Damping => "damping, parts of the mean diagonal",
        Quantity::Decrease => "decrease, % of the cost before; foretold thin",
    };
    text.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use backlit_ui::style::theme::Theme;

    #[test]
    fn the_figure_has_a_curve_a_shown_run_and_its_rejected_steps() {
        let run = crate::features::convergence::quantity::tests::run();
        let hidden = Run { is_shown: false, ..run.clone() };
        let runs = [run, hidden];
        let made = figure(&runs, ConvergencePreferences::default(), "Robust");
        assert_eq!((made.lines.len(), made.lines[0].points.len(), made.lines[0].crosses.len()), (1, 3, 2));
        assert!(made.lines[0].crosses[1][1] > made.lines[0].crosses[0][1]);
        assert!(made.lines[0].name.starts_with("Robust: 4 steps, 25.0 % of the start"));
        let without = ConvergencePreferences {
            rejected: false,
            quantity: Quantity::Decrease,
            ..ConvergencePreferences::default()
        };
        let made = figure(&runs, without, "Robust");
        assert_eq!((made.lines.len(), made.lines[0].crosses.len()), (2, 0));
        let _ = made.picture(Theme::Light);
    }
}
