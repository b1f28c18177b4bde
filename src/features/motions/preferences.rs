//! What is chosen of the motions' names: kept from start to start.

use backlit_recognition::Method;
use serde::{Deserialize, Serialize};

/// What the plane is of.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Plane {
    /// Axes that tell motions apart.
    #[default]
    Apart,
    /// Principal components of single frames.
    Principal,
}

/// All that is chosen.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct MotionsPreferences {
    /// How motions are named.
    pub(crate) method: Method,
    /// What the plane is of.
    pub(crate) plane: Plane,
}

impl Default for MotionsPreferences {
    fn default() -> Self {
        Self { method: Method::Combined, plane: Plane::default() }
    }
}
