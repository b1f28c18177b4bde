//! Grids of coloured cells as a picture, side by side by one scale, with their legend.

use backlit_words::format;
use image::RgbaImage;
use vello_cpu::kurbo::{Point, Rect};

use crate::AsPicture;
use crate::colours::{GRADIENT_STOPS, LAST_COLOUR, PageColours, Theme, error_share, interpolate};
use crate::page::{
    BODY, CENTRE_TOP, LEFT_BOTTOM, LEFT_MIDDLE, LEFT_TOP, Page, RIGHT_BOTTOM, RIGHT_MIDDLE, RIGHT_TOP, SMALL,
    TITLE,
};

/// Size of the picture of one map.
const SIZE: [u32; 2] = [620, 520];
/// The same of each of several, and what is above and below all of them.
const EACH: [u32; 2] = [400, 400];
const AROUND: [u32; 2] = [28, 116];
/// Most maps side by side.
const ACROSS: usize = 2;
/// Room at the sides of the page and above, and below the title for maps.
const MARGIN: [f64; 2] = [14.0, 10.0];
const HEADINGS: f64 = 48.0;
/// Height of a map's name.
const NAME: f64 = 22.0;
/// Room about a map: for its axes at the left and below, and above and at the right.
const AXES: [f64; 4] = [44.0, 22.0, 8.0, 34.0];
/// Radius of the dot in a cell within the limit, as a part of its side, at least and at most.
const DOT: f64 = 0.12;
const DOT_RANGE: [f64; 2] = [1.2, 3.0];
/// Height of the legend, and width and height of its bar.
const LEGEND: f64 = 34.0;
const BAR: [f64; 2] = [260.0, 10.0];

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

impl AsPicture for HeatMap {
    fn picture(&self, theme: Theme) -> RgbaImage {
        let colours = theme.page();
        let rows = self.maps.len().div_ceil(ACROSS);
        let across = self.maps.len().clamp(1, ACROSS);
        let size = match self.maps.len() {
            0 | 1 => SIZE,
            _ => [EACH[0] * ACROSS as u32 + AROUND[0], EACH[1] * rows as u32 + AROUND[1]],
        };
        let mut page = Page::new(size, colours.panel);
        let [left, top] = MARGIN;
        let [width, height] = size.map(f64::from);
        page.text(Point::new(left, top), LEFT_TOP, &self.title, TITLE, colours.text);
        page.text(Point::new(left, top + 25.0), LEFT_TOP, &self.subtitle, BODY, colours.text2);
        let legend_top = height - top - LEGEND;
        let each =
            [(width - 2.0 * left) / across as f64, (legend_top - 8.0 - top - HEADINGS) / rows.max(1) as f64];
        for (index, (name, values)) in self.maps.iter().enumerate() {
            let corner = Point::new(
                left + each[0] * (index % across) as f64,
                top + HEADINGS + each[1] * (index / across) as f64,
            );
            page.text(corner + (0.0, 0.5 * NAME), LEFT_MIDDLE, name, BODY, colours.text);
            let grid = grid_in(Rect::new(corner.x, corner.y + NAME, corner.x + each[0], corner.y + each[1]));
            self.axes(&mut page, grid, colours);
            self.cells(&mut page, grid, values, colours);
        }
        legend(&mut page, Point::new(left, legend_top + 2.0), self.limit, colours);
        page.finish()
    }
}

/// The square of a map in an area, with room for its axes.
fn grid_in(area: Rect) -> Rect {
    let [left, top, right, bottom] = AXES;
    let side = (area.width() - left - right).min(area.height() - top - bottom).max(40.0).floor();
    Rect::from_origin_size((area.x0 + left, area.y0 + top), (side, side)).round()
}

/// A cell of a map; rows go up.
fn cell_in(grid: Rect, columns: usize, [column, row]: [usize; 2]) -> Rect {
    let edge = |place: usize| (grid.width() * place as f64 / columns.max(1) as f64).round();
    Rect::new(
        grid.x0 + edge(column),
        grid.y1 - edge(row + 1),
        grid.x0 + edge(column + 1),
        grid.y1 - edge(row),
    )
}

