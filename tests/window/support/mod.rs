//! Windows in tests: `egui_kittest` over the CPU painter, so snapshots need no GPU.

pub(crate) mod app_window;
pub(crate) mod snapshots;
pub(crate) mod storage;
pub(crate) mod take;

use backlit::raster::{Canvas, TextureStore};
use backlit::style::theme;
use backlit::style::theme::Theme;
use egui::{Context, FullOutput, TexturesDelta, Vec2};
use egui_kittest::{HarnessBuilder, TestRenderer};
use image::RgbaImage;

#[derive(Default)]
struct CpuRenderer {
    textures: TextureStore,
}

impl TestRenderer for CpuRenderer {
    fn handle_delta(&mut self, delta: &mut TexturesDelta) {
        self.textures.update(delta);
    }

    fn render(&mut self, ctx: &Context, output: &FullOutput) -> Result<RgbaImage, String> {
        let primitives = ctx.tessellate(output.shapes.clone(), output.pixels_per_point);
        let size = (ctx.viewport_rect().size() * output.pixels_per_point).round();
        let background = ctx.global_style().visuals.panel_fill;
        let mut canvas = Canvas::new(size.x as u32, size.y as u32, background);
        canvas.paint(output.pixels_per_point, &primitives, &self.textures);
        Ok(canvas.image())
    }
}

/// A window of `size` points in `theme`.
pub(crate) fn harness_builder<State>(size: impl Into<Vec2>, theme: Theme) -> HarnessBuilder<State> {
    HarnessBuilder::default()
        .with_size(size)
        .with_theme(theme.to_egui())
        .with_context_setup(move |ctx| theme::apply(ctx, theme))
        .renderer(CpuRenderer::default())
}
