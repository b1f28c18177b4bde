//! What paints.

use egui::epaint::{ClippedPrimitive, ClippedShape};
use egui::{Color32, Context, TexturesDelta, Vec2};
use image::RgbaImage;

use crate::canvas::Canvas;
use crate::textures::TextureStore;

/// Paints egui's meshes, with the textures that egui has asked for.
///
/// Give every [`FullOutput::textures_delta`](egui::FullOutput::textures_delta) to [`update`](Self::update),
/// also those of frames that are not painted, and what [`Context::tessellate`](egui::Context::tessellate) returns
/// to [`paint`](Self::paint).
///
/// With the feature `kittest` it is a `TestRenderer` of `egui_kittest`.
#[derive(Debug, Default)]
pub struct Painter {
    textures: TextureStore,
    /// What could not be painted until now.
    pub skipped: Skipped,
}

/// How much could not be painted since a painter was made. All zero for what egui itself draws.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Skipped {
    /// Paint callbacks, which draw with a GPU.
    pub callbacks: usize,
    /// Meshes whose texture is unknown, such as one that was made by a GPU.
    pub meshes: usize,
    /// Triangles within their clip rectangle's mesh that have a corner which is not finite or does not exist.
    pub triangles: usize,
    /// Images for textures that were empty, had a wrong number of pixels, reached beyond their texture, or were
    /// patches of a texture that was never set.
    pub images: usize,
}

impl Painter {
    /// Applies what changed in a frame, and empties `delta`.
    ///
    /// Textures that are freed in it may still be painted with until the next call, as egui expects.
    pub fn update(&mut self, delta: &mut TexturesDelta) {
        self.skipped.images += self.textures.update(delta);
    }

    /// A picture of `size` pixels with `primitives` painted in their order on `background`, which is taken as
    /// opaque.
    ///
    /// The same input gives the same picture bit for bit. What cannot be painted is left out and counted:
    /// [`skipped`](Self::skipped). Never fails, unless there is no memory for the picture: 8 bytes a pixel.
    #[must_use]
    pub fn paint(
        &mut self,
        primitives: &[ClippedPrimitive],
        pixels_per_point: f32,
        size: [u32; 2],
        background: Color32,
    ) -> RgbaImage {
        let mut canvas = Canvas::new(size, background);
        canvas.paint(primitives, pixels_per_point, &self.textures, &mut self.skipped);
        canvas.image()
    }

    /// A window of `size` points as egui has shaped it, on the theme's panel colour.
    pub(crate) fn paint_shapes(
        &mut self,
        ctx: &Context,
        shapes: Vec<ClippedShape>,
        pixels_per_point: f32,
        size: Vec2,
    ) -> RgbaImage {
        let primitives = ctx.tessellate(shapes, pixels_per_point);
        let size_px = (size * pixels_per_point).round();
        let background = ctx.global_style().visuals.panel_fill;
        self.paint(&primitives, pixels_per_point, [size_px.x as u32, size_px.y as u32], background)
    }
}

/// Snapshots in tests.
#[cfg(feature = "kittest")]
impl egui_kittest::TestRenderer for Painter {
    fn handle_delta(&mut self, delta: &mut TexturesDelta) {
        self.update(delta);
    }

    fn render(&mut self, ctx: &Context, output: &egui::FullOutput) -> Result<RgbaImage, String> {
        let size = ctx.viewport_rect().size();
        Ok(self.paint_shapes(ctx, output.shapes.clone(), output.pixels_per_point, size))
    }
}
