//! The lanes against the reference kernel: costs and wrench blocks, for every ramp, stride and odd view.

use backlit_tracking::body::{Kinematics, Model, Parameters, Pose, builtin};
use backlit_tracking::camera::Camera;
use backlit_tracking::optimize::NormalEquations;
use backlit_tracking::render::wrench::WrenchBlock;
use backlit_tracking::render::{Ramp, RendererKind, View, prediction};
use backlit_tracking::residual::silhouette::{KernelMemory, SampledData, StateMap, WorldBlocks};
use backlit_tracking::search::start;
use backlit_tracking::silhouette::Measurement;
use glam::DVec3;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;

use crate::fixtures::{self, Failures, with_own_spheres};

const RAMPS: [Ramp; 6] = [
    Ramp::Thesis,
    Ramp::Half,
    Ramp::Width { px: 2.0 },
    Ramp::Width { px: 200.0 },
    Ramp::Distance { inner_px: 2.0, outer_px: 3.0 },
    Ramp::Distance { inner_px: 20.0, outer_px: 24.0 },
];
/// Difference of an entry of the normal equations from f32 lanes, over the largest.
const EQUATION_TOLERANCE: f64 = 1e-4;
/// The same where flat caps are seen: as a cap's plane turns edge-on its gradient grows without bound, and the
/// rounding of the ray's own coordinates with it.
const FLAT_CAP_TOLERANCE: f64 = 1e-3;
/// The same over √(dᵢ dⱼ) of JᵀJ's diagonal d, and over √dᵢ and the root of the cost: metres and radians alike. A few
/// pixels make a column of a picture three pixels wide; rounding may clip one of them.
const ENTRY_TOLERANCE: f64 = 2e-3;
/// Columns that hardly any pixel moves count as if their diagonal were this much of the largest.
const LEAST_DIAGONAL: f64 = 1e-4;
/// Relative difference of the cost.
const COST_TOLERANCE: f64 = 1e-5;

fn camera(width: u64, height: u64, azimuth: f64, distance: f64) -> Camera {
    crate::vectors::choose();
    let centre = DVec3::new(distance * azimuth.cos(), distance * azimuth.sin(), 0.3);
    let f = 1.1 * width.max(height) as f64;
    let intrinsics = [f, 1.02 * f, 0.5 * width as f64 - 0.7, 0.5 * height as f64 + 0.4];
    fixtures::camera([width, height], intrinsics, centre, [0.0, 0.0, 0.1], DVec3::Z)
}

fn view(model: &Model, pose: &Pose, camera: &Camera, renderer: RendererKind, ramp: Ramp) -> View {
    View::new(model, &Kinematics::new(model, pose), camera, renderer, ramp)
}

/// Another pose's picture with noise, and one pixel in eight without weight.
fn data(model: &Model, camera: &Camera, ramp: Ramp, seed: u64) -> Measurement {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let pose = start::perturb(model, &Pose::rest(model), 0.2, 0.05, seed + 1000);
    let levels = prediction::levels(&view(model, &pose, camera, RendererKind::Capsule, ramp));
    let values = levels.iter().map(|level| (level + random.random_range(-5.0..5.0)).clamp(0.0, 255.0) as f32);
    let values = values.collect();
    let weights = (0..levels.len())
        .map(|_| if random.random_range(0..8) == 0 { 0.0 } else { random.random_range(0.5..1.5) })
        .collect();
    Measurement::new(camera.width(), camera.height(), values, weights).unwrap()
}

/// The equations of one camera. Limbs that share a joint and a radius win its pixels together, to the bit in
/// f64 and by chance in f32; which of them is named makes no difference to the state, so states are compared.
fn equations(model: &Model, pose: &Pose, camera: &Camera, blocks: &[WrenchBlock]) -> NormalEquations {
    let columns = Parameters::Raw.columns(model.rotation_count());
    let mut world = WorldBlocks::new(model.limbs().len());
    world.add(camera, blocks, 1.0);
    let mut equations = NormalEquations::zeros(columns);
    let kinematics = Kinematics::new(model, pose);
    world.add_to(&kinematics, Parameters::Raw, &mut StateMap::default(), &mut equations);
    equations
}

