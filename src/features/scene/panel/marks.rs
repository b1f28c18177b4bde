//! What lies over the scene's picture: badges, the held joint, axes, and words about the hull.

use backlit_ui::style::format;
use backlit_ui::style::theme;
use backlit_ui::style::theme::data_colours::{CASING, SELECTED};
use backlit_ui::style::theme::{Palette, Theme, run_style, size};
use backlit_ui::widgets::paint_camera_badge;
use egui::{Align2, FontId, Pos2, Rect, Role, Sense, Stroke, TextStyle, Ui, Vec2, WidgetInfo, pos2, vec2};
use glam::DVec3;

use super::DrawnView;
use crate::context::Context;
use crate::features::scene::{Frustum, Scene, ShownHull, Viewpoint};

/// A badge stands so far above its camera, in points.
const BADGE_ABOVE: f32 = 14.0;
/// A name stands so far beside its badge, in points.
const BESIDE: f32 = 5.0;
/// Badges and names keep this far from the picture's edge, in points.
const EDGE: f32 = 3.0;
/// Names stand beside the badges in a picture at least so wide, in points.
const NAMES_FROM: f32 = 460.0;
/// The mark of the held joint: smaller than in the views, as the body is.
const JOINT_RADIUS: f32 = 3.4;
/// Length of the axes, and where they meet: from the lower left corner, in points.
const AXIS: f32 = 24.0;
const AXES_AT: Vec2 = vec2(40.0, -38.0);
/// Where words stand: from the lower right corner, in points.
const WORDS_AT: Vec2 = vec2(-12.0, -10.0);

/// The scene lies on its own dark ground in both themes, and so do its words.
const fn palette() -> &'static Palette {
    theme::colours(Theme::Dark)
}

/// Where a camera's badge is, if the camera is in the picture: above it, and whole.
pub(crate) fn badge_rect(seen: &DrawnView<'_>, frustum: &Frustum) -> Option<Rect> {
    let apex = seen.on_screen(frustum.apex).filter(|apex| seen.picture.contains(*apex))?;
    let room = seen.picture.shrink(EDGE + 0.5 * size::BADGE);
    if !room.is_positive() {
        return None;
    }
    let at = (apex - vec2(0.0, BADGE_ABOVE)).clamp(room.min, room.max);
    Some(Rect::from_center_size(at, Vec2::splat(size::BADGE)))
}

/// Where a text of some size stands beside a badge: at its right, or at its left where the picture ends.
fn beside(badge: Rect, text: Vec2, picture: Rect) -> Option<Pos2> {
    let top = badge.center().y - 0.5 * text.y;
    let [right, left] = [badge.right() + BESIDE, badge.left() - BESIDE - text.x];
    let fits = |from: &f32| *from >= picture.left() + EDGE && from + text.x <= picture.right() - EDGE;
    [right, left].into_iter().find(fits).map(|from| pos2(from, top))
}

pub(super) fn show(ui: &Ui, context: &Context<'_>, scene: &Scene, seen: &DrawnView<'_>) {
    let painter = ui.painter().with_clip_rect(seen.picture.intersect(ui.clip_rect()));
    let small = TextStyle::Small.resolve(ui.style());
    for frustum in &seen.order.frusta {
        let Some(rect) = badge_rect(seen, frustum) else { continue };
        paint_camera_badge(&painter, rect, frustum.camera);
        let name = context.document().cameras.get(frustum.camera).map(|camera| camera.name.as_str());
        if let Some(name) = name.filter(|_| seen.picture.width() >= NAMES_FROM) {
            let galley = painter.layout_no_wrap(name.to_owned(), small.clone(), palette().text2);
            if let Some(at) = beside(rect, galley.size(), seen.picture) {
                painter.galley(at, galley, palette().text2);
            }
        }
    }
    for mark in context.references {
        let ends = [mark.ours, mark.place].map(|place| seen.on_screen(place));
        if let [Some(from), Some(to)] = ends {
            let colour = run_style(mark.reference).colour;
            painter.line_segment([from, to], Stroke::new(1.25, colour));
            painter.circle_stroke(to, JOINT_RADIUS, Stroke::new(1.25, colour));
        }
    }
    if let Some(at) = seen.order.held.and_then(|joint| seen.on_screen(joint)) {
        painter.circle_filled(at, JOINT_RADIUS + size::CASING, CASING);
        painter.circle_filled(at, JOINT_RADIUS, SELECTED);
    }
    if scene.preferences.floor {
        axes(&painter, seen);
    }
    if let Some(text) = words(context, scene) {
        let at = seen.picture.right_bottom() + WORDS_AT;
        let rect = painter.text(at, Align2::RIGHT_BOTTOM, &text, small, palette().text2);
        let response = ui.interact(rect, ui.scope_id().with("hull words"), Sense::hover());
        response.widget_info(|| WidgetInfo::labeled(Role::Label, true, &text));
        response.on_hover_text("Box around the space that all silhouettes allow: the body is inside");
    }
}

/// The world's axes as the eye sees them.
fn axes(painter: &egui::Painter, seen: &DrawnView<'_>) {
    let view_from_world = seen.order.eye.view_from_world();
    let origin = seen.picture.left_bottom() + AXES_AT;
    let axes = [(DVec3::X, "x", 4), (DVec3::Y, "y", 2), (DVec3::Z, "z", 0)];
    let mut seen = axes.map(|(axis, name, run)| (view_from_world * axis, name, run));
    // The farthest first.
    seen.sort_by(|a, b| b.0.z.total_cmp(&a.0.z));
    for (axis, name, run) in seen {
        let along = vec2(axis.x as f32, axis.y as f32);
        painter.line_segment([origin, origin + along * AXIS], Stroke::new(1.75, run_style(run).colour));
        let at = origin + along * (AXIS + 8.0);
        let at = if along.length() < 0.2 { origin + vec2(-8.0, 8.0) } else { at };
        painter.text(at, Align2::CENTER_CENTER, name, FontId::proportional(12.0), palette().text2);
    }
}

/// What is to be said about the hull.
fn words(context: &Context<'_>, scene: &Scene) -> Option<String> {
    let preferences = scene.preferences;
    if preferences.hull == ShownHull::Hidden || matches!(preferences.viewpoint, Some(Viewpoint::Camera(_))) {
        return None;
    }
    let frame = context.session.shown_frame(context.selection.frame)?;
    Some(match scene.hulls.get(frame) {
        None => "Carving the visual hull…".to_owned(),
        Some(None) => "No visual hull: it needs two silhouettes that meet".to_owned(),
        Some(Some(hull)) => {
            let [x, y, z] = hull.size().to_array().map(|length| format::number(length, 2));
            format!("Visual hull {x} × {y} × {z} m")
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_stands_where_the_picture_has_room_for_it() {
        let picture = Rect::from_min_size(pos2(100.0, 50.0), vec2(300.0, 200.0));
        let badge = |x: f32| Rect::from_center_size(pos2(x, 120.0), Vec2::splat(size::BADGE));
        let text = vec2(80.0, 12.0);
        assert_eq!(beside(badge(200.0), text, picture), Some(pos2(213.0, 114.0)));
        assert_eq!(beside(badge(380.0), text, picture), Some(pos2(287.0, 114.0)));
        assert_eq!(beside(badge(250.0), vec2(290.0, 12.0), picture), None);
    }
}
