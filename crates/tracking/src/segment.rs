//! From footage to silhouettes: background subtraction for a camera that stands still.
//!
//! [`Background`] is what the camera sees without the subject; [`learn_plate`] learns it from footage that never shows the
//! scene alone. [`segment`] compares a frame with it, pixel by pixel
//! (4.25: foreground where |i − µ| > βσ), takes shadows (6.12) and undecidable dark places out of the decision,
//! cleans the result with morphology and by the size of its components, and returns a [`Mask`](crate::silhouette::Mask).
//!
//! Equation numbers are those of P. Kaimakis, "Markerless Motion Capture", University of Cambridge, 2004.

mod background;
mod bit_image;
pub mod changes;
mod components;
mod dont_know;
mod exposure;
mod gradient;
mod learning;
mod luminance;
mod morphology;
mod options;
mod shadow;
mod stages;
mod subtraction;
mod threshold;

pub use background::{Background, BackgroundError, BackgroundSums};
pub use dont_know::DontKnowOptions;
pub use learning::{LearningFrame, LearningOptions, LearntPlate, learn_plate};
pub use luminance::ChromaOptions;
pub use options::{BETA, BETA_GREY, HYSTERESIS, SegmentOptions};
pub use shadow::{ShadowOptions, ShadowTest};
pub use stages::{Segmentation, Stage, StageMask, segment_by_stages};
pub use subtraction::{SegmentError, segment};
