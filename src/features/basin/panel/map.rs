//! The maps of two directions, one a choice of fit: a click on a cell takes its start.

use backlit_ui::style::format;
use backlit_ui::style::theme;
use backlit_ui::style::theme::{gradient_colour, run_style, size, space};
use backlit_ui::widgets::choice;
use backlit_ui::widgets::heat_map::{
    AXES, NAME, axes, best_across, cell_in, error_colour, error_legend, grid_in, paint_cell, places,
};
use backlit_ui::widgets::segmented;
use egui::{
    Align, Color32, Id, Layout as Direction, Rect, RichText, Role, Sense, Stroke, StrokeKind, Ui, WidgetInfo,
    pos2, vec2,
};

use super::Wish;
use crate::features::basin::{MapColour, ShownMap};

/// Width of the legend beside the map; where there is less than `FOLD` in all it stands below, so high.
const LEGEND: f32 = 230.0;
const FOLD: f32 = 470.0;
const LEGEND_BELOW: f32 = 168.0;
/// The map is not made smaller than this for its legend's sake.
const LEAST: f32 = 240.0;
/// Where several maps would be smaller than this one of them is shown.
const LEAST_OF_SEVERAL: f32 = 96.0;
/// Space between two maps.
const BETWEEN: f32 = 12.0;
/// Width of the box of fits.
const CHOICE: f32 = 116.0;
/// Shares of the sequential map that stand for found and not found.
const FOUND: f32 = 0.85;
const NOT_FOUND: f32 = 0.2;

/// The maps and their legend.
pub(crate) fn ui(ui: &mut Ui, result: &ShownMap, colour: MapColour, wishes: &mut Vec<Wish>) {
    let area = ui.available_rect_before_wrap();
    let room = if area.width() >= FOLD {
        vec2(LEGEND, 0.0)
    } else if area.height() >= LEAST + LEGEND_BELOW {
        vec2(0.0, LEGEND_BELOW)
    } else {
        egui::Vec2::ZERO
    };
    let grids = grids(Rect::from_min_max(area.min, area.max - room), result);
    let mut under = None;
    for (choice, grid) in &grids {
        if result.options.choices.len() > 1 {
            name(ui, result, *choice, *grid);
        }
        axes(ui, *grid, &result.directions, result.options.degrees);
        under = cells(ui, result, (*choice, colour), *grid, wishes).or(under);
    }
    let shown: Vec<usize> = grids.iter().map(|(choice, _)| *choice).collect();
    for (_, grid) in &grids {
        marks(ui, result, *grid, under);
    }
    let edges = grids.iter().map(|(_, grid)| *grid).reduce(Rect::union).unwrap_or(area);
    let place = if room.x > 0.0 {
        let left = edges.right() + 20.0;
        Rect::from_min_max(pos2(left, edges.top()), pos2((left + LEGEND).min(area.right()), area.bottom()))
    } else {
        Rect::from_min_max(pos2(area.left(), edges.bottom() + 44.0), area.max)
    };
    if room != egui::Vec2::ZERO {
        let builder = egui::UiBuilder::new().max_rect(place).layout(Direction::top_down(Align::Min));
        ui.scope_builder(builder, |ui| legend(ui, result, colour, (&shown, under), wishes));
    }
    ui.advance_cursor_after_rect(area);
}

/// Which maps are shown.
pub(crate) fn choice_box(ui: &mut Ui, result: &ShownMap, wishes: &mut Vec<Wish>) {
    const ALL: &str = "All fits";
    let choices = &result.options.choices;
    let mut rows = vec![(None, ALL, "The maps of all fits side by side, by one scale".to_owned())];
    rows.extend(choices.iter().enumerate().map(|(index, choice)| {
        (Some(index), choice.name.as_str(), format!("The map of {} alone, large", choice.name))
    }));
    let chosen = result.choice.and_then(|index| choices.get(index)).map_or(ALL, |choice| &choice.name);
    if let Some(shown) = choice(ui, "Fits shown", CHOICE, chosen, &rows) {
        wishes.push(Wish::ShowChoice(shown));
    }
}

