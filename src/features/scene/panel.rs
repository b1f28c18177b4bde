//! The scene's tile: body, cameras with their pictures, floor and visual hull in three dimensions.

use std::sync::Arc;

use backlit_tracking::body::{Kinematics, Model, Pose};
use backlit_ui::drawing::{JointId, joint_position};
use backlit_ui::style::theme;
use backlit_ui::style::theme::data_colours::PICTURE_GROUND;
use backlit_ui::style::theme::{size, space};
use backlit_ui::widgets::heat_map::error_legend;
use backlit_ui::widgets::image_canvas::cached_texture;
use backlit_ui::widgets::{CHEVRON, checkbox, cut_off, menu_words, paint_text, paint_whole, within};
use egui::{Align, Align2, Button, Color32, Layout, Popup, Rect, TextStyle, Ui, pos2, vec2};
use glam::DVec3;

use super::raster::SceneCamera;
use super::{
    ContentsInput, Orbit, Scene, SceneDrawing, SceneOrder, ScenePreferences, ShownHull, Upright, Viewpoint,
    contents,
};
use crate::context::command::{Command, SceneCommand};
use crate::context::pane::{HEADER_BUTTONS, Pane};
use crate::context::{Context, Requests, pane_title};

pub(crate) mod input;
mod marks;

impl Scene {
    /// The tile, in all of the space that is left.
    pub(super) fn show(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        siblings: &[Pane],
        requests: &mut Requests,
    ) {
        if context.session.take.is_none() {
            return;
        }
        let tile = ui.available_rect_before_wrap();
        let header = Rect::from_min_max(tile.min, pos2(tile.right(), tile.top() + size::TILE_HEADER));
        let picture = Rect::from_min_max(pos2(tile.left(), header.bottom()), tile.max);
        show_header(ui, header, &mut self.preferences, context, siblings, requests);
        let viewpoint = &mut self.preferences.viewpoint;
        let Some(view) = SceneView::new(context, *viewpoint, picture).filter(|_| picture.is_positive())
        else {
            return;
        };
        let (seen_from, moves) = input::navigate(ui, &view, viewpoint);
        let view = view.seen_from(context, seen_from);
        let order = order_of(ui.pixels_per_point(), context, self, &view, moves);
        self.order(context.pool, order);
        ui.painter().rect_filled(picture, 0.0, PICTURE_GROUND);
        let Some(drawing) = &self.drawing else { return };
        show_drawing(ui, picture, drawing);
        let seen = DrawnView { picture, order: &drawing.order };
        input::pick_camera(ui, context, &seen, requests);
        marks::show(ui, context, self, &seen);
        if let Some(floor) = &drawing.order.floor_picture {
            show_floor_legend(ui, picture, floor.limit_mm);
        }
        input::show_focus(ui, picture);
    }
}

/// The scene as it is to be seen.
struct SceneView {
    /// The picture on the screen.
    picture: Rect,
    upright: Upright,
    /// Height of the floor.
    floor: f64,
    /// Where the start pose stands.
    middle: DVec3,
    viewpoint: Viewpoint,
    eye: SceneCamera,
    /// The body on the screen.
    kinematics: Kinematics,
    root: DVec3,
    /// The camera in whose view a joint is dragged, and where that joint is.
    ray: Option<(usize, DVec3)>,
}

/// How large a body is in a pose: twice the greatest distance of its limbs' ends from their middle, metres.
fn height_of(model: &Model, pose: &Pose) -> f64 {
    let kinematics = Kinematics::new(model, pose);
    let ends = kinematics.ends();
    let middle = ends.iter().sum::<DVec3>() / ends.len().max(1) as f64;
    let thickest = model.limbs().iter().map(|limb| limb.radius).fold(0.0, f64::max);
    let farthest = ends.iter().chain([&pose.root]).map(|end| end.distance(middle)).fold(0.0, f64::max);
    2.0 * (farthest + thickest)
}

impl SceneView {
    fn new(context: &Context<'_>, viewpoint: Option<Viewpoint>, picture: Rect) -> Option<Self> {
        let take = context.session.take.as_ref()?;
        let document = context.document();
        let upright = Upright::of(&take.cameras);
        let middle = document.start.root;
        let aspect = f64::from(picture.width() / picture.height().max(1.0));
        let viewpoint = viewpoint.unwrap_or_else(|| {
            let eyes: Vec<DVec3> = take.cameras.iter().map(|camera| camera.centre()).collect();
            let size = height_of(&document.model, &document.start);
            Viewpoint::Orbit(Orbit::around(&upright, (middle, size), &eyes, aspect))
        });
        // A body that sways is shown on its way.
        let swayed = context.observability.swayed_pose.as_ref();
        let pose = swayed.unwrap_or(context.shown_pose());
        let mut view = Self {
            picture,
            upright,
            floor: upright.floor(&document.model, &document.start),
            middle,
            viewpoint,
            eye: viewpoint.camera(&upright, &take.cameras, aspect),
            kinematics: Kinematics::new(&document.model, pose),
            root: pose.root,
            ray: None,
        };
        let dragged = context.drag.dragged_joint();
        view.ray = dragged
            .and_then(|(camera, joint)| Some((camera, joint_position(joint, view.root, &view.kinematics)?)));
        Some(view)
    }

