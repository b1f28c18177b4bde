//! The strip at the foot of a picture that says how to read its colours; the overlap too, where there is no gutter.

use std::sync::Arc;

use egui::{
    Align2, Color32, CornerRadius, FontId, Galley, Mesh, Painter, Pos2, Rect, Role, Sense, Shape, Stroke,
    StrokeKind, TextStyle, Ui, WidgetInfo, pos2, vec2,
};

use super::{CameraTileInput, TileLayout};
use crate::format;
use crate::picture::{Derivative, Legend, LegendEntry, NO_CHANGE_LEGEND, NO_PULL_LEGEND, Swatch, ViewMode};
use crate::theme::data_colours::{MAP_LEN, PICTURE_GROUND, gradient_map, mark, residual_map};
use crate::theme::{Palette, Theme, space};

/// Height of a row.
const ROW: f32 = 18.0;

/// Above and below the rows.
const MARGIN: f32 = 2.0;

/// What a picture without gutter leaves free for the strip: one row, in every mode, so that it never jumps.
pub(super) const RESERVED: f32 = ROW + 2.0 * MARGIN;

/// A map's bar is at least this long; else what stands beside it goes to a row of its own.
const LEAST_BAR: f32 = 60.0;

/// Opacity of its ground.
const OPACITY: f32 = 0.86;

/// Side of a swatch.
const SWATCH: f32 = 10.0;

/// About the width of the words at the ends of a map's bar.
const MAP_WORDS: f32 = 160.0;

/// Height of a map's bar.
const BAR: f32 = 6.0;

/// Shows the strip, if there is anything to say, and returns its height.
pub(super) fn show(ui: &Ui, layout: &TileLayout, input: &CameraTileInput<'_>, shown: ViewMode) -> f32 {
    let has_gutter = layout.gutter.is_some();
    let legend = match shown.legend() {
        // The gutter's bar and counts are this legend.
        Legend::Entries(_) if has_gutter && shown == ViewMode::Tinted => Legend::None,
        legend => legend,
    };
    let note = (!has_gutter).then(|| note(input)).flatten();
    if legend == Legend::None && note.is_none() {
        return 0.0;
    }
    let palette = Theme::Dark.palette();
    let fonts = [TextStyle::Small, TextStyle::Monospace].map(|style| style.resolve(ui.style()));
    let [small, mono] = &fonts;
    let picture = layout.picture;
    let painter = ui.painter_at(picture);
    let width = picture.width() - 2.0 * space::GROUP;
    let items = items(&painter, legend, small, palette);
    let note = note.map(|note| painter.layout_no_wrap(note, mono.clone(), palette.text));
    let note_width = note.as_ref().map_or(0.0, |note| note.size().x);
    let is_map = matches!(legend, Legend::ResidualMap | Legend::GradientMap | Legend::JacobianMap);
    let map_width = is_map.then_some(MAP_WORDS + LEAST_BAR);
    let widths: Vec<f32> = map_width.into_iter().chain(items.iter().map(|item| item.width)).collect();
    let (mut places, rows) = flow(&widths, note_width, width);
    if is_map {
        places.remove(0);
    }
    // The map takes what the others leave of the first row; they stand at its end.
    let beside: f32 =
        places.iter().zip(&items).filter(|([_, row], _)| *row == 0.0).map(|(_, item)| item.width).sum();
    let note_beside = if rows == 1 && note_width > 0.0 { note_width + space::GROUP } else { 0.0 };
    let map_room = width - note_beside - if beside > 0.0 { beside + space::GROUP } else { 0.0 };
    for place in places.iter_mut().filter(|[_, row]| is_map && *row == 0.0) {
        place[0] = map_room + space::GROUP;
    }

    let height = rows as f32 * ROW + 2.0 * MARGIN;
    let strip = Rect::from_min_max(pos2(picture.left(), picture.bottom() - height), picture.max);
    painter.rect_filled(strip, 0.0, PICTURE_GROUND.gamma_multiply(OPACITY));
    let origin = strip.min + vec2(space::GROUP, MARGIN + ROW * 0.5);
    let mut words: Vec<String> = Vec::new();
    for (item, [x, row]) in items.iter().zip(&places) {
        paint_swatch(&painter, origin + vec2(*x, row * ROW), item.entry.swatch, palette);
        let at = origin + vec2(x + item.indent, row * ROW - item.galley.size().y * 0.5);
        painter.galley(at, Arc::clone(&item.galley), palette.text2);
        words.push(item.entry.text.to_owned());
    }
    if let Some(map) = MapLegend::new(legend, input, palette) {
        map.paint(&painter, Rect::from_min_size(origin, vec2(map_room, 0.0)), small);
        words.push(format!("{} to {}", map.low, map.high));
    }
    if let Some(note) = note {
        let last_row = (rows - 1) as f32 * ROW;
        let at = origin + vec2(width - note.size().x, last_row - note.size().y * 0.5);
        words.push(note.text().to_owned());
        painter.galley(at, note, palette.text);
    }
    let node = ui.interact(strip, ui.scope_id().with("legend"), Sense::hover());
    node.widget_info(|| WidgetInfo::labeled(Role::Label, true, format!("Legend: {}", words.join(", "))));
    height
}

