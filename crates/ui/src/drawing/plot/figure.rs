//! A figure: title, axes, curves and legend, as one picture.

use egui::{CentralPanel, Frame, Margin, RichText, Sense, Shape, Stroke, Ui, vec2};
use egui_painter::Headless;
use egui_plot::{GridInput, LineStyle, MarkerShape, Plot, PlotPoints, PlotUi, Points};
use image::RgbaImage;

use super::{marks, png};
use crate::style::theme;
use crate::style::theme::data_colours::mark;
use crate::style::theme::{Palette, Theme, run_style};

/// Size of a figure, points; a pixel each.
const SIZE: [f32; 2] = [820.0, 460.0];
/// Values on a logarithmic axis are no smaller than this part of the largest.
const LOG_RANGE: f64 = 1e-6;
/// Length of the legend's piece of a line.
const SAMPLE: f32 = 28.0;
/// A dash's gap, as a part of the dash: the plot's own.
const DASH_GAP: f32 = 0.618;
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

    /// The value that counts as the least of a logarithmic axis.
    fn floor(&self, values: impl Iterator<Item = f64>) -> f64 {
        let largest = values.fold(f64::MIN_POSITIVE, f64::max);
        self.range.map_or(largest * LOG_RANGE, |[low, _]| low.max(f64::MIN_POSITIVE))
    }
}

