//! Pictures without a GPU or a display: a CPU painter for egui's meshes and one for the 3-D scene.
//!
//! Snapshots in tests and `backlit screenshot` come from here. The same input gives the same picture bit
//! for bit: vertices are snapped to 1/256 pixel, coverage and blending are integer arithmetic, and
//! interpolation is plain `f64` and `f32` arithmetic in a fixed order.

mod coverage;
mod painter;
mod pixel;
mod textures;
mod window;

pub use painter::Canvas;
pub use textures::TextureStore;
pub use window::Headless;
