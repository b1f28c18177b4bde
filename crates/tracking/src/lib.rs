//! Silhouette-based markerless motion capture: the tracking core of Backlit.

pub mod body;
pub mod camera;
pub mod cancel;
pub mod geometry;
pub mod io;
pub mod optimize;
pub mod render;
pub mod residual;
pub mod segment;
pub mod silhouette;
pub mod synthetic;
pub mod track;
