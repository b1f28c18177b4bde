//! A floor seen from above: how well places on it are known, with the cameras around it.

use backlit_words::format;
use image::RgbaImage;
use vello_cpu::kurbo::{Point, Rect, Vec2};

use crate::AsPicture;
use crate::colours::{PageColours, RUNS, Theme, rgb};
use crate::heat_map::{error_colour, legend};
use crate::page::{
    Anchor, BODY, CENTRE_BOTTOM, CENTRE_TOP, LEFT_MIDDLE, LEFT_TOP, Page, RIGHT_MIDDLE, SMALL, TITLE,
};

/// Size of a map, and what is around all of them, points.
const MAP: f64 = 460.0;
const MARGIN: f64 = 14.0;
const HEADINGS: f64 = 50.0;
const NAME: f64 = 24.0;
const LEGEND: f64 = 40.0;
/// Room for names of cameras about what is drawn.
const ROOM: f64 = 38.0;
/// A camera: its radius, how far it looks, and half the opening of that, points.
const DOT: f32 = 4.0;
const LOOKS: [f64; 2] = [22.0, 9.0];
/// A cell has its number in it where it is as wide and as high as that, points.
const NUMBERED: [f64; 2] = [26.0, 14.0];
/// The dot of a heat map's limit, millimetres: a tenth of what the lightest colour is.
const LIMIT: f64 = 25.0;
/// The middle of a number in its cell.
const CENTRE_MIDDLE: Anchor = [0.5, 0.5];
/// Above that brightness letters on a colour are dark.
const LIGHT: u32 = 380;

/// A camera on a map.
#[derive(Debug, Clone, PartialEq)]
pub struct MapCamera {
    /// What is written beside it.
    pub name: String,
    /// Where it stands, metres along the floor's axes.
    pub place: [f64; 2],
    /// Where it looks, along the same axes; its length does not count.
    pub looks: [f64; 2],
    /// Not there yet: drawn in another colour.
    pub is_added: bool,
}

/// Maps of one floor, side by side by one scale.
#[derive(Debug, Clone, PartialEq)]
pub struct FloorMap {
    /// What is shown.
    pub title: String,
    /// The conditions, in one line.
    pub subtitle: String,
    /// Middle of the area and its sides, metres along the floor's axes.
    pub middle: [f64; 2],
    /// Its sides, metres.
    pub size_m: [f64; 2],
    /// Cells along each side.
    pub cells: [usize; 2],
    /// By map: its name, millimetres by row, the lowest first, then by column, and the cameras.
    pub maps: Vec<(String, Vec<f64>, Vec<MapCamera>)>,
}

/// From metres to points.
struct Scale {
    centre: Point,
    middle: [f64; 2],
    points_per_m: f64,
}

impl Scale {
    fn at(&self, place: [f64; 2]) -> Point {
        let [x, y] = [0, 1].map(|axis| (place[axis] - self.middle[axis]) * self.points_per_m);
        self.centre + Vec2::new(x, -y)
    }
}

impl AsPicture for FloorMap {
    fn picture(&self, theme: Theme) -> RgbaImage {
        let colours = theme.page();
        let count = self.maps.len().max(1) as f64;
        let size = [count * MAP + (count + 1.0) * MARGIN, HEADINGS + NAME + MAP + LEGEND + 2.0 * MARGIN];
        let mut page = Page::new(size.map(|side| side as u32), colours.panel);
        page.text(Point::new(MARGIN, 10.0), LEFT_TOP, &self.title, TITLE, colours.text);
        page.text(Point::new(MARGIN, 35.0), LEFT_TOP, &self.subtitle, BODY, colours.text2);
        let [low, high] = self.ends();
        for (index, (name, values, cameras)) in self.maps.iter().enumerate() {
            let corner = Point::new(MARGIN + index as f64 * (MAP + MARGIN), HEADINGS + NAME);
            page.text(corner - (0.0, 0.5 * NAME), LEFT_MIDDLE, name, BODY, colours.text);
            let area = Rect::from_origin_size(corner, (MAP, MAP));
            page.fill(area, colours.plot);
            let longest = (high[0] - low[0]).max(high[1] - low[1]).max(0.1);
            let scale = Scale {
                centre: area.center(),
                middle: [0, 1].map(|axis| 0.5 * (low[axis] + high[axis])),
                points_per_m: (MAP - 2.0 * ROOM) / longest,
            };
            self.cells(&mut page, &scale, values);
            self.ruler(&mut page, &scale, colours);
            for camera in cameras {
                draw_camera(&mut page, &scale, camera, colours);
            }
            page.frame(area.inset(-0.5), colours.line);
        }
        let below = Point::new(MARGIN, HEADINGS + NAME + MAP + MARGIN);
        legend(&mut page, below, LIMIT, colours);
        page.finish()
    }
}

