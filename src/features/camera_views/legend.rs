//! The strip at the foot of a picture that says how to read its colours, in a row for each mode that is compared; the
//! overlap too, where there is no gutter.

use std::sync::Arc;

use backlit_ui::drawing::{Legend, Swatch, ViewMode};
use backlit_ui::style::format;
use backlit_ui::style::theme;
use backlit_ui::style::theme::data_colours::{GHOST, HELD_BY_CUE, JOINT, LIKELIER, PICTURE_GROUND};
use backlit_ui::style::theme::{Theme, run_style, space};
use egui::{Color32, Galley, Rect, RichText, Role, Sense, TextStyle, Ui, WidgetInfo, vec2};

use super::TileInput;
use super::comparison::ShownModes;
use super::gutter::IOU;
use super::legend_block::{Block, Item, ROW};
use super::overlays;
use super::tile::TileLayout;

/// Above and below the rows.
const MARGIN: f32 = 2.0;

/// What a picture without gutter leaves free for the strip: one row, in every mode, so that it never jumps.
pub(crate) const RESERVED: f32 = ROW + 2.0 * MARGIN;

/// No more of the picture's height lies under it, but for the first row: legs are at the foot.
const MOST_OF_PICTURE: f32 = 0.16;

/// Opacity of its ground.
const OPACITY: f32 = 0.86;

/// Opacity of what explains the mode that a blink does not show now.
const NOT_NOW: f32 = 0.45;

/// Shows the strip, if there is anything to say, and returns its height.
pub(crate) fn show(ui: &Ui, layout: &TileLayout, input: &TileInput<'_>, seen: ShownModes) -> f32 {
    let has_gutter = layout.gutter.is_some();
    let is_compared = seen.modes().len() > 1;
    let mut modes = seen.modes();
    // The name in the picture's corner says all of footage.
    modes.retain(|mode| !is_compared || mode.legend() != Legend::None);
    let note = (!has_gutter).then(|| note(input)).flatten();
    let further = further_entries(input, has_gutter);
    // The gutter's bar and counts are this legend.
    let says_nothing =
        |mode: ViewMode| mode.legend() == Legend::None || has_gutter && mode == ViewMode::Tinted;
    if !is_compared && says_nothing(modes[0]) && note.is_none() && further.is_empty() {
        return 0.0;
    }
    let palette = theme::colours(Theme::Dark);
    let fonts = [TextStyle::Small, TextStyle::Monospace].map(|style| style.resolve(ui.style()));
    let [small, mono] = &fonts;
    let painter = ui.painter_at(layout.picture);
    let note = note.map(|note| painter.layout_no_wrap(note, mono.clone(), palette.text));
    let note_width = note.as_ref().map_or(0.0, |note| note.size().x);
    let width = layout.picture.width() - 2.0 * space::GROUP;

    let name = |mode: &ViewMode| {
        painter.layout_no_wrap(format!("{}:", mode.short_label()), small.clone(), palette.text)
    };
    let names: Vec<Arc<Galley>> = modes.iter().filter(|_| is_compared).map(name).collect();
    let column = names.iter().map(|name| name.size().x + space::WIDGET).fold(0.0, f32::max);
    let last = modes.len().saturating_sub(1);
    let hatches = hatches(ui, input);
    let all_rows = (MOST_OF_PICTURE * layout.picture.height() / ROW) as usize;
    let most_rows = (all_rows / modes.len()).max(1);
    let block = |(index, mode): (usize, &ViewMode)| {
        let is_told = !is_compared && says_nothing(*mode);
        let mut items =
            if is_told { Vec::new() } else { Item::all_of(*mode, input, hatches, &painter, small) };
        let further = further.iter().filter(|_| index == last);
        items.extend(further.map(|(text, swatch)| Item::new(text.clone(), *swatch, &painter, small)));
        let legend = if is_told { Legend::None } else { mode.legend() };
        let note = if index == last { note_width } else { 0.0 };
        Block::new(legend, items, input, ([width - column, note], most_rows), &painter, small)
    };
    let blocks: Vec<Block> = modes.iter().enumerate().map(block).collect();

    let rows: usize = blocks.iter().map(|block| block.rows).sum();
    let height = rows as f32 * ROW + 2.0 * MARGIN;
    let picture = layout.picture;
    let strip = Rect::from_min_max(egui::pos2(picture.left(), picture.bottom() - height), picture.max);
    painter.rect_filled(strip, 0.0, PICTURE_GROUND.gamma_multiply(OPACITY));
    let mut origin = strip.min + vec2(space::GROUP, MARGIN + ROW * 0.5);
    let mut words: Vec<String> = Vec::new();
    for (index, (block, mode)) in blocks.iter().zip(&modes).enumerate() {
        let opacity = if seen.is_hidden_now(*mode) { NOT_NOW } else { 1.0 };
        let mut painter = painter.clone();
        painter.multiply_opacity(opacity);
        if let Some(name) = names.get(index) {
            painter.galley(origin - vec2(0.0, name.size().y * 0.5), Arc::clone(name), palette.text);
            words.push(name.text().to_owned());
        }
        block.paint(&painter, origin + vec2(column, 0.0), small, &mut words);
        origin.y += block.rows as f32 * ROW;
    }
    if let Some(note) = note {
        let at = origin + vec2(width - note.size().x, -ROW - note.size().y * 0.5);
        words.push(note.text().to_owned());
        painter.galley(at, note, palette.text);
    }
    let node = ui.interact(strip, ui.scope_id().with("legend"), Sense::hover());
    node.widget_info(|| WidgetInfo::labeled(Role::Label, true, format!("Legend: {}", words.join(", "))));
    node.on_hover_ui(|ui| explain(ui, &modes, input));
    height
}

