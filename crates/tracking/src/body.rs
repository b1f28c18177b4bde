//! The articulated body: limbs, the model file's content, poses and forward kinematics (4.11, 4.12).
//!
//! | file | holds |
//! |---|---|
//! | [`limb`] | one limb: parent, rest direction, length, radius, limits, spheres |
//! | [`model`] | [`Model`]: limbs checked once and kept in an arena; the files' [`ModelSpec`] |
//! | [`pose`] | [`Pose`]: root position and one quaternion per rotation; `retract`, `local` |
//! | [`parameters`] | raw coefficients or tangent update: the state's columns |
//! | [`kinematics`] | joint positions of a pose and the 7 × n map from state to a limb's motion |
//! | [`sizes`] | which lengths and radii may change, and together with which others |
//! | [`builtin`] | the models that come with the program |

pub mod builtin;
pub mod kinematics;
pub mod limb;
pub mod model;
pub mod parameters;
pub mod pose;
pub mod sizes;

pub use kinematics::Kinematics;
pub use limb::{JointAngles, JointLimits, Limb, LimbSphere, Range};
pub use model::{Model, ModelError, ModelSpec};
pub use parameters::Parameters;
pub use pose::{Pose, PoseError};
pub use sizes::{SizeKind, SizeParameter, Sizes};
