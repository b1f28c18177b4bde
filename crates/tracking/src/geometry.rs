//! Rotations and ray distances: the geometry everything else stands on.
//!
//! | file | holds |
//! |---|---|
//! | [`rotation`] | exponential and logarithm of SO(3), raw quaternions (4.15), swing and twist |
//! | [`segments`] | the closest points of two segments |
//! | [`umeyama`] | the similarity that lays points over others |
//! | [`ray_distance`] | distance of a ray to a limb's axis, to a point and to a flat cap, with derivatives |

pub mod ray_distance;
pub mod rotation;
pub mod segments;
mod similarity;

pub use similarity::{Similarity, umeyama};
