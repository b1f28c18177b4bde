//! Meshes on a picture in memory, as a GPU would paint them: premultiplied colours, blended in gamma space,
//! textures sampled with the filter they ask for.

use std::ops::Range;

use egui::epaint::{ClippedPrimitive, Mesh, Primitive, Vertex};
use egui::{Color32, Rect};
use image::RgbaImage;

use crate::Skipped;
use crate::coverage::{Clip, Snapped, UNIT, doubled_area, for_each_span, pixels_between};
use crate::pixel;
use crate::textures::{Tap, Texture, TextureStore};

/// Textured rectangles of this many pixels are shared among threads, row by row.
#[cfg(feature = "rayon")]
const PARALLEL_FROM: usize = 1 << 15;

/// A picture that is being painted.
#[derive(Debug)]
pub(crate) struct Canvas {
    width: usize,
    height: usize,
    pixels: Vec<u32>,
    /// Texture coordinates of a rectangle's columns; kept to spare allocations.
    columns: Vec<Tap>,
}

impl Canvas {
    /// A picture of `width` × `height` pixels, all of `background`, which is taken as opaque.
    pub(crate) fn new([width, height]: [u32; 2], background: Color32) -> Self {
        let (width, height) = (width as usize, height as usize);
        let pixels = vec![pixel::pack(background.to_opaque()); width * height];
        Self { width, height, pixels, columns: Vec::new() }
    }

    /// Paints `primitives` in order, and counts what it cannot paint.
    pub(crate) fn paint(
        &mut self,
        primitives: &[ClippedPrimitive],
        pixels_per_point: f32,
        textures: &TextureStore,
        skipped: &mut Skipped,
    ) {
        for ClippedPrimitive { clip_rect, primitive } in primitives {
            let Primitive::Mesh(mesh) = primitive else {
                skipped.callbacks += 1;
                continue;
            };
            let Some(texture) = textures.get(mesh.texture_id) else {
                skipped.meshes += 1;
                continue;
            };
            let clip = self.clip(*clip_rect, pixels_per_point);
            if clip.left < clip.right && clip.top < clip.bottom {
                skipped.triangles += self.paint_mesh(mesh, texture, clip, pixels_per_point);
            }
        }
    }

    /// The picture so far. Its pixels are opaque.
    pub(crate) fn image(&self) -> RgbaImage {
        let mut bytes = vec![0; self.pixels.len() * 4];
        for (bytes, pixel) in bytes.chunks_exact_mut(4).zip(&self.pixels) {
            bytes.copy_from_slice(&pixel.to_le_bytes());
        }
        RgbaImage::from_raw(self.width as u32, self.height as u32, bytes).unwrap_or_default()
    }

    fn clip(&self, rect: Rect, pixels_per_point: f32) -> Clip {
        let round =
            |points: f32, limit: usize| (points * pixels_per_point).round().clamp(0.0, limit as f32) as i64;
        Clip {
            left: round(rect.min.x, self.width),
            top: round(rect.min.y, self.height),
            right: round(rect.max.x, self.width),
            bottom: round(rect.max.y, self.height),
        }
    }

    /// How many triangles could not be painted.
    fn paint_mesh(&mut self, mesh: &Mesh, texture: &Texture, clip: Clip, pixels_per_point: f32) -> usize {
        let mut skipped = 0;
        let mut indices = mesh.indices.as_slice();
        while indices.len() >= 3 {
            let corner = |at: usize| Corner::new(mesh, indices[at], pixels_per_point);
            if indices.len() >= 6
                && indices[3] == indices[2]
                && indices[4] == indices[1]
                && let (Some(a), Some(b), Some(c), Some(d)) = (corner(0), corner(1), corner(2), corner(5))
                && let Some(quad) = Quad::new([a, b, c, d])
            {
                self.paint_quad(&quad, texture, clip);
                indices = &indices[6..];
                continue;
            }
            if let (Some(a), Some(b), Some(c)) = (corner(0), corner(1), corner(2)) {
                self.paint_triangle([a, b, c], texture, clip);
            } else {
                skipped += 1;
            }
            indices = &indices[3..];
        }
        skipped
    }

    fn row(&mut self, y: i64, span: Range<i64>) -> &mut [u32] {
        let start = y as usize * self.width;
        &mut self.pixels[start + span.start as usize..start + span.end as usize]
    }

