//! What a camera's tile shows, as pixels and as geometry in pixel coordinates. No interface here.
//!
//! Pixel centres lie at integer coordinates, x to the right and y down. Grey levels run from 0 (subject) to
//! 255 (background).

mod bodies;
mod calibration;
mod compose;
mod input;
mod joints;
mod limbs;
pub mod limits;
mod mode;
mod outline;
mod side_marks;
mod stages;
mod tinted;

pub use backlit_words::joint::{JointId, joint_name};
pub use bodies::{
    DEVIATIONS, FACTORS, Ghost, GhostMarks, Ghosts, JointEllipse, RivalMarks, SwayMarks, Swaying, Template,
    automatic_factor, farthest_limb, joint_ellipses, limbs_elsewhere, rival_opacity,
};
pub use calibration::{CalibrationMarks, SightRay, point_at, project_segment, sight_ray};
pub use compose::{Derivative, ViewedPicture, compose, limb_chains, limb_colours, shows_footage};
pub use input::{PictureInput, Sample};
pub use joints::{Drag, DragEvent, JointMark, draggable_joints, joint_position, project_joints};
pub use limbs::{
    ProjectedLimb, ProjectedSphere, body_spheres, joined_outline, project_limbs, project_spheres,
};
pub use limits::{BoundedAngle, LimitMark};
pub use mode::{
    Legend, LegendEntry, ModeComparison, NO_CHANGE_LEGEND, NO_PULL_LEGEND, StateAxis, Swatch, UNKNOWN_LEGEND,
    ViewMode,
};
pub use outline::body_outline;
pub use side_marks::SideMarks;
pub use stages::{decision, excess_picture, mask_picture, stage_words, subject_change};
