//! How a motion is written.

use std::ops::RangeInclusive;

use glam::{DQuat, DVec3, EulerRot};
use serde::{Deserialize, Serialize};

/// Which way a file's axes point. All are right-handed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Axes {
    /// y up. A world with z up becomes (x, z, −y).
    YUp,
    /// z up. A world with z up stays as it is.
    ZUp,
    /// The world of the take, whatever its axes are.
    World,
}

impl Axes {
    /// The turn of a world in which `up`, of unit length, is up.
    pub(super) fn file_from_world(self, up: DVec3) -> DQuat {
        // A world that stands on its head is turned about x.
        let turn = |to: DVec3| {
            if up.dot(to) < -1.0 + 1e-9 {
                DQuat::from_axis_angle(DVec3::X, std::f64::consts::PI)
            } else {
                DQuat::from_rotation_arc(up, to)
            }
        };
        match self {
            Self::YUp => turn(DVec3::Y),
            Self::ZUp => turn(DVec3::Z),
            Self::World => DQuat::IDENTITY,
        }
    }
}

/// The unit of a file's lengths.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Unit {
    /// m
    Metres,
    /// cm
    Centimetres,
    /// mm
    Millimetres,
}

impl Unit {
    /// How many there are in a metre.
    #[must_use]
    pub fn per_metre(self) -> f64 {
        [1.0, 100.0, 1000.0][self as usize]
    }

    /// Its sign.
    #[must_use]
    pub fn symbol(self) -> &'static str {
        ["m", "cm", "mm"][self as usize]
    }
}

/// What joints and bones are called. Names of other programs are those of the built-in full body; limbs that have none, and
/// other bodies, keep ours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Names {
    /// Joints by anatomy: elbow, wrist, knee; bones by the limbs' names.
    #[default]
    Anatomical,
    /// The limbs' names; a joint's is that of the limb that ends there.
    #[serde(alias = "ours")]
    Limbs,
    /// Bodies, coordinates and markers as `OpenSim` models and `OpenCap` call them.
    OpenSim,
    /// As Mixamo's characters, `mixamorig:Hips` …
    Mixamo,
}

/// The order of three angles: Z X Y means `R = Rz Rx Ry`, each about the axes that the ones before have turned.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[expect(missing_docs, reason = "each variant is its own description")]
pub enum EulerOrder {
    Xyz,
    Xzy,
    Yxz,
    Yzx,
    #[default]
    Zxy,
    Zyx,
}

impl EulerOrder {
    /// All of them.
    pub const ALL: [Self; 6] = [Self::Xyz, Self::Xzy, Self::Yxz, Self::Yzx, Self::Zxy, Self::Zyx];

    /// Its axes' letters.
    #[must_use]
    pub fn letters(self) -> [char; 3] {
        self.letters_and_axes().0
    }

    pub(super) fn intrinsic(self) -> EulerRot {
        self.letters_and_axes().1
    }

    fn letters_and_axes(self) -> ([char; 3], EulerRot) {
        match self {
            Self::Xyz => (['X', 'Y', 'Z'], EulerRot::XYZ),
            Self::Xzy => (['X', 'Z', 'Y'], EulerRot::XZY),
            Self::Yxz => (['Y', 'X', 'Z'], EulerRot::YXZ),
            Self::Yzx => (['Y', 'Z', 'X'], EulerRot::YZX),
            Self::Zxy => (['Z', 'X', 'Y'], EulerRot::ZXY),
            Self::Zyx => (['Z', 'Y', 'X'], EulerRot::ZYX),
        }
    }
}

/// How a motion is written.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionOptions {
    /// The file's axes; `None` for those that the format expects.
    pub axes: Option<Axes>,
    /// Which way is up in the world of the take, of any length but zero.
    pub up: DVec3,
    /// The file's unit of length; `None` for the one that the format expects.
    pub unit: Option<Unit>,
    /// First and last frame that are written; `None` for all.
    pub range: Option<RangeInclusive<usize>>,
    /// What joints are called; `None` for what the format expects.
    pub names: Option<Names>,
    /// The order of angles in BVH. MOT is Z X Y always, as the pelvis and the hips of `OpenSim` are.
    pub euler: EulerOrder,
}

impl Default for MotionOptions {
    /// z is up in the world; everything is as the format expects it.
    fn default() -> Self {
        Self { axes: None, up: DVec3::Z, unit: None, range: None, names: None, euler: EulerOrder::Zxy }
    }
}
