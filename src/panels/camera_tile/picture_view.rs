//! The picture with its marks, and what the pointer does in it.

use egui::{
    Align2, CursorIcon, Id, Key, Painter, Rect, Response, Role, Sense, Stroke, TextStyle, Ui, WidgetInfo,
    pos2, vec2,
};

use super::hand::{PointerInput, Scene, rotation_owner};
use super::{CameraTileInput, TileEvent, TileLayout, TileState, Wipe, hover_card, legend};
use crate::picture::{JointId, ProjectedLimb, ViewMode, compose};
use crate::theme::data_colours::{CASING, JOINT, PICTURE_GROUND};
use crate::theme::{Theme, size};
use crate::widgets::image_canvas::{cached_texture, navigate, paint_picture};
use crate::widgets::{
    Framing, Grip, JointLook, ViewTransform, grip_at, paint_body_outline, paint_joint, paint_limb_edges,
    paint_limbs, paint_sight_ray,
};

/// Radius of the wipe's handle.
const WIPE_RADIUS: f32 = 11.0;

/// How far down the picture the wipe's handle is.
const WIPE_HEIGHT: f32 = 0.6;

/// Width of the wipe's line.
const WIPE_WIDTH: f32 = 1.5;

/// Shows the picture and says how high its legend is.
pub(super) fn show(
    ui: &Ui,
    id: Id,
    layout: &TileLayout,
    input: &CameraTileInput<'_>,
    state: &mut TileState,
    events: &mut Vec<TileEvent>,
) -> f32 {
    let rect = layout.picture;
    let size_px = input.picture.size;
    let free = Rect::from_min_max(rect.min, pos2(rect.right(), rect.bottom() - layout.reserved));
    let mut view = input.framing.view(free, size_px, input.subject_px);
    let response = ui.interact(rect, id.with("picture"), Sense::DRAG);
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, format!("{} picture", input.name)));
    if let Some(changed) = navigate(ui, &response, &view) {
        events.push(TileEvent::SetFraming(Framing::of(&changed, size_px, input.subject_px)));
        view = changed;
    }
    let wipe = input.wipe.map(|wipe| drag_wipe(ui, id, rect, wipe, events));

    ui.painter().rect_filled(rect, 0.0, PICTURE_GROUND);
    let shown = input.picture.shown(input.mode);
    match wipe {
        None => paint_part(ui, id, rect, &view, input, shown),
        Some(wipe) => {
            let (left, right) = rect.split_left_right_at_fraction(wipe.at);
            paint_part(ui, id.with("left"), left, &view, input, shown);
            paint_part(ui, id.with("right"), right, &view, input, input.picture.shown(wipe.other));
        }
    }
    let painter = ui.painter_at(rect);
    if input.picture.frame.is_none() && shown == ViewMode::Footage {
        let font = TextStyle::Body.resolve(ui.style());
        let colour = Theme::Dark.palette().text3;
        painter.text(rect.center(), Align2::CENTER_CENTER, "No picture for this frame", font, colour);
    }
    follow_pointer(ui, &response, &view, input, state, events);
    paint_marks(ui, &painter, id, &view, input, state);
    if let Some(wipe) = wipe {
        paint_wipe(&painter, rect, wipe);
    }
    show_card(ui, id, &response, &view, input, state);
    if layout.has_legend { legend::show(ui, layout, input, shown) } else { 0.0 }
}

/// One view mode in one part of the picture.
fn paint_part(
    ui: &Ui,
    id: Id,
    part: Rect,
    view: &ViewTransform,
    input: &CameraTileInput<'_>,
    mode: ViewMode,
) {
    let painter = ui.painter_at(part);
    let size_px = input.picture.size;
    let is_crisp = view.is_crisp(ui.ctx().pixels_per_point());
    let texture = cached_texture(ui.ctx(), id.with("texture"), (input.generation, mode), is_crisp, || {
        compose(mode, &input.picture)
    });
    paint_picture(&painter, view, size_px, &texture);
    if mode.has_outline() {
        paint_limb_edges(&painter, view, input.limbs);
        paint_body_outline(&painter, view, input.outlines);
    }
}

/// Lets the pointer hold joints and limbs, and says which pixel it is on.
fn follow_pointer(
    ui: &Ui,
    response: &Response,
    view: &ViewTransform,
    input: &CameraTileInput<'_>,
    state: &mut TileState,
    events: &mut Vec<TileEvent>,
) {
    let (at, primary_pressed, primary_down, modifiers) = ui.input(|input| {
        let pointer = &input.pointer;
        (pointer.interact_pos(), pointer.primary_pressed(), pointer.primary_down(), input.modifiers)
    });
    let is_held = response.is_pointer_button_down_on();
    let inside = at.filter(|_| response.contains_pointer());
    let scene = Scene { body: input.body, joints: input.joints, limbs: input.limbs, view: *view };
    // Without handles there is nothing to hold: limbs are only shown.
    let under = inside.filter(|_| !input.joints.is_empty());
    let under = under.and_then(|at| grip_at(at, view, input.joints, input.limbs));
    let is_cancelled = state.hand.grip().is_some()
        && ui.input_mut(|input| input.consume_key(egui::Modifiers::NONE, Key::Escape));
    if let Some(at) = at {
        let pointer = PointerInput {
            at,
            is_pressed: is_held && primary_pressed,
            is_down: is_held && primary_down,
            modifiers,
            is_cancelled,
        };
        state.hand.update(&pointer, under, &scene, events);
    }
    if state.hand.action().is_some() {
        ui.set_cursor_icon(CursorIcon::Grabbing);
    } else if state.hand.hovered.is_some() {
        ui.set_cursor_icon(CursorIcon::Grab);
    }
    let hovered = inside.and_then(|at| view.pixel_at(at, input.picture.size));
    if hovered != state.hovered {
        state.hovered = hovered;
        events.push(TileEvent::Hover(hovered));
    }
}