    /// The same from elsewhere: what a drag asks for is ordered in the very frame.
    fn seen_from(self, context: &Context<'_>, viewpoint: Viewpoint) -> Self {
        if viewpoint == self.viewpoint {
            return self;
        }
        let cameras = context.session.take.as_ref().map_or(&[][..], |take| take.cameras.as_slice());
        let aspect = f64::from(self.picture.width() / self.picture.height().max(1.0));
        Self { viewpoint, eye: viewpoint.camera(&self.upright, cameras, aspect), ..self }
    }
}

/// The scene as it was drawn: what lies over the picture belongs to that one, until the next is there.
struct DrawnView<'a> {
    /// The picture on the screen.
    picture: Rect,
    /// What it shows.
    order: &'a SceneOrder,
}

impl DrawnView<'_> {
    /// Where a point appears on the screen, and its depth.
    fn on_screen(&self, point: DVec3) -> Option<egui::Pos2> {
        // In tenths of a point, so that marks do not jump by whole ones.
        const FINE: f32 = 10.0;
        let size = (self.picture.size() * FINE).round();
        let (at, _) = self.order.eye.project(point, [size.x.max(1.0) as u32, size.y.max(1.0) as u32])?;
        let share = vec2(at.x as f32 + 0.5, at.y as f32 + 0.5) / FINE;
        Some(self.picture.min + share).filter(|at| at.is_finite())
    }
}

/// Size of the legend of the picture on the floor.
const LEGEND_WIDTH: f32 = 280.0;
const LEGEND_HEIGHT: f32 = 64.0;
/// Longest side of a picture on a frustum, in points: about the size that it is seen.
const PICTURE_SIDE: f32 = 120.0;
/// Longest side of the scene's picture, in pixels: beyond that it is stretched.
const LONGEST: f32 = 1400.0;

/// The scene as it is now. `moves` says that the view does.
fn order_of(
    pixels_per_point: f32,
    context: &Context<'_>,
    scene: &Scene,
    view: &SceneView,
    moves: bool,
) -> SceneOrder {
    let (preferences, busy) = (&scene.preferences, context.busy);
    let goes_on = busy.fitting || busy.tracking || context.playback.is_playing();
    let size = view.picture.size() * pixels_per_point;
    let shrink = (LONGEST / size.max_elem()).min(1.0);
    let frame = context.session.shown_frame(context.selection.frame);
    let hull = frame.and_then(|frame| scene.hulls.get(frame)).flatten();
    let (session, document) = (context.session, context.document());
    let held = document.model.limbs().get(context.selection.limb(&document.model));
    let held = held.filter(|_| context.selection.joint != JointId::Root);
    let rivals = if context.ghosts.is_some() { Vec::new() } else { context.rivals() };
    let contents = contents(&ContentsInput {
        preferences,
        model: &document.model,
        kinematics: &view.kinematics,
        renderer: document.fit.renderer,
        sphere_level: context.views.drawn_level(),
        ghosts: context.ghosts,
        rivals: &rivals,
        rotation: held.map(|limb| limb.rotation),
        cameras: session.take.as_ref().map_or(&[], |take| take.cameras.as_slice()),
        uses: &document.cameras,
        active: context.selection.camera,
        hull: hull.map(Arc::as_ref),
        ray: view.ray,
        upright: view.upright,
        floor: view.floor,
        middle: view.middle,
        scale: f64::from(pixels_per_point * shrink),
    });
    SceneOrder {
        size_px: [size.x, size.y].map(|side| (side * shrink).round().max(1.0) as u32),
        is_draft: moves || goes_on || view.ray.is_some() || context.observability.is_playing,
        eye: view.eye,
        scene: contents.scene,
        pictures: frame.filter(|_| preferences.pictures && !contents.frusta.is_empty()).cloned(),
        frusta: contents.frusta,
        picture_side: (PICTURE_SIDE * pixels_per_point).round() as u32,
        shell: hull.filter(|_| preferences.hull == ShownHull::Shell).cloned(),
        floor_picture: context.floor_picture.filter(|_| preferences.floor).cloned(),
        held: joint_position(context.selection.joint, view.root, &view.kinematics)
            .filter(|_| context.ghosts.is_none()),
    }
}

