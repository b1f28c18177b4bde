//! What a camera's tile shows, as pixels and as geometry in pixel coordinates. No interface here.
//!
//! Pixel centres lie at integer coordinates, x to the right and y down. Grey levels run from 0 (subject) to
//! 255 (background).
//!
//! | file | holds |
//! |---|---|
//! | `mode` | [`ViewMode`]: the ways to look at a camera; [`ModeComparison`] of two; [`StateAxis`] |
//! | `input` | [`PictureInput`]: what there is to look at; [`Sample`]: its values at one pixel |
//! | `compose`, `tinted` | the pictures of the view modes |
//! | `joints` | the joints that can be dragged; [`Drag`]: how a drag in a picture moves the body |
//! | `limbs` | limbs and spheres projected to capsules and discs of the picture |
//! | `outline` | the body's outline by marching squares |
//! | `limits` | a joint's limits: the arc of what an angle may be |
//! | `bodies` | ghosts, a body that sways, ellipses of joints |
//! | `side_marks` | left, right and face of a body |
//! | `calibration` | principal point, world axes, grid and lens edge; one camera's ray as another camera sees it |

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
mod tinted;

pub use backlit_words::joint::{JointId, joint_name};
pub use bodies::{
    DEVIATIONS, FACTORS, Ghost, GhostMarks, Ghosts, JointEllipse, SwayMarks, Swaying, Template,
    automatic_factor, joint_ellipses,
};
pub use calibration::{CalibrationMarks, SightRay, point_at, project_segment, sight_ray};
pub use compose::{Derivative, limb_chains, limb_colours};
pub use input::{PictureInput, Sample};
pub use joints::{Drag, DragEvent, JointMark, draggable_joints, project_joints};
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

use egui::ColorImage;

/// The picture of a view mode. What `input` lacks for it is said by [`PictureInput::shown`].
pub fn compose(mode: ViewMode, input: &PictureInput<'_>) -> ColorImage {
    let input = input.fitting();
    match input.shown(mode) {
        ViewMode::Footage => compose::footage(&input),
        ViewMode::Data => compose::data(&input),
        ViewMode::Prediction => compose::prediction(&input),
        ViewMode::ReportOverlay => compose::report_overlay(&input),
        ViewMode::Tinted => tinted::compose(&input),
        ViewMode::Residual => compose::residual(&input),
        ViewMode::OwnerLimb => compose::owner_limb(&input),
        ViewMode::Gradient => compose::compose_gradient(&input),
        ViewMode::JacobianColumn => compose::compose_jacobian(&input),
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