/// Limbs under joints, rays between them.
fn paint_marks(
    ui: &Ui,
    painter: &Painter,
    id: Id,
    view: &ViewTransform,
    input: &CameraTileInput<'_>,
    state: &TileState,
) {
    let turning_with = |limb: usize| -> Vec<&ProjectedLimb> {
        let owner = rotation_owner(input.body, limb);
        let limbs = input.limbs.iter().enumerate();
        limbs
            .filter(|(index, _)| rotation_owner(input.body, *index) == owner)
            .filter_map(|(_, limb)| limb.as_ref())
            .collect()
    };
    if !input.joints.is_empty() {
        if let Some(Grip::Limb(limb)) = state.hand.hovered {
            paint_limbs(painter, view, &turning_with(limb), false);
        }
        if let Some(JointId::End(limb)) = input.selected {
            paint_limbs(painter, view, &turning_with(limb), true);
        }
    }
    if let Some(ray) = input.sight_ray {
        paint_sight_ray(painter, view, ray);
    }
    // The selected joint lies on top of its neighbours.
    let (selected, others): (Vec<_>, Vec<_>) =
        input.joints.iter().partition(|joint| Some(joint.id) == input.selected);
    for joint in others.into_iter().chain(selected) {
        let at = view.screen_from_px(joint.px);
        let grip = Some(Grip::Joint(joint.id));
        let look = JointLook {
            is_selected: Some(joint.id) == input.selected,
            is_hovered: state.hand.hovered == grip,
            is_dragged: state.hand.grip() == grip,
        };
        paint_joint(painter, at, joint.is_pinned, look);
        let box_of_joint = Rect::from_center_size(at, vec2(size::ROW, size::ROW));
        if painter.clip_rect().contains(at) {
            let node = ui.interact(box_of_joint, id.with(joint.id), Sense::hover());
            let label = format!("{}, {}", joint.name, input.name);
            node.widget_info(|| WidgetInfo::labeled(Role::GraphicsSymbol, true, &label));
        }
    }
}

fn show_card(
    ui: &Ui,
    id: Id,
    response: &Response,
    view: &ViewTransform,
    input: &CameraTileInput<'_>,
    state: &mut TileState,
) {
    let is_frozen = ui.input(|input| input.key_down(Key::H));
    if !is_frozen {
        state.card = state.hovered.filter(|_| state.hand.action().is_none());
    }
    if let Some(pixel) = state.card.filter(|_| input.shows_hover_card) {
        hover_card::show(ui, id.with("hover card"), response.rect, view, input, pixel);
    }
}

/// Lets the pointer move the wipe's handle.
fn drag_wipe(ui: &Ui, id: Id, rect: Rect, wipe: Wipe, events: &mut Vec<TileEvent>) -> Wipe {
    let at = if wipe.at.is_finite() { wipe.at.clamp(0.0, 1.0) } else { 0.5 };
    let handle = Rect::from_center_size(wipe_handle(rect, at), vec2(size::BUTTON, size::BUTTON));
    let response = ui.interact(handle, id.with("wipe"), Sense::drag());
    let label = format!("Wipe to {}", wipe.other.label().to_lowercase());
    response.widget_info(|| WidgetInfo::slider(true, f64::from(at), label.as_str()));
    let at = match response.interact_pointer_pos().filter(|_| response.dragged()) {
        Some(pointer) => {
            let moved = ((pointer.x - rect.left()) / rect.width()).clamp(0.0, 1.0);
            events.push(TileEvent::SetWipe(moved));
            moved
        }
        None => at,
    };
    response.on_hover_and_drag_cursor(CursorIcon::ResizeHorizontal);
    Wipe { at, ..wipe }
}

fn wipe_handle(rect: Rect, at: f32) -> egui::Pos2 {
    pos2(rect.left() + rect.width() * at, rect.top() + rect.height() * WIPE_HEIGHT)
}

fn paint_wipe(painter: &Painter, rect: Rect, wipe: Wipe) {
    let handle = wipe_handle(rect, wipe.at);
    painter.vline(handle.x, rect.y_range(), Stroke::new(WIPE_WIDTH + 2.0 * size::CASING, CASING));
    painter.vline(handle.x, rect.y_range(), Stroke::new(WIPE_WIDTH, JOINT));
    painter.circle(handle, WIPE_RADIUS, CASING, Stroke::new(WIPE_WIDTH, JOINT));
    for side in [-1.0, 1.0] {
        let tip = handle + vec2(side * 6.0, 0.0);
        let back = vec2(-side * 3.0, 3.5);
        let arrow = vec![tip + back, tip, tip + vec2(back.x, -back.y)];
        painter.line(arrow, Stroke::new(size::ICON_STROKE, JOINT));
    }
}
