//! What is measured of a motion, apart from where it happens, which way it goes and how tall the person is.

mod channels;
mod normalised;
mod smoothing;
mod window;

pub use channels::Channels;
pub(crate) use normalised::median;
pub use normalised::{FRAME_FEATURES, Normalised, body_size};
pub use window::{MEASURE_COUNT, window_measures};

/// Frames a second of all features.
pub const RATE: f64 = 30.0;
