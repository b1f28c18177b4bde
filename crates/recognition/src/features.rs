//! What is measured of a motion, apart from where it happens, which way it goes and how tall the person is.
//!
//! | file | holds |
//! |---|---|
//! | `smoothing` | Gaussian smoothing and derivatives over time |
//! | `normalised` | [`Normalised`]: joints in the body's own frame, of a body of unit size |
//! | `frame` | [`frame_features`]: a frame as numbers, for principal components |
//! | `channels` | angles, distances and speeds over time |
//! | `window` | [`window_measures`]: a stretch of time as numbers, for classifiers |

mod channels;
mod frame;
mod normalised;
mod smoothing;
mod window;

pub use channels::Channels;
pub use frame::{FRAME_FEATURES, frame_features};
pub(crate) use normalised::median;
pub use normalised::{Normalised, body_size};
pub use window::{MEASURE_COUNT, window_measures};

/// Frames a second of all features.
pub const RATE: f64 = 30.0;
