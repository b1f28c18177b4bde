//! The articulated body: limbs, the model file's content, poses and forward kinematics (4.11, 4.12).
//!
//! | | |
//! |---|---|
//! | [`Model`] | limbs checked once and kept in an arena, from a file's [`ModelSpec`] |
//! | [`Limb`] | one limb: parent, rest direction, length, radius, [`JointLimits`], [`LimbSphere`]s |
//! | [`Pose`] | root position and one quaternion per rotation; `retract`, `local` |
//! | [`Parameters`] | raw coefficients or tangent update: the state's columns |
//! | [`Kinematics`] | joint positions of a pose and the 7 × n map from state to a limb's motion |
//! | [`Sides`] | which way a body faces, by its right and left limbs |
//! | [`Sizes`] | which lengths and radii may change, and together with which others |
//! | [`anthropometry`] | how real people's sizes spread about the built-in full body's |
//! | [`builtin`] | the models that come with the program |

#[doc(inline)]
pub use crate::{metrics, names};

pub mod anthropometry;
pub mod builtin;
mod kinematics;
mod limb;
mod model;
mod model_trees;
mod pose;
mod sides;
pub(crate) mod sizes;

pub(crate) use kinematics::Branches;
pub use kinematics::{Kinematics, MovingColumn};
pub use limb::{JointAngles, JointLimits, Limb, LimbSphere, Range, SphereLevel};
pub use model::{FORMAT, LimbSpec, MAX_ANGLE, MAX_LIMBS, MAX_SIZE, Model, ModelError, ModelSpec, ROOT};
pub use model_trees::PlacedSphere;
pub use pose::{FARTHEST_ROOT, Parameters, Pose, PoseError};
pub use sides::Sides;
pub use sizes::{SizeChoice, SizeKind, SizeParameter, Sizes};
