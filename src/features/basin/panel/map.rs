//! The maps of two directions, one a choice of fit: a click on a cell takes its start.

use backlit_runs::basin::{BasinResult, StartGrid};
use backlit_ui::style::theme::{gradient_colour, run_style, size, space};
use backlit_ui::style::{format, theme};
use backlit_ui::widgets::heat_map::{
    AXES, NAME, axes, best_across, cell_in, error_colour, error_legend, grid_in, paint_cell, places,
};
use backlit_ui::widgets::{choice, paint_text, segmented, within};
use egui::{
    Align, Color32, Id, Layout as Direction, Rect, RichText, Role, Sense, Stroke, StrokeKind, TextStyle, Ui,
    WidgetInfo, pos2, vec2,
};

use crate::features::basin::{BasinResults, MapColour};

/// Width of the legend beside the map; where there is less than `FOLD` in all it stands below, so high.
const LEGEND: f32 = 230.0;
const FOLD: f32 = 470.0;
const LEGEND_BELOW: f32 = 168.0;
/// The map is not made smaller than this for its legend's sake.
const LEAST: f32 = 240.0;
/// Where several maps would be smaller than this one of them is shown.
const LEAST_OF_SEVERAL: f32 = 96.0;
const BETWEEN: f32 = 12.0;
const CHOICE: f32 = 116.0;
/// Width of a map’s dot and of its counts, beside its name.
const COUNTS: f32 = 78.0;
/// Shares of the sequential map that stand for found and not found.
const FOUND: f32 = 0.85;
const NOT_FOUND: f32 = 0.2;

#[derive(Clone, Copy)]
struct ShownMap<'a> {
    result: &'a BasinResult,
    grid: &'a StartGrid,
    /// The one choice that is shown, if not all are.
    choice: Option<usize>,
    taken: Option<[usize; 2]>,
    colour: MapColour,
}

/// The maps and their legend; the cell whose start is to be taken.
pub(crate) fn ui(ui: &mut Ui, results: &BasinResults, colour: &mut MapColour) -> Option<[usize; 2]> {
    let (result, grid) = results.map_and_grid()?;
    let (choice, taken) = (results.shown_choice, results.taken);
    let map = ShownMap { result, grid, choice, taken, colour: *colour };
    let map = &map;
    let area = ui.available_rect_before_wrap();
    let room = if area.width() >= FOLD {
        vec2(LEGEND, 0.0)
    } else if area.height() >= LEAST + LEGEND_BELOW {
        vec2(0.0, LEGEND_BELOW)
    } else {
        egui::Vec2::ZERO
    };
    let (grids, name_height) = grids(ui, Rect::from_min_max(area.min, area.max - room), map);
    let directions = result.directions(grid);
    let (mut under, mut clicked) = (None, None);
    for (choice, square) in &grids {
        if result.options.choices.len() > 1 {
            name(ui, map, *choice, (*square, name_height));
        }
        axes(ui, *square, &directions, grid.degrees);
        let cells = cells(ui, map, *choice, *square);
        (under, clicked) = (cells.0.or(under), cells.1.or(clicked));
    }
    let shown: Vec<usize> = grids.iter().map(|(choice, _)| *choice).collect();
    for (_, square) in &grids {
        marks(ui, map, *square, under);
    }
    let edges = grids.iter().map(|(_, square)| *square).reduce(Rect::union).unwrap_or(area);
    let place = if room.x > 0.0 {
        let left = edges.right() + 20.0;
        Rect::from_min_max(pos2(left, edges.top()), pos2((left + LEGEND).min(area.right()), area.bottom()))
    } else {
        Rect::from_min_max(pos2(area.left(), edges.bottom() + 44.0), area.max)
    };
    if room != egui::Vec2::ZERO {
        within(ui, place, Direction::top_down(Align::Min), |ui| legend(ui, map, colour, (&shown, under)));
    }
    ui.advance_cursor_after_rect(area);
    clicked
}

pub(crate) fn choice_box(ui: &mut Ui, results: &mut BasinResults) {
    const ALL: &str = "All fits";
    let Some(map) = &results.map else { return };
    let choices = &map.options.choices;
    let mut rows = vec![(None, ALL, "The maps of all fits side by side, by one scale".to_owned())];
    rows.extend(choices.iter().enumerate().map(|(index, choice)| {
        (Some(index), choice.name.as_str(), format!("The map of {} alone, large", choice.name))
    }));
    let shown = results.shown_choice.and_then(|index| choices.get(index));
    let shown = shown.map_or(ALL, |choice| &choice.name);
    if let Some(shown) = choice(ui, "Fits shown", CHOICE, shown, &rows) {
        results.shown_choice = shown;
    }
}