/// An entry laid out.
struct Item {
    entry: LegendEntry,
    galley: Arc<Galley>,
    /// From the swatch's left edge to the words.
    indent: f32,
    width: f32,
}

/// The entries of a legend; a map's stand beside it.
fn items(painter: &Painter, legend: Legend, font: &FontId, palette: &Palette) -> Vec<Item> {
    let entries = match legend {
        Legend::Entries(entries) => entries,
        Legend::GradientMap => NO_PULL_LEGEND,
        Legend::JacobianMap => NO_CHANGE_LEGEND,
        Legend::None | Legend::ResidualMap => &[],
    };
    let item = |entry: &LegendEntry| {
        let galley = painter.layout_no_wrap(entry.text.to_owned(), font.clone(), palette.text2);
        let indent = if entry.swatch == Swatch::None { 0.0 } else { SWATCH + space::WIDGET - 2.0 };
        Item { entry: *entry, indent, width: indent + galley.size().x, galley }
    };
    entries.iter().map(item).collect()
}

/// Places for items of these widths in rows `room` wide: x and row of each, and the number of rows. The last row
/// leaves room for the note at its end, or the note has a row of its own.
fn flow(widths: &[f32], note: f32, room: f32) -> (Vec<[f32; 2]>, usize) {
    let (mut x, mut row) = (0.0, 0);
    let mut places = Vec::new();
    for width in widths {
        if x > 0.0 && x + width > room {
            (x, row) = (0.0, row + 1);
        }
        places.push([x, row as f32]);
        x += width + space::GROUP;
    }
    if note > 0.0 && x + note > room {
        row += 1;
    }
    (places, row + 1)
}

/// What stands at the strip's right: the overlap, or what is missing for it.
fn note(input: &CameraTileInput<'_>) -> Option<String> {
    if !input.is_calibrated {
        return Some("Not calibrated".to_owned());
    }
    match input.overlap {
        Some(overlap) => overlap.iou().map(|iou| format!("IoU {}", format::ratio(iou))),
        None if input.picture.mask.is_none() => Some("No silhouette yet".to_owned()),
        None => None,
    }
}

/// `at` is the middle of the swatch's left edge.
fn paint_swatch(painter: &Painter, at: Pos2, swatch: Swatch, palette: &Palette) {
    let square = Rect::from_min_size(at - vec2(0.0, SWATCH * 0.5), vec2(SWATCH, SWATCH));
    let radius = CornerRadius::same(2);
    match swatch {
        Swatch::Fill(colour) => {
            painter.rect(square, radius, colour, palette.edge(), StrokeKind::Inside);
        }
        Swatch::Hatch(colour) => {
            painter.rect(square, radius, PICTURE_GROUND, palette.edge(), StrokeKind::Inside);
            hatch(painter, square, mark::UNKNOWN_HATCH, colour, false);
        }
        Swatch::NoGradient(colour) => {
            painter.rect(square, radius, PICTURE_GROUND, palette.edge(), StrokeKind::Inside);
            hatch(painter, square, mark::NO_GRADIENT_HATCH, colour, true);
        }
        Swatch::None => {}
    }
}

