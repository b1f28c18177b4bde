//! Grids of coloured cells as a picture, side by side by one scale, with their legend.

use egui::{Align2, CentralPanel, Frame, Margin, Painter, Pos2, Rect, RichText, TextStyle, Ui, pos2, vec2};
use egui_painter::Headless;
use image::RgbaImage;

use crate::style::theme;
use crate::style::theme::{Palette, Theme, gradient_colour, size};

/// Size of the picture of one map, points; a pixel each.
const SIZE: [f32; 2] = [620.0, 520.0];
/// The same of each of several, and what is above and below all of them.
const EACH: [f32; 2] = [400.0, 400.0];
const AROUND: [f32; 2] = [28.0, 116.0];
/// Most maps side by side.
const ACROSS: usize = 2;
/// Height of a map's name.
pub const NAME: f32 = 22.0;
/// The lightest colour stands for this many times the limit, and more.
pub const LAST_COLOUR: f64 = 10.0;
/// Room for a map's axes, across and up.
pub const AXES: egui::Vec2 = vec2(52.0, 56.0);
/// Radius of the dot in a cell within the limit, as a part of its side, and at most.
const DOT: f32 = 0.12;
const LARGEST_DOT: f32 = 3.0;
/// Height of the legend's bar.
const BAR: f32 = 10.0;

/// A map of distances over two offsets.
#[derive(Debug, Clone, PartialEq)]
pub struct HeatMap {
    /// What is shown.
    pub title: String,
    /// The conditions, in one line.
    pub subtitle: String,
    /// What is set off across and up.
    pub labels: [String; 2],
    /// Both axes go from minus this to this.
    pub ends_degrees: f64,
    /// Cells across and up.
    pub columns: usize,
    /// Maps by name: millimetres by row, the lowest first, then by column; nothing where it is not known.
    pub maps: Vec<(String, Vec<Option<f64>>)>,
    /// What is below this is marked with a dot.
    pub limit: f64,
}

impl HeatMap {
    /// The map as a picture. The same map gives the same bytes.
    pub fn picture(&self, theme: Theme) -> RgbaImage {
        let [width, height] = self.size();
        let mut window = Headless::new(width, height, 1.0);
        theme::apply(&window.ctx, theme);
        let palette = theme.palette();
        window.frames(3, Vec::new(), |ui| {
            let frame = Frame::NONE.fill(palette.panel).inner_margin(Margin::symmetric(14, 10));
            CentralPanel::default().frame(frame).show(ui, |ui| self.ui(ui, palette));
        })
    }

    fn size(&self) -> [f32; 2] {
        if self.maps.len() < 2 {
            return SIZE;
        }
        let rows = self.maps.len().div_ceil(ACROSS) as f32;
        [EACH[0] * ACROSS as f32 + AROUND[0], EACH[1] * rows + AROUND[1]]
    }

    fn ui(&self, ui: &mut Ui, palette: &Palette) {
        ui.label(RichText::new(&self.title).text_style(theme::title()).color(palette.text));
        ui.label(RichText::new(&self.subtitle).color(palette.text2));
        let area = ui.available_rect_before_wrap();
        let legend = Rect::from_min_max(pos2(area.left(), area.bottom() - 34.0), area.max);
        let room = Rect::from_min_max(area.min, pos2(area.right(), legend.top() - 8.0));
        for (place, (name, values)) in places(room, self.maps.len(), ACROSS).into_iter().zip(&self.maps) {
            let (title, below) = place.split_top_bottom_at_y(place.top() + NAME);
            let font = TextStyle::Body.resolve(ui.style());
            ui.painter().text(title.left_center(), Align2::LEFT_CENTER, name, font, palette.text);
            let grid = grid_in(below);
            axes(ui, grid, &self.labels, self.ends_degrees);
            for (index, value) in values.iter().enumerate() {
                let cell = cell_in(grid, self.columns, [index % self.columns, index / self.columns]);
                let found = value.is_some_and(|value| value < self.limit);
                let colour = value.map(|value| error_colour(value, self.limit));
                paint_cell(ui.painter(), cell, colour, found, palette);
            }
        }
        error_legend(ui, legend, self.limit);
    }
}

