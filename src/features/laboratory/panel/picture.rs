//! One picture of a fit: the report's overlay at this step, or what pushes at the start.

use std::hash::Hash;

use backlit_ui::drawing::{PictureInput, ViewMode, compose};
use backlit_ui::style::theme::data_colours::{CASING, PICTURE_GROUND, REPORT_GROUND, SELECTED};
use backlit_ui::style::theme::{self, Theme};
use backlit_ui::widgets::image_canvas::{cached_texture, paint_picture, picture_bounds};
use backlit_ui::widgets::{ViewTransform, first_that_fits};
use egui::{Align2, Color32, Rect, Role, Sense, Stroke, TextStyle, Ui, pos2, vec2};
use glam::DVec2;

use super::{Bench, named};
use crate::features::laboratory::Worst;
use crate::session::Extent;

/// Space around data and start, as a share of their larger side.
const PADDING: f32 = 0.12;
/// Room of the line above the picture.
const LABEL: f32 = 24.0;
/// The mark of the worst pixel: gap between pixel and ring, and its widths.
const RING_GAP: f32 = 5.0;
const RING: f32 = 1.6;
const RING_CASING: f32 = 3.6;

/// Whether two pictures of the camera are larger one above the other than side by side in `area`.
pub(crate) fn is_stacked(bench: &Bench<'_>, area: Rect) -> bool {
    let Some(crop) = crop(bench) else { return true };
    let scale = |width: f32, height: f32| (width / crop.width()).min((height - LABEL) / crop.height());
    scale(area.width(), 0.5 * area.height()) >= scale(0.5 * area.width(), area.height())
}

/// What the pictures show, in pixel coordinates of the camera.
fn crop(bench: &Bench<'_>) -> Option<Rect> {
    let camera = bench.key.0;
    let size = bench.comparison.basis.scene.cameras.get(camera).map(|c| [c.width(), c.height()])?;
    let extent: Option<Extent> = bench.comparison.extents.get(camera).copied().flatten();
    let rect = extent.map_or_else(
        || picture_bounds(size),
        |[left, top, right, bottom]| Rect::from_min_max(pos2(left, top), pos2(right, bottom)).expand(0.5),
    );
    Some(rect.expand(PADDING * rect.size().max_elem()))
}

fn view(bench: &Bench<'_>, rect: Rect) -> Option<ViewTransform> {
    let crop = crop(bench)?;
    let below = rect.with_min_y(rect.top() + LABEL.min(0.3 * rect.height()));
    let scale = (below.width() / crop.width()).min(below.height() / crop.height());
    // The subject keeps clear of the line above; what lies around it may reach under that.
    let centre_px = crop.center() - vec2(0.0, (below.center().y - rect.center().y) / scale);
    Some(ViewTransform { rect, points_per_px: scale, centre_px })
}

/// The report's overlay at this step, with the worst pixel if that is marked.
pub(crate) fn overlay(ui: &Ui, rect: Rect, bench: &Bench<'_>, index: usize, mark: Option<&Worst>) {
    let fit = &bench.comparison.contestants[index];
    let response = ui.interact(rect, ui.scope_id().with("overlay"), Sense::hover());
    named(&response, Role::Image, &format!("{}, data and model", fit.entrant.name));
    let ground = Color32::from_gray(REPORT_GROUND);
    ui.painter().rect_filled(rect, 0.0, ground);
    let camera = bench.key.0;
    let shown = fit.shown.as_ref();
    let parts = shown.and_then(|shown| Some((shown, shown.cameras.get(camera)?)));
    let (Some(view), Some((shown, prediction))) = (view(bench, rect), parts) else { return };
    let frame = bench.comparison.basis.scene.frame.as_ref().and_then(|frame| frame.cameras.get(camera));
    let size = [prediction.prediction.width, prediction.prediction.height];
    let input = PictureInput {
        mask: frame.and_then(|frame| frame.mask.as_deref()),
        data: prediction.data.as_deref(),
        prediction: Some(&prediction.prediction),
        ..PictureInput::empty(size)
    };
    let pose: Vec<u64> = shown.pose.to_state().iter().map(|x| x.to_bits()).collect();
    let mode = ViewMode::ReportOverlay;
    paint(ui, "overlay texture", &view, (bench.comparison.id, index, camera, pose), mode, &input);
    if let Some(worst) = mark {
        paint_mark(ui, &view, worst);
    }
    let words = ["Data black, model white, both grey", "Data black, model white", "Data and model"];
    label(ui, rect, &words, Color32::from_gray(0x20));
}

