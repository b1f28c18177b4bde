//! What a frame has beside its silhouettes: plain data, camera by camera.

use std::sync::Arc;

use glam::DVec2;

use super::picture::GreyPicture;

/// Where another tool saw a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointKeypoint {
    /// The limb whose second joint it is.
    pub limb: usize,
    /// Pixels of the camera that the fit uses: rectified, reduced like its masks. Centres at integers.
    pub pixel: DVec2,
    /// How sure the tool is, 0 to 1; more counts as 1.
    pub score: f64,
}

/// What one camera has beside its silhouette.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CameraCues {
    /// Keypoints of the tracked person.
    pub keypoints: Vec<JointKeypoint>,
    /// The picture, rectified, of the camera's size; none where nobody needs it.
    pub picture: Option<Arc<GreyPicture>>,
}

/// What a frame has beside its silhouettes, in the order of its views. Fewer cameras than views have nothing.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FrameCues {
    /// By view.
    pub cameras: Vec<CameraCues>,
}
