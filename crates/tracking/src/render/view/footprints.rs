//! The pixel boxes of a pinhole's solids against the same rays without any box.
//!
//! A lens whose coefficients are all zero bends nothing, but it takes the exact way: every ray meets every solid.

use glam::DVec3;

use crate::body::{Kinematics, Model, Parameters, Pose, builtin};
use crate::camera::{Camera, Distortion};
use crate::fixtures::{self, Failures};
use crate::render::{Ramp, RendererKind, View, prediction};

const RAMPS: [Ramp; 4] =
    [Ramp::Thesis, Ramp::Half, Ramp::Width { px: 3.0 }, Ramp::Distance { inner_px: 1.5, outer_px: 12.0 }];

fn camera(distortion: Distortion, size: [u64; 2], distance: f64, azimuth: f64) -> Camera {
    let centre = DVec3::new(distance * azimuth.cos(), distance * azimuth.sin(), 0.2);
    let f = 0.8 * size[0].max(size[1]) as f64;
    let (cx, cy) = (0.4 * size[0] as f64, 0.55 * size[1] as f64);
    fixtures::lens_camera(distortion, size, [f, 1.04 * f, cx, cy], centre, [0.0, 0.0, 0.1], DVec3::Z)
}

/// Complains of every pixel that is not background and lies in no box of the solid that makes it so.
fn compare(name: &str, boxed: &View, whole: &View, failures: &mut Failures) -> usize {
    let mut dark = 0;
    for solid in &whole.primitives {
        let same = boxed
            .primitives
            .iter()
            .find(|other| (other.limb, other.solid, other.radius) == (solid.limb, solid.solid, solid.radius));
        let [width, height] = whole.size;
        for y in 0..height {
            for x in 0..width {
                let level = solid.sample(whole.ray(x, y)).level;
                if level >= 255.0 {
                    continue;
                }
                dark += 1;
                let (limb, bounds) = (solid.limb, same.map(|same| same.bounds));
                failures.expect(
                    bounds.is_some_and(|bounds| bounds.contains(x, y)),
                    format_args!("{name}: limb {limb}, pixel ({x}, {y}) is {level} outside {bounds:?}"),
                );
            }
        }
    }
    let (boxed, whole) = (prediction::levels(boxed), prediction::levels(whole));
    failures.expect(
        boxed.iter().zip(&whole).all(|(boxed, whole)| (boxed - whole).abs() <= 1e-9),
        format_args!("{name}: levels differ"),
    );
    dark
}

fn views(model: &Model, pose: &Pose, cameras: &[Camera; 2], renderer: RendererKind, ramp: Ramp) -> [View; 2] {
    let kinematics = Kinematics::new(model, pose);
    [0, 1].map(|index| View::new(model, &kinematics, &cameras[index], renderer, ramp))
}

/// Another pose for every seed.
fn bent(model: &Model, seed: usize) -> Pose {
    let size = |column: usize| if column < 3 { 0.1 } else { 0.5 };
    fixtures::stepped(model, Parameters::Tangent, |i| size(i) * ((7 * seed + 3 * i) as f64).sin())
}

#[test]
fn boxes_hold_every_pixel_that_a_solid_darkens() {
    let model = builtin::upper_body();
    let (mut failures, mut dark) = (Failures::default(), 0);
    // From within the body, through it, to far away; the principal point off the middle.
    for (seed, distance) in [0.0, 0.1, 0.3, 0.5, 0.8, 1.5, 4.0, 30.0].into_iter().enumerate() {
        for size in [[31, 23], [1, 37], [40, 1], [1, 1]] {
            let cameras = [Distortion::None, fixtures::NO_BEND]
                .map(|lens| camera(lens, size, distance, 0.9 * seed as f64));
            let pose = bent(&model, seed);
            for renderer in fixtures::renderers() {
                for ramp in RAMPS {
                    let [boxed, whole] = views(&model, &pose, &cameras, renderer, ramp);
                    assert!(boxed.is_pinhole() && !whole.is_pinhole());
                    let name = format!("{distance} m, {size:?}, {renderer}, {ramp}");
                    dark += compare(&name, &boxed, &whole, &mut failures);
                }
            }
        }
    }
    assert!(dark > 100_000, "only {dark} pixels are dark");
}
