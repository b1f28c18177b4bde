//! A figure: title, axes, curves and legend, as one picture.

use image::RgbaImage;
use vello_cpu::kurbo::{Point, Rect};

use crate::AsPicture;
use crate::colours::{CURVE_WIDTH, DOT_RADIUS, PageColours, RUNS, Theme};
use crate::marks::{self, AxisSpan};
use crate::page::{
    BODY, CENTRE_BOTTOM, CENTRE_TOP, LEFT_MIDDLE, LEFT_TOP, Page, RIGHT_MIDDLE, SMALL, TITLE, line_height,
};

/// Size of a figure.
const SIZE: [u32; 2] = [820, 460];
/// Room at the sides of the page, and above and below.
const MARGIN: [f64; 2] = [14.0, 10.0];
/// Room beside the plot for the numbers and the name of the axis that goes up, and below it for the other's.
const AXIS_ROOM: [f64; 2] = [70.0, 40.0];
/// Values on a logarithmic axis are no smaller than this part of the largest.
const LOG_RANGE: f64 = 1e-6;
/// Length of the legend's piece of a line, height of its rows, and room between its entries.
const LEGEND_LINE: f64 = 28.0;
const LEGEND_ROW: f64 = 22.0;
const LEGEND_GAP: [f64; 2] = [8.0, 20.0];
/// Room around the curves, as a part of the axis.
const PAD: f64 = 0.04;

/// One axis: its words with the unit, and how it runs.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Axis {
    /// What it counts, with the unit.
    pub label: String,
    /// Whether it is logarithmic.
    pub is_log: bool,
    /// Its ends; those of the curves where there are none.
    pub range: Option<[f64; 2]>,
}

impl Axis {
    /// An even axis as long as its curves.
    pub fn linear(label: &str) -> Self {
        Self { label: label.to_owned(), is_log: false, range: None }
    }

    /// A logarithmic axis as long as its curves.
    pub fn log(label: &str) -> Self {
        Self { label: label.to_owned(), is_log: true, range: None }
    }

    /// The same with fixed ends.
    pub fn within(mut self, low: f64, high: f64) -> Self {
        self.range = Some([low, high]);
        self
    }
}

/// One curve; where a value is not finite the curve has a gap.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Line {
    /// Its name in the legend.
    pub name: String,
    /// Points, in the order in which they are joined.
    pub points: Vec<[f64; 2]>,
    /// Index of its colour and dash ([`RUNS`]).
    pub style: usize,
    /// Upright bars: x, and both ends. They say how sure a point is.
    pub bars: Vec<[f64; 3]>,
}

impl Line {
    /// A curve of values over 0, 1, 2 …
    pub fn of_values(name: &str, style: usize, values: &[f64]) -> Self {
        Self::of_points(
            name,
            style,
            values.iter().enumerate().map(|(index, &value)| [index as f64, value]).collect(),
        )
    }

    /// A curve through points.
    pub fn of_points(name: &str, style: usize, points: Vec<[f64; 2]>) -> Self {
        Self { name: name.to_owned(), points, style, ..Self::default() }
    }

    /// The same with upright bars: x, and both ends.
    pub fn with_bars(mut self, bars: Vec<[f64; 3]>) -> Self {
        self.bars = bars;
        self
    }
}

/// A plot of curves.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Figure {
    /// What is shown.
    pub title: String,
    /// The conditions, in one line.
    pub subtitle: String,
    /// Across.
    pub x: Axis,
    /// Up.
    pub y: Axis,
    /// The curves, first ones lowest.
    pub lines: Vec<Line>,
}