fn compare(
    name: &str,
    model: &Model,
    pose: &Pose,
    camera: &Camera,
    (renderer, ramp): (RendererKind, Ramp),
    data: &SampledData,
    failures: &mut Failures,
) {
    let view = view(model, pose, camera, renderer, ramp);
    let mut lanes = vec![WrenchBlock::default(); model.limbs().len()];
    let mut scalar = lanes.clone();
    let mut memory = KernelMemory::default();
    // Twice with the same memory: the first call must leave nothing behind.
    data.accumulate(&view, &mut memory, &mut lanes);
    lanes.fill(WrenchBlock::default());
    let lanes_cost = data.accumulate(&view, &mut memory, &mut lanes);
    let scalar_cost = data.accumulate_scalar(&view, &mut KernelMemory::default(), &mut scalar);
    let what = format_args!("{name}: cost");
    failures.near(what, lanes_cost, scalar_cost, COST_TOLERANCE * scalar_cost.max(1.0));
    let tolerance = if renderer == RendererKind::Cylinder { FLAT_CAP_TOLERANCE } else { EQUATION_TOLERANCE };
    let found = equations(model, pose, camera, &lanes);
    let expected = equations(model, pose, camera, &scalar);
    let diagonal = expected.jtj.diagonal();
    let largest = diagonal.amax().max(1.0);
    let root_cost = scalar_cost.max(1.0).sqrt();
    let roots = diagonal.map(|entry| entry.max(LEAST_DIAGONAL * largest).sqrt());
    let mut check = |place: String, difference: f64, largest: f64, own: f64| {
        let agrees = difference.abs() <= tolerance * largest && difference.abs() <= ENTRY_TOLERANCE * own;
        let (of_largest, of_own) = (difference / largest, difference / own);
        failures.expect(
            agrees,
            format_args!("{name}: {place} differs by {of_largest:.1e}, {of_own:.1e} of its own"),
        );
    };
    for i in 0..roots.len() {
        let difference = found.jtr[i] - expected.jtr[i];
        check(format!("Jᵀρ[{i}]"), difference, largest.sqrt() * root_cost, roots[i] * root_cost);
        for j in 0..=i {
            let difference = found.jtj[(i, j)] - expected.jtj[(i, j)];
            check(format!("JᵀJ[{i}, {j}]"), difference, largest, roots[i] * roots[j]);
        }
    }
}

#[test]
fn lanes_are_the_scalar_kernel() {
    let mut failures = Failures::default();
    let mut taken = 0;
    let capsule = RendererKind::Capsule;
    let spheres = RendererKind::SphereTree { spheres: None };
    for (model_name, model, renderer) in [
        ("upper", builtin::upper_body(), capsule),
        ("full", builtin::full_body(), capsule),
        ("upper", builtin::upper_body(), RendererKind::Cylinder),
        ("full", builtin::full_body(), RendererKind::Cylinder),
        ("upper", builtin::upper_body(), spheres),
        ("upper, own spheres", with_own_spheres(&builtin::upper_body()), spheres),
    ] {
        for (width, height) in [(97, 75), (192, 144), (40, 260), (1, 1), (3, 130)] {
            for (index, ramp) in RAMPS.into_iter().enumerate() {
                for stride in [1, 2, 3, 4] {
                    let seed = (width * 7 + height * 3 + index as u64 * 11 + stride) % 97;
                    let camera = camera(width, height, 0.7 * seed as f64, 3.0);
                    let pose = start::perturb(&model, &Pose::rest(&model), 0.2, 0.05, seed);
                    taken += usize::from(view(&model, &pose, &camera, renderer, ramp).suits_lanes());
                    let data = SampledData::new(&data(&model, &camera, ramp, seed), stride as usize);
                    let name = format!("{model_name} {width}×{height} {renderer} {ramp} stride {stride}");
                    compare(&name, &model, &pose, &camera, (renderer, ramp), &data, &mut failures);
                }
            }
        }
    }
    assert!(taken > 300, "only {taken} views were taken by the lanes");
}

/// A picture of many bands, in which no solid is in all of them; and cameras among and in front of the limbs: whoever takes
/// the view, the sums are those of the reference.
#[test]
fn bands_and_near_and_crossing_limbs_are_the_scalar_kernel_too() {
    let mut failures = Failures::default();
    let model = builtin::upper_body();
    let bands = (0..).zip(RAMPS).map(|(seed, ramp)| ([300, 500], 0.7, 3.0, (0.2, 0.05), seed, ramp));
    let near = (0..)
        .zip([0.05, 0.2, 0.4, 0.6, 0.8, 1.2])
        .flat_map(|(seed, distance)| RAMPS.map(|ramp| ([80, 60], 1.3, distance, (0.3, 0.1), seed, ramp)));
    for ([width, height], turn, distance, (angle, shift), seed, ramp) in bands.chain(near) {
        let camera = camera(width, height, turn * seed as f64, distance);
        let pose = start::perturb(&model, &Pose::rest(&model), angle, shift, seed);
        let data = SampledData::new(&data(&model, &camera, ramp, seed), 1);
        let (name, solid) =
            (format!("{width}×{height}, {distance} m, {ramp}"), (RendererKind::Capsule, ramp));
        compare(&name, &model, &pose, &camera, solid, &data, &mut failures);
    }
}

