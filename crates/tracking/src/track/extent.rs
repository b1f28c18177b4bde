//! How far from a camera somebody can be who covers that much of its picture.
//!
//! A body of limbs with lengths l and radii r covers at most A = Σ 2 r (l + 2 r) square metres, so that one who covers a pixels of a
//! camera of focal length f px stands no deeper than f √(A/a), give or take what masks and sizes are wrong ([`TOLERANCE`]).
//! What is farther from a camera than that depth along the ray of a corner of its picture, and the body's reach, is nowhere
//! in the scene. A pose that is goes to where the silhouettes are ([`place`]).

use glam::{DVec2, DVec3};

use crate::body::{Kinematics, Model};
use crate::fit::{Evidence, FitView};
use crate::silhouette::{Label, Overlap};

/// Masks may show the subject this many times smaller than it is.
const TOLERANCE: f64 = 3.0;

/// Whether the end of a limb is farther away than the silhouettes allow, or no number. The overlaps are the views'.
pub(super) fn is_beyond(
    model: &Model,
    kinematics: &Kinematics,
    views: &[FitView],
    overlaps: &[Option<Overlap>],
) -> bool {
    let area_m2 = area_m2(model);
    let reach_m: f64 = model.limbs().iter().map(|limb| limb.length).sum();
    let is_beyond = |(view, overlap): (&FitView, &Option<Overlap>)| {
        let Some(Overlap { agreement, missing, .. }) = overlap else { return false };
        let (camera, pixels) = (&*view.camera, agreement + missing);
        let focal_px = camera.intrinsics().mean_focal_px();
        let deepest_m = TOLERANCE * focal_px * (area_m2 / pixels as f64).sqrt();
        let diagonal_px = (camera.width() as f64).hypot(camera.height() as f64);
        let farthest_m = deepest_m * (diagonal_px / focal_px).hypot(1.0) + reach_m;
        !kinematics.ends().iter().all(|end| end.distance(camera.centre()) <= farthest_m)
    };
    views.iter().zip(overlaps).any(is_beyond)
}

/// The most that a body covers, square metres.
fn area_m2(model: &Model) -> f64 {
    model.limbs().iter().map(|limb| 2.0 * limb.radius * (limb.length + 2.0 * limb.radius)).sum()
}

/// Where somebody with these silhouettes stands, roughly: the mean over cameras of the point at the depth f √(A/a) on the ray of
/// the silhouette's centroid. `None` where no mask has a subject.
pub(super) fn place(model: &Model, views: &[FitView]) -> Option<DVec3> {
    let of_view = |view: &FitView| {
        let Evidence::Mask(mask) = &view.evidence else { return None };
        let subject = mask.labels().iter().enumerate().filter(|(_, label)| **label == Label::Subject);
        let pixel = |index: usize| DVec2::new((index % mask.width()) as f64, (index / mask.width()) as f64);
        let (sum, count) =
            subject.fold((DVec2::ZERO, 0.0), |(sum, count), (index, _)| (sum + pixel(index), count + 1.0));
        let camera = &*view.camera;
        let ray = camera.ray_in_world(sum / count)?;
        let depth_m = camera.intrinsics().mean_focal_px() * (area_m2(model) / count).sqrt();
        let ahead = camera.axis_in_world();
        Some(camera.centre() + ray * (depth_m / ray.dot(ahead)))
    };
    let points: Vec<DVec3> = views.iter().filter_map(of_view).filter(|point| point.is_finite()).collect();
    (!points.is_empty()).then(|| points.iter().sum::<DVec3>() / points.len() as f64)
}

#[cfg(test)]
mod tests {

    use super::*;
    use crate::body::{Pose, builtin};
    use crate::fixtures;
    use crate::render::RendererKind;
    use crate::track::estimate::overlaps;

    /// A body where its silhouettes are may be there, and three times as far; a hundred metres behind it or behind the camera it may
    /// not, and a root that is no number is nowhere.
    #[test]
    fn who_covers_much_of_a_picture_is_near() {
        let model = builtin::full_body();
        let truth = Pose::rest(&model);
        let camera = |from: DVec3| {
            fixtures::camera([120, 160], [160.0, 160.0, 59.5, 79.5], from, truth.root, DVec3::Z)
        };
        let views: Vec<FitView> = [DVec3::new(0.5, 3.5, 1.0), DVec3::new(3.5, 0.0, 1.5)]
            .map(|from| fixtures::fit_view(&model, &truth, camera(from)))
            .into();
        let is_beyond_at = |by: DVec3| {
            let pose = Pose { root: truth.root + by, ..truth.clone() };
            let overlaps = overlaps(&model, &pose, RendererKind::Capsule, &views);
            is_beyond(&model, &Kinematics::new(&model, &pose), &views, &overlaps)
        };
        for near in [DVec3::ZERO, DVec3::NEG_Y * 7.0, DVec3::NEG_X * 7.0] {
            assert!(!is_beyond_at(near), "{near}");
        }
        for far in [DVec3::NEG_Y * 100.0, DVec3::Y * 100.0, DVec3::Z * 1e9, DVec3::NAN] {
            assert!(is_beyond_at(far), "{far}");
        }
        let place = place(&model, &views).unwrap();
        assert!(place.distance(truth.root) < 3.0 && !is_beyond_at(place - truth.root), "{place}");
    }
}
