//! The picture with its marks, and what the pointer does in it.

use std::sync::Arc;

use backlit_ui::drawing::{CalibrationMarks, JointId, ViewMode, ViewedPicture, shows_footage};
use backlit_ui::style::theme;
use backlit_ui::style::theme::data_colours::{CASING, GHOST, JOINT, PICTURE_GROUND, WHITE};
use backlit_ui::style::theme::{Theme, size};
use backlit_ui::widgets::image_canvas::{cached_texture, navigate, paint_picture, paint_pixel_grid};
use backlit_ui::widgets::{Framing, Grip, JointLook, Overlay, SizeHandles, ViewTransform, cased, grip_at};
use egui::{
    Align2, CursorIcon, Id, Key, Pos2, Rect, Response, Role, Sense, Stroke, StrokeKind, TextStyle, Ui,
    WidgetInfo, pos2, vec2,
};
use glam::DVec2;

use super::comparison::{self, ShownModes};
use super::hover_card::HoverCard;
use super::pointer::{Grips, PointerInput};
use super::tile::{TileLayout, TileState};
use super::{TileEvent, TileInput, hand, legend, overlays};
use crate::context::marks::whole_percent;

/// Circles of spheres: width in points, and opacity.
const SPHERE_WIDTH: f32 = 1.0;
const SPHERE_OPACITY: f32 = 0.55;

/// Shows the picture; says how it lies on the screen.
pub(crate) fn show(
    ui: &Ui,
    id: Id,
    layout: &TileLayout,
    input: &TileInput<'_>,
    state: &mut TileState,
) -> ViewTransform {
    let rect = layout.picture;
    let size_px = input.picture.size;
    let free = Rect::from_min_max(rect.min, pos2(rect.right(), rect.bottom() - layout.reserved));
    let mut view = input.tile.framing.view(free, size_px, input.subject_px);
    let response = ui.interact(rect, id.with("picture"), Sense::CLICK | Sense::DRAG);
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, format!("{} picture", input.name())));
    let is_free = state.pointer.is_free() && input.steered.tool.is_none();
    if let Some(changed) = navigate(ui, &response, &view, is_free) {
        state.events.push(TileEvent::SetFraming(Framing::of(&changed, size_px, input.subject_px)));
        view = changed;
    }
    if response.double_clicked() && state.pointer.hovered.is_none() && input.steered.tool.is_none() {
        state.events.push(TileEvent::SetFraming(Framing::Subject));
    }
    let seen = comparison::seen(ui, id, rect, input, &mut state.events);

    ui.painter().rect_filled(rect, 0.0, PICTURE_GROUND);
    let shown = ShownPicture { ui, id, overlay: Overlay { painter: ui.painter_at(rect), view }, input };
    match seen {
        ShownModes::One(_) | ShownModes::Blinking(..) => shown.paint_part(id, rect, seen.mode()),
        ShownModes::Wiped(mode, other, at) => {
            let (left, right) = rect.split_left_right_at_fraction(at);
            shown.paint_part(id.with("left"), left, mode);
            shown.paint_part(id.with("right"), right, other);
        }
    }
    let painter = &shown.overlay.painter;
    if input.settings.pixel_grid {
        paint_pixel_grid(painter, &view, size_px);
    }
    if input.settings.calibration_marks
        && let Some(camera) = input.camera
    {
        shown.overlay.calibration(&CalibrationMarks::new(camera, input.raw_camera));
    }
    if input.picture.frame.is_none() && seen.mode() == ViewMode::Footage {
        let font = TextStyle::Body.resolve(ui.style());
        let colour = theme::colours(Theme::Dark).text3;
        painter.text(rect.center(), Align2::CENTER_CENTER, "No picture for this frame", font, colour);
    }
    match input.steered.tool {
        None => shown.follow_pointer(&response, state),
        Some((tool, radius_px)) => hand::draw(&shown, &response, tool, radius_px, state),
    }
    hand::paint_region(&shown);
    shown.paint_marks(state, seen.mode());
    shown.paint_rivals(state);
    shown.paint_size_handles(state);
    shown.offer_people(state);
    if let ShownModes::Wiped(_, _, at) = seen {
        comparison::paint_wipe(painter, rect, at);
    }
    comparison::paint_names(ui, painter, rect, seen);
    shown.show_card(rect, state, seen, layout.gutter.is_none());
    state.legend_height = if layout.has_legend { legend::show(ui, layout, input, seen) } else { 0.0 };
    view
}

/// A picture as it lies on the screen in this frame of the window.
pub(super) struct ShownPicture<'a> {
    pub(super) ui: &'a Ui,
    id: Id,
    pub(super) overlay: Overlay,
    pub(super) input: &'a TileInput<'a>,
}

