//! A camera's number on its colour. A camera is never named by colour alone.

use egui::{Align2, CornerRadius, FontId, Painter, Rect, Response, Role, Sense, Ui, Vec2, WidgetInfo};

use crate::style::theme::{camera_colours, size};

/// Size of the digit.
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
    painter.text(rect.center(), Align2::CENTER_CENTER, index + 1, font, colours.digit);
}
