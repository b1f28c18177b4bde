//! The scene's picture: what it is to show, and the one that there is, until the next is there.

use std::sync::Arc;

use backlit_ui::style::theme::data_colours::PICTURE_GROUND;
use backlit_ui::widgets::image_canvas::cached_texture;
use egui::{Color32, Rect, Ui, pos2, vec2};

use super::Stage;
use crate::context::Context;
use crate::features::scene::{Scene, SceneDrawing, SceneOrder, ShownHull, contents};

/// Longest side of a picture on a frustum, in points: about the size that it is seen.
const PICTURE_SIDE: f32 = 120.0;
/// Longest side of the scene's picture, in pixels: beyond that it is stretched.
const LONGEST: f32 = 1400.0;

/// The scene as it is now. `moves` says that the view does.
pub(super) fn order(
    pixels_per_point: f32,
    context: &Context<'_>,
    scene: &Scene,
    stage: &Stage,
    moves: bool,
) -> SceneOrder {
    let (preferences, busy) = (&scene.preferences, context.busy);
    let goes_on = busy.fitting || busy.tracking || context.playback.is_playing();
    let size = stage.picture.size() * pixels_per_point;
    let shrink = (LONGEST / size.max_elem()).min(1.0);
    let frame = context.session.shown_frame(context.selection.frame);
    let hull = frame.and_then(|frame| scene.hulls.get(frame)).flatten();
    let input = stage.contents_input(context, preferences, hull.map(Arc::as_ref), pixels_per_point * shrink);
    let contents = contents(&input);
    SceneOrder {
        size_px: [size.x, size.y].map(|side| (side * shrink).round().max(1.0) as u32),
        is_draft: moves || goes_on || stage.ray.is_some() || context.observability.is_playing,
        eye: stage.eye,
        scene: contents.scene,
        pictures: frame.filter(|_| preferences.pictures && !contents.frusta.is_empty()).cloned(),
        frusta: contents.frusta,
        picture_side: (PICTURE_SIDE * pixels_per_point).round() as u32,
        shell: hull.filter(|_| preferences.hull == ShownHull::Shell).cloned(),
        held: stage.position(context.selection.joint).filter(|_| context.ghosts.is_none()),
    }
}

/// Shows the picture that there is, as large as it was drawn for: while the tile changes its size, the scene keeps its
/// proportions.
pub(crate) fn show(ui: &Ui, picture: Rect, drawing: &SceneDrawing) {
    let texture = cached_texture(ui.ctx(), ui.scope_id().with("scene texture"), drawing.key, false, || {
        drawing.image.clone()
    });
    let [width, height] = drawing.order.size_px.map(|side| side as f32);
    let size = vec2(width / height * picture.height(), picture.height());
    // All but the rounding to whole pixels.
    let fits = (size.x - picture.width()).abs() <= 1.0;
    let place = if fits { picture } else { Rect::from_center_size(picture.center(), size) };
    let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
    let painter = ui.painter_at(picture);
    painter.image(texture.id(), place, uv, Color32::WHITE);
}

/// The ground on which the scene stands.
pub(crate) fn ground(ui: &Ui, picture: Rect) {
    ui.painter().rect_filled(picture, 0.0, PICTURE_GROUND);
}
