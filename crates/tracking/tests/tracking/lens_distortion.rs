//! The two ways through a lens: every pixel's own ray, or one resampling to the ideal pinhole grid.

use backlit_tracking::body::{Kinematics, Model, Pose, builtin};
use backlit_tracking::camera::{Camera, Distortion, Rectification};
use backlit_tracking::render::{Ramp, RendererKind, View, prediction};
use backlit_tracking::search::start;
use glam::DVec3;
use image::{Rgb, RgbImage};

use crate::fixtures::{self, Failures};

/// A ramp, and by how many grey levels the two ways may differ: at worst in a pixel with data, and in the mean over the
/// pixels that either way are not background. Half a level is rounding; the rest is what bilinear mixing does to a ramp that
/// clips or bends within a pixel, so narrow ramps differ most.
const RAMPS: [(Ramp, f64, f64); 3] = [
    (Ramp::Thesis, 25.0, 1.2),
    (Ramp::Half, 40.0, 1.8),
    (Ramp::Distance { inner_px: 3.0, outer_px: 12.0 }, 8.0, 0.5),
];
/// The mean for cylinders. Their λ jumps where a flat cap turns edge-on, so there is no worst difference.
const CYLINDER_MEAN: f64 = 2.5;
const BARREL: Distortion = Distortion::OpenCv { k1: -0.22, k2: 0.07, p1: 1.5e-3, p2: -1e-3, k3: 0.0 };
const PINCUSHION: Distortion = Distortion::OpenCv { k1: 0.16, k2: 0.02, p1: -1e-3, p2: 8e-4, k3: 0.0 };

fn camera(distortion: Distortion) -> Camera {
    let intrinsics = [170.0, 173.0, 97.0, 70.0];
    fixtures::lens_camera(distortion, [192, 144], intrinsics, [1.1, 0.5, 1.4], [0.0, 0.2, 0.0], DVec3::Y)
}

fn levels(model: &Model, pose: &Pose, camera: &Camera, renderer: RendererKind, ramp: Ramp) -> Vec<f64> {
    let kinematics = Kinematics::new(model, pose);
    prediction::levels(&View::new(model, &kinematics, camera, renderer, ramp))
}

/// How far a rectified picture is from the ideal one.
#[derive(Debug, Default)]
struct Difference {
    worst: f64,
    mean: f64,
    /// Pixels that are not background in either picture.
    grey: usize,
}

fn difference(rectification: &Rectification, rectified: &RgbImage, ideal: &[f64]) -> Difference {
    let mut out = Difference::default();
    let level = |x: u32, y: u32| ideal[y as usize * 192 + x as usize];
    for (x, y, pixel) in rectified.enumerate_pixels() {
        if !rectification.has_data(x as usize, y as usize) {
            continue;
        }
        let difference = (f64::from(pixel[0]) - level(x, y)).abs();
        out.worst = out.worst.max(difference);
        if level(x, y) < 255.0 || pixel[0] < 255 {
            out.mean += difference;
            out.grey += 1;
        }
    }
    out.mean /= out.grey as f64;
    out
}

#[test]
fn rays_through_the_lens_agree_with_the_rectified_picture() {
    let model = builtin::upper_body();
    let mut failures = Failures::default();
    for (lens_name, lens) in [("barrel", BARREL), ("pincushion", PINCUSHION)] {
        let raw = camera(lens);
        let rectification = Rectification::new(&raw);
        for seed in 0..4 {
            let pose = start::perturb(&model, &Pose::rest(&model), 0.3, 0.05, seed);
            for renderer in RendererKind::ALL {
                for (ramp, worst, mean) in RAMPS {
                    let bent = levels(&model, &pose, &raw, renderer, ramp);
                    let straight = levels(&model, &pose, &raw.without_distortion(), renderer, ramp);
                    let picture = RgbImage::from_fn(192, 144, |x, y| {
                        Rgb([bent[y as usize * 192 + x as usize].round() as u8; 3])
                    });
                    let found =
                        difference(&rectification, &rectification.rectify(&picture).unwrap(), &straight);
                    let cylinder = renderer == RendererKind::Cylinder;
                    let (worst, mean) = if cylinder { (255.0, CYLINDER_MEAN) } else { (worst, mean) };
                    let agrees = found.worst < worst && found.mean < mean;
                    failures.expect(
                        agrees && found.grey > 2000,
                        format_args!("{lens_name}, pose {seed}, {renderer}, {ramp}: {found:?}"),
                    );
                    // The lens does bend: without rectification the pictures are far apart.
                    let apart =
                        difference(&Rectification::new(&raw.without_distortion()), &picture, &straight);
                    assert!(apart.mean > 2.0 * found.mean, "{lens_name} bends too little to tell: {apart:?}");
                }
            }
        }
    }
}

/// A pincushion's ideal corners lie outside the raw picture; a barrel's raw corners lie outside the ideal one.
#[test]
fn what_the_lens_did_not_see_has_no_data() {
    let without = |lens| {
        let rectification = Rectification::new(&camera(lens));
        (0..192 * 144).filter(|index| !rectification.has_data(index % 192, index / 192)).count()
    };
    assert_eq!(without(Distortion::None), 0);
    assert!(without(PINCUSHION) > 100, "{}", without(PINCUSHION));
    assert!(without(BARREL) < 192 * 144 / 10, "{}", without(BARREL));
}
