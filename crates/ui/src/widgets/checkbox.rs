//! A box that is ticked or not, with an edge that can be seen when it is not.

use egui::{
    CornerRadius, Rect, Response, Role, Sense, StrokeKind, TextStyle, Ui, WidgetInfo, WidgetText, pos2, vec2,
};

use super::Icon;
use super::button::focus_ring;
use crate::style::theme;
use crate::style::theme::size;

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
