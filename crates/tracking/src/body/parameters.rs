//! What the columns of the state are: raw quaternion coefficients or a tangent update.

use serde::{Deserialize, Serialize};

/// The state's columns: three of the root, then one block per rotation in the order of the model file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Parameters {
    /// Four coefficients w x y z a rotation, as in the report (4.15): not held to unit length in a step.
    Raw,
    /// Three numbers ω a rotation, q ← exp(ω) q in the parent's frame.
    #[default]
    Tangent,
}

impl Parameters {
    /// Columns of one rotation's block.
    #[must_use]
    pub fn per_rotation(self) -> usize {
        match self {
            Self::Raw => 4,
            Self::Tangent => 3,
        }
    }

    /// Columns of the whole state.
    #[must_use]
    pub fn columns(self, rotations: usize) -> usize {
        3 + self.per_rotation() * rotations
    }

    /// First column of a rotation's block.
    #[must_use]
    pub fn first_column(self, rotation: usize) -> usize {
        3 + self.per_rotation() * rotation
    }
}
