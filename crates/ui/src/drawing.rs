//! What a camera's tile shows, as pixels and as geometry in pixel coordinates. No interface here.
//!
//! Pixel centres lie at integer coordinates, x to the right and y down. Grey levels run from 0 (subject) to
//! 255 (background).
//!
//! | file | holds |
//! |---|---|
//! | `mode` | [`ViewMode`]: the ways to look at a camera, with their names and legends |
//! | `comparison` | [`Comparison`]: how two modes are seen in one picture |
//! | `input` | [`PictureInput`]: what there is to look at; [`Sample`]: its values at one pixel |
//! | `footage` … `owner_limb` | one view mode each |
//! | `derivative` | gradient and Jacobian column: what they are and how they look |
//! | `drag` | [`Drag`]: how a drag in a picture moves the body |
//! | `ellipse_factor` | how much larger than life ellipses of uncertainty are drawn |
//! | `ghosts` | bodies that are looked at in the place of the posed one |
//! | `hatch` | the hatches of don't-know and of no gradient |
//! | `outline` | the body's outline by marching squares |
//! | `limits` | a joint's limits: the arc of what an angle may be |
//! | `limbs` | limbs projected to capsules of the picture |
//! | `joints` | the joints that can be dragged, and their names |
//! | `sway` | a body that sways, and ellipses of joints |
//! | [`side_marks`] | left, right and face of a body |
//! | [`mod@sight_ray`] | one camera's ray as another camera sees it |
//! | `calibration_marks` | principal point, world axes, grid and lens edge |
//! | [`spheres`] | spheres that stand for a body, in space and in a picture |
//! | `state_axis` | the coefficient whose Jacobian column is looked at |

pub mod calibration_marks;
mod comparison;
mod data;
pub mod derivative;
mod drag;
pub mod ellipse_factor;
mod footage;
mod ghosts;
mod hatch;
pub mod input;
pub mod joints;
pub mod limbs;
pub mod limits;
pub mod mode;
pub mod outline;
mod owner_limb;
mod polyline;
mod prediction;
mod report_overlay;
mod residual;
pub mod side_marks;
pub mod sight_ray;
pub mod spheres;
pub mod state_axis;
pub mod sway;
mod tinted;

pub use backlit_words::joint::{JointId, joint_name};
pub use calibration_marks::CalibrationMarks;
pub use comparison::Comparison;
pub use derivative::Derivative;
pub use drag::{Drag, DragEvent};
pub use ghosts::{Ghost, GhostMarks, Ghosts, Template};
pub use input::{PictureInput, Sample};
pub use joints::{JointMark, draggable_joints, project_joints};
pub use limbs::{ProjectedLimb, joined_outline, project_limbs};
pub use limits::{BoundedAngle, LimitMark};
pub use mode::{Legend, LegendEntry, NO_CHANGE_LEGEND, NO_PULL_LEGEND, Swatch, UNKNOWN_LEGEND, ViewMode};
pub use outline::body_outline;
pub use owner_limb::{limb_chains, limb_colours};
pub use side_marks::SideMarks;
pub use sight_ray::{SightRay, point_at, sight_ray};
pub use spheres::{ProjectedSphere, body_spheres, project_spheres};
pub use state_axis::StateAxis;
pub use sway::{JointEllipse, SwayMarks, Swaying, joint_ellipses};

use egui::ColorImage;

/// The picture of a view mode. What `input` lacks for it is said by [`PictureInput::shown`].
pub fn compose(mode: ViewMode, input: &PictureInput<'_>) -> ColorImage {
    let input = input.fitting();
    match input.shown(mode) {
        ViewMode::Footage => footage::compose(&input),
        ViewMode::Data => data::compose(&input),
        ViewMode::Prediction => prediction::compose(&input),
        ViewMode::ReportOverlay => report_overlay::compose(&input),
        ViewMode::Tinted => tinted::compose(&input),
        ViewMode::Residual => residual::compose(&input),
        ViewMode::OwnerLimb => owner_limb::compose(&input),
        ViewMode::Gradient => derivative::compose_gradient(&input),
        ViewMode::JacobianColumn => derivative::compose_jacobian(&input),
    }
}

/// Whether a mode shows footage as it is or tinted, so that it can lie over a larger picture of the same.
pub fn shows_footage(mode: ViewMode, input: &PictureInput<'_>) -> bool {
    input.frame.is_some() && matches!(input.fitting().shown(mode), ViewMode::Footage | ViewMode::Tinted)
}

/// What such a mode lays over the footage, as premultiplied colours.
pub fn compose_over_footage(mode: ViewMode, input: &PictureInput<'_>) -> ColorImage {
    let input = input.fitting();
    match input.shown(mode) {
        ViewMode::Tinted => tinted::compose_over_footage(&input),
        _ => ColorImage::filled(input.size, egui::Color32::TRANSPARENT),
    }
}
