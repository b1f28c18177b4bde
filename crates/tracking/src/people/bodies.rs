//! Whose pixel is whose, where the bodies of those in view are known: from a track of each.
//!
//! A pixel's distance from a body is that from the nearest limb as a picture shows it, less the limb's radius, metres at the limb's
//! depth; it is negative inside.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::DVec2;

use crate::body::{Kinematics, Model, Pose};
use crate::camera::Camera;
use crate::silhouette::{Label, Mask};

/// Pixels within that of another's body are, or may be, the other's, metres: clothes, and what the pose is off.
const WITHIN_M: f64 = 0.05;
/// Pixels nearer to another's body than to one's own are the other's, up to that far from it, metres.
const NEARER_M: f64 = 0.3;
/// A joint nearer to the camera plane than that, metres, is not drawn.
const NEAREST_M: f64 = 0.05;

/// A person's body, and its poses by frame.
#[derive(Debug, Clone, PartialEq)]
pub struct KnownBody {
    /// The body.
    pub model: Arc<Model>,
    /// Poses that can be believed; frames in which the person was lost are left out.
    pub poses: BTreeMap<usize, Pose>,
}

/// A limb in a picture.
#[derive(Debug, Clone, Copy)]
struct DrawnLimb {
    from: DVec2,
    along: DVec2,
    radii_px: [f64; 2],
    px_per_m: f64,
}

impl DrawnLimb {
    /// How far a pixel is outside, metres.
    fn distance_m(&self, pixel: DVec2) -> f64 {
        let share = (pixel - self.from).dot(self.along) / self.along.length_squared().max(f64::MIN_POSITIVE);
        let share = share.clamp(0.0, 1.0);
        let radius = self.radii_px[0] + share * (self.radii_px[1] - self.radii_px[0]);
        (pixel.distance(self.from + share * self.along) - radius) / self.px_per_m
    }
}

/// A body in the picture of a camera.
#[derive(Debug, Clone)]
pub(super) struct DrawnBody(Vec<DrawnLimb>);

impl DrawnBody {
    /// `None` in a frame without a pose that can be believed.
    pub(super) fn new(body: &KnownBody, camera: &Camera, frame: usize) -> Option<Self> {
        let kinematics = Kinematics::new(&body.model, body.poses.get(&frame)?);
        let focal = camera.intrinsics().mean_focal_px();
        let ends = kinematics.starts().iter().zip(kinematics.ends()).zip(body.model.limbs());
        let drawn = ends.filter_map(|((&start, &end), limb)| {
            let scales = [start, end].map(|at| focal / camera.depth(at).max(NEAREST_M));
            let [from, to] = [camera.project(start)?, camera.project(end)?];
            Some(DrawnLimb {
                from,
                along: to - from,
                radii_px: scales.map(|scale| limb.radius * scale),
                px_per_m: 0.5 * (scales[0] + scales[1]),
            })
        });
        Some(Self(drawn.collect()))
    }

    fn distance_m(&self, pixel: DVec2) -> f64 {
        self.0.iter().map(|limb| limb.distance_m(pixel)).fold(f64::INFINITY, f64::min)
    }
}

/// Makes subject that is, or may be, of these others' bodies unknown.
pub(super) fn hide(own: &DrawnBody, others: &[DrawnBody], mask: &mut Mask) {
    let width = mask.width();
    for (index, label) in mask.labels_mut().iter_mut().enumerate() {
        if *label != Label::Subject {
            continue;
        }
        let pixel = DVec2::new((index % width) as f64, (index / width) as f64);
        let other = others.iter().map(|other| other.distance_m(pixel)).fold(f64::INFINITY, f64::min);
        if other < WITHIN_M || (other < NEARER_M && other < own.distance_m(pixel)) {
            *label = Label::Unknown;
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::body::builtin;
    use crate::fixtures;

    #[test]
    fn pixels_of_another_body_are_unknown_and_ones_own_beside_it_are_not() {
        let model = Arc::new(builtin::full_body());
        let camera = fixtures::camera(
            [320, 240],
            [300.0, 300.0, 159.5, 119.5],
            DVec3::new(0.0, -4.0, 1.0),
            DVec3::Z,
            DVec3::Z,
        );
        let body = |x: f64| {
            let pose = Pose { root: DVec3::new(x, 0.0, 0.95), ..Pose::rest(&model) };
            KnownBody { model: model.clone(), poses: BTreeMap::from([(3, pose)]) }
        };
        let (own, other) = (body(-0.4), body(0.4));
        assert!(DrawnBody::new(&own, &camera, 4).is_none(), "no pose, no body");
        let [own, other] = [own, other].map(|body| DrawnBody::new(&body, &camera, 3).unwrap());
        let inside = |body: &DrawnBody, x, y| body.distance_m(DVec2::new(x as f64, y as f64)) < 0.0;
        let mut mask = fixtures::covered([320, 240], |x, y| inside(&own, x, y) || inside(&other, x, y));
        hide(&own, std::slice::from_ref(&other), &mut mask);
        for (index, label) in mask.labels().iter().enumerate() {
            let (x, y) = (index % 320, index / 320);
            let expected = match (inside(&own, x, y), inside(&other, x, y)) {
                (_, true) => Label::Unknown,
                (true, false) => Label::Subject,
                _ => Label::Background,
            };
            assert_eq!(*label, expected, "{x} {y}");
        }
        // In the same place nothing is known of either.
        let mut both = fixtures::covered([320, 240], |x, y| inside(&own, x, y));
        hide(&own, std::slice::from_ref(&own), &mut both);
        assert_eq!(both.count(Label::Subject), 0);
    }
}
