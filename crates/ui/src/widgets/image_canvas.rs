//! A picture that can be zoomed and moved: where its pixels are on the screen, and the texture they come from.
//!
//! Pixel centres lie at integer coordinates, so a picture of w × h pixels covers −½ … w − ½ by −½ … h − ½.

use std::hash::Hash;
use std::sync::Arc;

use egui::{
    Color32, ColorImage, Context, Id, Painter, PointerButton, Pos2, Rect, Response, TextureHandle,
    TextureOptions, Ui, Vec2, pos2, vec2,
};
use glam::DVec2;
use serde::{Deserialize, Serialize};

/// Space around the subject, as a share of its size on each side.
const SUBJECT_PADDING: f32 = 0.08;

/// Nearest-neighbour sampling from this magnification on, in physical pixels per picture pixel.
const CRISP_FROM: f32 = 2.0;

/// A picture pixel is drawn at least this large …
const SMALLEST_PIXEL: f32 = 0.02;

/// … and at most this large, in points.
const LARGEST_PIXEL: f32 = 64.0;

/// Points of wheel travel that magnify e-fold.
const WHEEL_POINTS: f32 = 240.0;

/// What a view shows of its picture. Relative to the subject, so that linked views of different cameras share it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Framing {
    /// The subject, padded.
    #[default]
    Subject,
    /// The whole picture.
    Whole,
    /// Chosen by hand.
    Free {
        /// Magnification relative to [`Self::Subject`].
        zoom: f32,
        /// From the subject's middle to the view's, in units of the subject's larger side.
        offset: [f32; 2],
    },
}

impl Framing {
    /// How a picture of `size_px` pixels lies in `rect`. `subject_px` are the subject's bounds in pixel
    /// coordinates; without them the whole picture stands for it.
    pub fn view(self, rect: Rect, size_px: [usize; 2], subject_px: Option<Rect>) -> ViewTransform {
        let picture = picture_bounds(size_px);
        let subject = padded_subject(picture, subject_px);
        let subject_view = ViewTransform::fit(rect, subject, picture);
        match self {
            Self::Subject => subject_view.filled_by(picture),
            Self::Whole => ViewTransform::fit(rect, picture, picture),
            Self::Free { zoom, offset } => {
                let offset = vec2(offset[0], offset[1]) * subject.size().max_elem();
                let centre = subject.center() + offset;
                ViewTransform {
                    rect,
                    points_per_px: clamp_scale(subject_view.points_per_px * zoom),
                    centre_px: centre.clamp(picture.min, picture.max),
                }
            }
        }
    }

    /// The framing that gives `view` again: the inverse of [`view`](Self::view).
    pub fn of(view: &ViewTransform, size_px: [usize; 2], subject_px: Option<Rect>) -> Self {
        let picture = picture_bounds(size_px);
        let subject = padded_subject(picture, subject_px);
        let fit = ViewTransform::fit(view.rect, subject, picture);
        let offset = (view.centre_px - subject.center()) / subject.size().max_elem();
        Self::Free { zoom: view.points_per_px / fit.points_per_px, offset: [offset.x, offset.y] }
    }
}

/// What a picture of this size covers, in pixel coordinates.
pub fn picture_bounds(size_px: [usize; 2]) -> Rect {
    let size = vec2(size_px[0].max(1) as f32, size_px[1].max(1) as f32);
    Rect::from_min_size(pos2(-0.5, -0.5), size)
}

fn padded_subject(picture: Rect, subject_px: Option<Rect>) -> Rect {
    let inside = subject_px.map(|subject| subject.intersect(picture));
    match inside.filter(|subject| subject.is_finite() && subject.width() >= 1.0 && subject.height() >= 1.0) {
        Some(subject) => subject.expand2(subject.size() * SUBJECT_PADDING),
        None => picture,
    }
}

fn clamp_scale(points_per_px: f32) -> f32 {
    if points_per_px.is_finite() { points_per_px.clamp(SMALLEST_PIXEL, LARGEST_PIXEL) } else { 1.0 }
}

/// Where the pixels of a picture are on the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewTransform {
    /// The view, in points of the screen.
    pub rect: Rect,
    /// The side of a picture pixel, in points.
    pub points_per_px: f32,
    /// The pixel coordinates in the middle of the view.
    pub centre_px: Pos2,
}

