//! Curves of runs: what is plotted over their steps, and how that is written to files.
//!
//! | file | holds |
//! |---|---|
//! | [`quantity`] | [`Quantity`]: cost, RMS, step norm, damping, decrease; the points of a run's curve |
//! | [`look`] | [`CurvesLook`]: what the plot shows |
//! | [`request`] | [`CurvesRequest`]: what the panel asks for |
//! | [`axis`] | ends of the plot's axes, which stay while a run goes on |
//! | [`table`] | all steps of all runs as CSV |
//! | [`picture`] | the plot as a [`Figure`](crate::plot::Figure) |

pub mod axis;
pub mod look;
pub mod picture;
pub mod quantity;
pub mod request;
pub mod table;

pub use look::CurvesLook;
pub use quantity::{CurvePoint, Quantity, points};
pub use request::CurvesRequest;
