//! Paints egui on the CPU: pictures of an app without GPU or display, the same bit for bit everywhere.
//!
//! # An app without a window
//!
//! [`Headless`] runs an app frame by frame, with a size, a clock and input of its own:
//!
//! ```
//! use egui_painter::Headless;
//!
//! let mut clicks = 0;
//! let mut app = |ui: &mut egui::Ui| {
//!     egui::CentralPanel::default().show(ui, |ui| {
//!         clicks += usize::from(ui.button("Click me").clicked());
//!     });
//! };
//! let mut window = Headless::new(120.0, 40.0, 2.0);
//! let before = window.frames(3, Vec::new(), &mut app);
//! assert_eq!(before.dimensions(), (240, 80));
//!
//! // The pointer comes to rest on the button, which looks different then, and clicks it.
//! let pos = egui::pos2(20.0, 16.0);
//! let button = |pressed| egui::Event::PointerButton {
//!     pos,
//!     button: egui::PointerButton::Primary,
//!     pressed,
//!     modifiers: egui::Modifiers::NONE,
//! };
//! let events = vec![egui::Event::PointerMoved(pos), button(true), button(false)];
//! let after = window.frames(2, events, &mut app);
//! assert_ne!(before, after);
//! assert_eq!(clicks, 1);
//! ```
//!
//! # Meshes from anywhere
//!
//! A [`Painter`] paints what egui tessellates, so whoever drives a context can have its pictures: give it the
//! textures of every frame, and the primitives of those frames that are shown.
//!
//! ```
//! use egui_painter::Painter;
//!
//! let ctx = egui::Context::default();
//! let mut output = ctx.run_ui(egui::RawInput::default(), |ui| {
//!     let rect = egui::Rect::from_min_max(egui::pos2(2.0, 1.0), egui::pos2(6.0, 4.0));
//!     ui.painter().rect_filled(rect, 0, egui::Color32::RED);
//! });
//! let mut painter = Painter::default();
//! painter.update(&mut output.textures_delta);
//! let primitives = ctx.tessellate(output.shapes, output.pixels_per_point);
//! let image = painter.paint(&primitives, output.pixels_per_point, [8, 5], egui::Color32::BLACK);
//! assert_eq!(image.get_pixel(3, 2).0, [255, 0, 0, 255]);
//! assert_eq!(image.get_pixel(1, 2).0, [0, 0, 0, 255]);
//! assert_eq!(painter.skipped(), egui_painter::Skipped::default());
//! ```
//!
//! # Snapshots
//!
//! With the feature `kittest` a [`Painter`] is a `TestRenderer` of `egui_kittest`, so snapshot tests run where
//! there is no GPU, and their tolerance can be zero:
//!
#![cfg_attr(feature = "kittest", doc = "```")]
#![cfg_attr(not(feature = "kittest"), doc = "```ignore")]
//! use egui_kittest::HarnessBuilder;
//! use egui_painter::Painter;
//!
//! let mut harness = HarnessBuilder::default()
//!     .with_size([120.0, 40.0])
//!     .renderer(Painter::default())
//!     .build_ui(|ui| _ = ui.label("Hello"));
//! harness.run();
//! assert_eq!(harness.render()?.dimensions(), (120, 40));
//! # Ok::<_, String>(())
//! ```
//!
//! # What is guaranteed
//!
//! The same primitives, textures, size and background give the same picture, bit for bit, from run to run and
//! from machine to machine, however many threads there are:
//!
//! - Corners are rounded to 1/256 pixel. Which pixels a triangle covers is then exact integer arithmetic: those
//!   whose centre lies inside it, or on a top or left edge. Triangles that share an edge cover every pixel along
//!   it once.
//! - Colours are premultiplied, modulated and blended as they are, in gamma space, in 8-bit integers rounded to
//!   the nearest. Sums beyond 255 saturate.
//! - Colours and texture coordinates between corners, and the place in a texture, rounded to 1/256 texel, are `f64`
//!   and `f32` sums, products and quotients in a fixed order. Texels are mixed (bilinear) or picked (nearest) in
//!   integers.
//! - Rows of large pictures are shared among threads; no row depends on another.
//!
//! Not guaranteed: that a GPU paints the same bits (it is close to egui's glow backend), and that egui itself
//! tessellates the same bits on another platform, where the sine of a round corner may have another last bit.
//! The rounding to 1/256 pixel hides nearly all of that.
//!
//! # What is left out
//!
//! Paint callbacks and user textures need a GPU. They are skipped, never an error, and counted like everything that
//! cannot be painted: [`Skipped`]. Mipmaps are not made: a texture that is shown very small is sampled bilinearly.

mod canvas;
mod coverage;
mod headless;
mod painter;
mod pixel;
mod svg;
mod textures;

pub use headless::Headless;
pub use image::RgbaImage;
pub use painter::{Painter, Skipped};
pub use svg::svg;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
