//! Grids of coloured cells, side by side by one scale, with their legend. A picture of them for a file is
//! [`backlit_plot::HeatMap`].

use backlit_plot::colours::{LAST_COLOUR, error_share};
use egui::{Align2, Painter, Rect, TextStyle, Ui, pos2, vec2};

use super::cards::paint_text;
use crate::style::theme;
use crate::style::theme::{Palette, gradient_colour, size};

/// Height of a map's name.
pub const NAME: f32 = 22.0;
/// Room for a map's axes, across and up.
pub const AXES: egui::Vec2 = vec2(52.0, 56.0);
/// Free at a map's right.
const MARGIN: f32 = 8.0;
/// Radius of the dot in a cell within the limit, as a part of its side, and at most.
const DOT: f32 = 0.12;
const LARGEST_DOT: f32 = 3.0;
/// Height of the legend's bar.
const BAR: f32 = 10.0;

/// Places of equal size for `count` maps in an area.
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

/// How many of `count` maps stand side by side when they are as large as possible, and the side of their squares.
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
    let room = Rect::from_min_max(area.min + vec2(44.0, 22.0), area.max - vec2(MARGIN, 34.0));
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
    gradient_colour(error_share(value, limit))
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
    let degrees =
        |value: f64| format!("{}°", crate::style::format::number(value, usize::from(value.fract() != 0.0)));
    for (value, share) in [(-ends_degrees, 0.0), (0.0, 0.5), (ends_degrees, 1.0)] {
        let across = pos2(grid.left() + share * grid.width(), grid.bottom() + 4.0);
        let align = [Align2::LEFT_TOP, Align2::CENTER_TOP, Align2::RIGHT_TOP][(2.0 * share) as usize];
        paint_text(ui, across, align, degrees(value), theme::tick(), palette.text2);
        let up = pos2(grid.left() - 6.0, grid.bottom() - share * grid.height());
        let align = [Align2::RIGHT_BOTTOM, Align2::RIGHT_CENTER, Align2::RIGHT_TOP][(2.0 * share) as usize];
        paint_text(ui, up, align, degrees(value), theme::tick(), palette.text2);
    }
    let names = [
        (format!("Up: {}", labels[1]), grid.top() - 6.0, Align2::LEFT_BOTTOM),
        (format!("Across: {}", labels[0]), grid.bottom() + 19.0, Align2::LEFT_TOP),
    ];
    for (name, y, align) in names {
        // A long name reaches to the left of its map, not into the next one.
        let text = ui.painter().layout_no_wrap(name, TextStyle::Small.resolve(ui.style()), palette.text);
        let x = grid.left().min(grid.right() + MARGIN - text.size().x);
        let rect = align.anchor_size(pos2(x, y), text.size());
        ui.painter().galley(rect.min, text, palette.text);
    }
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
    let y = bar.bottom() + 4.0;
    let mm = |value: f64| crate::style::format::number(value, usize::from(value.fract() != 0.0));
    let marks = [
        (bar.left(), Align2::LEFT_TOP, "0".to_owned()),
        (at_limit + 2.0, Align2::CENTER_TOP, mm(limit)),
        (bar.right(), Align2::RIGHT_TOP, format!("{} mm and more", mm(last))),
    ];
    for (x, align, text) in marks {
        paint_text(ui, pos2(x, y), align, text, theme::tick(), palette.text2);
    }
}

#[cfg(test)]
mod tests {
    use egui::Pos2;

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
}