impl FloorMap {
    /// The lowest and the highest place that is drawn.
    fn ends(&self) -> [[f64; 2]; 2] {
        let sides = [-0.5, 0.5].map(|half| [0, 1].map(|axis| self.middle[axis] + half * self.size_m[axis]));
        let cameras = self.maps.iter().flat_map(|(.., cameras)| cameras).map(|camera| camera.place);
        let all: Vec<[f64; 2]> = sides.into_iter().chain(cameras).collect();
        let end = |of: fn(f64, f64) -> f64| {
            [0, 1].map(|axis| all.iter().map(|place| place[axis]).fold(self.middle[axis], of))
        };
        [end(f64::min), end(f64::max)]
    }

    fn cells(&self, page: &mut Page, scale: &Scale, values: &[f64]) {
        let edge = |axis: usize, cell: usize| {
            self.middle[axis] + (cell as f64 / self.cells[axis].max(1) as f64 - 0.5) * self.size_m[axis]
        };
        for (index, &value) in values.iter().enumerate() {
            let [column, row] = [index % self.cells[0].max(1), index / self.cells[0].max(1)];
            let corner = |step: usize| scale.at([edge(0, column + step), edge(1, row + step)]);
            let cell = Rect::from_points(corner(0), corner(1)).round();
            let colour = error_colour(value, LIMIT);
            page.fill(cell.inset(-0.5), colour);
            if cell.width() >= NUMBERED[0] && cell.height() >= NUMBERED[1] {
                let is_light = rgb(colour).iter().map(|&channel| u32::from(channel)).sum::<u32>() > LIGHT;
                let letters = if is_light { 0x00_00_00 } else { 0xFF_FF_FF };
                page.text(cell.center(), CENTRE_MIDDLE, &format::number(value, 0), SMALL, letters);
            }
        }
    }

    /// A metre, and which way the axes go.
    fn ruler(&self, page: &mut Page, scale: &Scale, colours: &PageColours) {
        let from = scale.centre + (-0.5 * MAP + 12.0, 0.5 * MAP - 16.0);
        let to = from + (scale.points_per_m, 0.0);
        page.curve(&[from, to], (1.5, &[]), colours.text2);
        for end in [from, to] {
            page.curve(&[end - (0.0, 4.0), end + (0.0, 4.0)], (1.5, &[]), colours.text2);
        }
        page.text(to + (7.0, 0.0), LEFT_MIDDLE, "1 m along the first axis", SMALL, colours.text2);
    }
}

/// A dot, what it looks at, and its name on the side away from that.
fn draw_camera(page: &mut Page, scale: &Scale, camera: &MapCamera, colours: &PageColours) {
    let at = scale.at(camera.place);
    let looks = Vec2::new(camera.looks[0], -camera.looks[1]);
    let colour = if camera.is_added { RUNS[1].0 } else { colours.text };
    if looks.hypot() > 1e-9 {
        let looks = looks / looks.hypot();
        let aside = Vec2::new(-looks.y, looks.x);
        let [left, right] = [1.0, -1.0].map(|side| at + looks * LOOKS[0] + aside * (side * LOOKS[1]));
        page.curve(&[left, at, right, left], (1.25, &[]), colour);
    }
    page.dot(at, DOT, colour);
    let (anchor, off) = match (looks.x.abs() > looks.y.abs(), looks.x > 0.0, looks.y > 0.0) {
        (true, true, _) => (RIGHT_MIDDLE, Vec2::new(-8.0, 0.0)),
        (true, false, _) => (LEFT_MIDDLE, Vec2::new(8.0, 0.0)),
        (false, _, true) => (CENTRE_BOTTOM, Vec2::new(0.0, -7.0)),
        (false, _, false) => (CENTRE_TOP, Vec2::new(0.0, 7.0)),
    };
    page.text(at + off, anchor, &camera.name, SMALL, colour);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_map_is_the_same_picture_and_a_camera_shows() {
        let camera = |x: f64, is_added| MapCamera {
            name: "cam1".to_owned(),
            place: [x, -2.0],
            looks: [0.0, 1.0],
            is_added,
        };
        let map = |cameras: Vec<MapCamera>| FloorMap {
            title: "Map".to_owned(),
            subtitle: String::new(),
            middle: [0.5, 0.0],
            size_m: [2.0, 1.0],
            cells: [2, 1],
            maps: vec![("one".to_owned(), vec![10.0, 250.0], cameras)],
        };
        for theme in Theme::ALL {
            let one = map(vec![camera(0.0, false)]).picture(theme);
            assert_eq!(one, map(vec![camera(0.0, false)]).picture(theme));
            assert_ne!(one, map(vec![camera(0.0, true)]).picture(theme));
            assert_ne!(one, map(Vec::new()).picture(theme));
        }
        let [low, high] = map(vec![camera(3.0, false)]).ends();
        assert_eq!((low, high), ([-0.5, -2.0], [3.0, 0.5]));
    }
}