impl ShownPicture<'_> {
    /// One view mode in one part of the picture.
    fn paint_part(&self, id: Id, part: Rect, mode: ViewMode) {
        let (ctx, input) = (self.ui.ctx(), self.input);
        let overlay = Overlay { painter: self.ui.painter_at(part), view: self.overlay.view };
        let size_px = input.picture.size;
        let is_crisp = overlay.view.is_crisp(ctx.pixels_per_point());
        let over = input.full.filter(|_| shows_footage(mode, &input.picture));
        if let Some(full) = over {
            let key = Arc::as_ptr(full) as usize;
            let footage = cached_texture(ctx, id.with("full"), key, is_crisp, || full.clone());
            paint_picture(&overlay.painter, &overlay.view, size_px, &footage);
        }
        let shows = ViewedPicture { mode, is_over_footage: over.is_some() };
        let key = (input.generation, mode, shows.is_over_footage);
        let texture = cached_texture(ctx, id.with("texture"), key, is_crisp, || {
            let made = input.composed.iter().find(|made| made.shows == shows);
            made.map_or_else(|| Arc::new(shows.compose(&input.picture)), |made| made.image.clone())
        });
        paint_picture(&overlay.painter, &overlay.view, size_px, &texture);
        if mode.has_outline() {
            overlay.limb_edges(&input.marks.limbs);
            match &input.marks.quick_outline {
                Some(lines) => overlay.body_outline(lines, false),
                None => overlay.body_outline(input.outlines, true),
            }
        }
    }

    /// Lets the pointer hold joints and limbs, and notes which pixel it is on.
    fn follow_pointer(&self, response: &Response, state: &mut TileState) {
        let (ui, view, marks) = (self.ui, &self.overlay.view, self.input.marks);
        let is_held = response.is_pointer_button_down_on();
        let (at, pressed_at, primary_down, modifiers) = ui.input(|input| {
            let pointer = &input.pointer;
            let at = pointer.interact_pos();
            let pressed_at = pointer.press_origin().or(at).filter(|_| is_held && pointer.primary_pressed());
            (at, pressed_at, pointer.primary_down(), input.modifiers)
        });
        let inside = pressed_at.or(at.filter(|_| response.contains_pointer()));
        let grips = Grips { body: self.input.body, joints: &marks.joints, limbs: &marks.limbs, view: *view };
        // Without handles there is nothing to hold: limbs are only shown.
        let under = inside.filter(|_| !(marks.joints.is_empty() || self.input.is_behind));
        let sized = self.size_handles();
        let under = under.and_then(|at| {
            let size = sized.and_then(|(_, handles)| handles.grip_at(at));
            size.or_else(|| grip_at(at, view, &marks.joints, &marks.limbs))
        });
        let is_cancelled = state.pointer.grip().is_some()
            && ui.input_mut(|input| input.consume_key(egui::Modifiers::NONE, Key::Escape));
        if let Some(at) = at {
            let is_down = is_held && primary_down;
            let pointer = PointerInput { at, pressed_at, is_down, modifiers, is_cancelled };
            state.pointer.update(&pointer, under, &grips, &mut state.events);
        }
        if state.pointer.action().is_some() {
            ui.set_cursor_icon(CursorIcon::Grabbing);
        } else if state.pointer.hovered.is_some() {
            ui.set_cursor_icon(CursorIcon::Grab);
        } else if response.dragged() && state.pointer.is_free() {
            ui.set_cursor_icon(CursorIcon::AllScroll);
        }
        state.hovered = inside.and_then(|at| view.pixel_at(at, self.input.picture.size));
    }

    /// People to choose from, as boxes; a click on one follows it.
    fn offer_people(&self, state: &mut TileState) {
        let (ui, picture) = (self.ui, self.overlay.painter.clip_rect());
        let mut labels: Vec<Rect> = Vec::new();
        for (number, corners) in &self.input.marks.people {
            let points = corners.map(|px| self.overlay.at(px));
            let place = Rect::from_points(&points).intersect(picture);
            if !place.is_positive() {
                continue;
            }
            let name = format!("Person {}", number + 1);
            let response = ui.interact(place, self.id.with(("person", number)), Sense::CLICK);
            response.widget_info(|| {
                WidgetInfo::labeled(Role::Button, true, format!("Follow {name}, {}", self.input.name()))
            });
            let colour = if response.hovered() { WHITE } else { JOINT };
            for (from, to) in
                (0..8_usize).flat_map(|at| [1, 2, 4].map(|side| (at, at ^ side))).filter(|(a, b)| a < b)
            {
                for stroke in cased(1.25, colour) {
                    self.overlay.painter.line_segment([points[from], points[to]], stroke);
                }
            }
            let font = TextStyle::Body.resolve(ui.style());
            let galley = ui.painter().layout_no_wrap(name, font, colour);
            let mut label =
                Align2::CENTER_TOP.anchor_size(place.center_top(), galley.size() + vec2(10.0, 4.0));
            while let Some(other) = labels.iter().find(|other| other.intersects(label)) {
                label = label.translate(vec2(0.0, other.bottom() - label.top() + 1.0));
            }
            labels.push(label);
            self.overlay.painter.rect_filled(label, 3.0, CASING.gamma_multiply(0.8));
            self.overlay.painter.galley(label.min + vec2(5.0, 2.0), galley, colour);
            if response.on_hover_cursor(CursorIcon::PointingHand).clicked() {
                state.events.push(TileEvent::FollowPerson(*number));
            }
        }
    }

    /// Poses that rival the one on the screen; a click on the weight of one takes it.
    fn paint_rivals(&self, state: &mut TileState) {
        let (ui, picture) = (self.ui, self.overlay.painter.clip_rect());
        let font = TextStyle::Small.resolve(ui.style());
        let mut taken: Vec<Rect> = Vec::new();
        for (index, rival) in self.input.marks.rivals.iter().enumerate() {
            let Some(rival) = rival else { continue };
            let at = overlays::paint_rival(&self.overlay, rival);
            let galley = ui.painter().layout_no_wrap(whole_percent(rival.weight), font.clone(), GHOST);
            let size = galley.size() + vec2(8.0, 2.0);
            let mut place = Align2::LEFT_BOTTOM.anchor_size(at + vec2(4.0, -4.0), size);
            while let Some(other) = taken.iter().find(|other| other.intersects(place)) {
                place = place.translate(vec2(0.0, other.top() - place.bottom() - 1.0));
            }
            let [left, right] = [picture.left() - place.left(), picture.right() - place.right()];
            place = place.translate(vec2(left.max(0.0) + right.min(0.0), 0.0));
            if !picture.contains_rect(place) {
                continue;
            }
            taken.push(place);
            let name = format!("Rival pose {}, {} likely, {}", index + 1, galley.text(), self.input.name());
            let response = ui.interact(place, self.id.with(("rival", index)), Sense::CLICK);
            response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
            let edge = if response.hovered() { WHITE } else { GHOST };
            self.overlay.painter.rect(
                place,
                3.0,
                CASING.gamma_multiply(0.8),
                Stroke::new(1.0, edge),
                StrokeKind::Inside,
            );
            self.overlay.painter.galley(place.min + vec2(4.0, 1.0), galley, edge);
            let tooltip = "A pose that the tracker carried beside this one, and how likely it is. Click: take it as this frame’s key pose";
            if response.on_hover_text(tooltip).clicked() {
                state.events.push(TileEvent::TakeRival(index));
            }
        }
    }

    /// Limbs under joints, rays between them.
    fn paint_marks(&self, state: &TileState, mode: ViewMode) {
        let (overlay, input, marks) = (&self.overlay, self.input, self.input.marks);
        let name = input.name();
        // What pushes and pulls is at the limb's edge: no outline lies on it.
        let shows_limb = !matches!(mode, ViewMode::Gradient | ViewMode::JacobianColumn);
        if mode.has_outline() {
            self.paint_spheres();
        }
        if shows_limb {
            overlays::paint_held(overlay, input);
            overlays::paint_keypoints(overlay, input.keypoints, &marks.joints);
        }
        if !marks.joints.is_empty() {
            if let Some(Grip::Limb(limb)) = state.pointer.hovered {
                overlay.limbs(&input.turning_with(limb), false);
            }
            if let Some(JointId::End(limb)) = input.selected
                && shows_limb
            {
                overlay.limbs(&input.turning_with(limb), true);
            }
        }
        if let Some(ray) = &marks.sight_ray {
            overlay.sight_ray(ray);
        }
        overlay.limits(&marks.limits);
        if let Some(sway) = &marks.sway {
            overlays::paint_sway(overlay, sway);
        }
        if let Some(ghosts) = &marks.ghosts {
            overlays::paint_ghosts(overlay, ghosts);
        }
        // The selected joint lies on top of its neighbours.
        let (selected, others): (Vec<_>, Vec<_>) =
            marks.joints.iter().partition(|joint| Some(joint.id) == input.selected);
        for joint in others.into_iter().chain(selected) {
            let at = overlay.at(joint.px);
            let grip = Some(Grip::Joint(joint.id));
            let look = JointLook {
                is_selected: Some(joint.id) == input.selected,
                is_hovered: state.pointer.hovered == grip,
                is_dragged: state.pointer.grip() == grip,
                is_small: !marks.ellipses.joints.is_empty(),
            };
            overlay.joint(joint, look);
            if overlay.painter.clip_rect().contains(at) {
                self.name_point(at, self.id.with(joint.id), &format!("{}, {name}", joint.name));
                if let Some(known) = marks.ellipses.joints.iter().find(|known| known.joint == joint.id) {
                    let id = self.id.with(("ellipse", joint.id));
                    self.name_point(at, id, &format!("{}, {name}", known.text));
                }
            }
        }
        if shows_limb {
            overlays::paint_likelier(overlay, &marks.likelier);
        }
        overlays::paint_references(overlay, &marks.references);
        overlays::paint_ellipses(overlay, &marks.ellipses, &marks.joints);
        let font = TextStyle::Small.resolve(self.ui.style());
        if let Some(sides) = &marks.sides {
            // Below is the legend.
            let mut free = overlay.painter.clip_rect();
            free.set_bottom(free.bottom() - state.legend_height);
            overlay.sides(sides, free, &font);
            if let Some(face) = sides.face {
                let way = if face.is_towards { "faces" } else { "faces away from" };
                self.name_point(
                    overlay.at(face.tip),
                    self.id.with("face"),
                    &format!("The body {way} {name}"),
                );
            }
        }
        if !input.says_limits {
            return;
        }
        for (at, words) in overlay.limit_words(&marks.limits, &font) {
            let node = self.ui.interact(at, self.id.with(("limit", words)), Sense::hover());
            node.widget_info(|| WidgetInfo::labeled(Role::Label, true, format!("{words}, {name}")));
        }
    }

    /// Tells screen readers and tests what a mark is.
    fn name_point(&self, at: Pos2, id: Id, what: &str) {
        let node =
            self.ui.interact(Rect::from_center_size(at, vec2(size::ROW, size::ROW)), id, Sense::hover());
        node.widget_info(|| WidgetInfo::labeled(Role::GraphicsSymbol, true, what));
    }

    /// The spheres that stand for the body, each in the colour of its limb.
    fn paint_spheres(&self) {
        let Overlay { painter, view } = &self.overlay;
        for sphere in &self.input.marks.spheres {
            let colour = self.input.picture.limb_colours.get(sphere.limb).copied().unwrap_or(JOINT);
            let at = view.screen_from_px(sphere.centre_px);
            let radius = sphere.radius_px as f32 * view.points_per_px;
            if painter.clip_rect().expand(radius).contains(at) {
                let stroke = Stroke::new(SPHERE_WIDTH, colour.gamma_multiply(SPHERE_OPACITY));
                painter.circle_stroke(at, radius, stroke);
            }
        }
    }

    /// The limb that is selected and the handles of its size, if they are wanted.
    fn size_handles(&self) -> Option<(usize, SizeHandles)> {
        let (input, marks) = (self.input, self.input.marks);
        let limb = input.sized.filter(|_| input.settings.size_handles && !marks.joints.is_empty())?;
        let projected = marks.limbs.get(limb)?.as_ref()?;
        Some((limb, SizeHandles::new(limb, projected, &self.overlay.view, &marks.joints)))
    }

    fn paint_size_handles(&self, state: &TileState) {
        let Some((limb, handles)) = self.size_handles() else { return };
        let painter = &self.overlay.painter;
        handles.paint(painter, state.pointer.grip().or(state.pointer.hovered));
        for (at, what) in handles.places().filter(|(at, _)| painter.clip_rect().contains(*at)) {
            let label = format!("{} {what}, {}", self.input.limb_name(limb), self.input.name());
            self.name_point(at, self.id.with(("size", what)), &label);
        }
    }

    fn show_card(&self, picture: Rect, state: &mut TileState, seen: ShownModes, has_keys: bool) {
        let is_frozen = self.ui.input(|input| input.key_down(Key::H));
        let pointer = &state.pointer;
        if !is_frozen {
            state.card = state
                .hovered
                .filter(|_| pointer.action().is_none() && !pointer.has_dropped() && state.line.is_empty());
        }
        if let Some(pixel) = state.card.filter(|_| self.input.shows_hover_card) {
            let at = self.overlay.at(DVec2::new(pixel[0] as f64, pixel[1] as f64));
            let mode = seen.mode_at(picture, at);
            let grip = pointer.hovered.filter(|_| !is_frozen);
            let card = HoverCard { pixel, is_frozen, mode, grip, has_keys };
            card.show(self, self.id.with("hover card"), picture);
        }
    }
}