/// One curve; where a value is not finite the curve has a gap.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Line {
    /// Its name in the legend.
    pub name: String,
    /// Points, in the order in which they are joined.
    pub points: Vec<[f64; 2]>,
    /// Index of its colour and dash ([`run_style`]).
    pub style: usize,
    /// Upright bars: x, and both ends. They say how sure a point is.
    pub bars: Vec<[f64; 3]>,
    /// Whether it is drawn thin and without dots: one of many that a thick curve stands for. It has no name in
    /// the legend.
    pub is_faint: bool,
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

    /// The same, drawn as one of many.
    pub fn faint(mut self) -> Self {
        self.is_faint = true;
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

impl Figure {
    /// The figure as a picture. The same figure gives the same bytes.
    pub fn picture(&self, theme: Theme) -> RgbaImage {
        let mut window = Headless::new(SIZE[0], SIZE[1], 1.0);
        theme::apply(&window.ctx, theme);
        let palette = theme.palette();
        window.frames(4, Vec::new(), |ui| {
            let frame = Frame::NONE.fill(palette.panel).inner_margin(Margin::symmetric(14, 10));
            CentralPanel::default().frame(frame).show(ui, |ui| self.ui(ui, palette));
        })
    }

    /// The picture as the bytes of a PNG file.
    ///
    /// # Errors
    /// None that is known: the picture is small.
    pub fn png(&self, theme: Theme) -> image::ImageResult<Vec<u8>> {
        png(self.picture(theme))
    }

    fn ui(&self, ui: &mut Ui, palette: &Palette) {
        ui.label(RichText::new(&self.title).text_style(theme::title()).color(palette.text));
        ui.label(RichText::new(&self.subtitle).color(palette.text2));
        self.legend(ui, palette);
        let floors = [self.floor(0), self.floor(1)];
        let ranges = [self.range(0, floors[0]), self.range(1, floors[1])];
        let (x_log, y_log) = (self.x.is_log, self.y.is_log);
        let spacer = |is_log: bool| {
            move |input: GridInput| if is_log { marks::decade_marks(input) } else { marks::even_marks(input) }
        };
        let text = |is_log: bool, value: f64, step: f64| {
            if is_log {
                let value = 10f64.powf(value);
                marks::number(value, value)
            } else {
                marks::number(value, step)
            }
        };
        Plot::new("figure")
            .allow_drag(false)
            .allow_zoom(false)
            .allow_scroll(false)
            .show_crosshair(false)
            .grid_color(palette.grid)
            .y_axis_min_width(48.0)
            .x_axis_label(RichText::new(&self.x.label).color(palette.text))
            .y_axis_label(RichText::new(&self.y.label).color(palette.text))
            .x_grid_spacer(spacer(x_log))
            .y_grid_spacer(spacer(y_log))
            .x_axis_formatter(move |mark, _| text(x_log, mark.value, mark.step_size))
            .y_axis_formatter(move |mark, _| text(y_log, mark.value, mark.step_size))
            .show(ui, |plot| {
                plot.set_plot_bounds_x(ranges[0][0]..=ranges[0][1]);
                plot.set_plot_bounds_y(ranges[1][0]..=ranges[1][1]);
                self.lines.iter().for_each(|line| self.draw(plot, line, floors));
            });
    }

    /// The curves' names, each behind a piece of its line.
    fn legend(&self, ui: &mut Ui, palette: &Palette) {
        ui.horizontal_wrapped(|ui| {
            for line in self.lines.iter().filter(|line| !line.is_faint) {
                // A name stays beside its piece of line.
                let font = egui::TextStyle::Body.resolve(ui.style());
                let name = ui.painter().layout_no_wrap(line.name.clone(), font, palette.text);
                if ui.available_size_before_wrap().x < SAMPLE + theme::space::WIDGET + name.size().x {
                    ui.end_row();
                }
                let (rect, _) = ui.allocate_exact_size(vec2(SAMPLE, theme::size::ROW), Sense::hover());
                let style = run_style(line.style);
                let stroke = Stroke::new(style.width, style.colour);
                let ends = [rect.left_center(), rect.right_center()];
                match style.dash {
                    [] => drop(ui.painter().line_segment(ends, stroke)),
                    [length, ..] => {
                        let dashes = Shape::dashed_line(&ends, stroke, *length, *length * DASH_GAP);
                        ui.painter().extend(dashes);
                    }
                }
                ui.painter().circle_filled(rect.center(), mark::ACCEPTED_RADIUS, style.colour);
                ui.label(name);
                ui.add_space(theme::space::GROUP);
            }
        });
    }

    fn axis(&self, which: usize) -> &Axis {
        if which == 0 { &self.x } else { &self.y }
    }

    fn values(&self, which: usize) -> impl Iterator<Item = f64> {
        let points = self.lines.iter().flat_map(|line| &line.points);
        points.map(move |point| point[which]).filter(|value| value.is_finite())
    }

    fn floor(&self, which: usize) -> f64 {
        self.axis(which).floor(self.values(which))
    }

    /// Where a value lies on its axis.
    fn place(&self, which: usize, value: f64, floor: f64) -> f64 {
        if self.axis(which).is_log { value.max(floor).log10() } else { value }
    }

    /// Ends of an axis as it is drawn.
    fn range(&self, which: usize, floor: f64) -> [f64; 2] {
        let place = |value| self.place(which, value, floor);
        let ends = match self.axis(which).range {
            Some([low, high]) => [place(low), place(high)],
            None => self.values(which).map(place).fold([f64::INFINITY, f64::NEG_INFINITY], |ends, value| {
                [ends[0].min(value), ends[1].max(value)]
            }),
        };
        let [low, high] = if ends[0] < ends[1] { ends } else { [-0.5, 0.5].map(|half| half + place(1.0)) };
        let pad = PAD * (high - low);
        [low - pad, high + pad]
    }

    fn draw(&self, plot: &mut PlotUi<'_>, line: &Line, floors: [f64; 2]) {
        let style = run_style(line.style);
        let dash = match style.dash {
            [] => LineStyle::Solid,
            [length, ..] => LineStyle::Dashed { length: *length },
        };
        let place = |point: &[f64; 2]| [0, 1].map(|which| self.place(which, point[which], floors[which]));
        let (name, width) =
            if line.is_faint { ("", theme::size::HAIRLINE) } else { (line.name.as_str(), style.width) };
        let colour = if line.is_faint { style.colour.gamma_multiply(0.45) } else { style.colour };
        for &[x, low, high] in &line.bars {
            let ends: Vec<[f64; 2]> = [[x, low], [x, high]].iter().map(place).collect();
            plot.line(egui_plot::Line::new(name, PlotPoints::from(ends)).color(colour).width(1.0));
        }
        for piece in line.points.split(|point| !(point[0].is_finite() && point[1].is_finite())) {
            let points: Vec<[f64; 2]> = piece.iter().map(place).collect();
            let curve = egui_plot::Line::new(name, PlotPoints::from(points.clone()));
            plot.line(curve.color(colour).width(width).style(dash));
            if !line.is_faint {
                let dots = Points::new(name, PlotPoints::from(points)).color(style.colour);
                plot.points(dots.radius(mark::ACCEPTED_RADIUS).shape(MarkerShape::Circle).filled(true));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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

    fn count(picture: &RgbaImage, colour: egui::Color32) -> usize {
        let near = |a: u8, b: u8| a.abs_diff(b) < 12;
        picture
            .pixels()
            .filter(|p| near(p[0], colour.r()) && near(p[1], colour.g()) && near(p[2], colour.b()))
            .count()
    }

    #[test]
    fn every_curve_is_drawn_in_its_colour_in_both_themes() {
        for theme in Theme::ALL {
            let picture = figure().picture(theme);
            for style in [0, 1] {
                let pixels = count(&picture, run_style(style).colour);
                assert!(pixels > 50, "{theme:?}, curve {style}: {pixels} pixels");
            }
            assert_eq!(count(&picture, run_style(2).colour), 0);
        }
    }

    #[test]
    fn the_same_figure_is_the_same_picture_and_nothing_is_no_trouble() {
        assert_eq!(figure().picture(Theme::Light), figure().picture(Theme::Light));
        let empty = Figure { lines: Vec::new(), ..figure() };
        assert!(empty.range(1, empty.floor(1)).iter().all(|end| end.is_finite()));
        let _ = empty.picture(Theme::Dark);
    }

    #[test]
    fn marks_have_the_digits_they_need() {
        assert_eq!(marks::number(0.25, 0.05), "0.25");
        assert_eq!(marks::number(20.0, 5.0), "20");
        assert_eq!(marks::number(1e-5, 1e-5), "1e-5");
    }
}
