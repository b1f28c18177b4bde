//! What the views, and others who wait for it, must know of a drag.

use std::sync::Arc;

use backlit_tracking::body::Pose;
use backlit_ui::drawing::JointId;

/// A drag that goes on in a camera's view, as others see it.
#[derive(Debug, Clone, Default)]
pub(crate) struct DragMarks {
    /// The camera in whose view something is dragged.
    pub(crate) camera: Option<usize>,
    /// The joint that is dragged: its sight ray is in the other views.
    pub(crate) joint: Option<JointId>,
    /// The limb that is twisted: no outline shows how far.
    pub(crate) twisted: Option<usize>,
    /// The pose in which the drag, or the last nudges, began: limits that are met since then are shown.
    pub(crate) from: Option<Arc<Pose>>,
}

impl DragMarks {
    /// Whether something is dragged.
    pub(crate) fn is_dragging(&self) -> bool {
        self.camera.is_some()
    }

    /// The joint that is dragged, and in which camera's view.
    pub(crate) fn dragged_joint(&self) -> Option<(usize, JointId)> {
        self.camera.zip(self.joint)
    }
}
