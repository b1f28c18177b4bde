//! What a frame's cameras saw, kept until its fit is judged.

use std::sync::Arc;

use crate::body::{Kinematics, Model, Pose};
use crate::camera::Camera;
use crate::fit::{Evidence, FitView};
use crate::render::{Ramp, RendererKind, View, prediction};
use crate::silhouette::{Label, Mask, Overlap};

/// The cameras of a frame, and the masks of those that see somebody.
pub(super) struct FrameMasks {
    pub(super) cameras: Vec<Arc<Camera>>,
    masks: Vec<Option<Arc<Mask>>>,
}

impl FrameMasks {
    pub(super) fn of(views: &[FitView]) -> Self {
        let mask = |view: &FitView| match &view.evidence {
            Evidence::Mask(mask) if mask.labels().contains(&Label::Subject) => Some(Arc::clone(mask)),
            _ => None,
        };
        Self {
            cameras: views.iter().map(|view| Arc::clone(&view.camera)).collect(),
            masks: views.iter().map(mask).collect(),
        }
    }

    /// Overlap of a pose with every mask.
    pub(super) fn overlap(&self, model: &Model, pose: &Pose, renderer: RendererKind) -> Vec<Option<Overlap>> {
        let kinematics = Kinematics::new(model, pose);
        let of_camera = |(mask, camera): (&Option<Arc<Mask>>, &Arc<Camera>)| {
            let view = View::new(model, &kinematics, camera, renderer, Ramp::Half);
            Overlap::of_covered(mask.as_ref()?, &prediction::covered(&view)).ok()
        };
        self.masks.iter().zip(&self.cameras).map(of_camera).collect()
    }
}
