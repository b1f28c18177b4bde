//! Sphere trees of limbs: what a parent skips is not missed, levels go by the size in the picture.

use backlit_tracking::body::{
    Kinematics, LimbSphere, Model, ModelError, Parameters, Pose, SphereLevel, builtin,
};
use backlit_tracking::camera::Camera;
use backlit_tracking::render::{Ramp, RendererKind, View, prediction};
use glam::DVec3;

use crate::fixtures;

const OWN: RendererKind = RendererKind::SphereTree { spheres: None };

/// Two levels: three spheres a limb, and under each three small ones, some of which stand out of it.
fn levels(error: f64) -> Vec<Vec<SphereLevel>> {
    let body = builtin::upper_body();
    let tree = body.limbs().iter().map(|limb| {
        let aside = limb.direction.any_orthonormal_vector() * limb.radius;
        let sphere = |at: f64, radius: f64, aside: DVec3, parent| LimbSphere {
            at,
            radius: radius * limb.radius,
            offset: aside,
            parent,
        };
        let coarse = (0..3).map(|i| sphere(0.5 * f64::from(i), 1.3, 0.2 * aside, None)).collect();
        let fine = (0..9_usize).map(|i| {
            let around = aside * [0.9, -0.6, 0.2][i % 3];
            sphere(i as f64 / 8.0, 0.5 + 0.05 * i as f64, around, Some(i / 3))
        });
        vec![
            SphereLevel { error, spheres: coarse, reaches: Vec::new() },
            SphereLevel { error: 0.0, spheres: fine.collect(), reaches: Vec::new() },
        ]
    });
    tree.collect()
}

fn body(error: f64) -> Model {
    builtin::upper_body().with_trees(levels(error)).unwrap()
}

fn camera(size: [u64; 2], distance: f64, aside: f64) -> Camera {
    let intrinsics = [70.0, 74.0, 30.0, 21.0];
    fixtures::camera(size, intrinsics, [aside, 0.4, distance], [1.5 * aside, 0.3, 0.0], DVec3::Y)
}

fn bent(model: &Model, seed: usize) -> Pose {
    fixtures::stepped(model, Parameters::Tangent, |i| 0.4 * ((7 * seed + 3 * i) as f64).sin())
}

/// A picture of the tree is, to the bit, that of its finest spheres without parents: also where the body is cut by the border,
/// behind the camera or around it.
#[test]
fn parents_skip_nothing_that_is_seen() {
    // A level whose error is 50 m is never fine enough.
    let tree = body(50.0);
    let flat = tree.at_level(1).unwrap();
    let mut dark = 0;
    let ramps =
        [Ramp::Thesis, Ramp::Half, Ramp::Width { px: 3.0 }, Ramp::Distance { inner_px: 1.5, outer_px: 12.0 }];
    for (seed, (distance, aside)) in
        [(2.0, 0.0), (1.2, 0.6), (0.7, -0.7), (0.3, 0.2), (0.05, 0.0), (-0.5, 0.4)].into_iter().enumerate()
    {
        let camera = camera([61, 43], distance, aside);
        let kinematics = Kinematics::new(&tree, &bent(&tree, seed));
        for ramp in ramps {
            let [a, b] = [&tree, &flat].map(|body| View::new(body, &kinematics, &camera, OWN, ramp));
            let [levels, expected] = [&a, &b].map(prediction::levels);
            let bits =
                [&levels, &expected].map(|all| all.iter().map(|level| level.to_bits()).collect::<Vec<_>>());
            assert!(bits[0] == bits[1], "{distance} m, {ramp}");
            assert_eq!(prediction::covered(&a), prediction::covered(&b), "{distance} m, {ramp}");
            dark += levels.iter().filter(|&&level| level < 255.0).count();
        }
    }
    assert!(dark > 5000, "{dark}");
}

/// The coarse level is drawn where its error is small in the picture, and the fine one where it is not.
#[test]
fn the_level_goes_by_the_size_in_the_picture() {
    // 70 px focal length: a quarter of a pixel at 2 m is 7 mm.
    for (error, level) in [(0.005, 0), (0.009, 1)] {
        let tree = body(error);
        let kinematics = Kinematics::new(&tree, &Pose::rest(&tree));
        let alone = tree.at_level(level).unwrap();
        let camera = camera([61, 43], 2.0, 0.0);
        let [a, b] = [&tree, &alone]
            .map(|body| prediction::levels(&View::new(body, &kinematics, &camera, OWN, Ramp::Half)));
        assert_eq!(a, b, "{error}");
    }
    let tree = body(0.01);
    assert_eq!(tree.spheres_by_level(), [36, 108]);
    let kinematics = Kinematics::new(&tree, &bent(&tree, 1));
    let placed = tree.placed_spheres(&kinematics, 1);
    assert_eq!(placed.len(), 108);
    let limb = &tree.limbs()[placed[13].limb];
    let along = placed[13].centre - kinematics.starts()[placed[13].limb];
    assert!((along.length() - limb.centre(&limb.spheres[4]).length()).abs() < 1e-12);
}

#[test]
fn bodies_keep_their_trees_when_resized_and_refuse_broken_ones() {
    let tree = body(0.01);
    let larger = tree.scaled(1.5).unwrap();
    let (before, after) = (&tree.limbs()[2], &larger.limbs()[2]);
    assert!((after.coarser[0].error - 0.015).abs() < 1e-12);
    for (a, b) in before.coarser[0].reaches.iter().zip(&after.coarser[0].reaches) {
        assert!((1.5 * a - b).abs() < 1e-12 && *a > 0.0, "{a} {b}");
    }
    type Breaks = fn(&mut Vec<SphereLevel>);
    let broken: [(Breaks, &str); 5] = [
        (|levels| levels[1].spheres[4].parent = Some(3), "`parent` that is not there"),
        (|levels| levels[1].spheres[4].parent = None, "no `parent`"),
        (|levels| levels[0].error = f64::NAN, "no `error`"),
        (|levels| levels[0].spheres.clear(), "no spheres"),
        (|levels| levels[0].spheres[0].radius = -1.0, "coarser[0]"),
    ];
    for (breaks, expected) in broken {
        let mut trees = levels(0.01);
        breaks(&mut trees[3]);
        let error: ModelError = builtin::upper_body().with_trees(trees).unwrap_err();
        assert!(error.to_string().contains(expected), "{error}");
    }
}
