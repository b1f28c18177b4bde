#![doc = include_str!("../README.md")]
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
//! assert_eq!(painter.skipped, egui_painter::Skipped::default());
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
