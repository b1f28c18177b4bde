//! How to read the colours of one view mode: swatches with words, or a colour map between its ends.

use std::sync::Arc;

use backlit_ui::drawing::{
    Derivative, Legend, NO_CHANGE_LEGEND, NO_PULL_LEGEND, Swatch, UNKNOWN_LEGEND, ViewMode, limb_chains,
};
use backlit_ui::style::format;
use backlit_ui::style::theme;
use backlit_ui::style::theme::data_colours::{MAP_LEN, PICTURE_GROUND, gradient_map, mark, residual_map};
use backlit_ui::style::theme::{Palette, Theme, space};
use egui::{
    Align2, Color32, CornerRadius, FontId, Galley, Mesh, Painter, Pos2, Rect, Shape, Stroke, StrokeKind,
    pos2, vec2,
};

use super::TileInput;

pub(crate) const ROW: f32 = 18.0;

/// A map's bar is at least this long; else what stands beside it goes to a row of its own.
const LEAST_BAR: f32 = 48.0;
const SWATCH: f32 = 10.0;
const BAR: f32 = 6.0;

/// An entry laid out.
pub(crate) struct Item {
    swatch: Swatch,
    galley: Arc<Galley>,
    /// From the swatch's left edge to the words.
    indent: f32,
    width: f32,
}

impl Item {
    /// A swatch with its word.
    pub(crate) fn new(text: String, swatch: Swatch, painter: &Painter, font: &FontId) -> Self {
        let galley = painter.layout_no_wrap(text, font.clone(), theme::colours(Theme::Dark).text2);
        let indent = if swatch == Swatch::None { 0.0 } else { SWATCH + space::WIDGET - 2.0 };
        Self { swatch, indent, width: indent + galley.size().x, galley }
    }

    /// The entries of a mode; a map's stand beside it.
    pub(crate) fn all_of(
        mode: ViewMode,
        input: &TileInput<'_>,
        [has_unknown, has_shadow]: [bool; 2],
        painter: &Painter,
        font: &FontId,
    ) -> Vec<Self> {
        let entries = match mode.legend() {
            Legend::Entries(entries) => entries,
            Legend::ResidualMap => UNKNOWN_LEGEND,
            Legend::GradientMap => NO_PULL_LEGEND,
            Legend::JacobianMap => NO_CHANGE_LEGEND,
            Legend::None => &[],
            Legend::Chains => {
                let chains = limb_chains(input.body).into_iter();
                let item = |(name, colour)| Self::new(name, Swatch::Fill(colour), painter, font);
                return chains.map(item).collect();
            }
        };
        // A hatch is explained where there is one to be seen.
        let is_seen = |swatch: Swatch| match swatch {
            Swatch::Hatch(_) => has_unknown,
            Swatch::Shadow(_) => has_shadow,
            _ => true,
        };
        let seen = entries.iter().filter(|entry| is_seen(entry.swatch));
        seen.map(|entry| Self::new(entry.text.to_owned(), entry.swatch, painter, font)).collect()
    }
}

/// The entries of a mode in their places.
pub(crate) struct Block {
    items: Vec<Item>,
    /// x and row of each.
    places: Vec<[f32; 2]>,
    map: Option<MapLegend>,
    map_room: f32,
    /// Rows that it takes; one at least.
    pub(crate) rows: usize,
}

impl Block {
    /// Lays it out in at most `most_rows` rows that are `room` wide; the last one leaves free what `note` takes. Items for which there
    /// is no row are left to the tooltip.
    pub(crate) fn new(
        legend: Legend,
        mut items: Vec<Item>,
        input: &TileInput<'_>,
        ([room, note], most_rows): ([f32; 2], usize),
        painter: &Painter,
        font: &FontId,
    ) -> Self {
        let map = MapLegend::new(legend, input, theme::colours(Theme::Dark));
        let map_width = map.as_ref().map(|map| map.least_width(painter, font));
        let (mut places, rows) = loop {
            let widths: Vec<f32> = map_width.into_iter().chain(items.iter().map(|item| item.width)).collect();
            let (places, rows) = flow(&widths, note, room);
            if rows <= most_rows || items.pop().is_none() {
                break (places, rows);
            }
        };
        if map.is_some() {
            places.remove(0);
        }
        // The map takes what the others leave of the first row; they stand at its end.
        let first_row = places.iter().zip(&items).filter(|([_, row], _)| *row == 0.0);
        let beside: f32 = first_row.map(|(_, item)| item.width + space::GROUP).sum();
        let note_beside = if rows == 1 && note > 0.0 { note + space::GROUP } else { 0.0 };
        let map_room = room - note_beside - beside;
        let mut x = map_room + space::GROUP;
        for (place, item) in places.iter_mut().zip(&items).filter(|(place, _)| place[1] == 0.0) {
            if map.is_some() {
                place[0] = x;
                x += item.width + space::GROUP;
            }
        }
        Self { items, places, map, map_room, rows }
    }

