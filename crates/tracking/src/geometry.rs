//! Rotations and ray distances: the geometry everything else stands on.

mod nearest_to_lines;
pub mod ray_distance;
pub mod rotation;
pub mod segments;
mod similarity;

pub use nearest_to_lines::{NearestToLines, across};
pub use similarity::{Similarity, umeyama};