    fn paint_quad(&mut self, quad: &Quad, texture: &Texture, clip: Clip) {
        let columns = pixels_between(quad.min.at.x, quad.max.at.x);
        let columns = columns.start.max(clip.left)..columns.end.min(clip.right);
        let rows = pixels_between(quad.min.at.y, quad.max.at.y);
        let rows = rows.start.max(clip.top)..rows.end.min(clip.bottom);
        if columns.is_empty() || rows.is_empty() {
            return;
        }
        let colour = pixel::pack(quad.min.colour);
        if quad.min.uv == quad.max.uv {
            let source = pixel::modulate(constant_texel(texture, quad.min.uv), colour);
            for y in rows {
                pixel::fill(self.row(y, columns.clone()), source);
            }
            return;
        }
        let u = Ramp::new([quad.min.at.x, quad.max.at.x], [quad.min.uv[0], quad.max.uv[0]]);
        let v = Ramp::new([quad.min.at.y, quad.max.at.y], [quad.min.uv[1], quad.max.uv[1]]);
        let [width, height] = texture.size();
        let nearest = texture.is_nearest((u.slope as f32 * width).abs().max((v.slope as f32 * height).abs()));
        let mut taps = std::mem::take(&mut self.columns);
        taps.clear();
        taps.extend(columns.clone().map(|x| texture.tap_x(u.at(x), nearest)));
        let paint_row = |y: i64, row: &mut [u32]| {
            let texels = texture.rows(texture.tap_y(v.at(y), nearest));
            for (target, tap) in row.iter_mut().zip(&taps) {
                let texel = texels.sample(*tap);
                if texel != 0 {
                    let white = colour == pixel::WHITE;
                    pixel::blend(target, if white { texel } else { pixel::modulate(texel, colour) });
                }
            }
        };
        let span = columns.start as usize..columns.end as usize;
        let band = rows.start as usize * self.width..rows.end as usize * self.width;
        for_each_row(&mut self.pixels[band], self.width, span, |index, row| {
            paint_row(rows.start + index as i64, row);
        });
        self.columns = taps;
    }

    fn paint_triangle(&mut self, corners: [Corner; 3], texture: &Texture, clip: Clip) {
        let [a, b, c] = corners;
        let same_colour = a.colour == b.colour && b.colour == c.colour;
        let same_texel = a.uv == b.uv && b.uv == c.uv;
        let at = corners.map(|corner| corner.at);
        let gradients = Gradients::new(&corners);
        match (same_texel, same_colour) {
            (true, true) => {
                let source = pixel::modulate(constant_texel(texture, a.uv), pixel::pack(a.colour));
                if source != 0 {
                    for_each_span(at, clip, |y, span| pixel::fill(self.row(y, span), source));
                }
            }
            (true, false) => {
                let texel = constant_texel(texture, a.uv);
                for_each_span(at, clip, |y, span| {
                    let mut colour = gradients.walk(&gradients.colour, span.start, y);
                    for target in self.row(y, span) {
                        pixel::blend(target, pixel::modulate(texel, colour.next_pixel()));
                    }
                });
            }
            (false, _) => {
                let nearest = texture.is_nearest(gradients.texels_per_pixel(texture.size()));
                for_each_span(at, clip, |y, span| {
                    let mut colour = gradients.walk(&gradients.colour, span.start, y);
                    let mut uv = gradients.walk(&gradients.uv, span.start, y);
                    for target in self.row(y, span) {
                        let [u, v] = uv.next_values();
                        let texel = texture.sample(texture.tap_x(u, nearest), texture.tap_y(v, nearest));
                        pixel::blend(target, pixel::modulate(texel, colour.next_pixel()));
                    }
                });
            }
        }
    }
}

/// Calls `paint` with the pixels `span` of every row of `band`, and with the row's index in it. Rows do not
/// depend on each other, so threads change nothing.
fn for_each_row(
    band: &mut [u32],
    width: usize,
    span: Range<usize>,
    paint: impl Fn(usize, &mut [u32]) + Sync,
) {
    #[cfg(feature = "rayon")]
    if span.len() * (band.len() / width) >= PARALLEL_FROM {
        use rayon::prelude::*;
        let rows = band.par_chunks_exact_mut(width).enumerate();
        return rows.for_each(|(index, row)| paint(index, &mut row[span.clone()]));
    }
    for (index, row) in band.chunks_exact_mut(width).enumerate() {
        paint(index, &mut row[span.clone()]);
    }
}

/// The one texel of a shape whose corners all have the same texture coordinates: egui's white pixel, mostly.
fn constant_texel(texture: &Texture, [u, v]: [f32; 2]) -> u32 {
    texture.sample(texture.tap_x(u, true), texture.tap_y(v, true))
}

/// A vertex in snapped pixels.
#[derive(Clone, Copy, Debug)]
struct Corner {
    at: Snapped,
    uv: [f32; 2],
    colour: Color32,
}

impl Corner {
    fn new(mesh: &Mesh, index: u32, pixels_per_point: f32) -> Option<Self> {
        let Vertex { pos, uv, color } = *mesh.vertices.get(index as usize)?;
        let at = Snapped::new(pos.x * pixels_per_point, pos.y * pixels_per_point)?;
        (uv.x.is_finite() && uv.y.is_finite()).then_some(Self { at, uv: [uv.x, uv.y], colour: color })
    }
}

/// An upright rectangle of one colour, its texture upright too (or mirrored): glyphs, pictures, plain boxes.
struct Quad {
    min: Corner,
    max: Corner,
}

