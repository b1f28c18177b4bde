//! Snapshots in tests.

use egui::{Context, FullOutput, TexturesDelta};
use egui_kittest::TestRenderer;
use image::RgbaImage;

use crate::Painter;

/// Paints on the theme's panel colour.
impl TestRenderer for Painter {
    fn handle_delta(&mut self, delta: &mut TexturesDelta) {
        self.update(delta);
    }

    fn render(&mut self, ctx: &Context, output: &FullOutput) -> Result<RgbaImage, String> {
        let primitives = ctx.tessellate(output.shapes.clone(), output.pixels_per_point);
        let size_px = (ctx.viewport_rect().size() * output.pixels_per_point).round();
        let background = ctx.global_style().visuals.panel_fill;
        let size_px = [size_px.x as u32, size_px.y as u32];
        Ok(self.paint(&primitives, output.pixels_per_point, size_px, background))
    }
}
