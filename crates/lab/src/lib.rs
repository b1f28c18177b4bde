//! The laboratory of Backlit: people and rooms with known truth, and the experiments that are made with them.
//!
//! [`synthetic`] draws a person and a room by other geometry than the tracker's own, so that a fit that fits is not
//! merely the renderer agreeing with itself. [`experiment`] runs the experiments of P. Kaimakis, "Markerless Motion
//! Capture", University of Cambridge, 2004, again, and others like them. The same options give the same numbers.

pub mod experiment;
pub mod synthetic;