impl AsPicture for Figure {
    fn picture(&self, theme: Theme) -> RgbaImage {
        let colours = theme.page();
        let mut page = Page::new(SIZE, colours.panel);
        let [left, top] = MARGIN;
        let [width, height] = SIZE.map(f64::from);
        page.text(Point::new(left, top), LEFT_TOP, &self.title, TITLE, colours.text);
        page.text(Point::new(left, top + 25.0), LEFT_TOP, &self.subtitle, BODY, colours.text2);
        let legend_bottom = self.legend(&mut page, Point::new(left, top + 46.0), colours);
        let [beside, below] = AXIS_ROOM;
        let area = Rect::new(left + beside, legend_bottom + 8.0, width - left, height - top - below);
        let scales = [self.scale(0), self.scale(1)];
        page.fill(area, colours.plot);
        self.axes(&mut page, area, &scales, colours);
        self.lines.iter().for_each(|line| draw(&mut page, line, area, &scales));
        page.finish()
    }
}

/// How values lie on an axis.
struct Scale {
    is_log: bool,
    /// The value that counts as the least of a logarithmic axis.
    floor: f64,
    /// Ends of the axis as it is drawn, as places.
    ends: [f64; 2],
}

impl Scale {
    /// Where a value lies on the axis.
    fn place(&self, value: f64) -> f64 {
        if self.is_log { value.max(self.floor).log10() } else { value }
    }
}

/// Where a place on the axes lies on the page.
fn on_page(area: Rect, scales: &[Scale; 2], place: [f64; 2]) -> Point {
    let share = [0, 1].map(|which| {
        let [low, high] = scales[which].ends;
        (place[which] - low) / (high - low)
    });
    Point::new(area.x0 + share[0] * area.width(), area.y1 - share[1] * area.height())
}

impl Figure {
    /// Grid, numbers and names of both axes.
    fn axes(&self, page: &mut Page, area: Rect, scales: &[Scale; 2], colours: &PageColours) {
        for (which, length) in [area.width(), area.height()].into_iter().enumerate() {
            let Scale { is_log, ends: [low, high], .. } = scales[which];
            let span = AxisSpan { bounds: (low, high), division: marks::DIVISION * (high - low) / length };
            let marks = if is_log { marks::decade_marks(span) } else { marks::even_marks(span) };
            for mark in marks {
                let mut place = [scales[0].ends[0], scales[1].ends[0]];
                place[which] = mark.value;
                let low_end = on_page(area, scales, place);
                let at = if which == 0 { low_end.x } else { low_end.y }.floor() + 0.5;
                let value = if is_log { 10f64.powf(mark.value) } else { mark.value };
                let text = marks::number(value, if is_log { value } else { mark.step });
                let (from, to, name_at, anchor) = if which == 0 {
                    let below = Point::new(at, area.y1 + 4.0);
                    (Point::new(at, area.y0), Point::new(at, area.y1), below, CENTRE_TOP)
                } else {
                    let beside = Point::new(area.x0 - 6.0, at);
                    (Point::new(area.x0, at), Point::new(area.x1, at), beside, RIGHT_MIDDLE)
                };
                page.hairline(from, to, colours.grid);
                page.text(name_at, anchor, &text, SMALL, colours.text2);
            }
        }
        let bottom = Point::new(area.center().x, f64::from(SIZE[1]) - MARGIN[1]);
        page.text(bottom, CENTRE_BOTTOM, &self.x.label, BODY, colours.text);
        let beside = Point::new(MARGIN[0] + 0.5 * line_height(BODY), area.center().y);
        page.text_up(beside, &self.y.label, BODY, colours.text);
    }

    /// The curves' names, each behind a piece of its line. Returns where the legend ends.
    fn legend(&self, page: &mut Page, from: Point, colours: &PageColours) -> f64 {
        let mut at = from;
        for line in &self.lines {
            let width = LEGEND_LINE + LEGEND_GAP[0] + page.text_width(&line.name, BODY);
            if at.x + width > f64::from(SIZE[0]) - MARGIN[0] && at.x > from.x {
                at = Point::new(from.x, at.y + LEGEND_ROW);
            }
            let (colour, stroke) = style(line.style);
            let y = at.y + 0.5 * LEGEND_ROW;
            let ends = [Point::new(at.x, y), Point::new(at.x + LEGEND_LINE, y)];
            page.curve(&ends, stroke, colour);
            page.dot(ends[0].midpoint(ends[1]), DOT_RADIUS, colour);
            let name_at = Point::new(at.x + LEGEND_LINE + LEGEND_GAP[0], y);
            page.text(name_at, LEFT_MIDDLE, &line.name, BODY, colours.text);
            at.x += width + LEGEND_GAP[1];
        }
        at.y + if self.lines.is_empty() { 0.0 } else { LEGEND_ROW }
    }

