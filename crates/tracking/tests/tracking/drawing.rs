//! Pictures for the screen against the reference kernel: every renderer, ramp, odd size and view.

use backlit_tracking::body::{Kinematics, Model, Parameters, Pose, builtin};
use backlit_tracking::camera::{Camera, Distortion};
use backlit_tracking::render::{BodyMotion, MOST_ERROR, draw_plainly, jacobian_along};
use backlit_tracking::render::{DrawOptions, Drawing, Prediction, Ramp, RendererKind, View, draw, draw_over};
use backlit_tracking::search::start;
use glam::DVec3;

use crate::fixtures::{self, Failures, with_own_spheres};

const RAMPS: [Ramp; 7] = [
    Ramp::Thesis,
    Ramp::Half,
    Ramp::Width { px: 0.05 },
    Ramp::Width { px: 2.0 },
    Ramp::Width { px: 200.0 },
    Ramp::Distance { inner_px: 1.5, outer_px: 1.5 },
    Ramp::Distance { inner_px: 20.0, outer_px: 24.0 },
];

/// All renderers, and trees of a single sphere.
fn renderers() -> impl Iterator<Item = RendererKind> {
    RendererKind::ALL.into_iter().chain([RendererKind::SphereTree { spheres: Some(1) }])
}
/// A derivative of a pixel, over the largest of the picture.
const DERIVATIVE_TOLERANCE: f32 = 2e-3;
/// The same where flat caps are seen.
const FLAT_DERIVATIVE_TOLERANCE: f32 = 1e-2;

fn camera(size: [u64; 2], azimuth: f64, distance: f64, lens: Distortion) -> Camera {
    crate::vectors::choose();
    let centre = DVec3::new(distance * azimuth.cos(), 0.3, distance * azimuth.sin());
    let f = 1.1 * size[0].max(size[1]) as f64;
    let intrinsics = [f, 1.02 * f, 0.5 * size[0] as f64 - 0.7, 0.5 * size[1] as f64 + 0.4];
    fixtures::lens_camera(lens, size, intrinsics, centre, [0.0, 0.25, 0.1], DVec3::Y)
}

/// All limbs as thick as each other: whole joints are ties.
fn of_one_radius(model: &Model) -> Model {
    let mut spec = model.to_spec();
    spec.limbs.iter_mut().for_each(|limb| limb.radius = 0.05);
    Model::new(&spec).unwrap()
}

/// A direction in which everything moves.
fn direction(model: &Model) -> Vec<f64> {
    (0..Parameters::Tangent.columns(model.rotation_count())).map(|i| (1.7 * i as f64).sin()).collect()
}

struct Case {
    name: String,
    renderer: RendererKind,
    view: View,
    motion: BodyMotion,
}

impl Case {
    fn new(model: &Model, seed: u64, camera: &Camera, renderer: RendererKind, ramp: Ramp) -> Self {
        let pose = start::perturb(model, &Pose::rest(model), 0.4, 0.1, seed);
        let kinematics = Kinematics::new(model, &pose);
        let size = [camera.width(), camera.height()];
        Self {
            name: format!("{} {size:?} {renderer:?} {ramp} seed {seed}", model.name()),
            renderer,
            view: View::new(model, &kinematics, camera, renderer, ramp),
            motion: BodyMotion::along(&kinematics, camera, Parameters::Tangent, &direction(model)),
        }
    }