impl ViewTransform {
    /// The largest view of `bounds` (pixel coordinates) that is not smaller than the whole `picture` fitted.
    fn fit(rect: Rect, bounds: Rect, picture: Rect) -> Self {
        let scale = |bounds: Rect| (rect.size() / bounds.size()).min_elem();
        let points_per_px = clamp_scale(scale(bounds).max(scale(picture)));
        Self { rect, points_per_px, centre_px: bounds.center() }
    }

    /// Moved so that the picture leaves no gap where it is large enough, and is in the middle where it is not.
    fn filled_by(self, picture: Rect) -> Self {
        let half = self.rect.size() * 0.5 / self.points_per_px;
        let clamp = |centre: f32, min: f32, max: f32, half: f32| {
            if max - min <= 2.0 * half { (min + max) * 0.5 } else { centre.clamp(min + half, max - half) }
        };
        let centre_px = pos2(
            clamp(self.centre_px.x, picture.min.x, picture.max.x, half.x),
            clamp(self.centre_px.y, picture.min.y, picture.max.y, half.y),
        );
        Self { centre_px, ..self }
    }

    /// The point of the screen at a pixel coordinate.
    pub fn screen_from_px(&self, px: DVec2) -> Pos2 {
        self.rect.center() + (pos2(px.x as f32, px.y as f32) - self.centre_px) * self.points_per_px
    }

    /// The pixel coordinate at a point of the screen.
    pub fn px_from_screen(&self, point: Pos2) -> DVec2 {
        let px = self.centre_px + (point - self.rect.center()) / self.points_per_px;
        DVec2::new(f64::from(px.x), f64::from(px.y))
    }

    /// The pixel under a point of the screen; `None` outside the picture.
    pub fn pixel_at(&self, point: Pos2, size_px: [usize; 2]) -> Option<[usize; 2]> {
        let px = self.px_from_screen(point).round();
        let inside = px.x >= 0.0 && px.y >= 0.0 && px.x < size_px[0] as f64 && px.y < size_px[1] as f64;
        inside.then_some([px.x as usize, px.y as usize])
    }

    /// Where the whole picture is on the screen.
    pub fn picture_rect(&self, size_px: [usize; 2]) -> Rect {
        let bounds = picture_bounds(size_px);
        let at = |corner: Pos2| self.screen_from_px(DVec2::new(f64::from(corner.x), f64::from(corner.y)));
        Rect::from_min_max(at(bounds.min), at(bounds.max))
    }

    /// Magnified by `factor` with the pixel at `point` kept in place.
    pub fn zoomed_at(&self, point: Pos2, factor: f32) -> Self {
        let points_per_px = clamp_scale(self.points_per_px * factor);
        let fixed = self.centre_px + (point - self.rect.center()) / self.points_per_px;
        let centre_px = fixed + (self.centre_px - fixed) * (self.points_per_px / points_per_px);
        Self { points_per_px, centre_px, ..*self }
    }

    /// The picture moved by `delta` points.
    pub fn panned(&self, delta: Vec2) -> Self {
        Self { centre_px: self.centre_px - delta / self.points_per_px, ..*self }
    }

    /// Whether pixels are shown as squares at this magnification.
    pub fn is_crisp(&self, pixels_per_point: f32) -> bool {
        self.points_per_px * pixels_per_point >= CRISP_FROM
    }
}

/// Zooms at the pointer with the wheel (or a pinch) and pans with the middle or right button; with the left one too
/// where that holds nothing (`is_free`). `None` when nothing changed.
pub fn navigate(ui: &Ui, response: &Response, view: &ViewTransform, is_free: bool) -> Option<ViewTransform> {
    let mut changed = *view;
    if response.contains_pointer()
        && let Some(pointer) = ui.input(|input| input.pointer.latest_pos())
    {
        let factor = ui.input_mut(|input| {
            let wheel = std::mem::take(&mut input.smooth_scroll_delta);
            input.zoom_delta() * (wheel.y / WHEEL_POINTS).exp()
        });
        if (factor - 1.0).abs() > f32::EPSILON {
            changed = changed.zoomed_at(pointer, factor);
        }
    }
    let others = [PointerButton::Middle, PointerButton::Secondary];
    let pans = others.into_iter().any(|button| response.dragged_by(button))
        || is_free && response.dragged_by(PointerButton::Primary);
    if pans {
        changed = changed.panned(response.drag_delta());
    }
    (changed != *view).then_some(changed)
}

#[derive(Clone)]
struct CachedTexture {
    key: u64,
    handle: TextureHandle,
}

