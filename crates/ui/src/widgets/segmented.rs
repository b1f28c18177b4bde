//! One choice of a few, side by side.

use egui::{
    Align2, CornerRadius, Rect, Response, Role, Sense, StrokeKind, TextStyle, Ui, WidgetInfo, WidgetText,
    pos2, vec2,
};

use super::button::focus_ring;
use crate::style::theme;
use crate::style::theme::size;

/// Space on each side of a segment's text.
const PADDING: f32 = 12.0;

/// A row of segments of equal width, one for each of `choices`, of which `chosen` is on. A click, or
/// Space on the focused segment, changes `chosen`; then the response says [`Response::changed`].
pub fn segmented<T: PartialEq + Copy>(ui: &mut Ui, chosen: &mut T, choices: &[(T, &str)]) -> Response {
    let font = TextStyle::Button.resolve(ui.style());
    let widest = choices
        .iter()
        .map(|(_, text)| {
            let text = WidgetText::from(*text);
            text.into_galley(ui, None, f32::INFINITY, TextStyle::Button).size().x
        })
        .fold(0.0, f32::max);
    let segment = vec2((widest + 2.0 * PADDING).ceil(), size::BUTTON);
    let total = vec2(segment.x * choices.len() as f32, segment.y);
    let (rect, mut group) = ui.allocate_exact_size(total, Sense::hover());
    let palette = theme::palette(ui);
    let radius = CornerRadius::same(size::BUTTON_RADIUS);
    ui.painter().rect(rect, radius, palette.field, palette.hairline(), StrokeKind::Inside);

    for (index, (value, text)) in choices.iter().enumerate() {
        let corner = pos2(rect.left() + segment.x * index as f32, rect.top());
        let segment_rect = Rect::from_min_size(corner, segment);
        let mut response = ui.interact(segment_rect, group.id.with(index), Sense::click());
        let is_chosen = value == chosen;
        if response.clicked() && !is_chosen {
            *chosen = *value;
            response.mark_changed();
        }
        let is_chosen = value == chosen;
        let enabled = ui.is_enabled();
        response.widget_info(|| WidgetInfo::selected(Role::RadioButton, enabled, is_chosen, text));
        if is_chosen {
            ui.painter().rect_filled(segment_rect, radius, palette.active);
        } else if response.hovered() {
            ui.painter().rect_filled(segment_rect.shrink(1.0), radius, palette.hover);
        }
        let colour = match (enabled, is_chosen || response.hovered()) {
            (false, _) => palette.text3,
            (true, true) => palette.text,
            (true, false) => palette.text2,
        };
        ui.painter().text(segment_rect.center(), Align2::CENTER_CENTER, text, font.clone(), colour);
        focus_ring(ui, &response);
        group |= response;
    }
    group
}
