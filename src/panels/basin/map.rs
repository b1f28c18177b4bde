//! The map of two directions: a click on a cell takes its start.

use egui::{
    Align, Color32, Id, Layout as Direction, Rect, RichText, Role, Sense, Stroke, StrokeKind, Ui, WidgetInfo,
    pos2, vec2,
};

use crate::basin::{BasinRequest, MapColour, MapResult};
use crate::format;
use crate::plot::heat_map::{axes, cell_in, error_colour, error_legend, grid_in, paint_cell};
use crate::showing::{Intents, Request};
use crate::theme::{self, gradient_colour, size, space};
use crate::widgets::segmented;

/// Width of the legend beside the map; where there is less than `FOLD` in all it stands below, so high.
const LEGEND: f32 = 230.0;
const FOLD: f32 = 470.0;
const LEGEND_BELOW: f32 = 168.0;
/// The map is not made smaller than this for its legend's sake.
const LEAST: f32 = 240.0;
/// Shares of the sequential map that stand for found and not found.
const FOUND: f32 = 0.85;
const NOT_FOUND: f32 = 0.2;

/// The map and its legend.
pub(super) fn ui(ui: &mut Ui, result: &MapResult, colour: MapColour, intents: &mut Intents) {
    let area = ui.available_rect_before_wrap();
    let room = if area.width() >= FOLD {
        vec2(LEGEND, 0.0)
    } else if area.height() >= LEAST + LEGEND_BELOW {
        vec2(0.0, LEGEND_BELOW)
    } else {
        egui::Vec2::ZERO
    };
    let grid = grid_in(Rect::from_min_max(area.min, area.max - room));
    axes(ui, grid, &result.directions, result.options.degrees);
    let under = cells(ui, result, colour, grid, intents);
    let place = if room.x > 0.0 {
        let left = grid.right() + 20.0;
        Rect::from_min_max(pos2(left, grid.top()), pos2((left + LEGEND).min(area.right()), area.bottom()))
    } else {
        Rect::from_min_max(pos2(area.left(), grid.bottom() + 44.0), area.max)
    };
    if room != egui::Vec2::ZERO {
        let builder = egui::UiBuilder::new().max_rect(place).layout(Direction::top_down(Align::Min));
        ui.scope_builder(builder, |ui| legend(ui, result, colour, under, intents));
    }
    ui.advance_cursor_after_rect(area);
}

/// The cells, and the one under the pointer.
fn cells(
    ui: &Ui,
    result: &MapResult,
    colour: MapColour,
    grid: Rect,
    intents: &mut Intents,
) -> Option<[usize; 2]> {
    let palette = theme::palette(ui);
    let count = result.options.cells;
    let mut under = None;
    for row in 0..count {
        for column in 0..count {
            let place = [column, row];
            let rect = cell_in(grid, count, place);
            let cell = result.cell(place);
            let found = cell.is_some_and(|cell| cell.error_mm < result.options.success_mm);
            let fill = cell.map(|cell| cell_colour(cell.error_mm, found, colour, result.options.success_mm));
            paint_cell(ui.painter(), rect, fill, found, palette);
            let response = ui.interact(rect, Id::unique(("basin cell", place)), Sense::click());
            let label = cell_text(result, place);
            response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &label));
            if response.hovered() || response.has_focus() {
                under = Some(place);
                let edge = Stroke::new(1.0, palette.text);
                ui.painter().rect_stroke(rect, 0.0, edge, StrokeKind::Inside);
            }
            if response.clicked() {
                intents.request(Request::Basin(BasinRequest::TakeStart(place)));
            }
            response.on_hover_text(format!("{label}\nClick: take this start, and step it"));
        }
    }
    if let Some(taken) = result.taken {
        let edge = Stroke::new(2.0, theme::data_colours::SELECTED);
        ui.painter().rect_stroke(cell_in(grid, count, taken), 0.0, edge, StrokeKind::Inside);
    }
    // The reference stands in the middle, whether a cell is there or a corner.
    ui.painter().circle_stroke(grid.center(), 5.0, Stroke::new(1.5, theme::data_colours::SELECTED));
    under
}

fn cell_colour(error: f64, found: bool, colour: MapColour, limit: f64) -> Color32 {
    match colour {
        MapColour::Error => error_colour(error, limit),
        MapColour::Success => gradient_colour(if found { FOUND } else { NOT_FOUND }),
    }
}

/// A cell's offsets and what came of it.
fn cell_text(result: &MapResult, place: [usize; 2]) -> String {
    let [across, up] = place.map(|place| {
        let degrees = result.options.offset_degrees(place);
        // Offsets are shares of the largest one, and a share of a whole number need not be one to the last bit.
        format::number(degrees, usize::from((degrees - degrees.round()).abs() > 0.05))
    });
    let came = match result.cell(place) {
        Some(cell) => {
            let mm = |value: f64| format::number(value, usize::from(value < 99.5));
            format!("from {} to {} mm", mm(cell.start_mm), mm(cell.error_mm))
        }
        None => "not fitted".to_owned(),
    };
    format!("Start {across}°, {up}°: {came}")
}

fn legend(
    ui: &mut Ui,
    result: &MapResult,
    colour: MapColour,
    under: Option<[usize; 2]>,
    intents: &mut Intents,
) {
    let palette = theme::palette(ui);
    let mut chosen = colour;
    segmented(ui, &mut chosen, &[(MapColour::Error, "Distance"), (MapColour::Success, "Found")])
        .on_hover_text("What the cells are coloured by");
    if chosen != colour {
        intents.request(Request::Basin(BasinRequest::Colour(chosen)));
    }
    ui.add_space(space::WIDGET);
    let (bar, _) = ui.allocate_exact_size(vec2(ui.available_width().min(208.0), 34.0), Sense::hover());
    match colour {
        MapColour::Error => error_legend(ui, bar, result.options.success_mm),
        MapColour::Success => success_legend(ui, bar),
    }
    let [tried, found] = result.counts();
    let limit = format::short(result.options.success_mm);
    ui.label(RichText::new(format!("{found} of {tried} cells end within {limit} mm")).color(palette.text));
    let small = |text: &str| RichText::new(text).small().color(palette.text3);
    ui.label(small(&format!(
        "Dots: found. Ring: the pose itself. Fitted by {}.",
        result.options.choice.name
    )));
    ui.add_space(space::ROW);
    let text = under.or(result.taken).map_or_else(
        || "Point at a cell for its figures; a click takes its start.".to_owned(),
        |place| cell_text(result, place),
    );
    ui.label(RichText::new(text).small().color(palette.text2));
}

fn success_legend(ui: &Ui, area: Rect) {
    let palette = theme::palette(ui);
    let font = egui::TextStyle::Small.resolve(ui.style());
    for (index, (share, text)) in [(FOUND, "Found"), (NOT_FOUND, "Not found")].into_iter().enumerate() {
        let corner = area.min + vec2(100.0 * index as f32, 2.0);
        let swatch = Rect::from_min_size(corner, egui::Vec2::splat(size::ICON));
        ui.painter().rect(swatch, 0.0, gradient_colour(share), palette.edge(), StrokeKind::Inside);
        let at = swatch.right_center() + vec2(6.0, 0.0);
        ui.painter().text(at, egui::Align2::LEFT_CENTER, text, font.clone(), palette.text2);
    }
}