/// The squares of the maps that are shown, each with its choice: all of them side by side, unless one is chosen or
/// they would be too small to be read; and the height of their names.
fn grids(ui: &Ui, area: Rect, map: &ShownMap<'_>) -> (Vec<(usize, Rect)>, f32) {
    let count = map.result.options.choices.len();
    if count < 2 {
        return (vec![(0, grid_in(area))], NAME);
    }
    let (across, side) = best_across(area, count);
    let one = map.choice.filter(|choice| *choice < count).or((side < LEAST_OF_SEVERAL).then_some(0));
    let grid = |place: Rect, name: f32| grid_in(place.with_min_y(place.top() + name));
    if let Some(choice) = one {
        return (vec![(choice, grid(area, NAME))], NAME);
    }
    // Close to each other: what is left over stays at the edges.
    let rows = count.div_ceil(across) as f32;
    let name = name_height(ui, map, side + AXES.x - BETWEEN);
    let each = vec2(side, side) + AXES + vec2(BETWEEN, name);
    let size = vec2(each.x * across as f32, each.y * rows).min(area.size());
    let places = places(Rect::from_min_size(area.min, size), count, across).into_iter();
    (places.map(|place| grid(place, name)).enumerate().collect(), name)
}

/// Height of the maps' names: of more than one line where one of them is too long for its map.
fn name_height(ui: &Ui, map: &ShownMap<'_>, width: f32) -> f32 {
    let font = TextStyle::Body.resolve(ui.style());
    let lines = |name: &str| {
        let text = ui.painter().layout(name.to_owned(), font.clone(), Color32::WHITE, width - COUNTS);
        text.rows.len()
    };
    let most = map.result.options.choices.iter().map(|choice| lines(&choice.name)).max().unwrap_or(1);
    NAME + (most.max(1) - 1) as f32 * ui.text_style_height(&TextStyle::Body)
}

/// Which fit a map is of, and how much of it was found.
fn name(ui: &mut Ui, map: &ShownMap<'_>, choice: usize, (grid, height): (Rect, f32)) {
    let palette = theme::palette(ui);
    // Above the names of the axes, and as far left as those of the heights.
    let left_top = grid.left_top() - vec2(0.8 * AXES.x, height + 22.0);
    let row = Rect::from_min_max(left_top, pos2(grid.right(), left_top.y + height));
    let dot = row.left_center() + vec2(4.0, 0.0);
    ui.painter().circle_filled(dot, 4.0, run_style(choice).colour);
    let [tried, found] = map.result.counts(choice);
    let name = &map.result.options.choices[choice].name;
    let inner = row.with_min_x(row.left() + 14.0);
    within(ui, inner, Direction::right_to_left(Align::Center), |ui| {
        let counts = RichText::new(format!("{found} of {tried}")).monospace().color(palette.text2);
        ui.label(counts).on_hover_text(format!(
            "Cells that end within {} mm of the target, of those that were fitted",
            format::short(map.result.options.success_mm)
        ));
        ui.with_layout(Direction::left_to_right(Align::Center), |ui| {
            ui.add(egui::Label::new(RichText::new(name).color(palette.text)).wrap());
        });
    });
}

/// The cells of a choice's map; the one under the pointer, and the one that was clicked.
fn cells(
    ui: &Ui,
    map: &ShownMap<'_>,
    choice: usize,
    square: Rect,
) -> (Option<[usize; 2]>, Option<[usize; 2]>) {
    let palette = theme::palette(ui);
    let count = map.grid.cells;
    let (mut under, mut clicked) = (None, None);
    for row in 0..count {
        for column in 0..count {
            let place = [column, row];
            let rect = cell_in(square, count, place);
            let cell = map.result.trial(choice, place);
            let found = cell.is_some_and(|cell| map.result.is_found(cell));
            let limit = map.result.options.success_mm;
            let fill = cell.map(|cell| match map.colour {
                MapColour::Error => error_colour(cell.error_mm, limit),
                MapColour::Success => gradient_colour(if found { FOUND } else { NOT_FOUND }),
            });
            paint_cell(ui.painter(), rect, fill, found, palette);
            let response = ui.interact(rect, Id::unique(("basin cell", choice, place)), Sense::click());
            let label = || cell_text(map, choice, place);
            response.widget_info(|| WidgetInfo::labeled(Role::Button, true, label()));
            if response.hovered() || response.has_focus() {
                under = Some(place);
            }
            if response.clicked() {
                clicked = Some(place);
            }
            response.on_hover_ui(|ui| {
                ui.label(format!("{}\nClick: take this start and step it", label()));
            });
        }
    }
    (under, clicked)
}

