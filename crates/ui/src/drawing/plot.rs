//! Plots as pictures, drawn by the window's own painter without a display: what `backlit experiment` writes.
//!
//! | file | holds |
//! |---|---|
//! | [`figure`] | [`Figure`]: a title, axes with their units, and what is drawn between them |
//! | [`heat_map`] | [`HeatMap`]: a grid of coloured cells |
//! | [`marks`] | where an axis has its marks |
//! | [`png`](mod@png) | figures as PNG files |

pub mod figure;
pub mod heat_map;
pub mod marks;
pub mod png;

pub use figure::{Axis, Figure, Line};
pub use heat_map::HeatMap;
pub use png::png;