/// The texture of `id`, made again by `image` only when `key` differs from the last call's. Pixels are squares if
/// `is_crisp`.
pub fn cached_texture<I: Into<Arc<ColorImage>>>(
    ctx: &Context,
    id: Id,
    key: impl Hash,
    is_crisp: bool,
    image: impl FnOnce() -> I,
) -> TextureHandle {
    let key = egui::util::hash((key, is_crisp));
    let cached = ctx.data(|data| data.get_temp::<CachedTexture>(id));
    if let Some(cached) = cached.as_ref().filter(|cached| cached.key == key) {
        return cached.handle.clone();
    }
    let options = if is_crisp { TextureOptions::NEAREST } else { TextureOptions::LINEAR };
    let image = within_side(image().into(), ctx.input(|input| input.max_texture_side));
    let handle = match cached {
        Some(mut cached) => {
            cached.handle.set(image, options);
            cached.handle
        }
        None => ctx.load_texture("picture", image, options),
    };
    ctx.data_mut(|data| data.insert_temp(id, CachedTexture { key, handle: handle.clone() }));
    handle
}

/// Forgets all textures of [`cached_texture`]: they are made again when they are next shown.
pub fn forget_textures(ctx: &Context) {
    ctx.data_mut(|data| data.remove_by_type::<CachedTexture>());
}

/// The image with every n-th row and column, so that no side is longer than a texture's can be.
fn within_side(image: Arc<ColorImage>, side: usize) -> Arc<ColorImage> {
    let [width, height] = image.size;
    let step = width.max(height).div_ceil(side.max(1));
    if step <= 1 {
        return image;
    }
    let pixels: Vec<Color32> = (0..height)
        .step_by(step)
        .flat_map(|y| image.pixels[y * width..(y + 1) * width].iter().step_by(step).copied())
        .collect();
    Arc::new(ColorImage::new([width.div_ceil(step), height.div_ceil(step)], pixels))
}

/// Paints a texture as the picture of `view`.
pub fn paint_picture(painter: &Painter, view: &ViewTransform, size_px: [usize; 2], texture: &TextureHandle) {
    paint_whole(painter, texture, view.picture_rect(size_px));
}

/// Fills a rectangle with a whole texture.
pub fn paint_whole(painter: &Painter, texture: &TextureHandle, place: Rect) {
    let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
    painter.image(texture.id(), place, uv, Color32::WHITE);
}

/// Lines between pixels begin to show at this size of a pixel, in points, and are whole at twice that.
const GRID_FROM: f32 = 10.0;

const GRID_OPACITY: f32 = 0.22;