/// What pushes at the start; pixels of the ramp that do not are hatched.
pub(crate) fn push(ui: &Ui, rect: Rect, bench: &Bench<'_>, index: usize) {
    let fit = &bench.comparison.contestants[index];
    let response = ui.interact(rect, ui.scope_id().with("push"), Sense::hover());
    let words = format!("At the start: what {}", bench.axis.verb(bench.limb));
    named(&response, Role::Image, &format!("{}, what pushes at the start", fit.entrant.name));
    ui.painter().rect_filled(rect, 0.0, PICTURE_GROUND);
    if let (Some(view), Some((key, pushed))) = (view(bench, rect), fit.pushed.as_ref()) {
        // Of another camera it would lie in the wrong place.
        if key.0 == bench.key.0 {
            let size = [pushed.prediction.width, pushed.prediction.height];
            let input = PictureInput {
                prediction: Some(&pushed.prediction),
                jacobian: Some(&pushed.picture),
                ..PictureInput::empty(size)
            };
            let mode = ViewMode::JacobianColumn;
            paint(ui, "push texture", &view, (bench.comparison.id, index, *key), mode, &input);
        }
    }
    let colour = theme::colours(Theme::Dark).text2;
    label(ui, rect, &[&words, "What pushes at the start", "What pushes"], colour);
}

fn paint(
    ui: &Ui,
    salt: &str,
    view: &ViewTransform,
    key: impl Hash,
    mode: ViewMode,
    input: &PictureInput<'_>,
) {
    let is_crisp = view.is_crisp(ui.ctx().pixels_per_point());
    let texture = cached_texture(ui.ctx(), ui.scope_id().with(salt), key, is_crisp, || compose(mode, input));
    paint_picture(&ui.painter_at(view.rect), view, input.size, &texture);
}

/// One line in the upper left corner: the first of these texts that there is room for.
fn label(ui: &Ui, rect: Rect, texts: &[&str], colour: Color32) {
    let font = TextStyle::Small.resolve(ui.style());
    let at = rect.left_top() + vec2(12.0, 7.0);
    let room = rect.width() - 24.0;
    if let Some(text) = first_that_fits(ui, texts, &TextStyle::Small, room) {
        ui.painter().text(at, Align2::LEFT_TOP, text, font, colour);
    }
}

/// A ring around the pixel, and its numbers.
fn paint_mark(ui: &Ui, view: &ViewTransform, worst: &Worst) {
    let [x, y] = worst.pixel;
    let at = view.screen_from_px(DVec2::new(x as f64, y as f64));
    let radius = 0.5 * view.points_per_px + RING_GAP;
    let painter = ui.painter_at(view.rect);
    painter.circle_stroke(at, radius, Stroke::new(RING_CASING, CASING));
    painter.circle_stroke(at, radius, Stroke::new(RING, SELECTED));
    let font = TextStyle::Small.resolve(ui.style());
    let text = format!("({x}, {y})");
    let galley = painter.layout_no_wrap(text.clone(), font.clone(), SELECTED);
    let size = galley.size() + vec2(8.0, 4.0);
    let free = view.rect.shrink(2.0);
    let right = at.x + radius + 4.0;
    let left = if right + size.x > free.right() { at.x - radius - 4.0 - size.x } else { right };
    let top = (at.y - 0.5 * size.y).clamp(free.top(), (free.bottom() - size.y).max(free.top()));
    let tag = Rect::from_min_size(pos2(left, top), size);
    painter.rect_filled(tag, 3.0, CASING);
    painter.text(tag.center(), Align2::CENTER_CENTER, text, font, SELECTED);
}
