//! Which primitive wins each pixel of a row.
//!
//! [`scalar`] is plain f64 and stays for ever: every faster path is tested against it. [`lanes`] does all
//! solids that lie in front of a pinhole camera, winners and sums at once, in f32 lanes of whatever width the
//! processor has.

pub(super) mod lanes;
pub(super) mod scalar;