/// What the colours of the picture on the floor mean, in the upper left corner: the axes are in the lower one.
fn show_floor_legend(ui: &Ui, picture: Rect, limit_mm: f64) {
    let legend = vec2(LEGEND_WIDTH.min(picture.width() - 2.0 * space::WIDGET), LEGEND_HEIGHT);
    if legend.x < LEGEND_HEIGHT || legend.y > 0.4 * picture.height() {
        return;
    }
    let palette = theme::palette(ui);
    let card = Rect::from_min_size(picture.min + vec2(space::WIDGET, space::WIDGET), legend);
    ui.painter_at(picture).rect_filled(card, size::FIELD_RADIUS, palette.panel);
    let inner = card.shrink2(vec2(space::WIDGET, space::ROW));
    let title = "How far off joints would be there";
    paint_text(ui, inner.left_top(), Align2::LEFT_TOP, title, TextStyle::Small, palette.text2);
    error_legend(ui, inner.with_min_y(inner.top() + size::ROW), limit_mm);
}

/// Shows the picture that there is, as large as it was drawn for: while the tile changes its size, the scene keeps its
/// proportions.
fn show_drawing(ui: &Ui, picture: Rect, drawing: &SceneDrawing) {
    let texture = cached_texture(ui.ctx(), ui.scope_id().with("scene texture"), drawing.key, false, || {
        drawing.image.clone()
    });
    let [width, height] = drawing.order.size_px.map(|side| side as f32);
    let size = vec2(width / height * picture.height(), picture.height());
    // All but the rounding to whole pixels.
    let fits = (size.x - picture.width()).abs() <= 1.0;
    let place = if fits { picture } else { Rect::from_center_size(picture.center(), size) };
    paint_whole(&ui.painter_at(picture), &texture, place);
}

fn show_header(
    ui: &mut Ui,
    rect: Rect,
    preferences: &mut ScenePreferences,
    context: &Context<'_>,
    siblings: &[Pane],
    requests: &mut Requests,
) {
    ui.painter().rect_filled(rect, 0.0, theme::palette(ui).raised);
    let right = (rect.right() - HEADER_BUTTONS).max(rect.left());
    let left = Rect::from_min_max(pos2(rect.left() + space::WIDGET, rect.top()), pos2(right, rect.bottom()));
    within(ui, left, Layout::left_to_right(Align::Center), |ui| {
        pane_title::show(ui, Pane::Scene, siblings, requests);
        menu(ui, preferences, context, requests);
    });
}

fn menu(ui: &mut Ui, preferences: &mut ScenePreferences, context: &Context<'_>, requests: &mut Requests) {
    let text = title(preferences);
    let room = (ui.available_width() - CHEVRON).max(0.0);
    let galley = cut_off(ui, &text, TextStyle::Button, Color32::PLACEHOLDER, room);
    let response = menu_words(ui, galley, &format!("Scene view: {text}"));
    let response = response.on_hover_text("Views, and what is shown");
    Popup::menu(&response).close_behavior(egui::PopupCloseBehavior::CloseOnClickOutside).show(|ui| {
        ui.set_min_width(190.0);
        views(ui, preferences, context, requests);
        ui.separator();
        shown(ui, preferences);
    });
}

/// From where it is seen, or what is shown.
fn title(preferences: &ScenePreferences) -> String {
    match preferences.viewpoint {
        Some(Viewpoint::Camera(index)) => format!("From camera {}", index + 1),
        _ if preferences.cameras => "Body and cameras".to_owned(),
        _ => "Body".to_owned(),
    }
}

fn views(ui: &mut Ui, preferences: &mut ScenePreferences, context: &Context<'_>, requests: &mut Requests) {
    let presets = [
        ("Whole scene", Command::Scene(SceneCommand::Reset)),
        ("Front", Command::Scene(SceneCommand::Front)),
        ("Side", Command::Scene(SceneCommand::Side)),
        ("Above", Command::Scene(SceneCommand::Top)),
    ];
    for (text, command) in presets {
        if ui.add(Button::new(text)).on_hover_text(command.tooltip()).clicked() {
            requests.run(command);
            ui.close();
        }
    }
    for camera in 0..context.session.camera_count() {
        let viewpoint = Some(Viewpoint::Camera(camera));
        let is_chosen = preferences.viewpoint == viewpoint;
        if ui.add(Button::new(format!("From camera {}", camera + 1)).selected(is_chosen)).clicked() {
            preferences.viewpoint = viewpoint;
            ui.close();
        }
    }
}

fn shown(ui: &mut Ui, preferences: &mut ScenePreferences) {
    checkbox(ui, &mut preferences.cameras, "Cameras");
    let pictures = &mut preferences.pictures;
    ui.add_enabled_ui(preferences.cameras, |ui| checkbox(ui, pictures, "Their pictures"));
    checkbox(ui, &mut preferences.floor, "Floor and axes");
    ui.separator();
    for (hull, text) in ShownHull::ALL {
        let tooltip = "The visual hull: the space that all silhouettes allow";
        if ui.add(Button::new(text).selected(preferences.hull == hull)).on_hover_text(tooltip).clicked() {
            preferences.hull = hull;
        }
    }
}