/// The squares of the maps that are shown, each with its choice: all of them side by side, unless one is chosen or
/// they would be too small to be read.
fn grids(area: Rect, result: &ShownMap) -> Vec<(usize, Rect)> {
    let count = result.options.choices.len();
    if count < 2 {
        return vec![(0, grid_in(area))];
    }
    let (across, side) = best_across(area, count);
    let one = result.choice.filter(|choice| *choice < count).or((side < LEAST_OF_SEVERAL).then_some(0));
    let grid = |place: Rect| grid_in(place.with_min_y(place.top() + NAME));
    if let Some(choice) = one {
        return vec![(choice, grid(area))];
    }
    // Close to each other: what is left over stays at the edges.
    let rows = count.div_ceil(across) as f32;
    let each = vec2(side, side) + AXES + vec2(BETWEEN, NAME);
    let size = vec2(each.x * across as f32, each.y * rows).min(area.size());
    places(Rect::from_min_size(area.min, size), count, across).into_iter().map(grid).enumerate().collect()
}

/// Which fit a map is of, and how much of it was found.
fn name(ui: &mut Ui, result: &ShownMap, choice: usize, grid: Rect) {
    let palette = theme::palette(ui);
    // Above the names of the axes, and as far left as those of the heights.
    let left_top = grid.left_top() - vec2(0.8 * AXES.x, NAME + 22.0);
    let row = Rect::from_min_max(left_top, pos2(grid.right(), left_top.y + NAME));
    let dot = row.left_center() + vec2(4.0, 0.0);
    ui.painter().circle_filled(dot, 4.0, run_style(choice).colour);
    let [tried, found] = result.counts(choice);
    let name = &result.options.choices[choice].name;
    let inner = row.with_min_x(row.left() + 14.0);
    let builder = egui::UiBuilder::new().max_rect(inner).layout(Direction::right_to_left(Align::Center));
    ui.scope_builder(builder, |ui| {
        let counts = RichText::new(format!("{found} of {tried}")).monospace().color(palette.text2);
        ui.label(counts).on_hover_text(format!(
            "Cells that end within {} mm of the target, of those that were fitted",
            format::short(result.options.success_mm)
        ));
        ui.with_layout(Direction::left_to_right(Align::Center), |ui| {
            ui.add(egui::Label::new(RichText::new(name).color(palette.text)).truncate());
        });
    });
}

/// The cells of a choice's map; the one under the pointer.
fn cells(
    ui: &Ui,
    result: &ShownMap,
    (choice, colour): (usize, MapColour),
    grid: Rect,
    wishes: &mut Vec<Wish>,
) -> Option<[usize; 2]> {
    let palette = theme::palette(ui);
    let count = result.options.cells;
    let mut under = None;
    for row in 0..count {
        for column in 0..count {
            let place = [column, row];
            let rect = cell_in(grid, count, place);
            let cell = result.cell(choice, place);
            let found = cell.is_some_and(|cell| cell.error_mm < result.options.success_mm);
            let fill = cell.map(|cell| cell_colour(cell.error_mm, found, colour, result.options.success_mm));
            paint_cell(ui.painter(), rect, fill, found, palette);
            let response = ui.interact(rect, Id::unique(("basin cell", choice, place)), Sense::click());
            let label = || cell_text(result, choice, place);
            response.widget_info(|| WidgetInfo::labeled(Role::Button, true, label()));
            if response.hovered() || response.has_focus() {
                under = Some(place);
            }
            if response.clicked() {
                wishes.push(Wish::TakeStart(place));
            }
            response.on_hover_ui(|ui| {
                ui.label(format!("{}\nClick: take this start and step it", label()));
            });
        }
    }
    under
}