/// What ellipses, outlines of other colours, and marks of the calibration are.
fn further_entries(input: &TileInput<'_>, has_gutter: bool) -> Vec<(String, Swatch)> {
    let marks = input.marks;
    let mut outlines: Vec<(&str, Color32)> = overlays::held_legend(input.held).collect();
    // The gutter counts them, and rivals.
    outlines.extend(overlays::doubts_legend(input).filter(|_| !has_gutter));
    if !input.keypoints.is_empty() {
        outlines.push((overlays::KEYPOINT_LEGEND, HELD_BY_CUE));
    }
    outlines.extend(marks.ghosts.as_ref().map_or_else(Vec::new, overlays::ghost_legend));
    if !has_gutter && marks.rivals.iter().any(Option::is_some) {
        outlines.push((overlays::RIVAL_LEGEND, GHOST));
    }
    if !marks.likelier.is_empty() {
        outlines.push(("Where likely poses pull", LIKELIER));
    }
    if let Some((_, reference)) = marks.references.first() {
        outlines.push(("Ring: the reference’s joint", run_style(*reference).colour));
    }
    let has_calibration = input.settings.calibration_marks && input.camera.is_some();
    let calibration =
        ["Cross: principal point", "x y z: the world’s axes", "Grid: half metres", "Dashes: lens edge"];
    let calibration = calibration.into_iter().filter(|_| has_calibration);
    let ellipses = marks.ellipses.words().map(|text| (text, Swatch::Ring(JOINT)));
    let outlines = outlines.into_iter().map(|(text, colour)| (text.to_owned(), Swatch::Fill(colour)));
    let calibration = calibration.map(|text| (text.to_owned(), Swatch::None));
    ellipses.into_iter().chain(outlines).chain(calibration).collect()
}

/// Whether some pixel of the picture is unknown, and whether one is shadow, looked up when the picture changes.
fn hatches(ui: &Ui, input: &TileInput<'_>) -> [bool; 2] {
    if let Some(known) = input.has_unknown_and_shadow {
        return known;
    }
    let id = ui.scope_id().with("hatches");
    let known = ui.data(|data| data.get_temp::<(u64, [bool; 2])>(id));
    if let Some((_, known)) = known.filter(|(generation, _)| *generation == input.generation) {
        return known;
    }
    let hatches = [input.picture.has_unknown(), input.picture.has_shadow()];
    ui.data_mut(|data| data.insert_temp(id, (input.generation, hatches)));
    hatches
}

/// What the colours mean, in sentences.
fn explain(ui: &mut Ui, modes: &[ViewMode], input: &TileInput<'_>) {
    for mode in modes {
        ui.label(RichText::new(format!("{}   {}", mode.label(), mode.key())).strong());
        ui.label(mode.explanation());
    }
    if input.overlap.is_some() {
        ui.label(IOU);
    }
    if input.marks.ghosts.is_some() {
        ui.label(
            "A step of a way to begin, in the place of the pose. Sticks are bodies that were tried, each as faint as it weighs \
             little; the outline is the one that the step is about. White is a template that is laid on the silhouette.",
        );
    }
    if !input.doubts.is_empty() {
        ui.label(overlays::doubts_tooltip(input));
    }
    if !input.marks.ellipses.joints.is_empty() {
        ui.label(
            "Ellipses: where each joint may be, two standard deviations, from the data alone. Point at a \
             joint for the numbers. Arrows show directions that nothing bounds.",
        );
    }
}

/// What stands at the strip's right: the overlap, or what is missing for it.
fn note(input: &TileInput<'_>) -> Option<String> {
    if !input.is_calibrated {
        return Some("Not calibrated".to_owned());
    }
    match input.overlap {
        Some(overlap) => overlap.iou().map(|iou| format!("IoU {}", format::ratio(iou))),
        None if input.picture.mask.is_none() => Some("No silhouette yet".to_owned()),
        None => None,
    }
}
