//! The picture with its marks, and what the pointer does in it.

use std::sync::Arc;

use backlit_tracking::body::Model;
use backlit_ui::drawing::{
    CalibrationMarks, JointId, ProjectedLimb, ViewMode, compose, compose_over_footage, shows_footage,
};
use backlit_ui::style::theme;
use backlit_ui::style::theme::data_colours::{JOINT, PICTURE_GROUND};
use backlit_ui::style::theme::{Theme, size};
use backlit_ui::widgets::image_canvas::{cached_texture, navigate, paint_picture, paint_pixel_grid};
use backlit_ui::widgets::{
    Framing, Grip, JointLook, SizeHandles, ViewTransform, grip_at, paint_body_outline, paint_calibration,
    paint_joint, paint_limb_edges, paint_limbs, paint_limit_words, paint_limits, paint_quick_outline,
    paint_sides, paint_sight_ray,
};
use egui::{
    Align2, CursorIcon, Id, Key, Painter, Rect, Response, Role, Sense, Stroke, TextStyle, Ui, WidgetInfo,
    pos2, vec2,
};

use super::comparison::{self, ShownModes};
use super::hover_card::HoverCard;
use super::overlays::{paint_bodies, paint_ellipses, paint_likelier};
use super::pointer::{Grips, PointerInput, rotation_owner};
use super::tile::{TileLayout, TileState};
use super::{CameraTileInput, TileEvent, legend, overlays};
use glam::DVec2;

/// Circles of spheres: width in points, and opacity.
const SPHERE_WIDTH: f32 = 1.0;
const SPHERE_OPACITY: f32 = 0.55;

/// Shows the picture; says how it lies on the screen and how high its legend is.
pub(crate) fn show(
    ui: &Ui,
    id: Id,
    layout: &TileLayout,
    input: &CameraTileInput<'_>,
    state: &mut TileState,
    events: &mut Vec<TileEvent>,
) -> (ViewTransform, f32) {
    let rect = layout.picture;
    let size_px = input.picture.size;
    let free = Rect::from_min_max(rect.min, pos2(rect.right(), rect.bottom() - layout.reserved));
    let mut view = input.tile.framing.view(free, size_px, input.subject_px);
    let response = ui.interact(rect, id.with("picture"), Sense::CLICK | Sense::DRAG);
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, format!("{} picture", input.name)));
    if let Some(changed) = navigate(ui, &response, &view, state.pointer.is_free()) {
        events.push(TileEvent::SetFraming(Framing::of(&changed, size_px, input.subject_px)));
        view = changed;
    }
    if response.double_clicked() && state.pointer.hovered.is_none() {
        events.push(TileEvent::SetFraming(Framing::Subject));
    }
    let seen = comparison::seen(ui, id, rect, input, events);

    ui.painter().rect_filled(rect, 0.0, PICTURE_GROUND);
    match seen {
        ShownModes::One(_) | ShownModes::Blinking(..) => paint_part(ui, id, rect, &view, input, seen.mode()),
        ShownModes::Wiped(mode, other, at) => {
            let (left, right) = rect.split_left_right_at_fraction(at);
            paint_part(ui, id.with("left"), left, &view, input, mode);
            paint_part(ui, id.with("right"), right, &view, input, other);
        }
    }
    let painter = ui.painter_at(rect);
    if input.settings.pixel_grid {
        paint_pixel_grid(&painter, &view, size_px);
    }
    if input.settings.calibration_marks
        && let Some(camera) = input.camera
    {
        paint_calibration(&painter, &view, &CalibrationMarks::new(camera, input.raw_camera));
    }
    if input.picture.frame.is_none() && seen.mode() == ViewMode::Footage {
        let font = TextStyle::Body.resolve(ui.style());
        let colour = theme::colours(Theme::Dark).text3;
        painter.text(rect.center(), Align2::CENTER_CENTER, "No picture for this frame", font, colour);
    }
    follow_pointer(ui, &response, &view, input, state, events);
    paint_marks(ui, &painter, id, &view, input, (&*state, seen.mode()));
    paint_size_handles(ui, &painter, id, &view, input, state);
    if let ShownModes::Wiped(_, _, at) = seen {
        comparison::paint_wipe(&painter, rect, at);
    }
    comparison::paint_names(ui, &painter, rect, seen);
    show_card(ui, id, rect, &view, input, (state, seen, layout.gutter.is_none()));
    state.legend_height = if layout.has_legend { legend::show(ui, layout, input, seen) } else { 0.0 };
    (view, state.legend_height)
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
    let over = input.full.filter(|_| shows_footage(mode, &input.picture));
    if let Some(full) = over {
        let key = Arc::as_ptr(full) as usize;
        let footage = cached_texture(ui.ctx(), id.with("full"), key, is_crisp, || full.clone());
        paint_picture(&painter, view, size_px, &footage);
    }
    let key = (input.generation, mode, over.is_some());
    let texture = cached_texture(ui.ctx(), id.with("texture"), key, is_crisp, || match over {
        Some(_) => compose_over_footage(mode, &input.picture),
        None => compose(mode, &input.picture),
    });
    paint_picture(&painter, view, size_px, &texture);
    if mode.has_outline() {
        paint_limb_edges(&painter, view, input.limbs);
        match input.quick_outline {
            Some(lines) => paint_quick_outline(&painter, view, lines),
            None => paint_body_outline(&painter, view, input.outlines),
        }
    }
}

