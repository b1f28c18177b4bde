//! What is chosen for the basin and how it is shown: kept from start to start.

use serde::{Deserialize, Serialize};

use super::BasinSettings;
use crate::context::command::BasinView;

/// What the cells of the map are coloured by.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum MapColour {
    /// How far from the target the fit ended.
    #[default]
    Error,
    /// Whether it found it.
    Success,
}

/// All that is chosen.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct BasinPreferences {
    /// What is tried.
    pub settings: BasinSettings,
    /// What is shown.
    pub view: BasinView,
    /// What cells are coloured by.
    pub(crate) colour: MapColour,
}
