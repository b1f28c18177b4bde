//! Experiments on ways to begin, and the data of those that are the command line's own.
//!
//! | file | holds |
//! |---|---|
//! | [`sequence`] | a sequence, simulated or a take's, in the report's small pictures |
//! | [`acquire`] | first bodies, grown from nothing known, beside fitted ones |
//! | [`begin`] | ways to begin: downhill, particles, templates, the search, from given starts and without |
//! | [`no_start`] | sets of a take's cameras, and what a fit from the keypoints is worth |
//! | [`starts`] | starts of known distance from their truth |
//! | [`scene`] | simulated data of a pose as a fit takes them |
//! | [`progress`] | how far an experiment is, and why one cannot run |

pub mod acquire;
pub mod begin;
pub mod no_start;
pub mod progress;
pub mod scene;
pub mod sequence;
pub mod starts;

pub use progress::{ExperimentError, Progress};
pub use scene::Simulation;
