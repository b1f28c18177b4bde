//! The floor seen from above: how well each place is known, with the cameras. A picture of it for a file is
//! [`backlit_plot::FloorMap`].

use backlit_runs::camera_plan::{PlanResult, PlanSubject};
use backlit_tracking::observability::plan::PlannedSet;
use backlit_ui::style::theme::size;
use backlit_ui::style::{format, theme};
use backlit_ui::widgets::heat_map::error_colour;
use backlit_ui::widgets::{paint_camera_badge, paint_text};
use egui::{Align2, Color32, Pos2, Rect, Role, Sense, Shape, Stroke, TextStyle, Ui, Vec2, WidgetInfo, vec2};
use image::{Rgba, RgbaImage};

use crate::context::marks::FloorPicture;

/// Free about what is drawn, for the cameras.
const ROOM: f32 = 22.0;
/// How far a camera looks, and half the opening of that.
const LOOKS: [f32; 2] = [20.0, 8.0];
/// A cell has its number in it where it is as wide as that.
const NUMBERED: f32 = 20.0;
/// A tenth of what the lightest colour is, millimetres.
pub(super) const LIMIT_MM: f64 = 25.0;
/// From that sum of channels on a colour has dark letters on it.
const LIGHT: u32 = 380;

/// Shows what a set of cameras knows of each place; one that is not there yet is a ring.
pub(super) fn ui(ui: &mut Ui, found: &PlanResult, set: &PlannedSet, side: f32) {
    let (area, response) = ui.allocate_exact_size(vec2(side, side), Sense::hover());
    let palette = theme::palette(ui);
    let floor = &found.subject.area;
    let names = format!("The floor with {}: {} mm", found.names(set), format::number(1e3 * set.mean_m(), 0));
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, names.as_str()));
    ui.painter().rect_filled(area, size::FIELD_RADIUS, palette.plot);
    ui.painter().rect_stroke(area, size::FIELD_RADIUS, palette.hairline(), egui::StrokeKind::Inside);
    let cameras: Vec<_> = found.subject.cameras.iter().map(|camera| found.on_map(camera, false)).collect();
    let added = found.added(set).map(|camera| found.on_map(camera, true));
    // All maps of a plan by one scale: about every place for one more camera.
    let others = found.candidates.iter().map(|camera| found.subject.floor.place(camera.centre()));
    let half = [0, 1].map(|axis| {
        let places = cameras.iter().map(|camera| camera.place).chain(others.clone());
        let reach = places.map(|place| (place[axis] - floor.middle[axis]).abs());
        reach.fold(0.5 * floor.size_m[axis], f64::max)
    });
    let per_m = (0.5 * side - ROOM) / half[0].max(half[1]).max(0.1) as f32;
    let at = |place: [f64; 2]| {
        let [x, y] = [0, 1].map(|axis| (place[axis] - floor.middle[axis]) as f32 * per_m);
        area.center() + vec2(x, -y)
    };
    for (index, place) in set.places.iter().enumerate() {
        let [column, row] = [index % floor.cells[0].max(1), index / floor.cells[0].max(1)];
        let corner = |step: usize| {
            let along = [(0, column), (1, row)].map(|(axis, cell)| {
                let share = (cell + step) as f64 / floor.cells[axis].max(1) as f64 - 0.5;
                floor.middle[axis] + share * floor.size_m[axis]
            });
            at(along)
        };
        cell(ui, Rect::from_two_pos(corner(0), corner(1)), 1e3 * place.mean_m);
    }
    for (index, camera) in cameras.iter().enumerate() {
        let place = at(camera.place);
        wedge(ui, place, camera.looks, palette.text2);
        let badge = Rect::from_center_size(place, Vec2::splat(size::BADGE));
        paint_camera_badge(ui.painter(), badge, index);
    }
    if let Some(camera) = added {
        let place = at(camera.place);
        wedge(ui, place, camera.looks, palette.warn);
        ui.painter().circle(place, 0.4 * size::BADGE, palette.plot, Stroke::new(2.0, palette.warn));
    }
}

/// So far above the floor a picture on it is drawn, metres: the grid lies under it.
const ABOVE_M: f64 = 0.004;

/// What all cameras there are would know of each place, to lie on the floor of the scene.
pub(super) fn on_floor(found: &PlanResult) -> Option<FloorPicture> {
    let (PlanSubject { floor, area, .. }, set) = (&found.subject, found.whole()?);
    let [ahead, left] = floor.axes();
    let corner = [0, 1].map(|axis| area.middle[axis] - 0.5 * area.size_m[axis]);
    let [columns, rows] = area.cells.map(|cells| cells as u32);
    let colour = |column: u32, row: u32| {
        let place = set.places.get((row * columns + column) as usize);
        Rgba(place.map_or([0; 4], |place| error_colour(1e3 * place.mean_m, LIMIT_MM).to_array()))
    };
    Some(FloorPicture {
        corner: floor.point(corner, ABOVE_M),
        across: ahead * area.size_m[0],
        down: left * area.size_m[1],
        image: RgbaImage::from_fn(columns, rows, colour),
        limit_mm: LIMIT_MM,
    })
}

fn cell(ui: &Ui, rect: Rect, millimetres: f64) {
    let rect = Rect::from_min_max(rect.min.round(), rect.max.round()).shrink(0.5);
    let colour = error_colour(millimetres, LIMIT_MM);
    ui.painter().rect_filled(rect, 0.0, colour);
    if rect.width() >= NUMBERED {
        let [r, g, b, _] = colour.to_array().map(u32::from);
        let letters = if r + g + b > LIGHT { Color32::BLACK } else { Color32::WHITE };
        let text = format::number(millimetres, 0);
        paint_text(ui, rect.center(), Align2::CENTER_CENTER, text, TextStyle::Small, letters);
    }
}

/// Where a camera looks, from above.
fn wedge(ui: &Ui, at: Pos2, looks: [f64; 2], colour: Color32) {
    let looks = vec2(looks[0] as f32, -looks[1] as f32);
    if looks.length() > 1e-6 {
        let looks = looks.normalized();
        let [left, right] = [1.0, -1.0].map(|side| at + looks * LOOKS[0] + looks.rot90() * (side * LOOKS[1]));
        ui.painter().add(Shape::closed_line(vec![at, left, right], Stroke::new(1.25, colour)));
    }
}