/// So many places for maps in an area, as large as each other.
pub fn places(area: Rect, count: usize, across: usize) -> Vec<Rect> {
    let across = across.clamp(1, count.max(1));
    let rows = count.div_ceil(across).max(1);
    let size = vec2(area.width() / across as f32, area.height() / rows as f32);
    let place = |index: usize| {
        let offset = vec2((index % across) as f32 * size.x, (index / across) as f32 * size.y);
        Rect::from_min_size(area.min + offset, size)
    };
    (0..count).map(place).collect()
}

/// How many of so many maps stand side by side so that they are as large as can be, and the side of their squares.
pub fn best_across(area: Rect, count: usize) -> (usize, f32) {
    let side = |across: usize| {
        let place = places(area, count, across).first().copied().unwrap_or(Rect::ZERO);
        let room = place.size() - AXES - vec2(0.0, NAME);
        room.x.min(room.y)
    };
    let across = (1..=count.max(1)).max_by(|a, b| side(*a).total_cmp(&side(*b))).unwrap_or(1);
    (across, side(across))
}

/// The square of a map in an area, with room for its axes.
pub fn grid_in(area: Rect) -> Rect {
    let room = Rect::from_min_max(area.min + vec2(44.0, 22.0), area.max - vec2(8.0, 34.0));
    let side = room.width().min(room.height()).max(40.0).floor();
    Rect::from_min_size(pos2(room.left().round(), room.top().round()), vec2(side, side))
}

/// A cell of a map; rows go up.
pub fn cell_in(grid: Rect, columns: usize, [column, row]: [usize; 2]) -> Rect {
    let edge = |place: usize, length: f32| (length * place as f32 / columns.max(1) as f32).round();
    let (left, right) = (edge(column, grid.width()), edge(column + 1, grid.width()));
    let (low, high) = (edge(row, grid.height()), edge(row + 1, grid.height()));
    Rect::from_min_max(
        pos2(grid.left() + left, grid.bottom() - high),
        pos2(grid.left() + right, grid.bottom() - low),
    )
}

/// The colour of a distance: dark at none, lightest from ten times the limit on.
pub fn error_colour(value: f64, limit: f64) -> egui::Color32 {
    gradient_colour((value / (LAST_COLOUR * limit)).clamp(0.0, 1.0).sqrt() as f32)
}

/// Paints a cell; one that is not known is empty, one that was found has a dot.
pub fn paint_cell(
    painter: &Painter,
    cell: Rect,
    colour: Option<egui::Color32>,
    found: bool,
    palette: &Palette,
) {
    let inner = cell.shrink(0.5);
    painter.rect_filled(inner, 0.0, colour.unwrap_or(palette.plot));
    if colour.is_none() {
        painter.rect_stroke(inner, 0.0, palette.hairline(), egui::StrokeKind::Inside);
    }
    if found {
        let radius = (DOT * cell.width()).clamp(1.2, LARGEST_DOT);
        painter.circle_filled(cell.center(), radius, theme::data_colours::WHITE);
    }
}

/// Names and ends of both axes.
pub fn axes(ui: &Ui, grid: Rect, labels: &[String; 2], ends_degrees: f64) {
    let palette = theme::palette(ui);
    let tick = theme::tick().resolve(ui.style());
    let small = TextStyle::Small.resolve(ui.style());
    let text = |at: Pos2, align: Align2, text: String, font: &egui::FontId, colour| {
        ui.painter().text(at, align, text, font.clone(), colour);
    };
    let degrees =
        |value: f64| format!("{}°", crate::style::format::number(value, usize::from(value.fract() != 0.0)));
    for (value, share) in [(-ends_degrees, 0.0), (0.0, 0.5), (ends_degrees, 1.0)] {
        let across = pos2(grid.left() + share * grid.width(), grid.bottom() + 4.0);
        let align = [Align2::LEFT_TOP, Align2::CENTER_TOP, Align2::RIGHT_TOP][(2.0 * share) as usize];
        text(across, align, degrees(value), &tick, palette.text2);
        let up = pos2(grid.left() - 6.0, grid.bottom() - share * grid.height());
        let align = [Align2::RIGHT_BOTTOM, Align2::RIGHT_CENTER, Align2::RIGHT_TOP][(2.0 * share) as usize];
        text(up, align, degrees(value), &tick, palette.text2);
    }
    text(
        grid.left_top() - vec2(0.0, 6.0),
        Align2::LEFT_BOTTOM,
        format!("Up: {}", labels[1]),
        &small,
        palette.text,
    );
    let below = pos2(grid.left(), grid.bottom() + 19.0);
    text(below, Align2::LEFT_TOP, format!("Across: {}", labels[0]), &small, palette.text);
}