    /// Paints it with the middle of its first row's left edge at `origin`, and says what it says.
    pub(crate) fn paint(&self, painter: &Painter, origin: Pos2, font: &FontId, words: &mut Vec<String>) {
        let palette = theme::colours(Theme::Dark);
        for (item, [x, row]) in self.items.iter().zip(&self.places) {
            paint_swatch(painter, origin + vec2(*x, row * ROW), item.swatch, palette);
            let at = origin + vec2(x + item.indent, row * ROW - item.galley.size().y * 0.5);
            painter.galley(at, Arc::clone(&item.galley), palette.text2);
            words.push(item.galley.text().to_owned());
        }
        if let Some(map) = &self.map {
            map.paint(painter, Rect::from_min_size(origin, vec2(self.map_room, 0.0)), font);
            words.push(format!("{} to {}", map.low, map.high));
        }
    }
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

/// `at` is the middle of the swatch's left edge.
fn paint_swatch(painter: &Painter, at: Pos2, swatch: Swatch, palette: &Palette) {
    let square = Rect::from_min_size(at - vec2(0.0, SWATCH * 0.5), vec2(SWATCH, SWATCH));
    let radius = CornerRadius::same(2);
    let ground = match swatch {
        Swatch::Fill(colour) => Some(colour),
        Swatch::Hatch(_) | Swatch::Shadow(_) | Swatch::NoGradient(_) => Some(PICTURE_GROUND),
        Swatch::Ring(_) | Swatch::None => None,
    };
    if let Some(ground) = ground {
        painter.rect(square, radius, ground, palette.edge(), StrokeKind::Inside);
    }
    match swatch {
        Swatch::Hatch(colour) => hatch(painter, square, mark::UNKNOWN_HATCH, colour, false),
        Swatch::NoGradient(colour) => hatch(painter, square, mark::NO_GRADIENT_HATCH, colour, true),
        Swatch::Shadow(colour) => {
            let [width, period] = mark::SHADOW_HATCH;
            let inside = square.shrink(1.0);
            for line in 0..(inside.height() / period) as usize {
                let y = inside.top() + (line as f32 + 0.5) * period;
                painter.hline(inside.x_range(), y, Stroke::new(width, colour));
            }
        }
        Swatch::Ring(colour) => {
            let radius = vec2(SWATCH * 0.5, SWATCH * 0.35);
            painter.add(Shape::ellipse_stroke(square.center(), radius, Stroke::new(1.25, colour)));
        }
        Swatch::Fill(_) | Swatch::None => {}
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
    fn new(legend: Legend, input: &TileInput<'_>, palette: &Palette) -> Option<Self> {
        let picture = &input.picture;
        let scale = |derivative: Option<&Derivative>| {
            derivative.map_or(format::MISSING.to_owned(), |d| format::cost(f64::from(d.scale)))
        };
        match legend {
            Legend::ResidualMap => Some(Self {
                low: "Missing −255".to_owned(),
                high: "255 spurious".to_owned(),
                word_colours: [palette.missing_text, palette.spurious_text],
                map: residual_map(),
            }),
            Legend::GradientMap => Some(Self {
                low: "Pull 0".to_owned(),
                high: format!("{} grey/m", scale(picture.gradient)),
                word_colours: [palette.text2; 2],
                map: gradient_map(),
            }),
            Legend::JacobianMap => Some(Self {
                low: format!("Darker −{}", scale(picture.jacobian)),
                high: format!("{} lighter, grey/{}", scale(picture.jacobian), input.settings.axis.unit()),
                word_colours: [palette.missing_text, palette.spurious_text],
                map: residual_map(),
            }),
            Legend::None | Legend::Entries(_) | Legend::Chains => None,
        }
    }

    /// With the shortest bar.
    fn least_width(&self, painter: &Painter, font: &FontId) -> f32 {
        let width = |text: &str| {
            painter.layout_no_wrap(text.to_owned(), font.clone(), Color32::WHITE).size().x + space::WIDGET
        };
        width(&self.low) + LEAST_BAR + width(&self.high)
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