/// The colour of a distance.
pub(crate) fn error_colour(value: f64, limit: f64) -> u32 {
    let [r, g, b] = interpolate(&GRADIENT_STOPS, error_share(value, limit));
    u32::from_be_bytes([0, r, g, b])
}

/// A number without decimals if it is whole.
fn plain(value: f64) -> String {
    format::number(value, usize::from(value.fract() != 0.0))
}

impl HeatMap {
    /// The cells: one that is not known is empty, one within the limit has a dot.
    fn cells(&self, page: &mut Page, grid: Rect, values: &[Option<f64>], colours: &PageColours) {
        for (index, value) in values.iter().enumerate() {
            let cell = cell_in(grid, self.columns, [index % self.columns, index / self.columns]);
            let inner = cell.inset(-0.5);
            match value {
                Some(value) => page.fill(inner, error_colour(*value, self.limit)),
                None => {
                    page.fill(inner, colours.plot);
                    page.frame(inner, colours.line);
                }
            }
            if value.is_some_and(|value| value < self.limit) {
                let radius = (DOT * cell.width()).clamp(DOT_RANGE[0], DOT_RANGE[1]);
                page.dot(cell.center(), radius as f32, 0xFF_FF_FF);
            }
        }
    }

    /// Names and ends of both axes.
    fn axes(&self, page: &mut Page, grid: Rect, colours: &PageColours) {
        let ends = self.ends_degrees;
        let marks = [
            (-ends, 0.0, LEFT_TOP, RIGHT_BOTTOM),
            (0.0, 0.5, CENTRE_TOP, RIGHT_MIDDLE),
            (ends, 1.0, RIGHT_TOP, RIGHT_TOP),
        ];
        for (value, share, across, up) in marks {
            let text = format!("{}°", plain(value));
            let below = Point::new(grid.x0 + share * grid.width(), grid.y1 + 4.0);
            page.text(below, across, &text, SMALL, colours.text2);
            let beside = Point::new(grid.x0 - 6.0, grid.y1 - share * grid.height());
            page.text(beside, up, &text, SMALL, colours.text2);
        }
        let above = Point::new(grid.x0, grid.y0 - 6.0);
        page.text(above, LEFT_BOTTOM, &format!("Up: {}", self.labels[1]), SMALL, colours.text);
        let below = Point::new(grid.x0, grid.y1 + 19.0);
        page.text(below, LEFT_TOP, &format!("Across: {}", self.labels[0]), SMALL, colours.text);
    }
}

/// The bar that says which colour is which distance, millimetres.
pub(crate) fn legend(page: &mut Page, corner: Point, limit: f64, colours: &PageColours) {
    let bar = Rect::from_origin_size(corner, (BAR[0], BAR[1]));
    let last = LAST_COLOUR * limit;
    for column in 0..BAR[0] as usize {
        let x = bar.x0 + column as f64;
        let colour = error_colour(column as f64 / BAR[0] * last, limit);
        page.fill(Rect::new(x, bar.y0, x + 1.0, bar.y1), colour);
    }
    page.frame(bar.inset(1.0), colours.line2);
    let at_limit = (bar.x0 + BAR[0] / LAST_COLOUR).floor() + 0.5;
    let [above, below] = [bar.y0 - 2.0, bar.y1 + 2.0].map(|y| Point::new(at_limit, y));
    page.hairline(above, below, colours.text);
    let words = [
        (bar.x0, LEFT_TOP, "0".to_owned()),
        (at_limit + 2.0, CENTRE_TOP, plain(limit)),
        (bar.x1, RIGHT_TOP, format!("{} mm and more", plain(last))),
    ];
    for (x, anchor, text) in words {
        page.text(Point::new(x, bar.y1 + 4.0), anchor, &text, SMALL, colours.text2);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn farther_is_lighter_and_the_same_map_is_the_same_picture() {
        let light = |value: f64| {
            error_colour(value, 20.0).to_be_bytes().iter().map(|&channel| u32::from(channel)).sum::<u32>()
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
