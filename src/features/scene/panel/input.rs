//! Pointer and keys in the scene: orbit by drag, pan by middle drag, zoom by wheel, a click on a camera. Keys are the scene's
//! while the pointer is over it or it has the focus.

use backlit_ui::style::theme;
use backlit_ui::style::theme::size;
use egui::{
    CursorIcon, Event, EventFilter, Id, Key, PointerButton, Pos2, Rect, Response, Role, Sense, Stroke,
    StrokeKind, Ui, Vec2, WidgetInfo,
};

use super::marks::badge_rect;
use super::{DrawnView, SceneView};
use crate::context::pane::Pane;
use crate::context::{Context, Requests, ShellRequest};
use crate::features::scene::{Frustum, Orbit, Viewpoint};

/// Points of wheel travel that magnify e-fold.
const WHEEL_POINTS: f32 = 240.0;
/// A quadrilateral smaller than this is hard to hit, in points.
const LEAST_SIDE: f32 = 4.0;

/// Turns the view where the pointer or the keys want it: from where the scene is to be seen, and whether it moves now.
pub(super) fn navigate(ui: &Ui, view: &SceneView, kept: &mut Option<Viewpoint>) -> (Viewpoint, bool) {
    let response = ui.interact(view.picture, canvas_id(ui.scope_id()), Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, "Scene"));
    let pressed = take(ui, &response);
    if response.double_clicked() || pressed.resets {
        *kept = None;
        return (view.viewpoint, false);
    }
    let before = orbit(view);
    let mut after = before.turned(pressed.turn);
    let delta = response.drag_delta();
    let by = [f64::from(delta.x), f64::from(delta.y)];
    let is_pan = response.dragged_by(PointerButton::Middle)
        || response.dragged_by(PointerButton::Secondary)
        || (response.dragged_by(PointerButton::Primary) && ui.input(|input| input.modifiers.shift));
    if is_pan {
        after = after.panned(&view.upright, by, f64::from(view.picture.height()));
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
        return (view.viewpoint, response.dragged());
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
fn orbit(view: &SceneView) -> Orbit {
    match view.viewpoint {
        Viewpoint::Orbit(orbit) => orbit,
        Viewpoint::Camera(_) => {
            let eye = view.eye;
            let ahead = (eye.target - eye.position).normalize_or_zero();
            let depth = (view.middle - eye.position).dot(ahead).max(0.5);
            Orbit::looking(&view.upright, eye.position, eye.position + ahead * depth)
        }
    }
}

/// A click on a camera's badge or picture makes its tile the active one.
pub(super) fn pick_camera(ui: &Ui, context: &Context<'_>, seen: &DrawnView<'_>, requests: &mut Requests) {
    for frustum in &seen.order.frusta {
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
    let response = ui.interact(seen.picture, canvas_id(ui.scope_id()).with("over"), Sense::hover());
    let Some(pointer) = response.hover_pos() else { return };
    let Some(camera) = picture_at(seen, pointer) else { return };
    let is_dragging = ui.input(|input| input.pointer.is_decidedly_dragging());
    if !is_dragging {
        ui.set_cursor_icon(CursorIcon::PointingHand);
    }
    if ui.read_response(canvas_id(ui.scope_id())).is_some_and(|response| response.clicked()) {
        requests.request(ShellRequest::Camera(camera));
    }
}

/// The camera whose picture is under the pointer, the nearest to the eye.
fn picture_at(seen: &DrawnView<'_>, pointer: Pos2) -> Option<usize> {
    let mut near: Vec<&Frustum> = seen.order.frusta.iter().collect();
    let eye = seen.order.eye.position;
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

/// A key turns the scene like a drag over this many points.
const KEY_TURN: f64 = 16.0;
/// A key magnifies by this factor.
const KEY_ZOOM: f64 = 1.15;

/// Keys as they are listed, and what they do.
pub(crate) const KEYS: [(&str, &str); 3] = [
    ("Left, Right, Up, Down", "Turn the scene"),
    ("+, -", "Zoom the scene"),
    ("Home, F", "See the whole scene"),
];

/// What the keys of a frame ask for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PressedKeys {
    /// The drag that turns as much, points.
    pub(crate) turn: [f64; 2],
    /// Magnification.
    pub(crate) zoom: f64,
    /// Back to the whole scene.
    pub(crate) resets: bool,
}

pub(crate) fn canvas_id(scope: Id) -> Id {
    scope.with("scene canvas")
}

/// Takes the scene's keys out of the input, to be [given back](give_back) when the commands have had theirs.
pub(crate) fn hold_back(ctx: &egui::Context) -> Vec<Event> {
    let canvas = ctx.read_response(canvas_id(Pane::Scene.scope()));
    let is_meant = canvas.is_some_and(|canvas| canvas.contains_pointer() || canvas.has_focus());
    if !is_meant || ctx.text_edit_focused() {
        return Vec::new();
    }
    ctx.input_mut(|input| input.events.extract_if(.., |event| pressed_key(event).is_some()).collect())
}

/// Puts the scene's keys back into the input.
pub(crate) fn give_back(ctx: &egui::Context, events: Vec<Event>) {
    ctx.input_mut(|input| input.events.extend(events));
}

/// Uses up the keys that are the scene's.
pub(crate) fn take(ui: &Ui, response: &Response) -> PressedKeys {
    let mut pressed = PressedKeys { turn: [0.0; 2], zoom: 1.0, resets: false };
    if response.has_focus() {
        let arrows = EventFilter { horizontal_arrows: true, vertical_arrows: true, ..EventFilter::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, arrows));
    }
    if !(response.contains_pointer() || response.has_focus()) || ui.ctx().text_edit_focused() {
        return pressed;
    }
    let keys: Vec<Key> = ui.input_mut(|input| {
        let taken = input.events.extract_if(.., |event| pressed_key(event).is_some());
        taken.filter_map(|event| pressed_key(&event)).collect()
    });
    for key in keys {
        match key {
            Key::ArrowLeft => pressed.turn[0] -= KEY_TURN,
            Key::ArrowRight => pressed.turn[0] += KEY_TURN,
            Key::ArrowUp => pressed.turn[1] -= KEY_TURN,
            Key::ArrowDown => pressed.turn[1] += KEY_TURN,
            Key::Minus => pressed.zoom /= KEY_ZOOM,
            Key::Plus | Key::Equals => pressed.zoom *= KEY_ZOOM,
            _ => pressed.resets = true,
        }
    }
    pressed
}

/// A ring about the picture, if the keys are its because it has the focus.
pub(crate) fn show_focus(ui: &Ui, picture: Rect) {
    if ui.memory(|memory| memory.has_focus(canvas_id(ui.scope_id()))) {
        let ring = Stroke::new(size::FOCUS_RING, theme::palette(ui).accent);
        ui.painter().rect_stroke(picture, 0.0, ring, StrokeKind::Inside);
    }
}

/// The key, if it is one of the scene's and was pressed.
fn pressed_key(event: &Event) -> Option<Key> {
    let Event::Key { key, pressed: true, modifiers, .. } = event else { return None };
    let is_plus = matches!(key, Key::Plus | Key::Equals);
    let is_plain = modifiers.is_none() || (is_plus && modifiers.shift_only());
    let is_ours = matches!(
        key,
        Key::ArrowLeft | Key::ArrowRight | Key::ArrowUp | Key::ArrowDown | Key::Minus | Key::Home | Key::F
    );
    (is_plain && (is_ours || is_plus)).then_some(*key)
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
