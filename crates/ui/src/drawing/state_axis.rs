//! The coefficient of the pose whose Jacobian column is looked at.

use backlit_tracking::body::Parameters;
use serde::{Deserialize, Serialize};

/// A coefficient of the tangent state: a turn of the selected limb, or a move of the root.
///
/// A turn ω is made as q ← exp(ω) q, so its axes are those of the frame in which the limb's rotation stands: its
/// parent's. The root moves along the axes of the world.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StateAxis {
    /// A turn about the x axis.
    #[default]
    TurnX,
    /// A turn about the y axis.
    TurnY,
    /// A turn about the z axis.
    TurnZ,
    /// A move of the root along the x axis.
    RootX,
    /// A move of the root along the y axis.
    RootY,
    /// A move of the root along the z axis.
    RootZ,
}

impl StateAxis {
    /// All axes, in the order of the menu.
    pub const ALL: [Self; 6] = [Self::TurnX, Self::TurnY, Self::TurnZ, Self::RootX, Self::RootY, Self::RootZ];

    /// The name in menus.
    pub const fn label(self) -> &'static str {
        match self {
            Self::TurnX => "Turn about x",
            Self::TurnY => "Turn about y",
            Self::TurnZ => "Turn about z",
            Self::RootX => "Root along x",
            Self::RootY => "Root along y",
            Self::RootZ => "Root along z",
        }
    }

    /// The name where there is little room.
    pub const fn short_label(self) -> &'static str {
        match self {
            Self::TurnX => "turn x",
            Self::TurnY => "turn y",
            Self::TurnZ => "turn z",
            Self::RootX => "root x",
            Self::RootY => "root y",
            Self::RootZ => "root z",
        }
    }

    /// What the column is divided by: radian or metre.
    pub const fn unit(self) -> &'static str {
        if self.is_of_root() { "m" } else { "rad" }
    }

    /// Whether it moves the root, whatever is selected.
    pub const fn is_of_root(self) -> bool {
        matches!(self, Self::RootX | Self::RootY | Self::RootZ)
    }

    /// The column of the tangent state, for the limb with this rotation.
    pub fn column(self, rotation: usize) -> usize {
        let turn = Parameters::Tangent.first_column(rotation);
        match self {
            Self::TurnX => turn,
            Self::TurnY => turn + 1,
            Self::TurnZ => turn + 2,
            Self::RootX => 0,
            Self::RootY => 1,
            Self::RootZ => 2,
        }
    }

    /// The next of the three axes of the same kind.
    pub const fn next(self) -> Self {
        match self {
            Self::TurnX => Self::TurnY,
            Self::TurnY => Self::TurnZ,
            Self::TurnZ => Self::TurnX,
            Self::RootX => Self::RootY,
            Self::RootY => Self::RootZ,
            Self::RootZ => Self::RootX,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_those_of_the_tangent_state() {
        let columns: Vec<usize> = StateAxis::ALL.iter().map(|axis| axis.column(2)).collect();
        assert_eq!(columns, [9, 10, 11, 0, 1, 2]);
        for axis in StateAxis::ALL {
            assert_eq!(axis.next().next().next(), axis);
            assert_eq!(axis.next().unit(), axis.unit());
        }
    }
}