/// The bar that says which colour is which distance.
pub fn error_legend(ui: &Ui, area: Rect, limit: f64) {
    let palette = theme::palette(ui);
    let bar = Rect::from_min_size(area.min + vec2(0.0, 2.0), vec2(area.width().min(260.0), BAR));
    let last = LAST_COLOUR * limit;
    for column in 0..bar.width() as usize {
        let share = column as f64 / f64::from(bar.width());
        let x = bar.left() + column as f32;
        let colour = error_colour(share * last, limit);
        let line = Rect::from_min_max(pos2(x, bar.top()), pos2(x + 1.0, bar.bottom()));
        ui.painter().rect_filled(line, 0.0, colour);
    }
    ui.painter().rect_stroke(bar, 0.0, palette.edge(), egui::StrokeKind::Outside);
    let at_limit = bar.left() + bar.width() * (limit / last) as f32;
    ui.painter().vline(
        at_limit,
        bar.expand2(vec2(0.0, 2.0)).y_range(),
        egui::Stroke::new(size::HAIRLINE, palette.text),
    );
    let tick = theme::tick().resolve(ui.style());
    let y = bar.bottom() + 4.0;
    let mm = |value: f64| crate::style::format::number(value, usize::from(value.fract() != 0.0));
    let marks = [
        (bar.left(), Align2::LEFT_TOP, "0".to_owned()),
        (at_limit + 2.0, Align2::CENTER_TOP, mm(limit)),
        (bar.right(), Align2::RIGHT_TOP, format!("{} mm and more", mm(last))),
    ];
    for (x, align, text) in marks {
        ui.painter().text(pos2(x, y), align, text, tick.clone(), palette.text2);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_fill_the_grid_without_gaps() {
        let grid = grid_in(Rect::from_min_size(Pos2::ZERO, vec2(500.0, 400.0)));
        assert_eq!(grid.width(), grid.height());
        let corner = cell_in(grid, 7, [0, 0]);
        assert_eq!(corner.left_bottom(), grid.left_bottom());
        for place in 0..6 {
            let (one, next) = (cell_in(grid, 7, [place, 3]), cell_in(grid, 7, [place + 1, 3]));
            assert_eq!(one.right(), next.left());
        }
        assert_eq!(cell_in(grid, 7, [6, 6]).right_top(), grid.right_top());
    }

    #[test]
    fn several_maps_are_as_large_as_can_be() {
        let across = |width, height| best_across(Rect::from_min_size(Pos2::ZERO, vec2(width, height)), 4).0;
        assert_eq!([across(1000.0, 200.0), across(600.0, 600.0), across(200.0, 1000.0)], [4, 2, 1]);
        let area = Rect::from_min_size(Pos2::ZERO, vec2(300.0, 200.0));
        let all = places(area, 3, 2);
        assert_eq!((all.len(), all[2].min), (3, pos2(0.0, 100.0)));
        assert!(all.iter().all(|place| area.contains_rect(*place)));
    }

    #[test]
    fn farther_is_lighter_and_the_same_map_is_the_same_picture() {
        let light = |value: f64| {
            let colour = error_colour(value, 20.0);
            u32::from(colour.r()) + u32::from(colour.g()) + u32::from(colour.b())
        };
        assert!(light(0.0) < light(10.0) && light(10.0) < light(100.0) && light(200.0) == light(900.0));
        let map = HeatMap {
            title: "Map".to_owned(),
            subtitle: String::new(),
            labels: ["a".to_owned(), "b".to_owned()],
            ends_degrees: 30.0,
            columns: 2,
            maps: vec![("one".to_owned(), vec![Some(1.0), Some(300.0), None, Some(40.0)])],
            limit: 20.0,
        };
        assert_eq!(map.picture(Theme::Dark), map.picture(Theme::Dark));
        assert_ne!(
            map.picture(Theme::Dark),
            HeatMap { maps: vec![("one".to_owned(), vec![None; 4])], ..map.clone() }.picture(Theme::Dark)
        );
        let both = HeatMap { maps: [map.maps.clone(), map.maps.clone()].concat(), ..map.clone() };
        assert!(both.picture(Theme::Dark).width() > map.picture(Theme::Dark).width());
    }
}
