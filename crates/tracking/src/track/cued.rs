//! What cues watch of a frame.

use std::sync::Arc;

use crate::cues::{FrameCues, WatchedCamera};
use crate::fit::{Evidence, FitView};

/// The cameras that see somebody, with their cues: one that sees nobody, or is left out, holds nothing and has no cues.
pub(super) fn watched(views: &[FitView], mut cues: FrameCues) -> (Vec<WatchedCamera>, FrameCues) {
    let camera = |view: &FitView| WatchedCamera {
        camera: Arc::clone(&view.camera),
        mask: match &view.evidence {
            Evidence::Mask(mask) => Some(Arc::clone(mask)),
            Evidence::Measurement(_) => None,
        },
    };
    cues.cameras.resize_with(views.len(), Default::default);
    let used = views.iter().zip(cues.cameras).filter(|(view, _)| view.has_data());
    let (cameras, cues) = used.map(|(view, cues)| (camera(view), cues)).unzip();
    (cameras, FrameCues { cameras: cues })
}
