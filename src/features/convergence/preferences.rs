//! What the convergence plot shows.

use serde::{Deserialize, Serialize};

use super::Quantity;

/// The choices above the plot. They are kept from start to start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct ConvergencePreferences {
    /// What is plotted.
    pub(crate) quantity: Quantity,
    /// Whether its axis is logarithmic.
    pub(crate) is_log: bool,
    /// Whether rejected steps have marks.
    pub(crate) rejected: bool,
    /// Whether the plot's file has light colours whatever the window has.
    pub(crate) exports_light: bool,
}

impl Default for ConvergencePreferences {
    fn default() -> Self {
        Self { quantity: Quantity::Percent, is_log: true, rejected: true, exports_light: true }
    }
}
