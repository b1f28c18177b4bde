//! When cameras that were started by hand saw the same moment: their clocks' offsets, from the motion of the silhouettes.
//!
//! The centres of two cameras span a line, and the half-planes φ that it bounds are the same in both pictures. A half-plane
//! that touches the body touches both silhouettes, so the two extreme ones agree at the same moment and only then
//! (S. Sinha, M. Pollefeys, "Synchronization and calibration of camera networks from silhouettes", ICPR 2004):
//!
//! ```text
//! φ_A(t) = φ_B(t + τ),  low and high
//! ```
//!
//! For every pair of cameras and every offset τ the evidence is how much better B predicts A's two angles than no
//! knowledge does, in nats, moving samples only,
//!
//! ```text
//! E(τ) = 1/c Σ w (ln(s/σ) − 5/2 ln(1 + r²/4σ²)),  r = φ_A(t) − φ_B(t + τ) − bias(τ)
//! ```
//!
//! with angles in pixels at their points of touch, s the spread of the signal, σ the pair's own noise, w how fast either
//! moves, c the length over which residuals hang together, and a bias for silhouettes that are too wide and calibrations
//! that are a little off. Where a line through both centres passes through the person there is no touch: then the height of
//! the silhouette's top and its area take the place of φ, brought to one scale. Offsets of all cameras are those of the
//! largest sum over the pairs; their fractions of a frame are the weighted least squares over the pairs' own peaks.

mod answer;
pub(crate) mod cells;
mod evidence;
mod network;
pub(crate) mod outline;
pub(crate) mod signals;

pub use answer::{
    CameraOffset, Offset, PairCue, PairOffset, Synchronisation, SynchroniseError, SynchroniseOptions,
    Undecided,
};
pub use network::synchronise;
pub use outline::Recording;
