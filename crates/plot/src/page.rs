//! A page: lines, dots and text, painted on pixels without a window. Lengths are pixels.

use image::RgbaImage;
use skrifa::instance::{LocationRef, Size};
use skrifa::outline::{DrawSettings, OutlinePen};
use skrifa::{FontRef, MetadataProvider};
use vello_cpu::color::{AlphaColor, Srgb};
use vello_cpu::kurbo::{Affine, BezPath, Circle, Point, Rect, Shape, Stroke, Vec2};
use vello_cpu::{Pixmap, RenderContext, Resources};

use crate::colours::rgb;

/// The window's own font; its licence lies beside it.
const FONT: &[u8] = include_bytes!("../fonts/Ubuntu-Light.ttf");

/// Sizes of text.
pub(crate) const TITLE: f64 = 18.0;
pub(crate) const BODY: f64 = 13.5;
pub(crate) const SMALL: f64 = 12.0;

/// What a text is anchored by: shares of its width and height.
pub(crate) type Anchor = [f64; 2];
pub(crate) const LEFT_TOP: Anchor = [0.0, 0.0];
pub(crate) const LEFT_MIDDLE: Anchor = [0.0, 0.5];
pub(crate) const LEFT_BOTTOM: Anchor = [0.0, 1.0];
pub(crate) const CENTRE_TOP: Anchor = [0.5, 0.0];
pub(crate) const CENTRE_BOTTOM: Anchor = [0.5, 1.0];
pub(crate) const RIGHT_TOP: Anchor = [1.0, 0.0];
pub(crate) const RIGHT_MIDDLE: Anchor = [1.0, 0.5];
pub(crate) const RIGHT_BOTTOM: Anchor = [1.0, 1.0];

/// A picture that is being drawn.
pub(crate) struct Page {
    context: RenderContext,
    font: Option<FontRef<'static>>,
}

impl Page {
    /// An empty page of this ground.
    pub(crate) fn new([width, height]: [u32; 2], ground: u32) -> Self {
        let side = |side: u32| side.clamp(1, u32::from(u16::MAX)) as u16;
        let mut page =
            Self { context: RenderContext::new(side(width), side(height)), font: FontRef::new(FONT).ok() };
        page.fill(Rect::new(0.0, 0.0, width.into(), height.into()), ground);
        page
    }

    fn paint(&mut self, colour: u32) {
        let [r, g, b] = rgb(colour);
        self.context.set_paint(AlphaColor::<Srgb>::from_rgba8(r, g, b, u8::MAX));
    }

    /// Fills a rectangle.
    pub(crate) fn fill(&mut self, rect: Rect, colour: u32) {
        self.paint(colour);
        self.context.fill_rect(&rect);
    }

    /// A hairline just inside a rectangle.
    pub(crate) fn frame(&mut self, rect: Rect, colour: u32) {
        self.paint(colour);
        self.context.set_stroke(Stroke::new(1.0));
        self.context.stroke_rect(&rect.inset(-0.5));
    }

    /// A straight hairline.
    pub(crate) fn hairline(&mut self, from: Point, to: Point, colour: u32) {
        self.curve(&[from, to], (1.0, &[]), colour);
    }

    /// A line through points, of a width and a dash.
    pub(crate) fn curve(&mut self, points: &[Point], (width, dash): (f32, &[f32]), colour: u32) {
        let mut path = BezPath::new();
        for pair in points.windows(2) {
            if path.is_empty() {
                path.move_to(pair[0]);
            }
            path.line_to(pair[1]);
        }
        let stroke = Stroke::new(width.into()).with_dashes(0.0, dash.iter().map(|&length| f64::from(length)));
        self.paint(colour);
        self.context.set_stroke(stroke);
        self.context.stroke_path(&path);
    }

    /// A filled circle.
    pub(crate) fn dot(&mut self, centre: Point, radius: f32, colour: u32) {
        self.paint(colour);
        self.context.fill_path(&Circle::new(centre, radius.into()).to_path(0.05));
    }

    /// Text whose anchor lies at a point.
    pub(crate) fn text(&mut self, at: Point, anchor: Anchor, text: &str, size: f64, colour: u32) {
        let corner = Vec2::new(-anchor[0] * self.text_width(text, size), -anchor[1] * line_height(size));
        self.text_by(Affine::translate((at + corner).round().to_vec2()), text, size, colour);
    }

    /// Text that runs upward, its middle at a point.
    pub(crate) fn text_up(&mut self, at: Point, text: &str, size: f64, colour: u32) {
        let corner = Vec2::new(-0.5 * self.text_width(text, size), -0.5 * line_height(size));
        let turn = Affine::rotate(-std::f64::consts::FRAC_PI_2);
        self.text_by(Affine::translate(at.to_vec2()) * turn * Affine::translate(corner), text, size, colour);
    }

    /// The width of a text in a line.
    pub(crate) fn text_width(&self, text: &str, size: f64) -> f64 {
        let Some(font) = &self.font else { return 0.0 };
        let metrics = font.glyph_metrics(Size::new(size as f32), LocationRef::default());
        let glyphs = text.chars().filter_map(|letter| font.charmap().map(letter));
        glyphs.filter_map(|glyph| metrics.advance_width(glyph)).map(f64::from).sum()
    }

    fn text_by(&mut self, place: Affine, text: &str, size: f64, colour: u32) {
        let Some(font) = self.font.clone() else { return };
        let font_size = Size::new(size as f32);
        let metrics = font.glyph_metrics(font_size, LocationRef::default());
        let outlines = font.outline_glyphs();
        self.paint(colour);
        let mut x = 0.0;
        for glyph in text.chars().filter_map(|letter| font.charmap().map(letter)) {
            let mut pen = GlyphPen::default();
            if let Some(outline) = outlines.get(glyph) {
                let settings = DrawSettings::unhinted(font_size, LocationRef::default());
                if outline.draw(settings, &mut pen).is_ok() {
                    let baseline = 0.5 * (line_height(size) + CAPITAL * size);
                    self.context.fill_path(&(place * Affine::translate((x, baseline)) * pen.0));
                }
            }
            x += f64::from(metrics.advance_width(glyph).unwrap_or_default());
        }
    }

    /// The picture.
    pub(crate) fn finish(mut self) -> RgbaImage {
        let [width, height] = [self.context.width(), self.context.height()];
        let mut pixels = Pixmap::new(width, height);
        self.context.flush();
        self.context.render(&mut pixels, &mut Resources::new());
        RgbaImage::from_raw(width.into(), height.into(), pixels.data_as_u8_slice().to_vec())
            .unwrap_or_default()
    }
}

/// Height of a capital letter, as a part of the size of its text.
const CAPITAL: f64 = 0.69;

/// Height of a line of text.
pub(crate) fn line_height(size: f64) -> f64 {
    1.2 * size
}

/// A glyph's outline, upright on the page.
#[derive(Default)]
struct GlyphPen(BezPath);

fn at(x: f32, y: f32) -> Point {
    Point::new(x.into(), (-y).into())
}

impl OutlinePen for GlyphPen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.0.move_to(at(x, y));
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.0.line_to(at(x, y));
    }

    fn quad_to(&mut self, cx0: f32, cy0: f32, x: f32, y: f32) {
        self.0.quad_to(at(cx0, cy0), at(x, y));
    }

    fn curve_to(&mut self, cx0: f32, cy0: f32, cx1: f32, cy1: f32, x: f32, y: f32) {
        self.0.curve_to(at(cx0, cy0), at(cx1, cy1), at(x, y));
    }

    fn close(&mut self) {
        self.0.close_path();
    }
}
