//! Motions by name: joints of a track for the recognizer, and what it was learnt from.

pub mod joints;
pub mod model;
