//! ∂Λ/∂X against central differences of Λ: every renderer × ramp × parametrisation × camera.
//!
//! All mismatches are reported at once by renderer, ramp, parametrisation, camera, limb, column and pixel.
//! Pixels at a kink (the winner changes or the ramp clips within the difference step) are skipped, and few are.

use backlit_tracking::body::{Kinematics, LimbSphere, Model, ModelSpec, Parameters, Pose, builtin};
use backlit_tracking::camera::{Camera, Distortion, Intrinsics};
use backlit_tracking::optimize::gradient_check::{DifferenceOptions, GradientCheck, check_jacobian};
use backlit_tracking::render::{Ramp, RendererKind, View, dense_jacobian, prediction};
use glam::DVec3;
use rayon::prelude::*;

use crate::bad_input;
use crate::fixtures::{self, BOTH};

/// Largest share of derivatives that may lie at a kink.
const MOST_SKIPPED: f64 = 0.001;
/// The same where limbs reach the camera: their candidates end at its plane.
const MOST_SKIPPED_ACROSS: f64 = 0.01;
/// The same where a single pixel may be the kink.
const MOST_SKIPPED_THIN: f64 = 0.2;
/// The same where rays run along the axis, between the two ends.
const MOST_SKIPPED_END_ON: f64 = 0.02;

const RAMPS: [Ramp; 4] =
    [Ramp::Thesis, Ramp::Half, Ramp::Width { px: 0.6 }, Ramp::Distance { inner_px: 0.5, outer_px: 2.0 }];

const LENS: Distortion = Distortion::OpenCv { k1: -0.2, k2: 0.06, p1: 2e-3, p2: -1e-3, k3: 0.01 };

fn camera(distortion: Distortion, size: [u64; 2]) -> Camera {
    let (width, height) = (size[0] as f64, size[1] as f64);
    let focal = 1.6 * width;
    let intrinsics = [focal, 1.05 * focal, 0.5 * width - 0.3, 0.5 * height - 0.6];
    let (at, up) = ([0.05, 0.25, 0.0], DVec3::new(0.1, 1.0, 0.0));
    fixtures::lens_camera(distortion, size, intrinsics, [1.3, 0.6, 2.0], at, up)
}

/// The upper body with three spheres of their own in every limb, off the axis and of different sizes.
fn body_with_own_spheres() -> Model {
    let mut spec: ModelSpec = builtin::upper_body().to_spec();
    for limb in &mut spec.limbs {
        let radius = limb.radius;
        limb.spheres =
            [(0.1, 0.9, [0.2, 0.0, -0.3]), (0.5, 1.2, [-0.3, 0.2, 0.1]), (0.95, 0.7, [0.0, 0.4, 0.2])]
                .map(|(at, scale, offset)| LimbSphere {
                    at,
                    radius: scale * radius,
                    offset: DVec3::from(offset) * radius,
                    parent: None,
                })
                .to_vec();
    }
    Model::new(&spec).unwrap()
}

/// A bent pose; raw quaternions are not of unit length.
fn pose(model: &Model, parameters: Parameters) -> Pose {
    fixtures::stretched(model, parameters, [0.03, 0.16], 0.0)
}

/// "torso x", "right forearm ω y" …: what a column of the state moves.
fn column_name(model: &Model, parameters: Parameters, column: usize) -> String {
    if column < 3 {
        return format!("root {}", ["x", "y", "z"][column]);
    }
    let (rotation, part) =
        ((column - 3) / parameters.per_rotation(), (column - 3) % parameters.per_rotation());
    let part = match parameters {
        Parameters::Raw => ["w", "x", "y", "z"][part],
        Parameters::Tangent => ["ω x", "ω y", "ω z"][part],
    };
    format!("{} {part}", model.limbs()[model.rotation_owners()[rotation]].name)
}

struct Case<'a> {
    name: String,
    model: &'a Model,
    /// Where the limbs are.
    pose: Pose,
    renderer: RendererKind,
    ramp: Ramp,
    parameters: Parameters,
    camera: &'a Camera,
}

impl Case<'_> {
    /// How many pixels have a gradient.
    fn active(&self) -> usize {
        let Case { model, renderer, ramp, parameters, camera, ref pose, .. } = *self;
        let kinematics = Kinematics::new(model, pose);
        let view = View::new(model, &kinematics, camera, renderer, ramp);
        let jacobian = dense_jacobian(&view, &kinematics, camera, parameters);
        jacobian.row_iter().filter(|row| row.amax() > 0.0).count()
    }

    fn check(&self) -> GradientCheck {
        let Case { model, renderer, ramp, parameters, camera, ref pose, .. } = *self;
        let mut kinematics = Kinematics::new(model, pose);
        let mut view = View::new(model, &kinematics, camera, renderer, ramp);
        let jacobian = dense_jacobian(&view, &kinematics, camera, parameters);
        let owners = prediction::Prediction::of(&view).owner;
        let name = |pixel: usize, column: usize| {
            let limb = model.limbs().get(usize::from(owners[pixel])).map_or("none", |limb| &limb.name);
            let (x, y) = (pixel % camera.width(), pixel / camera.width());
            let column = column_name(model, parameters, column);
            format!("{}, limb {limb}, column {column}, pixel ({x}, {y})", self.name)
        };
        let levels = |column: usize, offset: f64| {
            kinematics.update(model, &pose.nudged(parameters, column, offset));
            view.prepare(model, &kinematics, camera, renderer, ramp);
            prediction::levels(&view)
        };
        let options = DifferenceOptions { tolerance: 1e-5, ..DifferenceOptions::default() };
        check_jacobian(&jacobian, levels, name, &options)
    }
}