/// Lets the pointer hold joints and limbs, and notes which pixel it is on.
fn follow_pointer(
    ui: &Ui,
    response: &Response,
    view: &ViewTransform,
    input: &CameraTileInput<'_>,
    state: &mut TileState,
    events: &mut Vec<TileEvent>,
) {
    let is_held = response.is_pointer_button_down_on();
    let (at, pressed_at, primary_down, modifiers) = ui.input(|input| {
        let pointer = &input.pointer;
        let at = pointer.interact_pos();
        let pressed_at = pointer.press_origin().or(at).filter(|_| is_held && pointer.primary_pressed());
        (at, pressed_at, pointer.primary_down(), input.modifiers)
    });
    let inside = pressed_at.or(at.filter(|_| response.contains_pointer()));
    let grips = Grips { body: input.body, joints: input.joints, limbs: input.limbs, view: *view };
    // Without handles there is nothing to hold: limbs are only shown.
    let under = inside.filter(|_| !input.joints.is_empty());
    let sized = size_handles(view, input);
    let under = under.and_then(|at| {
        let size = sized.and_then(|handles| handles.grip_at(at));
        size.or_else(|| grip_at(at, view, input.joints, input.limbs))
    });
    let is_cancelled = state.pointer.grip().is_some()
        && ui.input_mut(|input| input.consume_key(egui::Modifiers::NONE, Key::Escape));
    if let Some(at) = at {
        let pointer =
            PointerInput { at, pressed_at, is_down: is_held && primary_down, modifiers, is_cancelled };
        state.pointer.update(&pointer, under, &grips, events);
    }
    if state.pointer.action().is_some() {
        ui.set_cursor_icon(CursorIcon::Grabbing);
    } else if state.pointer.hovered.is_some() {
        ui.set_cursor_icon(CursorIcon::Grab);
    } else if response.dragged() && state.pointer.is_free() {
        ui.set_cursor_icon(CursorIcon::AllScroll);
    }
    state.hovered = inside.and_then(|at| view.pixel_at(at, input.picture.size));
}

/// Limbs under joints, rays between them.
fn paint_marks(
    ui: &Ui,
    painter: &Painter,
    id: Id,
    view: &ViewTransform,
    input: &CameraTileInput<'_>,
    (state, mode): (&TileState, ViewMode),
) {
    // What pushes and pulls is at the limb's edge: no outline lies on it.
    let shows_limb = !matches!(mode, ViewMode::Gradient | ViewMode::JacobianColumn);
    let turning_with = |limb: usize| turning_with(input.body, input.limbs, limb);
    if mode.has_outline() {
        paint_spheres(painter, view, input);
    }
    if shows_limb {
        overlays::paint_held(painter, view, input.held, input.body, input.limbs);
        overlays::paint_keypoints(painter, view, input.keypoints, input.joints);
    }
    if !input.joints.is_empty() {
        if let Some(Grip::Limb(limb)) = state.pointer.hovered {
            paint_limbs(painter, view, &turning_with(limb), false);
        }
        if let Some(JointId::End(limb)) = input.selected
            && shows_limb
        {
            paint_limbs(painter, view, &turning_with(limb), true);
        }
    }
    if let Some(ray) = input.sight_ray {
        paint_sight_ray(painter, view, ray);
    }
    paint_limits(painter, view, input.limits, theme::colours(Theme::Dark));
    paint_bodies(painter, view, &input.observed);
    // The selected joint lies on top of its neighbours.
    let (selected, others): (Vec<_>, Vec<_>) =
        input.joints.iter().partition(|joint| Some(joint.id) == input.selected);
    for joint in others.into_iter().chain(selected) {
        let at = view.screen_from_px(joint.px);
        let grip = Some(Grip::Joint(joint.id));
        let look = JointLook {
            is_selected: Some(joint.id) == input.selected,
            is_hovered: state.pointer.hovered == grip,
            is_dragged: state.pointer.grip() == grip,
            is_small: !input.observed.ellipses.is_empty(),
        };
        paint_joint(painter, at, joint.is_pinned, look);
        let box_of_joint = Rect::from_center_size(at, vec2(size::ROW, size::ROW));
        if painter.clip_rect().contains(at) {
            let node = ui.interact(box_of_joint, id.with(joint.id), Sense::hover());
            let label = format!("{}, {}", joint.name, input.name);
            node.widget_info(|| WidgetInfo::labeled(Role::GraphicsSymbol, true, &label));
            if let Some(known) = input.observed.ellipses.iter().find(|known| known.joint == joint.id) {
                let ellipse = ui.interact(box_of_joint, id.with(("ellipse", joint.id)), Sense::hover());
                let label = format!("{}, {}", known.text, input.name);
                ellipse.widget_info(|| WidgetInfo::labeled(Role::GraphicsSymbol, true, &label));
            }
        }
    }
    if shows_limb {
        paint_likelier(painter, view, input.likelier);
    }
    paint_ellipses(painter, view, &input.observed, input.joints);
    let font = TextStyle::Small.resolve(ui.style());
    if let Some(sides) = input.sides {
        // Below is the legend.
        let mut free = painter.clip_rect();
        free.set_bottom(free.bottom() - state.legend_height);
        paint_sides(painter, view, sides, free, theme::colours(Theme::Dark), &font);
        if let Some(face) = sides.face {
            let tip = Rect::from_center_size(view.screen_from_px(face.tip), vec2(size::ROW, size::ROW));
            let node = ui.interact(tip, id.with("face"), Sense::hover());
            let way = if face.is_towards { "faces" } else { "faces away from" };
            node.widget_info(|| {
                WidgetInfo::labeled(Role::GraphicsSymbol, true, format!("The body {way} {}", input.name))
            });
        }
    }
    if !input.says_limits {
        return;
    }
    for (at, words) in paint_limit_words(painter, view, input.limits, theme::colours(Theme::Dark), &font) {
        let node = ui.interact(at, id.with(("limit", words)), Sense::hover());
        node.widget_info(|| WidgetInfo::labeled(Role::Label, true, format!("{words}, {}", input.name)));
    }
}

