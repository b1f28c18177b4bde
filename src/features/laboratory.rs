//! The laboratory: several ways to fit, from one start, side by side. What it compares and what came of it, without
//! a window; nothing here is saved or undone.
//!
//! | file | holds |
//! |---|---|
//! | [`lineup`] | which ways are compared: renderers, ramps, presets, updates |
//! | [`start`] | where they all begin |
//! | [`push`] | a direction of the body, and how hard every pixel pushes along it |
//! | [`check`] | the analytic Jacobian against differences, column by column |
//! | [`comparison`] | the curves of one comparison, and the step that is looked at |
//! | [`state`] | [`Laboratory`]: the choices, and the comparison that they make |
//! | [`story`] | the caption: told from the numbers |
//! | [`table`] | the curves as text and as a figure |

pub mod check;
pub mod comparison;
pub(crate) mod job;
pub mod lineup;
pub(crate) mod panel;
pub mod push;
pub mod start;
pub mod state;
pub mod story;
pub mod table;
pub(crate) mod update;

pub use check::{CheckProgress, ColumnCheck, Worst};
pub use comparison::{Basis, Comparison, Contestant};
pub use lineup::{Entrant, Lineup};
pub use push::{Push, PushAxis, Pushed};
pub use start::StartChoice;
pub use state::{Laboratory, LaboratoryRequest};
