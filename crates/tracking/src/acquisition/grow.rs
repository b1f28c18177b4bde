//! Sizes by growing: a template shrinks until it holds no background and grows until background enters, in any camera.
//!
//! A capsule of radius R under a template of radius r > R leaves about the share 1 − R/r of the template to background: where
//! growing ends at the share β, R = (1 − β) r. A ball of radius b that is moved along a limb sticks out of its end by a sixth of b
//! where a twentieth of its disc is background.

use glam::DVec3;

use super::options::AcquireOptions;
use crate::templates::{Pictures, Template};

/// A limb's end is felt for by a ball of this share of its radius.
const BALL: f64 = 0.8;
/// How far the ball sticks out where it is stopped, in its radii.
const STICKS_OUT: f64 = 0.18;

/// A radius, by growing; `None` where nothing stops it, or nothing of it is inside.
pub(super) fn radius(pictures: &Pictures, options: &AcquireOptions, template: &Template) -> Option<f64> {
    let enters =
        |radius: f64| pictures.held(&Template { radius, ..*template }).most_background > options.background;
    let found = grown(template.radius, options, enters)?;
    Some(found * (1.0 - options.background))
}

/// The length of a limb from one joint along a direction to where the silhouettes end, less `beyond`: what the body has there beyond
/// the joint. `None` where nothing stops it, or nothing of it is inside.
pub(super) fn length(
    pictures: &Pictures,
    options: &AcquireOptions,
    template: &Template,
    beyond: f64,
) -> Option<f64> {
    let along = (template.to - template.from).try_normalize()?;
    let ball = BALL * template.radius;
    let enters = |length: f64| {
        let centre: DVec3 = template.from + along * length;
        let ball = Template { from: centre, to: centre, radius: ball };
        pictures.held(&ball).most_background > options.background
    };
    let found = grown(template.from.distance(template.to), options, enters)?;
    Some(found + (1.0 - STICKS_OUT) * ball - beyond)
}

/// A size that shrinks while background is inside, and grows until it enters.
fn grown(begin: f64, options: &AcquireOptions, enters: impl Fn(f64) -> bool) -> Option<f64> {
    let [low, high] = options.range.map(|factor| factor * begin);
    let mut size = begin;
    while enters(size) {
        size *= 1.0 - options.step;
        if size < low {
            return None;
        }
    }
    while !enters(size * (1.0 + options.step)) {
        size *= 1.0 + options.step;
        if size > high {
            return None;
        }
    }
    Some(size)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::camera::{Camera, CameraFromWorld, Distortion, Intrinsics};
    use crate::fit::{Evidence, FitView};
    use crate::silhouette::{Label, Mask};
    use glam::DVec2;

    /// Two cameras' pictures of a capsule.
    fn pictures(from: DVec3, to: DVec3, radius: f64) -> Pictures {
        let view = |at: DVec3| {
            let place = CameraFromWorld::looking_at(at, 0.5 * (from + to), DVec3::Z);
            let pinhole = Intrinsics { fx: 400.0, fy: 400.0, cx: 99.5, cy: 99.5 };
            let camera = Camera::new("c", [200, 200], pinhole, Distortion::None, place).unwrap();
            let label = |index: usize| {
                let ray =
                    camera.ray_in_world(DVec2::new((index % 200) as f64, (index / 200) as f64)).unwrap();
                let distance = |t: f64| {
                    let away = from.lerp(to, t) - at;
                    (away - ray * ray.dot(away)).length()
                };
                let least = (0..=100).map(|k| distance(f64::from(k) / 100.0)).fold(f64::INFINITY, f64::min);
                if least < radius { Label::Subject } else { Label::Background }
            };
            let mask = Mask::new(200, 200, (0..200 * 200).map(label).collect()).unwrap();
            FitView { camera: Arc::new(camera), evidence: Evidence::Mask(Arc::new(mask)), weight: 1.0 }
        };
        Pictures::new(&[view(DVec3::new(3.0, 0.2, 0.5)), view(DVec3::new(0.3, -3.0, 0.4))])
    }

    #[test]
    fn a_capsule_gets_its_own_sizes_whatever_the_template_begins_with() {
        let (from, to, radius) = (DVec3::new(0.0, 0.0, 0.2), DVec3::new(0.05, 0.02, 0.7), 0.07);
        let pictures = pictures(from, to, radius);
        let options = AcquireOptions::default();
        let along = (to - from).normalize();
        for (long, thick) in [(0.8, 0.8), (1.0, 1.3), (1.2, 1.0)] {
            let template = Template { from, to: from + (to - from) * long, radius: radius * thick };
            let inside = Template { to: from + (to - from) * 0.9, ..template };
            let found = super::radius(&pictures, &options, &inside).unwrap();
            assert!((found / radius - 1.0).abs() < 0.06, "radius {found} of {radius}, begun at {thick}");
            let template = Template { radius, ..template };
            let found = length(&pictures, &options, &template, radius).unwrap();
            assert!((found - (to - from).length()).abs() < 0.02, "length {found}, begun at {long}");
        }
        let outside = Template { from: from + along * 2.0, to: to + along * 2.0, radius };
        assert_eq!(super::radius(&pictures, &options, &outside), None);
    }
}
