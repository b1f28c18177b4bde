//! Curves of runs: what is plotted over their steps, and how that is written to files.
//!
//! | file | holds |
//! |---|---|
//! | [`quantity`] | [`Quantity`]: cost, RMS, step norm, damping, decrease; the points of a run's curve |
//! | [`look`] | [`CurvesLook`]: what the plot shows |
//! | [`request`] | [`CurvesRequest`]: what the panel asks for |
//! | [`axis`] | ends of the plot's axes, which stay while a run goes on |
//! | [`table`] | all steps of all runs as CSV |
//! | [`picture`] | the plot as a [`Figure`](crate::drawing::plot::Figure) |

pub mod axis;
pub mod look;
pub(crate) mod panel;
pub mod picture;
pub mod quantity;
pub mod request;
pub(crate) mod runs;
pub(crate) mod steps;
pub mod table;
pub(crate) mod update;

pub use look::CurvesLook;
pub use quantity::{CurvePoint, Quantity, points};
pub use request::CurvesRequest;
