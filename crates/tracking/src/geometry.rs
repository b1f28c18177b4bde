//! Rotations and ray distances: the geometry everything else stands on.

pub mod ray_distance;
pub mod rotation;
pub mod segments;
mod similarity;

pub use similarity::{Similarity, umeyama};
