//! Two view modes in one picture.

use serde::{Deserialize, Serialize};

/// How a second view mode is seen in the same picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Comparison {
    /// Side by side: the tile's own mode is left of a handle, the other one right of it.
    Wipe,
    /// One after the other.
    Blink,
}