    fn wanted(&self) -> DrawOptions<'_> {
        DrawOptions { gradient: true, motion: Some(&self.motion) }
    }

    /// Says where a drawing is not the oracle's.
    fn compare(&self, fast: &Drawing, oracle: &Drawing, failures: &mut Failures) {
        let width = self.view.size[0];
        let mut say = |what: &str, pixel: usize, found: f32, expected: f32| {
            let (x, y) = (pixel % width, pixel / width);
            let name = &self.name;
            let place = format_args!("{name} ({x}, {y}): {what} is {found} instead of {expected}");
            failures.expect(false, place);
        };
        let (lambdas, owners) = (&oracle.prediction.lambda, &oracle.prediction.owner);
        let found = fast.prediction.lambda.iter().zip(&fast.prediction.owner);
        let expected = lambdas.iter().zip(owners);
        for (pixel, ((&found, owner), (&expected, oracle))) in found.zip(expected).enumerate() {
            if (found - expected).abs() > 255.0 * MOST_ERROR || !found.is_finite() {
                say("λ", pixel, found, expected);
            }
            if owner != oracle {
                say("the owner", pixel, f32::from(*owner), f32::from(*oracle));
            }
        }
        let has_caps = self.renderer == RendererKind::Cylinder;
        let tolerance = if has_caps { FLAT_DERIVATIVE_TOLERANCE } else { DERIVATIVE_TOLERANCE };
        for (what, fast, oracle) in
            [("pull", &fast.gradient, &oracle.gradient), ("change", &fast.change, &oracle.change)]
        {
            assert_eq!(fast.len(), oracle.len());
            let scale = oracle.iter().fold(0.0_f32, |most, value| most.max(value.abs()));
            for (pixel, (&found, &expected)) in fast.iter().zip(oracle).enumerate() {
                let is_near = (found - expected).abs() <= tolerance * scale;
                if !is_near || (found == 0.0) != (expected == 0.0) && expected.abs() > 1e-3 * scale {
                    say(what, pixel, found, expected);
                }
            }
        }
    }
}

#[test]
fn drawings_are_the_oracle_s() {
    let body = builtin::upper_body();
    let (own, equal) = (with_own_spheres(&body), of_one_radius(&body));
    let mut failures = Failures::default();
    let mut taken = 0;
    let mut seed = 0;
    for renderer in renderers() {
        for ramp in RAMPS {
            for model in [&body, &own, &equal] {
                for (size, distance) in
                    [([272, 480], 2.6), ([97, 61], 1.4), ([33, 129], 9.0), ([1, 1], 2.0), ([1, 200], 1.1)]
                {
                    seed += 1;
                    let camera = camera(size, seed as f64, distance, Distortion::None);
                    let case = Case::new(model, seed, &camera, renderer, ramp);
                    taken += usize::from(case.view.suits_lanes());
                    let (fast, oracle) =
                        (draw(&case.view, case.wanted()), draw_plainly(&case.view, case.wanted()));
                    case.compare(&fast, &oracle, &mut failures);
                }
            }
        }
    }
    assert!(taken > 250, "the lanes took only {taken} of {seed}");
}

/// Where a pixel is a millimetre, and the ramp a few of them, rounding weighs most.
#[test]
fn full_hd_drawings_are_the_oracle_s() {
    let body = builtin::upper_body();
    let mut failures = Failures::default();
    for (seed, renderer) in RendererKind::ALL.iter().cycle().take(9).enumerate() {
        let camera = camera([1920, 1080], 0.9 * seed as f64, 1.9 + 0.4 * seed as f64, Distortion::None);
        let ramp = Ramp::Distance { inner_px: 1.5, outer_px: 1.5 };
        let case = Case::new(&body, 100 + seed as u64, &camera, *renderer, ramp);
        assert!(case.view.suits_lanes());
        let oracle = draw_plainly(&case.view, DrawOptions::default());
        case.compare(&draw(&case.view, DrawOptions::default()), &oracle, &mut failures);
    }
}

/// Views that the lanes cannot take are the oracle's own work.
#[test]
fn lenses_and_limbs_around_the_camera_are_drawn_by_the_oracle() {
    let model = builtin::upper_body();
    let lens = Distortion::OpenCv { k1: -0.2, k2: 0.05, p1: 0.0, p2: 0.0, k3: 0.0 };
    let mut others = 0;
    for renderer in renderers() {
        for (seed, (lens, distance)) in
            [(lens, 2.0), (Distortion::None, 0.3), (Distortion::None, 0.05)].into_iter().enumerate()
        {
            let camera = camera([64, 45], 0.4, distance, lens);
            let case = Case::new(&model, seed as u64, &camera, renderer, Ramp::Half);
            others += usize::from(!case.view.suits_lanes());
            let plain = draw_plainly(&case.view, case.wanted());
            assert_eq!(draw(&case.view, case.wanted()), plain, "{}", case.name);
        }
    }
    assert!(others > 8, "{others}");
}

