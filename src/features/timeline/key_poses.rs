//! Key poses: diamonds on the ruler, each a button that goes to its frame.

use backlit_ui::style::theme;
use egui::{Id, Rect, Role, Sense, Shape, Stroke, Ui, Vec2, WidgetInfo, pos2, vec2};

use super::marks;
use super::span::Scale;
use crate::context::{Context, Requests, SessionRequest};

/// Half a diamond.
const HALF: f32 = 5.0;
/// Half a diamond under the pointer.
const HALF_HOVERED: f32 = 6.5;
/// Half the square that takes the pointer.
const TARGET: f32 = 8.0;

/// The diamonds. Says which one is under the pointer.
pub(crate) fn ui(
    ui: &Ui,
    context: &Context<'_>,
    requests: &mut Requests,
    plot: Rect,
    scale: &Scale,
    count: usize,
) -> Option<usize> {
    let palette = theme::palette(ui);
    let y = marks::line(plot);
    let mut hovered = None;
    let mut before = f32::NEG_INFINITY;
    for (&frame, _) in context.document().keys.range(scale.span.frames(count)) {
        let at = pos2(scale.x(frame as f64), y);
        if at.x - before < 1.0 || !plot.x_range().expand(0.5).contains(at.x) {
            continue;
        }
        before = at.x;
        let target = Rect::from_center_size(at, Vec2::splat(2.0 * TARGET));
        let response = ui.interact(target, Id::unique(("key pose", frame)), Sense::click());
        let name = || WidgetInfo::labeled(Role::Button, true, format!("Key pose of frame {frame}"));
        response.widget_info(name);
        if response.clicked() {
            requests.request(SessionRequest::Frame(frame));
        }
        let is_hovered = response.hovered();
        if is_hovered {
            hovered = Some(frame);
        }
        let half = if is_hovered || response.has_focus() { HALF_HOVERED } else { HALF };
        let corners = [vec2(0.0, -half), vec2(half, 0.0), vec2(0.0, half), vec2(-half, 0.0)];
        let corners = corners.map(|corner| at + corner).to_vec();
        // A gap in the colour of the panel keeps it apart from its neighbours and from the bar.
        let edge = if response.has_focus() { palette.accent_text } else { palette.panel };
        ui.painter().add(Shape::convex_polygon(corners, palette.text, Stroke::new(1.5, edge)));
    }
    hovered
}