fn renderers<'a>(plain: &'a Model, own: &'a Model) -> [(&'static str, &'a Model, RendererKind); 4] {
    [
        ("cylinder", plain, RendererKind::Cylinder),
        ("capsule", plain, RendererKind::Capsule),
        ("equal spheres", plain, RendererKind::SphereTree { spheres: Some(5) }),
        ("own spheres", own, RendererKind::SphereTree { spheres: None }),
    ]
}

/// Every renderer, ramp, parametrisation and camera, in the poses that `poses` has of them, by name.
fn cases<'a>(
    renderers: &[(&str, &'a Model, RendererKind)],
    cameras: &'a [Camera],
    poses: impl Fn(&Model, Parameters, &Camera) -> Vec<(String, Pose)>,
) -> Vec<Case<'a>> {
    let mut cases = Vec::new();
    for &(shape, model, renderer) in renderers {
        for ramp in RAMPS {
            for parameters in BOTH {
                for camera in cameras {
                    let (size, lens) = ([camera.width(), camera.height()], camera.distortion());
                    for (place, pose) in poses(model, parameters, camera) {
                        let name = format!("{shape}, {ramp}, {parameters:?}, {size:?}, {lens:?}, {place}");
                        cases.push(Case { name, model, pose, renderer, ramp, parameters, camera });
                    }
                }
            }
        }
    }
    cases
}

/// Checks all cases and only then complains, of all at once.
fn assert_all_match(cases: &[Case], most_skipped: f64) {
    let checks: Vec<GradientCheck> = cases.par_iter().map(Case::check).collect();
    for (case, check) in cases.iter().zip(&checks) {
        assert!(check.skipped_share() < most_skipped, "{}: {check}", case.name);
    }
    let mut all = GradientCheck::default();
    checks.into_iter().for_each(|check| all += check);
    assert!(all.passes(), "{all}");
}

#[test]
fn jacobians_match_differences() {
    let (plain, own) = (builtin::upper_body(), body_with_own_spheres());
    let cameras = [Distortion::None, LENS].map(|lens| camera(lens, [44, 36]));
    let bent = |model: &Model, parameters, _: &Camera| vec![("bent".to_owned(), pose(model, parameters))];
    let cases = cases(&renderers(&plain, &own), &cameras, bent);
    for case in &cases {
        assert!(case.active() > 60, "{}: only {} pixels have a gradient", case.name, case.active());
    }
    assert_all_match(&cases, MOST_SKIPPED);
}

/// Limbs behind the camera, across its plane and around its centre, through a pinhole and a lens.
#[test]
fn jacobians_match_differences_of_limbs_across_the_camera() {
    let (plain, own) = (builtin::upper_body(), body_with_own_spheres());
    let cameras = [Distortion::None, LENS].map(|lens| camera(lens, [20, 16]));
    let cases = cases(&renderers(&plain, &own), &cameras, |model, parameters, camera| {
        let axis = camera.axis_in_world();
        let at = |depth: f64| {
            let pose = Pose { root: camera.centre() + axis * depth, ..pose(model, parameters) };
            (format!("root at {depth} m"), pose)
        };
        [-0.2, 0.02, 0.3, 0.55, 0.8].map(at).to_vec()
    });
    let seen = cases.iter().filter(|case| case.active() > 20).count();
    assert!(3 * seen > cases.len(), "only {seen} of {} see a limb", cases.len());
    assert_all_match(&cases, MOST_SKIPPED_ACROSS);
}

