//! The pointer in the scene: orbit by drag, pan by middle drag, zoom by wheel, a click on a camera. Keys do it too.

use egui::{CursorIcon, Id, PointerButton, Pos2, Response, Role, Sense, Ui, Vec2, WidgetInfo};

use super::marks::badge_rect;
use super::{Seen, Stage, keys};
use crate::context::{Context, Requests, ShellRequest};
use crate::features::scene::{Frustum, Orbit, Viewpoint};

/// Points of wheel travel that magnify e-fold.
const WHEEL_POINTS: f32 = 240.0;
/// A quadrilateral smaller than this is hard to hit, in points.
const LEAST_SIDE: f32 = 4.0;

fn canvas_id(ui: &Ui) -> Id {
    keys::canvas_id(ui.scope_id())
}

/// Turns the view where the pointer or the keys want it: from where the scene is to be seen, and whether it moves now.
pub(super) fn navigate(ui: &Ui, stage: &Stage, kept: &mut Option<Viewpoint>) -> (Viewpoint, bool) {
    let response = ui.interact(stage.picture, canvas_id(ui), Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, "Scene"));
    let pressed = keys::take(ui, &response);
    if response.double_clicked() || pressed.resets {
        *kept = None;
        return (stage.viewpoint, false);
    }
    let before = orbit(stage);
    let mut after = before.turned(pressed.turn);
    let delta = response.drag_delta();
    let by = [f64::from(delta.x), f64::from(delta.y)];
    let is_pan = response.dragged_by(PointerButton::Middle)
        || response.dragged_by(PointerButton::Secondary)
        || (response.dragged_by(PointerButton::Primary) && ui.input(|input| input.modifiers.shift));
    if is_pan {
        after = after.panned(&stage.upright, by, f64::from(stage.picture.height()));
    } else if response.dragged_by(PointerButton::Primary) {
        after = after.turned(by);
    }
    let factor = f64::from(wheel(ui, &response)) * pressed.zoom;
    if (factor - 1.0).abs() > f64::from(f32::EPSILON) {
        after = after.zoomed(factor);
    }
    if response.dragged() {
        ui.set_cursor_icon(CursorIcon::Grabbing);
    }
    if after == before {
        return (stage.viewpoint, response.dragged());
    }
    let viewpoint = Viewpoint::Orbit(after);
    *kept = Some(viewpoint);
    if !response.dragged() {
        // Wheels do not say when they end: the next frame is drawn well.
        ui.request_repaint();
    }
    (viewpoint, true)
}

fn wheel(ui: &Ui, response: &Response) -> f32 {
    if !response.contains_pointer() {
        return 1.0;
    }
    ui.input_mut(|input| {
        let wheel: Vec2 = std::mem::take(&mut input.smooth_scroll_delta);
        input.zoom_delta() * (wheel.y / WHEEL_POINTS).exp()
    })
}

/// The orbit that goes on from where the scene is seen now.
fn orbit(stage: &Stage) -> Orbit {
    match stage.viewpoint {
        Viewpoint::Orbit(orbit) => orbit,
        Viewpoint::Camera(_) => {
            let eye = stage.eye;
            let ahead = (eye.target - eye.position).normalize_or_zero();
            let depth = (stage.middle - eye.position).dot(ahead).max(0.5);
            Orbit::looking(&stage.upright, eye.position, eye.position + ahead * depth)
        }
    }
}

/// A click on a camera's badge or picture makes its tile the active one.
pub(crate) fn pick_camera(ui: &Ui, context: &Context<'_>, seen: &Seen<'_>, requests: &mut Requests) {
    for frustum in seen.frusta {
        let Some(rect) = badge_rect(seen, frustum) else { continue };
        let id = ui.scope_id().with(("scene camera", frustum.camera));
        let response = ui.interact(rect, id, Sense::click());
        let name = context.document().cameras.get(frustum.camera).map_or("", |camera| camera.name.as_str());
        let label = format!("Scene camera {}", frustum.camera + 1);
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &label));
        let number = frustum.camera + 1;
        let tooltip = format!("Camera {number}, {name}: click for its view");
        if response.on_hover_cursor(CursorIcon::PointingHand).on_hover_text(tooltip).clicked() {
            requests.request(ShellRequest::Camera(frustum.camera));
        }
    }
    let response = ui.interact(seen.picture, canvas_id(ui).with("over"), Sense::hover());
    let Some(pointer) = response.hover_pos() else { return };
    let Some(camera) = picture_at(seen, pointer) else { return };
    let is_dragging = ui.input(|input| input.pointer.is_decidedly_dragging());
    if !is_dragging {
        ui.set_cursor_icon(CursorIcon::PointingHand);
    }
    if ui.read_response(canvas_id(ui)).is_some_and(|response| response.clicked()) {
        requests.request(ShellRequest::Camera(camera));
    }
}

/// The camera whose picture is under the pointer, the nearest to the eye.
fn picture_at(seen: &Seen<'_>, pointer: Pos2) -> Option<usize> {
    let mut near: Vec<&Frustum> = seen.frusta.iter().collect();
    let eye = seen.eye.position;
    near.sort_by(|a, b| a.apex.distance(eye).total_cmp(&b.apex.distance(eye)));
    let hit = |frustum: &&&Frustum| {
        let corners: Option<Vec<Pos2>> =
            frustum.corners.iter().map(|corner| seen.on_screen(*corner)).collect();
        corners.is_some_and(|corners| contains(&corners, pointer))
    };
    near.iter().find(hit).map(|frustum| frustum.camera)
}

/// Whether a point lies in a convex polygon.
fn contains(corners: &[Pos2], point: Pos2) -> bool {
    let side = |index: usize| {
        let (from, to) = (corners[index], corners[(index + 1) % corners.len()]);
        let (along, away) = (to - from, point - from);
        along.x * away.y - along.y * away.x
    };
    let is_large = corners.windows(2).all(|pair| pair[0].distance(pair[1]) >= LEAST_SIDE);
    let sides: Vec<f32> = (0..corners.len()).map(side).collect();
    is_large && (sides.iter().all(|side| *side > 0.0) || sides.iter().all(|side| *side < 0.0))
}

#[cfg(test)]
mod tests {
    use egui::pos2;

    use super::*;

    #[test]
    fn a_polygon_contains_what_is_inside_whichever_way_round() {
        let mut corners = vec![pos2(0.0, 0.0), pos2(40.0, 5.0), pos2(38.0, 30.0), pos2(2.0, 28.0)];
        for _ in 0..2 {
            assert!(contains(&corners, pos2(20.0, 15.0)));
            assert!(!contains(&corners, pos2(20.0, 40.0)) && !contains(&corners, pos2(-1.0, 10.0)));
            corners.reverse();
        }
        let thin = [pos2(0.0, 0.0), pos2(1.0, 0.0), pos2(1.0, 30.0), pos2(0.0, 30.0)];
        assert!(!contains(&thin, pos2(0.5, 10.0)));
    }
}
