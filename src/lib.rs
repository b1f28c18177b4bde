//! The inspector.

pub mod format;
pub mod raster;
pub mod theme;
pub mod widgets;