/// Pictures of one pixel, one column and one row.
#[test]
fn jacobians_match_differences_in_thin_pictures() {
    let (plain, own) = (builtin::upper_body(), body_with_own_spheres());
    let cameras: Vec<Camera> = [[1, 1], [1, 40], [40, 1], [2, 3]]
        .into_iter()
        .flat_map(|size| {
            [Distortion::None, LENS].map(|lens| {
                // A pixel sees what forty do.
                let camera = camera(lens, size);
                let k = *camera.intrinsics();
                let scale = 44.0 / size[0].max(size[1]) as f64;
                let intrinsics = Intrinsics { fx: k.fx.max(k.fy) / scale, fy: k.fx.max(k.fy) / scale, ..k };
                Camera::new("thin", size, intrinsics, lens, *camera.camera_from_world()).unwrap()
            })
        })
        .collect();
    let cases = cases(&renderers(&plain, &own), &cameras, |model, parameters, camera| {
        let across = camera.camera_from_world().rotation.transpose().x_axis;
        let aside = |shift: f64| {
            let mut pose = pose(model, parameters);
            pose.root += across * shift;
            (format!("{shift} m aside"), pose)
        };
        [0.0, 0.06, 0.1].map(aside).to_vec()
    });
    let seen = cases.iter().filter(|case| case.active() > 0).count();
    assert!(3 * seen > cases.len(), "only {seen} of {} see a limb", cases.len());
    assert_all_match(&cases, MOST_SKIPPED_THIN);
}

/// A limb seen end on: the middle rays run along its axis, the others nearly so.
#[test]
fn jacobians_match_differences_of_axes_parallel_to_a_ray() {
    let model = builtin::single_limb();
    let direction = model.limbs()[0].direction;
    let aside = direction.any_orthonormal_vector();
    let cameras = [Distortion::None, LENS].map(|lens| {
        fixtures::lens_camera(lens, [21, 17], [40.0, 40.0, 10.0, 8.0], DVec3::ZERO, direction, aside)
    });
    let spheres = RendererKind::SphereTree { spheres: Some(3) };
    let renderers =
        [RendererKind::Cylinder, RendererKind::Capsule, spheres].map(|kind| ("limb", &model, kind));
    let cases = cases(&renderers, &cameras, |model, _, _| {
        let before = |(depth, shift): (f64, f64)| {
            let pose = Pose { root: direction * depth + aside * shift, ..Pose::rest(model) };
            (format!("{depth} m before and {shift} m aside"), pose)
        };
        [(0.6, 0.0), (0.6, 0.04), (1.5, 0.0), (1.5, 0.04)].map(before).to_vec()
    });
    assert_all_match(&cases, MOST_SKIPPED_END_ON);
}

/// Whatever the pose and the picture, every level, derivative and sight is a number.
fn assert_finite(name: &str, model: &Model, pose: &Pose, camera: &Camera) {
    bad_input::assert_finite(name, model, pose, camera, &RAMPS, |view, case| {
        let drawn = prediction::Prediction::of(view);
        let pixels = (0..drawn.lambda.len()).map(|pixel| [pixel % drawn.width, pixel / drawn.width]);
        let mut sights = pixels.filter_map(|[x, y]| view.seen_limb(x, y));
        let has_nan = drawn.lambda.iter().any(|level| level.is_nan())
            || sights.any(|sight| sight.depth.is_nan() || sight.distance_over_radius.is_nan());
        assert!(!has_nan, "{case}: the picture has NaN");
    });
}

#[test]
fn odd_views_hold_no_nan() {
    let (arm, body) = (builtin::single_limb(), builtin::upper_body());
    let own = body_with_own_spheres();
    let folding = Distortion::OpenCv { k1: -1.5, k2: 0.0, p1: 0.0, p2: 0.0, k3: 0.0 };
    for (lens, distortion) in [("pinhole", Distortion::None), ("lens", LENS), ("folding lens", folding)] {
        for size in [[1, 1], [1, 7], [9, 1], [12, 9]] {
            let camera = camera(distortion, size);
            let (centre, axis) = (camera.centre(), camera.axis_in_world());
            for (model_name, model) in [("single limb", &arm), ("upper body", &body), ("own spheres", &own)] {
                let rest = pose(model, Parameters::Raw);
                // Behind, through and before the camera; exactly in its centre and on its axis too.
                for depth in [-3.0, -0.5, -0.1, 0.0, 0.05, 0.3, 2.0] {
                    let moved = Pose { root: centre + axis * depth, rotations: rest.rotations.clone() };
                    let name = format!("{lens}, {size:?}, {model_name} at {depth} m");
                    assert_finite(&name, model, &moved, &camera);
                }
            }
        }
    }
}

#[test]
fn axes_parallel_to_a_ray_hold_no_nan() {
    let model = builtin::single_limb();
    let direction = model.limbs()[0].direction;
    let across = direction.any_orthonormal_vector();
    // Odd sizes and a principal point on a pixel: the middle ray is the optical axis.
    let camera = fixtures::camera([9, 7], [20.0, 20.0, 4.0, 3.0], DVec3::ZERO, direction, across);
    for offset in [-1.0, -0.2, 0.0, 0.5, 2.0] {
        for aside in [DVec3::ZERO, across * 0.03] {
            let pose = Pose { root: direction * offset + aside, ..Pose::rest(&model) };
            assert_finite(&format!("end on at {offset} m"), &model, &pose, &camera);
        }
    }
}