/// Paints the lines between the pixels of `view` where each of them is large enough.
pub fn paint_pixel_grid(painter: &Painter, view: &ViewTransform, size_px: [usize; 2]) {
    let share = ((view.points_per_px - GRID_FROM) / GRID_FROM).clamp(0.0, 1.0);
    if share == 0.0 {
        return;
    }
    let shown = view.picture_rect(size_px).intersect(painter.clip_rect());
    if !shown.is_positive() {
        return;
    }
    // On dark and on bright pixels alike: a dark line with a bright one beside it.
    let lines = [(0.0, Color32::BLACK), (1.0 / painter.pixels_per_point(), Color32::WHITE)];
    let [min, max] = [shown.min, shown.max].map(|corner| view.px_from_screen(corner));
    for (shift, colour) in lines {
        let stroke =
            egui::Stroke::new(1.0 / painter.pixels_per_point(), colour.gamma_multiply(GRID_OPACITY * share));
        for x in (min.x + 0.5).ceil() as i64..=(max.x + 0.5).floor() as i64 {
            let at = view.screen_from_px(DVec2::new(x as f64 - 0.5, 0.0)).x + shift;
            painter.vline(at, shown.y_range(), stroke);
        }
        for y in (min.y + 0.5).ceil() as i64..=(max.y + 0.5).floor() as i64 {
            let at = view.screen_from_px(DVec2::new(0.0, y as f64 - 0.5)).y + shift;
            painter.hline(shown.x_range(), at, stroke);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use proptest::prelude::*;

    use super::*;

    const SIZE: [usize; 2] = [272, 480];

    fn rect() -> Rect {
        Rect::from_min_size(pos2(10.0, 36.0), vec2(440.0, 370.0))
    }

    fn subject() -> Rect {
        Rect::from_min_max(pos2(80.0, 120.0), pos2(200.0, 420.0))
    }

    #[test]
    fn a_picture_covers_half_a_pixel_more_than_its_centres() {
        let view = Framing::Whole.view(rect(), SIZE, None);
        let shown = view.picture_rect(SIZE);
        assert!((shown.height() - rect().height()).abs() < 1e-3);
        assert!(
            (view.screen_from_px(DVec2::new(0.0, 0.0)).y - shown.top() - view.points_per_px * 0.5).abs()
                < 1e-3
        );
        assert_eq!(view.pixel_at(shown.min + vec2(0.1, 0.1), SIZE), Some([0, 0]));
        assert_eq!(view.pixel_at(shown.min - vec2(0.1, 0.0), SIZE), None);
        assert_eq!(view.pixel_at(shown.max - vec2(0.1, 0.1), SIZE), Some([271, 479]));
    }

    #[test]
    fn the_subject_is_padded_and_leaves_no_gap() {
        let view = Framing::Subject.view(rect(), SIZE, Some(subject()));
        let top = view.screen_from_px(DVec2::new(100.0, 120.0)).y;
        assert!((top - rect().top() - 0.08 * 300.0 * view.points_per_px).abs() < 0.01);
        let shown = view.picture_rect(SIZE);
        // Narrower than the view: in the middle.
        assert!(shown.width() < rect().width());
        assert!((shown.center().x - rect().center().x).abs() < 1e-3);
        let corner = Rect::from_min_max(pos2(0.0, 400.0), pos2(60.0, 479.0));
        let view = Framing::Subject.view(rect(), SIZE, Some(corner));
        assert!(view.picture_rect(SIZE).contains_rect(rect().shrink(0.01)));
    }

    #[test]
    fn a_subject_outside_the_picture_shows_the_whole() {
        let outside = Rect::from_min_max(pos2(900.0, 900.0), pos2(950.0, 990.0));
        let whole = Framing::Whole.view(rect(), SIZE, None);
        assert_eq!(Framing::Subject.view(rect(), SIZE, Some(outside)), whole);
        assert_eq!(Framing::Subject.view(rect(), SIZE, Some(Rect::NOTHING)), whole);
    }

    #[test]
    fn pictures_too_large_for_a_texture_lose_rows_and_columns() {
        let image = ColorImage::new([5, 2], (0..10).map(Color32::from_gray).collect());
        let image = Arc::new(image);
        let smaller = within_side(image.clone(), 3);
        assert_eq!(smaller.size, [3, 1]);
        assert_eq!(smaller.pixels[1], Color32::from_gray(2));
        assert_eq!(within_side(image.clone(), 5), image);
    }

    #[test]
    fn textures_are_made_once_for_each_key() {
        let ctx = Context::default();
        let made = Cell::new(0);
        let texture = |key: u64, crisp: bool| {
            cached_texture(&ctx, Id::unique("picture"), key, crisp, || {
                made.set(made.get() + 1);
                ColorImage::filled([2, 2], Color32::RED)
            })
            .id()
        };
        let first = texture(7, false);
        assert_eq!((texture(7, false), made.get()), (first, 1));
        assert_eq!((texture(7, true), made.get()), (first, 2));
        assert_eq!((texture(8, true), made.get()), (first, 3));
    }

    proptest! {
        #[test]
        fn zooming_keeps_the_pixel_under_the_pointer(
            x in 10.0..450.0_f32, y in 36.0..400.0_f32, factor in 0.2..5.0_f32, start in 0.3..3.0_f32,
        ) {
            let view = Framing::Free { zoom: start, offset: [0.1, -0.05] }.view(rect(), SIZE, Some(subject()));
            let before = view.px_from_screen(pos2(x, y));
            let zoomed = view.zoomed_at(pos2(x, y), factor);
            prop_assert!(zoomed.px_from_screen(pos2(x, y)).distance(before) < 0.01);
            prop_assert!(zoomed.screen_from_px(before).distance(pos2(x, y)) < 0.05);
            let panned = zoomed.panned(vec2(13.0, -7.0));
            prop_assert!(panned.px_from_screen(pos2(x + 13.0, y - 7.0)).distance(before) < 0.01);
        }

        #[test]
        fn a_framing_gives_its_view_again(zoom in 0.3..4.0_f32, x in -0.3..0.3_f32, y in -0.3..0.3_f32) {
            let view = Framing::Free { zoom, offset: [x, y] }.view(rect(), SIZE, Some(subject()));
            let again = Framing::of(&view, SIZE, Some(subject())).view(rect(), SIZE, Some(subject()));
            prop_assert!((view.points_per_px - again.points_per_px).abs() < 1e-4);
            prop_assert!(view.centre_px.distance(again.centre_px) < 1e-2);
        }
    }
}
