//! Buttons with an icon, and the one primary button.

use egui::{Button, CornerRadius, Response, RichText, Role, Sense, StrokeKind, Ui, WidgetInfo, vec2};

use super::Icon;
use crate::style::theme;
use crate::style::theme::size;

/// A square button that shows only an icon. `label` is its name for screen readers and tests, `tooltip`
/// what it says under the pointer.
pub fn icon_button(ui: &mut Ui, icon: Icon, label: &str, tooltip: &str) -> Response {
    paint_icon_button(ui, icon, label, tooltip, None)
}

/// An [`icon_button`] that is on or off; a click changes `on`.
pub fn icon_toggle(ui: &mut Ui, icon: Icon, label: &str, tooltip: &str, on: &mut bool) -> Response {
    let mut response = paint_icon_button(ui, icon, label, tooltip, Some(*on));
    if response.clicked() {
        *on = !*on;
        response.mark_changed();
    }
    response
}

fn paint_icon_button(ui: &mut Ui, icon: Icon, label: &str, tooltip: &str, on: Option<bool>) -> Response {
    let (rect, response) = ui.allocate_exact_size(vec2(size::BUTTON, size::BUTTON), Sense::click());
    let enabled = ui.is_enabled();
    response.widget_info(|| match on {
        Some(on) => WidgetInfo::selected(Role::Button, enabled, on, label),
        None => WidgetInfo::labeled(Role::Button, enabled, label),
    });
    if ui.is_rect_visible(rect) {
        let palette = theme::palette(ui);
        let is_on = on == Some(true);
        let pressed = response.is_pointer_button_down_on();
        let radius = CornerRadius::same(size::BUTTON_RADIUS);
        if enabled && (pressed || response.hovered() || is_on) {
            let fill = if pressed || is_on { palette.active } else { palette.hover };
            ui.painter().rect_filled(rect, radius, fill);
        }
        let colour = match (enabled, response.hovered() || pressed || is_on) {
            (false, _) => palette.text3,
            (true, true) => palette.text,
            (true, false) => palette.text2,
        };
        icon.paint(ui.painter(), rect, colour);
        focus_ring(ui, &response);
    }
    response.on_hover_text(tooltip).on_disabled_hover_text(tooltip)
}

/// The one button that is the likely next act, in the accent. There is at most one on the screen.
pub fn primary_button(ui: &mut Ui, text: &str) -> Response {
    let palette = theme::palette(ui);
    let button = Button::new(RichText::new(text).color(palette.on_accent))
        .fill(palette.accent)
        .stroke(palette.accent_edge)
        .min_size(vec2(0.0, size::BUTTON));
    let response = ui.add(button);
    focus_ring(ui, &response);
    response
}

/// The ring around a widget that has the keyboard, outside of it.
pub(super) fn focus_ring(ui: &Ui, response: &Response) {
    if response.has_focus() {
        let radius = CornerRadius::same(size::BUTTON_RADIUS + 1);
        let stroke = theme::palette(ui).focus_ring();
        ui.painter().rect_stroke(response.rect.expand(1.0), radius, stroke, StrokeKind::Outside);
    }
}
