//! The probabilities of the frame on the screen, one row a motion.

use backlit_ui::style::format;
use backlit_ui::style::theme;
use backlit_ui::style::theme::{motion_colours, space};
use egui::{Align2, Id, Rect, Role, Sense, TextStyle, Ui, WidgetInfo, pos2, vec2};

use crate::context::marks::whole_percent;
use crate::features::motions::job::RecognisedMotions;

/// Height of the line that says what the frame is.
pub(super) const TITLE: f32 = 20.0;
/// Height of a row.
const ROW: f32 = 17.0;
/// Width of the longest name and of a percentage.
const NAME: f32 = 112.0;
const PERCENT: f32 = 50.0;
/// From this width on there are two columns.
const TWO_COLUMNS: f32 = 430.0;
/// Side of the mark of a colour.
const SWATCH: f32 = 9.0;

fn columns(width: f32) -> usize {
    if width >= TWO_COLUMNS { 2 } else { 1 }
}

/// The room that all rows want.
pub(super) fn height(found: &RecognisedMotions, width: f32) -> f32 {
    TITLE + ROW * found.names.len().div_ceil(columns(width)) as f32
}

/// What the frame is, and as many rows as there is room for.
pub(super) fn ui(ui: &Ui, area: Rect, found: &RecognisedMotions, frame: usize) {
    let palette = theme::palette(ui);
    let painter = ui.painter().with_clip_rect(area);
    let [body, small] = [TextStyle::Body, TextStyle::Small].map(|style| style.resolve(ui.style()));
    let mono = TextStyle::Monospace.resolve(ui.style());
    let number = format::count(frame as i64);
    let named = found.frame(frame);
    let title = match named {
        None => format!("Frame {number} has no name: it is not tracked, or in a piece that is too short."),
        Some(named) => {
            let likeliest =
                (0..named.shares.len()).max_by(|&a, &b| named.shares[a].total_cmp(&named.shares[b]));
            let nearest = match named.class {
                Some(_) => String::new(),
                None => format!(". Nearest is {}", found.name(likeliest)),
            };
            let sure = whole_percent(named.confidence);
            format!("Frame {number}: {}{nearest}, {sure}", found.name(named.class))
        }
    };
    let swatch =
        Rect::from_center_size(pos2(area.left() + 6.0, area.top() + 0.5 * TITLE), vec2(SWATCH, SWATCH));
    let mut left = area.left();
    if let Some(named) = named {
        painter.rect_filled(swatch, 2.0, motion_colours(named.class).fill);
        left = swatch.right() + space::ROW + 2.0;
    }
    painter.text(pos2(left, swatch.center().y), Align2::LEFT_CENTER, &title, body, palette.text);
    let place = Rect::from_min_size(area.min, vec2(area.width(), TITLE));
    let said = ui.interact(place, Id::unique("frame's motion"), Sense::hover());
    said.widget_info(|| WidgetInfo::labeled(Role::Label, true, &title));
    let (Some(named), columns) = (named, columns(area.width())) else { return };
    let rows = found.names.len().div_ceil(columns);
    let width = (area.width() - space::GROUP * (columns - 1) as f32) / columns as f32;
    for (class, (name, share)) in found.names.iter().zip(&named.shares).enumerate() {
        let corner =
            vec2((width + space::GROUP) * (class / rows) as f32, TITLE + ROW * (class % rows) as f32);
        let row = Rect::from_min_size(area.min + corner, vec2(width, ROW));
        if row.bottom() > area.bottom() + 0.5 {
            continue;
        }
        let y = row.center().y;
        painter.text(pos2(row.left(), y), Align2::LEFT_CENTER, name, small.clone(), palette.text2);
        let text = whole_percent(*share);
        painter.text(pos2(row.right(), y), Align2::RIGHT_CENTER, text, mono.clone(), palette.text);
        let across = row.left() + NAME..=(row.right() - PERCENT).max(row.left() + NAME);
        let bar = Rect::from_x_y_ranges(across, y - 4.0..=y + 4.0);
        painter.rect_filled(bar, 2.0, palette.field);
        let part = Rect::from_min_size(bar.min, vec2(bar.width() * *share as f32, bar.height()));
        painter.rect_filled(part, 2.0, motion_colours(Some(class)).fill);
        let said = ui.interact(row, Id::unique(("motion's share", class)), Sense::hover());
        said.widget_info(|| {
            WidgetInfo::labeled(Role::Label, true, format!("{name}: {}", whole_percent(*share)))
        });
    }
}
