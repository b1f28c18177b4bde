//! Pictures no larger than the search needs: thin limbs a few pixels thick.

use std::sync::Arc;

use crate::body::{Model, Pose};
use crate::camera::{Camera, Intrinsics};
use crate::fit::{ApparentSize, Evidence, FitView};
use crate::silhouette::{Label, Mask};

/// Radius of the thinnest limb that the search is meant for, pixels: that of the robust preset.
const MEANT_FOR_PX: f64 = 4.6;

/// The views with every block of pixels made one, where the thinnest limb is twice as thick as it need be and more. Grey
/// levels stay as they are.
pub(crate) fn reduced(model: &Model, views: &[FitView], pose: &Pose) -> Vec<FitView> {
    let factor = (ApparentSize::of(model, views, pose).thinnest_px / MEANT_FOR_PX).floor();
    if !(factor.is_finite() && factor >= 2.0) {
        return views.to_vec();
    }
    views.iter().map(|view| smaller(view, factor as usize).unwrap_or_else(|| view.clone())).collect()
}

fn smaller(view: &FitView, factor: usize) -> Option<FitView> {
    let Evidence::Mask(mask) = &view.evidence else { return None };
    let (width, height) = (mask.width() / factor, mask.height() / factor);
    let block = |x: usize, y: usize| {
        let rows = (0..factor).map(|row| (y * factor + row) * mask.width() + x * factor);
        let (mut subject, mut unknown) = (0, 0);
        for label in rows.flat_map(|from| &mask.labels()[from..from + factor]) {
            subject += usize::from(*label == Label::Subject);
            unknown += usize::from(*label == Label::Unknown);
        }
        let known = factor * factor - unknown;
        match (2 * unknown > factor * factor, 2 * subject >= known) {
            (true, _) => Label::Unknown,
            (false, true) => Label::Subject,
            (false, false) => Label::Background,
        }
    };
    let labels =
        (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| block(x, y)).collect();
    let mask = Mask::new(width, height, labels).ok()?;
    let (camera, by) = (&view.camera, factor as f64);
    let pinhole = camera.intrinsics();
    // Centres of pixels are at integers: the first block's is at half of what it holds beside its first pixel.
    let centre = |at: f64| (at - 0.5 * (by - 1.0)) / by;
    let pinhole = Intrinsics {
        fx: pinhole.fx / by,
        fy: pinhole.fy / by,
        cx: centre(pinhole.cx),
        cy: centre(pinhole.cy),
    };
    let size = [width as u64, height as u64];
    let place = *camera.camera_from_world();
    let camera = Camera::new(camera.name(), size, pinhole, *camera.distortion(), place).ok()?;
    let view = FitView { camera: Arc::new(camera), evidence: Evidence::Mask(Arc::new(mask)), ..*view };
    view.has_data().then_some(view)
}