/// The plain drawing is put together from what the Jacobian's own pictures are made of.
#[test]
fn plain_drawings_hold_the_gradients_of_the_jacobian() {
    let model = builtin::upper_body();
    let camera = camera([60, 80], 0.4, 2.0, Distortion::None);
    let case = Case::new(&model, 3, &camera, RendererKind::Capsule, Ramp::Width { px: 4.0 });
    let pose = start::perturb(&model, &Pose::rest(&model), 0.4, 0.1, 3);
    let kinematics = Kinematics::new(&model, &pose);
    let drawing = draw_plainly(&case.view, case.wanted());
    let along = jacobian_along(&case.view, &kinematics, &camera, Parameters::Tangent, &direction(&model));
    assert!(along.iter().map(|value| *value as f32).eq(drawing.change.iter().copied()));
    let mut pulls = vec![0.0; 60 * 80];
    for (pixel, pull) in pulls.iter_mut().enumerate() {
        let found = case.view.pull_by_every_solid(pixel % 60, pixel / 60);
        *pull = found.and_then(|found| found.wrench).map_or(0.0, |wrench| wrench.force.length()) as f32;
    }
    assert_eq!(pulls, drawing.gradient);
    assert!(pulls.iter().any(|pull| *pull > 0.0));
    assert_eq!(Prediction::of(&case.view), drawing.prediction);
}

#[test]
fn only_what_is_wanted_is_drawn_and_threads_change_no_bit() {
    let model = builtin::upper_body();
    let camera = camera([301, 217], 2.0, 2.2, Distortion::None);
    for renderer in renderers() {
        let case = Case::new(&model, 7, &camera, renderer, Ramp::Half);
        let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let whole = pool(1).install(|| draw(&case.view, case.wanted()));
        for threads in [2, 5] {
            assert_eq!(pool(threads).install(|| draw(&case.view, case.wanted())), whole);
        }
        let bare = draw(&case.view, DrawOptions::default());
        assert!(bare.gradient.is_empty() && bare.change.is_empty());
        assert_eq!(bare.prediction, whole.prediction);
    }
}

/// An earlier drawing's memory changes nothing: of another pose, size, or other pictures, by either kernel.
#[test]
fn drawings_in_used_memory_are_as_in_new() {
    let model = builtin::upper_body();
    let mut used = Drawing::default();
    let lens = Distortion::OpenCv { k1: -0.2, k2: 0.05, p1: 0.0, p2: 0.0, k3: 0.0 };
    for renderer in renderers() {
        for (seed, distance) in [3.0, 2.0, 6.0, 0.05, 2.5, 4.0, 3.0].into_iter().enumerate() {
            let size = if seed == 4 { [61, 80] } else { [80, 61] };
            let lens = if seed == 5 { lens } else { Distortion::None };
            let camera = camera(size, 0.7 * seed as f64, distance, lens);
            let case = Case::new(&model, seed as u64, &camera, renderer, Ramp::Half);
            let options = [case.wanted(), case.wanted(), DrawOptions::default()][seed % 3];
            used = draw_over(used, &case.view, options);
            assert_eq!(used, draw(&case.view, options), "{} {seed}", case.name);
            let footprint = &used.prediction.footprint;
            let width = used.prediction.width;
            for at in (0..80 * 61).filter(|at| !footprint.contains(at % width, at / width)) {
                assert_eq!((used.prediction.lambda[at], used.prediction.owner[at]), (255.0, u16::MAX));
            }
        }
    }
}

/// What a pixel sees is the oracle's winner of it.
#[test]
fn sights_are_of_the_owner() {
    let model = builtin::upper_body();
    let camera = camera([45, 60], 1.0, 2.0, Distortion::None);
    for renderer in renderers() {
        let case = Case::new(&model, 5, &camera, renderer, Ramp::Thesis);
        let drawing = draw(&case.view, DrawOptions::default());
        for (pixel, &owner) in drawing.prediction.owner.iter().enumerate() {
            let sight = case.view.seen_limb(pixel % 45, pixel / 45);
            assert_eq!(sight.map_or(u16::MAX, |sight| sight.limb as u16), owner);
            let Some(sight) = sight else { continue };
            // The thesis ramp: λ/255 = (d/r)²/2 − 1/8.
            let level = (0.5 * sight.distance_over_radius.powi(2) - 0.125).clamp(0.0, 1.0);
            if !matches!(renderer, RendererKind::SphereTree { .. }) {
                assert!((255.0 * level - f64::from(drawing.prediction.lambda[pixel])).abs() < 0.03);
            }
            assert!(sight.depth > 0.5 && sight.depth < 4.0);
        }
        assert_eq!(case.view.seen_limb(45, 0), None);
    }
}
