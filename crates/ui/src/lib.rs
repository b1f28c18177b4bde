//! What Backlit's window is made of, without a window: [`style`], how everything looks; [`drawing`], what a camera's
//! picture shows; [`widgets`], what egui does not have.
//!
//! It knows people and cameras, but no takes, no documents and no tasks. `drawing` uses `style`, `widgets` use both.

pub mod drawing;
pub mod style;
pub mod widgets;
