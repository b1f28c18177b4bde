//! Curves of runs: their pieces of a line beside names, their lines and points in a plot, and words at their ends.

use egui::{Painter, Pos2, Shape, Stroke};
use egui_plot::{Line, LineStyle, MarkerShape, PlotPoints, PlotUi, Points};

use crate::style::theme::run_style;

/// Paints a piece of the line of the run of this index; the gaps of a dashed one are `gap` times as long as its dashes.
pub fn paint_run_sample(painter: &Painter, ends: [Pos2; 2], index: usize, stroke: Stroke, gap: f32) {
    match run_style(index).dash {
        [] => drop(painter.line_segment(ends, stroke)),
        [length, ..] => painter.extend(Shape::dashed_line(&ends, stroke, *length, *length * gap)),
    }
}

/// Draws the line of the run of this index through points of the plot.
pub fn run_line(plot: &mut PlotUi<'_>, points: Vec<[f64; 2]>, index: usize, width: f32) {
    let style = run_style(index);
    let dash = match style.dash {
        [] => LineStyle::Solid,
        [length, ..] => LineStyle::Dashed { length: *length },
    };
    plot.line(Line::new("", PlotPoints::from(points)).color(style.colour).width(width).style(dash));
}

/// How a point of a curve is marked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PointMark {
    /// A dot.
    Dot,
    /// A ×.
    Cross,
    /// A ring.
    Ring,
}

/// Draws points of the plot.
pub fn mark_points(
    plot: &mut PlotUi<'_>,
    points: Vec<[f64; 2]>,
    mark: PointMark,
    colour: egui::Color32,
    radius: f32,
) {
    let shape = if mark == PointMark::Cross { MarkerShape::Cross } else { MarkerShape::Circle };
    let points = Points::new("", PlotPoints::from(points)).color(colour).radius(radius);
    plot.points(points.shape(shape).filled(mark != PointMark::Ring));
}

/// The end of the axis of steps that leaves points at its right for what stands at the ends of the curves: of `width`
/// points in all, `axis` are the numbers of the other axis, and the curves keep some.
pub fn end_with_room(last: f64, width: f64, axis: f64, room: f64) -> f64 {
    /// The least that is left for the curves.
    const LEAST_CURVES: f64 = 120.0;
    let all = (width - axis).max(room + LEAST_CURVES);
    last * all / (all - room)
}

/// Heights as near to the wanted ones, which are sorted, as they can be with room between them.
pub fn apart(wanted: &[f32], spacing: f32, top: f32, bottom: f32) -> Vec<f32> {
    let mut heights: Vec<f32> = Vec::with_capacity(wanted.len());
    for height in wanted {
        let least = heights.last().map_or(top, |last| last + spacing);
        heights.push(height.max(least));
    }
    let mut most = bottom;
    for height in heights.iter_mut().rev() {
        *height = height.min(most);
        most = *height - spacing;
    }
    heights
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_keep_apart_and_within_the_plot() {
        for (wanted, spacing, heights) in [
            (vec![10.0, 50.0], 17.0, vec![10.0, 50.0]),
            (vec![96.0, 97.0, 98.0], 17.0, vec![66.0, 83.0, 100.0]),
            (vec![-5.0, 1.0], 17.0, vec![0.0, 17.0]),
            (vec![20.0, 22.0, 23.0], 14.0, vec![20.0, 34.0, 48.0]),
        ] {
            assert_eq!(apart(&wanted, spacing, 0.0, 100.0), heights, "{wanted:?}");
        }
    }
}