/// The cell under the pointer, in every map; the one that was taken; and the pose itself.
fn marks(ui: &Ui, result: &ShownMap, grid: Rect, under: Option<[usize; 2]>) {
    let count = result.options.cells;
    let edges = [
        (under, Stroke::new(1.5, theme::palette(ui).text)),
        (result.taken, Stroke::new(2.0, theme::data_colours::SELECTED)),
    ];
    for (place, edge) in edges {
        if let Some(place) = place {
            ui.painter().rect_stroke(cell_in(grid, count, place), 0.0, edge, StrokeKind::Inside);
        }
    }
    // The reference stands in the middle, whether a cell is there or a corner.
    ui.painter().circle_stroke(grid.center(), 5.0, Stroke::new(1.5, theme::data_colours::SELECTED));
}

fn cell_colour(error: f64, found: bool, colour: MapColour, limit: f64) -> Color32 {
    match colour {
        MapColour::Error => error_colour(error, limit),
        MapColour::Success => gradient_colour(if found { FOUND } else { NOT_FOUND }),
    }
}

/// A cell's offsets, and what came of it by a choice of fit.
fn cell_text(result: &ShownMap, choice: usize, place: [usize; 2]) -> String {
    let start = start_text(result, place);
    match result.options.choices.as_slice() {
        [] | [_] => format!("Start {start}: {}", came_text(result, choice, place)),
        several => {
            let name = several.get(choice).map_or("", |choice| &choice.name);
            format!("Start {start} by {name}: {}", came_text(result, choice, place))
        }
    }
}

fn start_text(result: &ShownMap, place: [usize; 2]) -> String {
    let [across, up] = place.map(|place| {
        let degrees = result.options.offset_degrees(place);
        // Offsets are shares of the largest one, and a share of a whole number need not be one to the last bit.
        format::number(degrees, usize::from((degrees - degrees.round()).abs() > 0.05))
    });
    format!("{across}°, {up}°")
}

fn came_text(result: &ShownMap, choice: usize, place: [usize; 2]) -> String {
    match result.cell(choice, place) {
        Some(cell) => {
            let mm = |value: f64| format::number(value, usize::from(value < 99.5));
            format!("from {} to {} mm", mm(cell.start_mm), mm(cell.error_mm))
        }
        None => "not fitted".to_owned(),
    }
}

fn legend(
    ui: &mut Ui,
    result: &ShownMap,
    colour: MapColour,
    (shown, under): (&[usize], Option<[usize; 2]>),
    wishes: &mut Vec<Wish>,
) {
    let palette = theme::palette(ui);
    let mut chosen = colour;
    segmented(ui, &mut chosen, &[(MapColour::Error, "Distance"), (MapColour::Success, "Found")])
        .on_hover_text("What the cells are coloured by");
    if chosen != colour {
        wishes.push(Wish::Colour(chosen));
    }
    ui.add_space(space::WIDGET);
    let (bar, _) = ui.allocate_exact_size(vec2(ui.available_width().min(208.0), 34.0), Sense::hover());
    match colour {
        MapColour::Error => error_legend(ui, bar, result.options.success_mm),
        MapColour::Success => success_legend(ui, bar),
    }
    let small = |text: &str, colour| RichText::new(text).small().color(colour);
    let limit = format::short(result.options.success_mm);
    let words = match result.options.choices.as_slice() {
        [one] => {
            let [tried, found] = result.counts(0);
            let text = format!("{found} of {tried} cells end within {limit} mm");
            ui.label(RichText::new(text).color(palette.text));
            format!(
                "Distance from the target at the end. Dots: found. Ring: the pose itself. Fitted by {}.",
                one.name
            )
        }
        _ => format!(
            "Distance from the target at the end. Dots: found, within {limit} mm. Ring: the pose itself. All maps have the \
             same starts and colours."
        ),
    };
    ui.label(small(&words, palette.text3));
    ui.add_space(space::ROW);
    let Some(place) = under.or(result.taken) else {
        ui.label(small("Point at a cell for its figures; a click takes its start.", palette.text2));
        return;
    };
    if let [choice] = shown {
        ui.label(small(&cell_text(result, *choice, place), palette.text2));
        return;
    }
    ui.label(small(&format!("Start {}", start_text(result, place)), palette.text));
    for choice in shown {
        let name = &result.options.choices[*choice].name;
        let text = format!("{name}: {}", came_text(result, *choice, place));
        ui.label(small(&text, palette.text2));
    }
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