impl Quad {
    /// From the corners of two triangles `a b c`, `c b d`: `None` unless they form such a rectangle.
    fn new([a, b, c, d]: [Corner; 4]) -> Option<Self> {
        let upright = a.at.x == c.at.x && b.at.x == d.at.x && a.at.y == b.at.y && c.at.y == d.at.y;
        let texture_upright =
            a.uv[0] == c.uv[0] && b.uv[0] == d.uv[0] && a.uv[1] == b.uv[1] && c.uv[1] == d.uv[1];
        let plain = a.colour == b.colour && b.colour == c.colour && c.colour == d.colour;
        if !(upright && texture_upright && plain) {
            return None;
        }
        let (mut min, mut max) = (a, d);
        if min.at.x > max.at.x {
            std::mem::swap(&mut min.at.x, &mut max.at.x);
            std::mem::swap(&mut min.uv[0], &mut max.uv[0]);
        }
        if min.at.y > max.at.y {
            std::mem::swap(&mut min.at.y, &mut max.at.y);
            std::mem::swap(&mut min.uv[1], &mut max.uv[1]);
        }
        Some(Self { min, max })
    }
}

/// A linear function of the pixel index along one axis.
struct Ramp {
    start: f64,
    slope: f64,
}

impl Ramp {
    fn new([from, to]: [i64; 2], [at_from, at_to]: [f32; 2]) -> Self {
        let unit = UNIT as f64;
        let slope = (f64::from(at_to) - f64::from(at_from)) / (to - from).max(1) as f64 * unit;
        Self { start: f64::from(at_from) - (from as f64 / unit - 0.5) * slope, slope }
    }

    fn at(&self, pixel: i64) -> f32 {
        (self.start + pixel as f64 * self.slope) as f32
    }
}

/// Colour and texture coordinates as linear functions over a triangle.
struct Gradients {
    origin: Snapped,
    colour: [Plane; 4],
    uv: [Plane; 2],
}

#[derive(Clone, Copy)]
struct Plane {
    base: f64,
    per_column: f64,
    per_row: f64,
}

impl Gradients {
    fn new(corners: &[Corner; 3]) -> Self {
        let [a, b, c] = corners.map(|corner| corner.at);
        // A triangle without area covers no pixel, so what is divided by here is never seen.
        let area = match doubled_area([a, b, c]) {
            0 => 1.0,
            area => area as f64,
        };
        let unit = UNIT as f64;
        let (abx, aby) = ((b.x - a.x) as f64, (b.y - a.y) as f64);
        let (acx, acy) = ((c.x - a.x) as f64, (c.y - a.y) as f64);
        let plane = |values: [f64; 3]| {
            let (ab, ac) = (values[1] - values[0], values[2] - values[0]);
            Plane {
                base: values[0],
                per_column: (ab * acy - ac * aby) / area * unit,
                per_row: (ac * abx - ab * acx) / area * unit,
            }
        };
        let channel = |i: usize| plane(corners.map(|corner| f64::from(corner.colour[i])));
        let coordinate = |i: usize| plane(corners.map(|corner| f64::from(corner.uv[i])));
        Self { origin: a, colour: std::array::from_fn(channel), uv: std::array::from_fn(coordinate) }
    }

    /// From a pixel of a row to the right.
    fn walk<const N: usize>(&self, planes: &[Plane; N], x: i64, y: i64) -> Walk<N> {
        let unit = UNIT as f64;
        let dx = x as f64 + 0.5 - self.origin.x as f64 / unit;
        let dy = y as f64 + 0.5 - self.origin.y as f64 / unit;
        Walk {
            start: planes.map(|plane| (plane.base + dx * plane.per_column + dy * plane.per_row) as f32),
            step: planes.map(|plane| plane.per_column as f32),
            column: 0.0,
        }
    }

    /// How far one pixel reaches in the texture. Without `hypot`, whose last bit is the platform's.
    fn texels_per_pixel(&self, [width, height]: [f32; 2]) -> f32 {
        let [u, v] = &self.uv;
        let squared = |du: f64, dv: f64| {
            let (across, down) = (du * f64::from(width), dv * f64::from(height));
            across * across + down * down
        };
        squared(u.per_column, v.per_column).max(squared(u.per_row, v.per_row)).sqrt() as f32
    }
}

/// Values along a row, pixel by pixel.
struct Walk<const N: usize> {
    start: [f32; N],
    step: [f32; N],
    column: f32,
}

impl<const N: usize> Walk<N> {
    #[inline]
    fn next_values(&mut self) -> [f32; N] {
        let values = std::array::from_fn(|i| self.start[i] + self.step[i] * self.column);
        self.column += 1.0;
        values
    }
}

impl Walk<4> {
    #[inline]
    fn next_pixel(&mut self) -> u32 {
        u32::from_le_bytes(self.next_values().map(|value| (value + 0.5) as u8))
    }
}
