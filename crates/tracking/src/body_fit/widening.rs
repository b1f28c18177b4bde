//! Silhouettes that are too wide, or too narrow, by as many pixels all round: neural nets, morphology and blur leave them so.
//!
//! Such a widening would become girth. The two differ in what they do to thick and thin limbs and to near and far ones:
//! w pixels make a limb of radius r at depth z look like one of r + w z / f, so that in proportion arms gain more than the
//! trunk, while a stout person's limbs gain about alike. w is one unknown for all cameras and frames, held near 0 by its prior
//! ([`BodyFitOptions::widening`](super::BodyFitOptions::widening)).
//! The body's gaps that a wide silhouette closes are closed in the prediction too, which narrowing the mask cannot undo.

use std::borrow::Cow;
use std::sync::Arc;

use crate::body::{Kinematics, Model};
use crate::camera::Camera;
use crate::fit::{Evidence, FitView};
use crate::residual::body_size::RadiusGrowth;
use crate::silhouette::{Label, Mask, SignedDistance};

/// A limb in a picture has at least this share of its own radius, however much too narrow silhouettes are said to be.
const LEAST_SHARE: f64 = 0.2;

/// By how much silhouettes were found to be too wide all round.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Widening {
    /// Pixels; below 0 they are too narrow.
    pub px: f64,
    /// Standard deviation of that, pixels.
    pub deviation_px: f64,
    /// What a pixel is where the body is, metres, mean of all cameras and frames.
    pub metres_per_px: f64,
    /// Whether the sizes are those of silhouettes narrowed by it. One that is not surely there is left alone: then sizes are
    /// those of silhouettes as they are.
    pub is_believed: bool,
}

/// What a camera contributes once its mask is narrower by this many pixels all round (wider, below 0). Unknown pixels stay
/// unknown, and a mask in which nothing would be left stays as it is. Grey levels do too.
pub fn narrowed(view: &FitView, by_px: f64) -> FitView {
    let narrow = |mask: &Mask| {
        let distances = SignedDistance::from_mask(mask);
        let mut narrow = mask.clone();
        for (label, &distance) in narrow.labels_mut().iter_mut().zip(distances.values()) {
            if *label != Label::Unknown {
                let is_inside = f64::from(distance) + by_px < 0.0;
                *label = if is_inside { Label::Subject } else { Label::Background };
            }
        }
        narrow.labels().contains(&Label::Subject).then(|| Evidence::Mask(Arc::new(narrow)))
    };
    let evidence = match &view.evidence {
        Evidence::Mask(mask) if by_px != 0.0 => narrow(mask),
        _ => None,
    };
    FitView { evidence: evidence.unwrap_or_else(|| view.evidence.clone()), ..view.clone() }
}

/// Metres that a pixel covers at every limb's middle.
pub(super) fn metres_per_px(kinematics: &Kinematics, camera: &Camera) -> Vec<f64> {
    let focal_px = 0.5 * (camera.intrinsics().fx + camera.intrinsics().fy);
    let middles = kinematics.starts().iter().zip(kinematics.ends()).map(|(&start, &end)| 0.5 * (start + end));
    middles.map(|middle| camera.camera_from_world().transform(middle).z.max(0.0) / focal_px).collect()
}

/// The body as silhouettes that are too wide show it: every radius is r + w c.
pub(super) fn widened<'a>(model: &'a Model, metres_per_px: &[f64], px: f64) -> Cow<'a, Model> {
    if px == 0.0 {
        return Cow::Borrowed(model);
    }
    let size = |limb: usize| {
        let part = &model.limbs()[limb];
        [part.length, radius(part.radius, metres_per_px[limb], px)]
    };
    model.with_sizes(size).map_or(Cow::Borrowed(model), Cow::Owned)
}

/// How the radii of [`widened`] grow.
pub(super) fn growth(model: &Model, metres_per_px: &[f64], px: f64) -> Vec<RadiusGrowth> {
    let of = |(limb, &metres): (&crate::body::Limb, &f64)| {
        let wide = radius(limb.radius, metres, px);
        if wide <= LEAST_SHARE * limb.radius {
            return RadiusGrowth::PLAIN;
        }
        RadiusGrowth { by_radius: limb.radius / wide, by_px: metres / wide }
    };
    model.limbs().iter().zip(metres_per_px).map(of).collect()
}

fn radius(radius: f64, metres_per_px: f64, px: f64) -> f64 {
    (radius + px * metres_per_px).max(LEAST_SHARE * radius)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::{Pose, builtin};
    use crate::fixtures;
    use glam::DVec3;

    fn camera() -> Arc<Camera> {
        let (intrinsics, from) = ([90.0, 90.0, 39.5, 59.5], DVec3::new(0.2, 3.0, 0.4));
        Arc::new(fixtures::camera([80, 120], intrinsics, from, DVec3::Z * 0.2, DVec3::Z))
    }

    #[test]
    fn a_pixel_more_is_a_pixel_of_radius_wherever_the_limb_is() {
        let (model, camera) = (builtin::full_body(), camera());
        let kinematics = Kinematics::new(&model, &Pose::rest(&model));
        let metres = metres_per_px(&kinematics, &camera);
        let wide = widened(&model, &metres, 2.0);
        for (limb, (own, wide)) in model.limbs().iter().zip(wide.limbs()).enumerate() {
            let middle = 0.5 * (kinematics.starts()[limb] + kinematics.ends()[limb]);
            let depth = camera.camera_from_world().transform(middle).z;
            assert!(((wide.radius - own.radius) * 90.0 / depth - 2.0).abs() < 1e-9, "{}", own.name);
            assert_eq!(wide.length, own.length);
        }
        // Growth is that of the logarithm, by differences.
        let growth = growth(&model, &metres, 2.0);
        let further = widened(&model, &metres, 2.0 + 1e-6);
        for (limb, growth) in growth.iter().enumerate() {
            let numeric = (further.limbs()[limb].radius / wide.limbs()[limb].radius).ln() / 1e-6;
            assert!((numeric - growth.by_px).abs() < 1e-6, "{} {}", numeric, growth.by_px);
        }
        assert_eq!(widened(&model, &metres, -50.0).limbs()[3].radius, LEAST_SHARE * model.limbs()[3].radius);
    }

    #[test]
    fn narrowing_undoes_a_widening_of_something_convex() {
        let is_in = |x: usize, y: usize| (x.abs_diff(40).pow(2) + y.abs_diff(60).pow(2)) < 23 * 23;
        let mut mask = fixtures::covered([80, 120], is_in);
        mask.labels_mut()[0] = Label::Unknown;
        let mask = Arc::new(mask);
        let view = FitView { camera: camera(), evidence: Evidence::Mask(mask.clone()), weight: 0.5 };
        let count = |view: &FitView| match &view.evidence {
            Evidence::Mask(mask) => (mask.count(Label::Subject) as f64, mask.count(Label::Unknown)),
            Evidence::Measurement(_) => (f64::NAN, 0),
        };
        let radius = |view: &FitView| (count(view).0 / std::f64::consts::PI).sqrt();
        for by in [3.0, -3.0] {
            let narrow = narrowed(&view, by);
            assert!((radius(&view) - radius(&narrow) - by).abs() < 0.3, "{by}: {}", radius(&narrow));
            assert_eq!((count(&narrow).1, narrow.weight), (1, 0.5));
        }
        assert_eq!(count(&narrowed(&view, 60.0)), count(&view));
        assert_eq!(count(&narrowed(&view, 0.0)), count(&view));
    }
}