/// The lines of a hatch inside a swatch's edge.
fn hatch(painter: &Painter, square: Rect, [width, period]: [f32; 2], colour: Color32, rises: bool) {
    let stroke = Stroke::new(width, colour);
    let inside = painter.with_clip_rect(square.shrink(1.0).intersect(painter.clip_rect()));
    let mut offset = -SWATCH;
    while offset < SWATCH {
        let (start, along) = if rises {
            (square.left_bottom(), vec2(SWATCH, -SWATCH))
        } else {
            (square.left_top(), vec2(SWATCH, SWATCH))
        };
        let start = start + vec2(offset, 0.0);
        inside.line_segment([start, start + along], stroke);
        offset += period * 0.8;
    }
}

/// A colour map between its ends, in words and numbers.
struct MapLegend {
    low: String,
    high: String,
    word_colours: [Color32; 2],
    map: &'static [Color32; MAP_LEN],
}

impl MapLegend {
    fn new(legend: Legend, input: &CameraTileInput<'_>, palette: &Palette) -> Option<Self> {
        let picture = &input.picture;
        let scale = |derivative: Option<&Derivative>| {
            derivative.map_or(format::MISSING.to_owned(), |d| format::cost(f64::from(d.scale)))
        };
        match legend {
            Legend::ResidualMap => Some(Self {
                low: "Missing −255".to_owned(),
                high: "255 Spurious".to_owned(),
                word_colours: [palette.missing_text, palette.spurious_text],
                map: residual_map(),
            }),
            Legend::GradientMap => Some(Self {
                low: "Pull 0".to_owned(),
                high: format!("{} / m", scale(picture.gradient)),
                word_colours: [palette.text2; 2],
                map: gradient_map(),
            }),
            Legend::JacobianMap => Some(Self {
                low: format!("Darker −{}", scale(picture.jacobian)),
                high: format!("{} lighter / {}", scale(picture.jacobian), input.settings.axis.unit()),
                word_colours: [palette.missing_text, palette.spurious_text],
                map: residual_map(),
            }),
            Legend::None | Legend::Entries(_) => None,
        }
    }

    /// Paints along the middle of `room`.
    fn paint(&self, painter: &Painter, room: Rect, font: &FontId) {
        let y = room.center().y;
        let word = |x: f32, align: Align2, text: &str, colour: Color32| {
            painter.text(pos2(x, y), align, text, font.clone(), colour)
        };
        let low = word(room.left(), Align2::LEFT_CENTER, &self.low, self.word_colours[0]);
        let high = word(room.right(), Align2::RIGHT_CENTER, &self.high, self.word_colours[1]);
        let bar = Rect::from_min_max(
            pos2(low.right() + space::WIDGET, y - BAR * 0.5),
            pos2(high.left() - space::WIDGET, y + BAR * 0.5),
        );
        if bar.width() <= 0.0 {
            return;
        }
        let mut mesh = Mesh::default();
        for (index, colour) in self.map.iter().enumerate() {
            let x = bar.left() + bar.width() * index as f32 / (MAP_LEN - 1) as f32;
            let first = index as u32 * 2;
            mesh.colored_vertex(pos2(x, bar.top()), *colour);
            mesh.colored_vertex(pos2(x, bar.bottom()), *colour);
            if index > 0 {
                mesh.add_triangle(first - 2, first - 1, first);
                mesh.add_triangle(first, first - 1, first + 1);
            }
        }
        painter.add(Shape::mesh(mesh));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_has_no_room_goes_to_the_next_row() {
        let (places, rows) = flow(&[60.0, 60.0, 60.0], 50.0, 300.0);
        assert_eq!((places, rows), (vec![[0.0, 0.0], [72.0, 0.0], [144.0, 0.0]], 1));
        let (places, rows) = flow(&[60.0, 60.0, 60.0], 50.0, 200.0);
        assert_eq!((places[2], rows), ([0.0, 1.0], 2));
        assert_eq!(flow(&[190.0], 50.0, 200.0).1, 2);
        assert_eq!(flow(&[190.0], 0.0, 200.0).1, 1);
        assert_eq!(flow(&[], 50.0, 200.0).1, 1);
    }
}
