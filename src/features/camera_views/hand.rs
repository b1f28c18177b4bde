//! Drawing over silhouettes by hand: the line that is drawn, the brush under the pointer, and the region of interest.

use backlit_tracking::silhouette::Label;
use backlit_ui::style::theme::data_colours::{CASING, JOINT, WHITE};
use backlit_ui::widgets::cased;
use egui::{CursorIcon, PointerButton, Rect, Response, Stroke, StrokeKind};
use glam::DVec2;

use super::TileEvent;
use super::picture_view::ShownPicture;
use super::tile::TileState;
use crate::context::marks::SilhouetteTool;

/// A line gets another corner after so much travel, in pixels of the picture.
const CORNER_PX: f32 = 0.75;
/// How much of the picture is seen through a stroke that is being drawn.
const OPACITY: f32 = 0.55;
/// How much the picture is darkened outside the region of interest.
const OUTSIDE: f32 = 0.45;

/// Draws with the left button; the line is handed on when it is let go.
pub(super) fn draw(
    shown: &ShownPicture<'_>,
    response: &Response,
    tool: SilhouetteTool,
    radius_px: f32,
    state: &mut TileState,
) {
    let (ui, overlay) = (shown.ui, &shown.overlay);
    let inside = response.hover_pos().or(response.interact_pointer_pos());
    state.hovered = inside.and_then(|at| overlay.view.pixel_at(at, shown.input.picture.size));
    let is_down = response.is_pointer_button_down_on()
        && ui.input(|input| input.pointer.button_down(PointerButton::Primary));
    if is_down && state.line.is_empty() {
        state.events.push(TileEvent::Activate);
    }
    // Where the button is let go the line ends.
    if (is_down || !state.line.is_empty())
        && let Some(at) = response.interact_pointer_pos()
    {
        let [x, y] = overlay.view.px_from_screen(at).as_vec2().to_array();
        let is_new = |last: &[f32; 2]| (last[0] - x).hypot(last[1] - y) >= CORNER_PX;
        if state.line.last().is_none_or(is_new) {
            state.line.push([x, y]);
        }
    }
    if !is_down && !state.line.is_empty() {
        state.drawn = Some(std::mem::take(&mut state.line));
    }
    let points: Vec<_> =
        state.line.iter().map(|[x, y]| overlay.at(DVec2::new(f64::from(*x), f64::from(*y)))).collect();
    match tool {
        SilhouetteTool::Region => {
            if let (Some(from), Some(to)) = (points.first(), points.last()) {
                for stroke in cased(1.5, WHITE) {
                    overlay.painter.rect_stroke(
                        Rect::from_two_pos(*from, *to),
                        0.0,
                        stroke,
                        StrokeKind::Middle,
                    );
                }
            }
        }
        SilhouetteTool::Brush(label) => {
            let radius = radius_px * overlay.view.points_per_px;
            let colour = match label {
                Label::Subject => WHITE,
                Label::Background => CASING,
                Label::Unknown => JOINT,
            }
            .gamma_multiply(OPACITY);
            match points[..] {
                [] => {}
                [only] => drop(overlay.painter.circle_filled(only, radius, colour)),
                _ => drop(overlay.painter.line(points, Stroke::new(2.0 * radius, colour))),
            }
            if let Some(at) = response.hover_pos() {
                cased(1.25, WHITE).into_iter().for_each(|stroke| {
                    overlay.painter.circle_stroke(at, radius.max(1.5), stroke);
                });
            }
        }
    }
    if response.contains_pointer() {
        ui.set_cursor_icon(CursorIcon::Crosshair);
    }
}

/// Darkens what lies outside the region of interest.
pub(super) fn paint_region(shown: &ShownPicture<'_>) {
    let Some(region) = shown.input.steered.region else { return };
    let overlay = &shown.overlay;
    // A pixel reaches half its side around its centre.
    let corner = |x: usize, y: usize| overlay.at(DVec2::new(x as f64 - 0.5, y as f64 - 0.5));
    let inside = Rect::from_two_pos(
        corner(region.x, region.y),
        corner(region.x + region.width, region.y + region.height),
    );
    let whole = overlay.view.picture_rect(shown.input.picture.size);
    let inside = inside.intersect(whole);
    let (top, rest) = whole.split_top_bottom_at_y(inside.top());
    let (middle, bottom) = rest.split_top_bottom_at_y(inside.bottom());
    let (left, right) = middle.split_left_right_at_x(inside.left());
    let (_, right) = right.split_left_right_at_x(inside.right());
    for outside in [top, bottom, left, right] {
        overlay.painter.rect_filled(outside, 0.0, CASING.gamma_multiply(OUTSIDE));
    }
    for stroke in cased(1.0, WHITE) {
        overlay.painter.rect_stroke(inside, 0.0, stroke, StrokeKind::Middle);
    }
}