    fn scale(&self, which: usize) -> Scale {
        let axis = if which == 0 { &self.x } else { &self.y };
        let points = || self.lines.iter().flat_map(|line| &line.points);
        let values = || points().map(move |point| point[which]).filter(|value| value.is_finite());
        let largest = values().fold(f64::MIN_POSITIVE, f64::max);
        let floor = axis.range.map_or(largest * LOG_RANGE, |[low, _]| low.max(f64::MIN_POSITIVE));
        let mut scale = Scale { is_log: axis.is_log, floor, ends: [f64::INFINITY, f64::NEG_INFINITY] };
        let ends = match axis.range {
            Some(range) => range.map(|end| scale.place(end)),
            None => values()
                .map(|value| scale.place(value))
                .fold(scale.ends, |[low, high], value| [low.min(value), high.max(value)]),
        };
        let [low, high] =
            if ends[0] < ends[1] { ends } else { [-0.5, 0.5].map(|half| half + scale.place(1.0)) };
        let pad = PAD * (high - low);
        scale.ends = [low - pad, high + pad];
        scale
    }
}

fn draw(page: &mut Page, line: &Line, area: Rect, scales: &[Scale; 2]) {
    let (colour, stroke) = style(line.style);
    let place =
        |point: &[f64; 2]| on_page(area, scales, [0, 1].map(|which| scales[which].place(point[which])));
    for &[x, low, high] in &line.bars {
        page.curve(&[[x, low], [x, high]].map(|end| place(&end)), (1.0, &[]), colour);
    }
    for piece in line.points.split(|point| !(point[0].is_finite() && point[1].is_finite())) {
        let points: Vec<Point> = piece.iter().map(place).collect();
        page.curve(&points, stroke, colour);
        points.iter().for_each(|point| page.dot(*point, DOT_RADIUS, colour));
    }
}

/// Colour, width and dash of the curve of this index. From the seventh on the list is reused with a thinner line.
fn style(index: usize) -> (u32, (f32, &'static [f32])) {
    let (colour, dash) = RUNS[index % RUNS.len()];
    (colour, (if index < RUNS.len() { CURVE_WIDTH } else { 1.0 }, dash))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colours::rgb;

    fn figure() -> Figure {
        Figure {
            title: "Cost".to_owned(),
            subtitle: "one limb".to_owned(),
            x: Axis::linear("iteration"),
            y: Axis::log("cost, % of the start"),
            lines: vec![
                Line::of_values("falls", 0, &[100.0, 10.0, 0.0, f64::NAN, 5.0]),
                Line::of_values("stays", 1, &[100.0; 5]),
            ],
        }
    }

    fn count(picture: &RgbaImage, style: usize) -> usize {
        let colour = rgb(RUNS[style].0);
        picture.pixels().filter(|p| (0..3).all(|channel| p[channel].abs_diff(colour[channel]) < 12)).count()
    }

    #[test]
    fn every_curve_is_drawn_in_its_colour_in_both_themes() {
        for theme in Theme::ALL {
            let picture = figure().picture(theme);
            for style in [0, 1] {
                let pixels = count(&picture, style);
                assert!(pixels > 50, "{theme:?}, curve {style}: {pixels} pixels");
            }
            assert_eq!(count(&picture, 2), 0);
        }
    }

    #[test]
    fn the_same_figure_is_the_same_picture_and_nothing_is_no_trouble() {
        assert_eq!(figure().picture(Theme::Light), figure().picture(Theme::Light));
        let empty = Figure { lines: Vec::new(), ..figure() };
        assert!(empty.scale(1).ends.iter().all(|end| end.is_finite()));
        let _ = empty.picture(Theme::Dark);
    }
}
