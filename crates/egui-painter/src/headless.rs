//! An egui app without a window.

use egui::{Event, FullOutput, Pos2, RawInput, Rect, Ui, Vec2, ViewportId, vec2};
use image::RgbaImage;

use crate::Painter;

/// An egui context that is driven by hand, frame by frame, and painted on the CPU.
///
/// Its clock moves only with its frames, so what an app shows does not depend on how fast the machine is.
#[derive(Debug)]
pub struct Headless {
    /// The context. Set fonts and style here before the first frame.
    pub ctx: egui::Context,
    /// What has painted so far, and what it could not paint.
    pub painter: Painter,
    size: Vec2,
    /// Pixels per point.
    pub pixels_per_point: f32,
    /// Seconds from frame to frame: at first a quarter of a second, in which every animation of egui ends.
    pub frame_time: f64,
    frames_run: u32,
}

impl Headless {
    /// A window of `width` × `height` points, each at least 1.
    #[must_use]
    pub fn new(width: f32, height: f32, pixels_per_point: f32) -> Self {
        Self {
            ctx: egui::Context::default(),
            painter: Painter::default(),
            size: vec2(width.max(1.0), height.max(1.0)),
            pixels_per_point,
            frame_time: 0.25,
            frames_run: 0,
        }
    }

    /// The size in points.
    #[must_use]
    pub fn size(&self) -> Vec2 {
        self.size
    }

    /// Runs `count` frames of `ui` (at least one) and paints the last, on the theme's panel colour. The first of
    /// them receives `events`.
    ///
    /// egui settles sizes over two frames, so three show a new window as it stays.
    pub fn frames(&mut self, count: usize, events: Vec<Event>, ui: impl FnMut(&mut Ui)) -> RgbaImage {
        let output = self.last_of(count, events, ui);
        self.painter.paint_shapes(&self.ctx, output.shapes, output.pixels_per_point, self.size)
    }

    /// The same as [`frames`](Self::frames), as an SVG: see [`svg`](crate::svg).
    pub fn svg(&mut self, count: usize, events: Vec<Event>, ui: impl FnMut(&mut Ui)) -> String {
        let output = self.last_of(count, events, ui);
        crate::svg(&output.shapes, self.size, self.ctx.global_style().visuals.panel_fill)
    }

    /// Runs `count` frames of `ui` and paints none of them. The first of them receives `events`.
    pub fn run(&mut self, count: usize, events: Vec<Event>, ui: impl FnMut(&mut Ui)) {
        if count > 0 {
            self.last_of(count, events, ui);
        }
    }

    /// The last of `count` frames (at least one), of which the first receives `events`.
    fn last_of(&mut self, count: usize, mut events: Vec<Event>, mut ui: impl FnMut(&mut Ui)) -> FullOutput {
        for _ in 1..count {
            self.frame(std::mem::take(&mut events), &mut ui);
        }
        self.frame(events, ui)
    }

    /// Gives the window another size, in points, from the next frame on.
    pub fn resize(&mut self, size: Vec2) {
        self.size = size.max(vec2(1.0, 1.0));
    }

    fn frame(&mut self, events: Vec<Event>, ui: impl FnMut(&mut Ui)) -> FullOutput {
        let mut input = RawInput {
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, self.size)),
            time: Some(f64::from(self.frames_run) * self.frame_time),
            predicted_dt: self.frame_time as f32,
            focused: true,
            events,
            ..RawInput::default()
        };
        self.frames_run += 1;
        if let Some(viewport) = input.viewports.get_mut(&ViewportId::ROOT) {
            viewport.native_pixels_per_point = Some(self.pixels_per_point);
        }
        let mut output = self.ctx.run_ui(input, ui);
        self.painter.update(&mut output.textures_delta);
        output
    }
}

#[cfg(test)]
mod tests {
    use egui::{CentralPanel, Color32, Frame, PointerButton, pos2};

    use super::*;

    fn red_panel(ui: &mut Ui) {
        let frame = Frame::NONE.fill(Color32::from_rgb(200, 30, 20));
        CentralPanel::default().frame(frame).show(ui, |ui| ui.label("Painted"));
    }

    #[test]
    fn a_panel_fills_the_window_and_text_is_drawn_on_it() {
        let image = Headless::new(80.0, 30.0, 1.5).frames(2, Vec::new(), red_panel);
        assert_eq!(image.dimensions(), (120, 45));
        assert_eq!(image.get_pixel(119, 44).0, [200, 30, 20, 255]);
        let ground = image.pixels().filter(|p| p.0 == [200, 30, 20, 255]).count();
        assert!((4000..5400).contains(&ground), "{ground} of 5400 pixels are ground");
    }

    #[test]
    fn the_same_frames_give_the_same_picture() {
        let paint = || Headless::new(90.0, 40.0, 1.25).frames(3, Vec::new(), red_panel);
        assert_eq!(paint(), paint());
    }

    #[test]
    fn events_reach_the_first_frame() {
        let mut window = Headless::new(100.0, 40.0, 1.0);
        let mut clicks = 0;
        let mut ui = |ui: &mut Ui| clicks += usize::from(ui.button("Step").clicked());
        window.frames(2, Vec::new(), &mut ui);
        let pos = pos2(12.0, 10.0);
        let button = |pressed| Event::PointerButton {
            pos,
            button: PointerButton::Primary,
            pressed,
            modifiers: egui::Modifiers::NONE,
        };
        window.frames(2, vec![Event::PointerMoved(pos), button(true), button(false)], &mut ui);
        assert_eq!(clicks, 1);
    }
}
