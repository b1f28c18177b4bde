//! Which primitive wins each pixel of a row.
//!
//! [`scalar`] is plain f64 and stays for ever: every faster path is tested against it.

pub mod scalar;