/// The limbs that turn together with one, as they are seen.
pub(super) fn turning_with<'a>(
    body: &Model,
    limbs: &'a [Option<ProjectedLimb>],
    limb: usize,
) -> Vec<&'a ProjectedLimb> {
    let owner = rotation_owner(body, limb);
    let turns = limbs.iter().enumerate().filter(|(index, _)| rotation_owner(body, *index) == owner);
    turns.filter_map(|(_, limb)| limb.as_ref()).collect()
}

/// The spheres that stand for the body, each in the colour of its limb.
fn paint_spheres(painter: &Painter, view: &ViewTransform, input: &CameraTileInput<'_>) {
    for sphere in input.spheres {
        let colour = input.picture.limb_colours.get(sphere.limb).copied().unwrap_or(JOINT);
        let (at, radius) =
            (view.screen_from_px(sphere.centre_px), sphere.radius_px as f32 * view.points_per_px);
        if painter.clip_rect().expand(radius).contains(at) {
            painter.circle_stroke(
                at,
                radius,
                Stroke::new(SPHERE_WIDTH, colour.gamma_multiply(SPHERE_OPACITY)),
            );
        }
    }
}

/// The handles of the selected limb's size, if they are wanted.
fn size_handles(view: &ViewTransform, input: &CameraTileInput<'_>) -> Option<SizeHandles> {
    let limb = input.sized.filter(|_| input.settings.size_handles && !input.joints.is_empty())?;
    Some(SizeHandles::new(limb, input.limbs.get(limb)?.as_ref()?, view, input.joints))
}

fn paint_size_handles(
    ui: &Ui,
    painter: &Painter,
    id: Id,
    view: &ViewTransform,
    input: &CameraTileInput<'_>,
    state: &TileState,
) {
    let Some((handles, limb)) = size_handles(view, input).zip(input.sized) else { return };
    handles.paint(painter, state.pointer.grip().or(state.pointer.hovered));
    let name = input.body.limbs().get(limb).map_or("limb", |limb| limb.name.as_str());
    for (at, what) in handles.places().filter(|(at, _)| painter.clip_rect().contains(*at)) {
        let place = Rect::from_center_size(at, vec2(size::ROW, size::ROW));
        let node = ui.interact(place, id.with(("size", what)), Sense::hover());
        let label = format!("{name} {what}, {}", input.name);
        node.widget_info(|| WidgetInfo::labeled(Role::GraphicsSymbol, true, &label));
    }
}

fn show_card(
    ui: &Ui,
    id: Id,
    picture: Rect,
    view: &ViewTransform,
    input: &CameraTileInput<'_>,
    (state, seen, has_keys): (&mut TileState, ShownModes, bool),
) {
    let is_frozen = ui.input(|input| input.key_down(Key::H));
    if !is_frozen {
        state.card =
            state.hovered.filter(|_| state.pointer.action().is_none() && !state.pointer.has_dropped());
    }
    if let Some(pixel) = state.card.filter(|_| input.shows_hover_card) {
        let at = view.screen_from_px(DVec2::new(pixel[0] as f64, pixel[1] as f64));
        let card = HoverCard {
            pixel,
            is_frozen,
            mode: seen.mode_at(picture, at),
            grip: state.pointer.hovered.filter(|_| !is_frozen),
            has_keys,
        };
        card.show(ui, id.with("hover card"), picture, view, input);
    }
}
