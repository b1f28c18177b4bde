//! The articulated body: limbs, the model file's content, poses and forward kinematics (4.11, 4.12).

#[doc(inline)]
pub use crate::{metrics, names};

mod anatomy;
pub mod anthropometry;
pub mod builtin;
mod kinematics;
mod limb;
mod model;
mod model_trees;
mod pose;
mod sides;
pub(crate) mod sizes;

pub use anatomy::{joint_at_end, joint_names, split_side};
pub(crate) use kinematics::Branches;
pub use kinematics::{Kinematics, MovingColumn};
pub use limb::{JointAngles, JointLimits, Limb, LimbSphere, Range, SphereLevel};
pub use model::{FORMAT, LimbSpec, MAX_ANGLE, MAX_LIMBS, MAX_SIZE, Model, ModelError, ModelSpec, ROOT};
pub use model_trees::PlacedSphere;
pub use pose::{FARTHEST_ROOT, Parameters, Pose, PoseError};
pub use sides::Sides;
pub use sizes::{SizeChoice, SizeKind, SizeParameter, Sizes};