/// The cell under the pointer, in every map; the one that was taken; and the pose itself.
fn marks(ui: &Ui, map: &ShownMap<'_>, grid: Rect, under: Option<[usize; 2]>) {
    let count = map.grid.cells;
    let edges = [
        (under, Stroke::new(1.5, theme::palette(ui).text)),
        (map.taken, Stroke::new(2.0, theme::data_colours::SELECTED)),
    ];
    for (place, edge) in edges {
        if let Some(place) = place {
            ui.painter().rect_stroke(cell_in(grid, count, place), 0.0, edge, StrokeKind::Inside);
        }
    }
    // The reference stands in the middle, whether a cell is there or a corner.
    ui.painter().circle_stroke(grid.center(), 5.0, Stroke::new(1.5, theme::data_colours::SELECTED));
}

/// A cell's offsets, and what came of it by a choice of fit.
fn cell_text(map: &ShownMap<'_>, choice: usize, place: [usize; 2]) -> String {
    let by = match map.result.options.choices.as_slice() {
        [] | [_] => String::new(),
        several => format!(" by {}", several.get(choice).map_or("", |choice| &choice.name)),
    };
    format!("Start {}{by}: {}", start_text(map, place), came_text(map, choice, place))
}

fn start_text(map: &ShownMap<'_>, place: [usize; 2]) -> String {
    let [across, up] = place.map(|place| {
        let degrees = map.grid.offset_degrees(place);
        // Offsets are shares of the largest one, and a share of a whole number need not be one to the last bit.
        format::number(degrees, usize::from((degrees - degrees.round()).abs() > 0.05))
    });
    format!("{across}°, {up}°")
}

fn came_text(map: &ShownMap<'_>, choice: usize, place: [usize; 2]) -> String {
    match map.result.trial(choice, place) {
        Some(cell) => {
            let mm = |value: f64| format::number(value, usize::from(value < 99.5));
            format!("from {} to {} mm", mm(cell.start_mm), mm(cell.error_mm))
        }
        None => "not fitted".to_owned(),
    }
}

fn legend(
    ui: &mut Ui,
    map: &ShownMap<'_>,
    colour: &mut MapColour,
    (shown, under): (&[usize], Option<[usize; 2]>),
) {
    let palette = theme::palette(ui);
    segmented(ui, colour, &[(MapColour::Error, "Distance"), (MapColour::Success, "Found")])
        .on_hover_text("What the cells are coloured by");
    ui.add_space(space::WIDGET);
    let (bar, _) = ui.allocate_exact_size(vec2(ui.available_width().min(208.0), 34.0), Sense::hover());
    match map.colour {
        MapColour::Error => error_legend(ui, bar, map.result.options.success_mm),
        MapColour::Success => success_legend(ui, bar),
    }
    let small = |text: &str, colour| RichText::new(text).small().color(colour);
    let limit = format::short(map.result.options.success_mm);
    let words = match map.result.options.choices.as_slice() {
        [one] => {
            let [tried, found] = map.result.counts(0);
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
    let Some(place) = under.or(map.taken) else {
        ui.label(small("Point at a cell for its figures; a click takes its start.", palette.text2));
        return;
    };
    if let [choice] = shown {
        ui.label(small(&cell_text(map, *choice, place), palette.text2));
        return;
    }
    ui.label(small(&format!("Start {}", start_text(map, place)), palette.text));
    for choice in shown {
        let name = &map.result.options.choices[*choice].name;
        let text = format!("{name}: {}", came_text(map, *choice, place));
        ui.label(small(&text, palette.text2));
    }
}

fn success_legend(ui: &Ui, area: Rect) {
    let palette = theme::palette(ui);
    for (index, (share, text)) in [(FOUND, "Found"), (NOT_FOUND, "Not found")].into_iter().enumerate() {
        let corner = area.min + vec2(100.0 * index as f32, 2.0);
        let swatch = Rect::from_min_size(corner, egui::Vec2::splat(size::ICON));
        ui.painter().rect(swatch, 0.0, gradient_colour(share), palette.edge(), StrokeKind::Inside);
        let at = swatch.right_center() + vec2(6.0, 0.0);
        paint_text(ui, at, egui::Align2::LEFT_CENTER, text, TextStyle::Small, palette.text2);
    }
}
