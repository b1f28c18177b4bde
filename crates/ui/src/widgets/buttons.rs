//! Buttons, camera badges, check boxes, combo boxes and segments.

use std::sync::Arc;

use egui::{
    Align2, Button, ComboBox, CornerRadius, FontId, Galley, Painter, Popup, Rect, Response, RichText, Role,
    Sense, StrokeKind, TextStyle, Ui, Vec2, WidgetInfo, WidgetText, pos2, vec2,
};

use super::Icon;
use crate::style::theme;
use crate::style::theme::{camera_colours, size};

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

/// A button of words, as high as one of an icon.
pub fn text_button(ui: &mut Ui, text: &str) -> Response {
    ui.add(Button::new(text).min_size(vec2(0.0, size::BUTTON)))
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

const DIGIT: f32 = 12.0;

/// The badge of the camera of this index, counted from zero; it shows the number counted from one.
pub fn camera_badge(ui: &mut Ui, index: usize) -> Response {
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(size::BADGE), Sense::click());
    let enabled = ui.is_enabled();
    response.widget_info(|| WidgetInfo::labeled(Role::Button, enabled, format!("Camera {}", index + 1)));
    paint_camera_badge(ui.painter(), rect, index);
    response
}

/// Paints the badge in `rect`.
pub fn paint_camera_badge(painter: &Painter, rect: Rect, index: usize) {
    let colours = camera_colours(index);
    painter.rect_filled(rect, CornerRadius::same(size::FIELD_RADIUS), colours.fill);
    let font = FontId::proportional(DIGIT);
    painter.text(rect.center(), Align2::CENTER_CENTER, index + 1, font, colours.text);
}

/// Space for the chevron behind the words that open a menu, in points.
pub const CHEVRON: f32 = 18.0;

/// Words with a chevron behind them that open a menu. `label` is their name for screen readers and tests.
pub fn menu_words(ui: &mut Ui, words: Arc<Galley>, label: &str) -> Response {
    let (rect, response) = ui.allocate_exact_size(vec2(words.size().x + CHEVRON, size::ROW), Sense::click());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, label));
    let palette = theme::palette(ui);
    let is_open = Popup::is_id_open(ui.ctx(), Popup::default_response_id(&response));
    let colour = if response.hovered() || is_open { palette.text } else { palette.text2 };
    ui.painter().galley(pos2(rect.left(), rect.center().y - words.size().y * 0.5), words, colour);
    let chevron = Rect::from_min_max(pos2(rect.right() - size::ICON, rect.top()), rect.max);
    Icon::ChevronDown.paint_scaled(ui.painter(), chevron, colour, 0.85);
    response
}

/// A box with its label; a click on either changes `ticked`.
pub fn checkbox(ui: &mut Ui, ticked: &mut bool, label: &str) -> Response {
    let galley = WidgetText::from(label).into_galley(ui, None, f32::INFINITY, TextStyle::Body);
    let gap = ui.spacing().icon_spacing;
    let width = size::ICON + if label.is_empty() { 0.0 } else { gap + galley.size().x };
    let (rect, mut response) = ui.allocate_exact_size(vec2(width, size::ROW), Sense::click());
    if response.clicked() {
        *ticked = !*ticked;
        response.mark_changed();
    }
    let (enabled, is_ticked) = (ui.is_enabled(), *ticked);
    response.widget_info(|| WidgetInfo::selected(Role::CheckBox, enabled, is_ticked, label));
    if !ui.is_rect_visible(rect) {
        return response;
    }
    let palette = theme::palette(ui);
    let corner = pos2(rect.left(), rect.center().y - 0.5 * size::ICON);
    let square = Rect::from_min_size(corner, vec2(size::ICON, size::ICON));
    let radius = CornerRadius::same(size::FIELD_RADIUS);
    let painter = ui.painter();
    match (is_ticked, enabled) {
        (true, true) => {
            painter.rect(square, radius, palette.accent, palette.accent_edge, StrokeKind::Inside);
            Icon::Check.paint_scaled(painter, square, palette.on_accent, 0.85);
        }
        (true, false) => {
            painter.rect_filled(square, radius, palette.active);
            Icon::Check.paint_scaled(painter, square, palette.text2, 0.85);
        }
        (false, _) => {
            let fill = if response.hovered() { palette.hover } else { palette.field };
            painter.rect(square, radius, fill, palette.edge(), StrokeKind::Inside);
        }
    }
    let text = pos2(square.right() + gap, rect.center().y - 0.5 * galley.size().y);
    painter.galley(text, galley, if enabled { palette.text } else { palette.text3 });
    focus_ring(ui, &response);
    response
}

/// A box of a few choices, named for screen readers. Says which one was chosen.
pub fn choice<T: PartialEq + Copy, S: AsRef<str>>(
    ui: &mut Ui,
    name: &str,
    width: f32,
    chosen: &str,
    choices: &[(T, S, String)],
) -> Option<T> {
    let mut picked = None;
    ui.name_inputs(name, |ui| {
        ComboBox::from_id_salt(name).width(width).selected_text(chosen).show_ui(ui, |ui| {
            for (value, text, tooltip) in choices {
                let text = text.as_ref();
                if ui.selectable_label(text == chosen, text).on_hover_text(tooltip).clicked() {
                    picked = Some(*value);
                }
            }
        });
    });
    picked
}

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
