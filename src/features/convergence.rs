//! Runs of the fit: their curves over their steps, one by one, and as files.
//!
//! | file | holds |
//! |---|---|
//! | [`quantity`] | [`Quantity`]: cost, RMS, step norm, damping, decrease; the points of a run's curve |
//! | [`preferences`] | [`ConvergencePreferences`]: what the plot shows, kept from start to start |
//! | [`axis`] | ends of the plot's axes, which stay while a run goes on |
//! | `update` | runs removed and brought back, files written |
//! | `panel`, `runs`, `steps` | the pane: the plot, the list of runs, the steps of one |
//! | [`table`] | all steps of all runs as CSV |
//! | `plot`, `picture` | the plot, on the screen and as a file |

pub(crate) mod axis;
mod panel;
mod picture;
mod plot;
pub(crate) mod preferences;
pub(crate) mod quantity;
mod runs;
mod steps;
pub(crate) mod table;
mod update;

pub(crate) use preferences::ConvergencePreferences;
pub(crate) use quantity::{CurvePoint, Quantity, points};

use crate::context::file_dialog::FileDialogs;

/// What curves are written as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CurvesFile {
    /// Every step of all runs.
    Table,
    /// The plot as it is shown.
    Plot,
}

/// The feature.
#[derive(Debug, Default)]
pub struct Convergence {
    /// What is chosen, kept from start to start.
    pub(crate) preferences: ConvergencePreferences,
    /// The name that is being typed: of which run, and the text so far.
    typing: Option<(usize, String)>,
    dialogs: FileDialogs<CurvesFile>,
}
