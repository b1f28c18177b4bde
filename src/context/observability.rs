//! What camera views and the scene draw of what the cameras see: a body that sways, ellipses of its joints, an angle and
//! its limits.

use std::sync::Arc;

use backlit_tracking::body::{Model, Pose};
use backlit_tracking::camera::Camera;
use backlit_tracking::observability::JointUncertainty;
use backlit_tracking::posing::LimitedAngle;
use backlit_ui::drawing::{JointEllipse, Swaying, joint_ellipses};

/// What is drawn in a frame.
#[derive(Debug, Clone, Default)]
pub(crate) struct ObservabilityMarks {
    /// Whether what is known is of an older pose, frame or set of cameras than the one on the screen.
    pub(crate) is_stale: bool,
    /// Whether the body is on its way.
    pub(crate) is_playing: bool,
    /// The body on its way, if it sways or is held there.
    pub(crate) swaying: Option<Swaying>,
    pub(crate) swayed_pose: Option<Pose>,
    /// What is known of the joints, if that is to be seen.
    pub(crate) uncertainty: Option<Uncertainty>,
    /// Ellipses are drawn so many times as large as they are.
    pub(crate) factor: u32,
    /// The angle of the selected limb whose limits are to be seen.
    pub(crate) angle: Option<LimitedAngle>,
}

/// What cameras know of joints.
#[derive(Debug, Clone)]
pub(crate) struct Uncertainty {
    /// The body.
    pub(crate) model: Arc<Model>,
    pub(crate) joints: Vec<JointUncertainty>,
    /// Whether the cameras are others than those in use.
    pub(crate) is_of_others: bool,
    /// Whether it is what a Kalman filter believes.
    pub(crate) is_believed: bool,
}

impl Uncertainty {
    /// Ellipses of the joints in a camera's view.
    pub(crate) fn ellipses(&self, camera: &Camera) -> Vec<JointEllipse> {
        joint_ellipses(&self.model, &self.joints, camera)
    }
}
