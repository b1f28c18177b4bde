//! Silhouette-based markerless motion capture: the tracking core of Backlit.

pub mod body;
pub mod camera;
pub mod geometry;
pub mod render;
pub mod segment;
pub mod silhouette;