/// λ from the lanes, grey levels.
const LEVEL_TOLERANCE: f64 = 5e-2;
/// A pixel's row of the Jacobian from the lanes, over the largest row of the picture.
const ROW_TOLERANCE: f64 = 2e-3;
/// A datum this dark makes λ certain: cost = (λ + 255)².
const BELOW_ALL: f32 = -255.0;
/// Pixels whose winners or caps are so close that rounding decides, as a share of all.
const MOST_TIES: f64 = 0.002;

/// λ and its row of the Jacobian in one pixel, by a measurement in which no other pixel weighs anything.
fn one_pixel(
    model: &Model,
    pose: &Pose,
    camera: &Camera,
    pixel: usize,
    accumulate: impl FnOnce(&SampledData, &mut [WrenchBlock]) -> f64,
) -> (f64, nalgebra::DVector<f64>) {
    let pixels = camera.width() * camera.height();
    let mut weights = vec![0.0; pixels];
    weights[pixel] = 1.0;
    let data = Measurement::new(camera.width(), camera.height(), vec![BELOW_ALL; pixels], weights).unwrap();
    let mut blocks = vec![WrenchBlock::default(); model.limbs().len()];
    let cost = accumulate(&SampledData::new(&data, 1), &mut blocks);
    let level = cost.sqrt() + f64::from(BELOW_ALL);
    let residual = f64::from(BELOW_ALL) - level;
    (level, equations(model, pose, camera, &blocks).jtr / residual)
}

/// Pixel by pixel: the same pixels have a gradient, with the same level and the same row of the Jacobian.
#[test]
fn every_pixel_of_the_lanes_is_the_scalar_kernel_s() {
    let mut failures = Failures::default();
    let model = builtin::upper_body();
    let own = with_own_spheres(&model);
    let spheres = RendererKind::SphereTree { spheres: None };
    for (model, renderer) in [
        (&model, RendererKind::Capsule),
        (&model, RendererKind::Cylinder),
        (&model, spheres),
        (&own, spheres),
    ] {
        for (seed, ramp) in RAMPS.into_iter().enumerate() {
            let camera = camera(40, 30, 0.7 * seed as f64, 2.0);
            let pose = start::perturb(model, &Pose::rest(model), 0.2, 0.05, seed as u64);
            let view = view(model, &pose, &camera, renderer, ramp);
            let name = format!("{renderer}, {} spheres of its own, {ramp}", model.limbs()[0].spheres.len());
            let mut memory = KernelMemory::default();
            let mut rows = Vec::new();
            for pixel in 0..40 * 30 {
                let fast = one_pixel(model, &pose, &camera, pixel, |data, blocks| {
                    data.accumulate(&view, &mut memory, blocks)
                });
                let slow = one_pixel(model, &pose, &camera, pixel, |data, blocks| {
                    data.accumulate_scalar(&view, &mut KernelMemory::default(), blocks)
                });
                rows.push((fast, slow));
            }
            let scale = rows.iter().map(|(_, slow)| slow.1.amax()).fold(1.0, f64::max);
            let mut ties = Vec::new();
            for (pixel, ((fast_level, fast_row), (level, row))) in rows.iter().enumerate() {
                let place = format!("{name}, pixel ({}, {})", pixel % 40, pixel / 40);
                failures.near(format_args!("{place}: λ"), *fast_level, *level, LEVEL_TOLERANCE);
                let error = (fast_row - row).amax() / scale;
                if error > ROW_TOLERANCE || !fast_row.iter().all(|x| x.is_finite()) {
                    ties.push(format!("{place}: the Jacobian differs by {error:.1e}"));
                }
            }
            if ties.len() as f64 > MOST_TIES * rows.len() as f64 {
                ties.iter().for_each(|tie| failures.expect(false, format_args!("{tie}")));
            }
        }
    }
}
