//! The sums that a fit steps on, against the long way: dense Jacobians for pixels, differences for priors.

use backlit_tracking::body::{Kinematics, Model, Parameters, Pose, builtin};
use backlit_tracking::camera::Camera;
use backlit_tracking::geometry::rotation::{log, swing_twist};
use backlit_tracking::optimize::NormalEquations;
use backlit_tracking::render::wrench::WrenchBlock;
use backlit_tracking::render::{Ramp, RendererKind, View, dense_jacobian, prediction};
use backlit_tracking::residual::point::PointTarget;
use backlit_tracking::residual::silhouette::{KernelMemory, SampledData, StateMap, WorldBlocks};
use backlit_tracking::residual::{Loss, point, pose_prior};
use backlit_tracking::silhouette::Measurement;
use glam::{DQuat, DVec3};
use nalgebra::{DMatrix, DVector};

use crate::fixtures::{self, BOTH, Failures};

/// Largest relative error of sums in f32 lanes. Where two limbs share a joint they tie, and rounding may give
/// such a pixel to either: with raw coefficients its stretch then counts for the other limb.
const FAST_TOLERANCE: f64 = 5e-5;
/// Weights of the two cameras.
const CAMERA_WEIGHTS: [f64; 2] = [1.0, 0.35];

/// Names of the built-in bodies with their up direction.
fn bodies() -> [(&'static str, Model, DVec3); 2] {
    [("upper body", builtin::upper_body(), DVec3::Y), ("full body", builtin::full_body(), DVec3::Z)]
}

/// A bent pose, another for every `phase`; raw quaternions are not of unit length.
fn pose(model: &Model, parameters: Parameters, phase: f64, size: f64) -> Pose {
    fixtures::stretched(model, parameters, [0.1 * size, size], phase)
}

/// Two cameras that see the whole body from a quarter turn apart.
fn cameras(model: &Model, up: DVec3) -> Vec<Camera> {
    crate::vectors::choose();
    let kinematics = Kinematics::new(model, &Pose::rest(model));
    let ends = kinematics.ends();
    let centre = ends.iter().sum::<DVec3>() / ends.len() as f64;
    let radius = ends.iter().map(|end| end.distance(centre)).fold(0.0, f64::max);
    let across = up.any_orthonormal_vector();
    [across, up.cross(across)]
        .iter()
        .map(|side| {
            let intrinsics = [70.0, 72.0, 25.3, 21.8];
            fixtures::camera([52, 44], intrinsics, centre + (*side * 3.5 + up * 0.7) * radius, centre, up)
        })
        .collect()
}

/// A silhouette problem both ways.
struct Problem {
    /// From wrench blocks of the reference kernel.
    sums: NormalEquations,
    /// The same of the kernel that fits use, which may sum in f32 lanes.
    fast_sums: NormalEquations,
    /// √w J and √w ρ of the sampled pixels, cameras one below the other.
    jacobian: DMatrix<f64>,
    residual: DVector<f64>,
}

fn problem(
    model: &Model,
    up: DVec3,
    parameters: Parameters,
    stride: usize,
    renderer: RendererKind,
) -> Problem {
    let ramp = Ramp::Distance { inner_px: 2.0, outer_px: 3.0 };
    let here = Kinematics::new(model, &pose(model, parameters, 0.0, 0.1));
    let there = Kinematics::new(model, &pose(model, Parameters::Tangent, 0.4, 0.12));
    let columns = parameters.columns(model.rotation_count());
    // The reference kernel, and the one that fits use.
    let mut worlds = [WorldBlocks::new(model.limbs().len()), WorldBlocks::new(model.limbs().len())];
    let mut both_sums = [NormalEquations::zeros(columns), NormalEquations::zeros(columns)];
    let (mut rows, mut residual) = (Vec::new(), Vec::new());
    for (camera, camera_weight) in cameras(model, up).iter().zip(CAMERA_WEIGHTS) {
        let data = prediction::levels(&View::new(model, &there, camera, renderer, ramp));
        let data: Vec<f32> = data.iter().map(|&level| level as f32).collect();
        // Weights of every kind, zero among them.
        let weights: Vec<f32> = (0..data.len()).map(|i| ((i * 7) % 5) as f32 * 0.5).collect();
        let data = Measurement::new(camera.width(), camera.height(), data, weights).unwrap();
        let view = View::new(model, &here, camera, renderer, ramp);
        let sampled = SampledData::new(&data, stride);
        for (index, (world, sums)) in worlds.iter_mut().zip(&mut both_sums).enumerate() {
            let mut blocks = vec![WrenchBlock::default(); model.limbs().len()];
            let cost = match index {
                0 => sampled.accumulate_scalar(&view, &mut KernelMemory::default(), &mut blocks),
                _ => sampled.accumulate(&view, &mut KernelMemory::default(), &mut blocks),
            };
            sums.cost += camera_weight * cost;
            world.add(camera, &blocks, camera_weight);
        }
        let dense = dense_jacobian(&view, &here, camera, parameters);
        let levels = prediction::levels(&view);
        for y in (stride / 2..camera.height()).step_by(stride) {
            for x in (stride / 2..camera.width()).step_by(stride) {
                let pixel = y * camera.width() + x;
                let root = (camera_weight * f64::from(data.weights()[pixel])).sqrt();
                rows.push(dense.row(pixel) * root);
                residual.push(root * (f64::from(data.values()[pixel]) - levels[pixel]));
            }
        }
    }
    for (world, sums) in worlds.iter().zip(&mut both_sums) {
        world.add_to(&here, parameters, &mut StateMap::default(), sums);
    }
    let [sums, fast_sums] = both_sums;
    Problem { sums, fast_sums, jacobian: DMatrix::from_rows(&rows), residual: DVector::from_vec(residual) }
}

/// Of every body and parametrisation, every second pixel, by name.
fn problems() -> impl Iterator<Item = (String, Problem)> {
    let of = |(name, model, up): (&str, Model, DVec3)| {
        BOTH.map(|parameters| {
            let problem = problem(&model, up, parameters, 2, RendererKind::Capsule);
            (format!("{name}, {parameters:?}"), problem)
        })
    };
    bodies().into_iter().flat_map(of)
}

/// Columns that nothing but rounding moves count as if their diagonal were this much of the largest.
const LEAST_DIAGONAL: f64 = 1e-6;

/// Differences of JᵀJ, Jᵀρ and cost above a tolerance, by name: over √(dᵢ dⱼ) of JᵀJ's diagonal d and over √dᵢ and the
/// root of the cost, so that metres and radians count alike.
fn compare(
    name: &str,
    found: &NormalEquations,
    jacobian: &DMatrix<f64>,
    residual: &DVector<f64>,
    tolerance: f64,
    failures: &mut Failures,
) {
    let mut check = |what: String, found: f64, expected: f64, scale: f64| {
        failures.near(format_args!("{name}: {what}"), found, expected, tolerance * scale);
    };
    let (jtj, jtr) = (jacobian.tr_mul(jacobian), jacobian.tr_mul(residual));
    let (diagonal, cost) = (jtj.diagonal(), residual.norm_squared());
    let root = diagonal.map(|entry| entry.max(LEAST_DIAGONAL * diagonal.amax()).sqrt());
    for i in 0..jtr.len() {
        check(format!("(Jᵀρ)[{i}]"), found.jtr[i], jtr[i], root[i] * cost.sqrt());
        for j in 0..jtr.len() {
            check(format!("(JᵀJ)[{i}, {j}]"), found.jtj[(i, j)], jtj[(i, j)], root[i] * root[j]);
        }
    }
    check("cost".into(), found.cost, cost, cost);
}

#[test]
fn wrench_sums_are_the_dense_normal_equations() {
    let mut failures = Failures::default();
    for (name, model, up) in bodies() {
        for parameters in BOTH {
            for stride in [1, 2, 3] {
                for renderer in RendererKind::ALL {
                    let problem = problem(&model, up, parameters, stride, renderer);
                    let name = format!("{name}, {renderer}, {parameters:?}, stride {stride}");
                    assert!(problem.sums.cost > 1e5 && problem.sums.jtr.amax() > 1e4, "{name}: too little");
                    let (jacobian, residual) = (&problem.jacobian, &problem.residual);
                    compare(&name, &problem.sums, jacobian, residual, 1e-10, &mut failures);
                    let name = format!("{name}, fast kernel");
                    compare(&name, &problem.fast_sums, jacobian, residual, FAST_TOLERANCE, &mut failures);
                }
            }
        }
    }
}

/// Where a limb keeps the rotation of one that it does not grow from, no rotation before it carries a whole branch, and
/// sums go another way.
#[test]
fn sums_of_limbs_that_lean_on_others_are_the_dense_ones_too() {
    let mut spec = builtin::upper_body().to_spec();
    let hand = spec.limbs.iter_mut().find(|limb| limb.name == "left forearm").unwrap();
    hand.rigid_with = Some("torso".into());
    let model = Model::new(&spec).unwrap();
    let mut failures = Failures::default();
    for parameters in BOTH {
        let problem = problem(&model, DVec3::Y, parameters, 1, RendererKind::Capsule);
        let (jacobian, residual) = (&problem.jacobian, &problem.residual);
        compare(&format!("{parameters:?}"), &problem.sums, jacobian, residual, 1e-10, &mut failures);
    }
}

#[test]
fn the_undamped_step_is_the_dense_least_squares_solution() {
    let mut failures = Failures::default();
    for (name, Problem { sums, jacobian, residual, .. }) in problems() {
        let step = sums.step(0.0);
        // Eigenvalues of JᵀJ below 1e-6 of the largest are null: singular values below 1e-3.
        let svd = jacobian.clone().svd(true, true);
        let largest = svd.singular_values.amax();
        let nulls = svd.singular_values.iter().filter(|value| **value < 1e-3 * largest).count();
        let dense = svd.solve(&residual, 1e-3 * largest).unwrap();
        let error = (&step - &dense).norm() / dense.norm();
        failures.expect(error < 1e-6, format_args!("{name}: {error:.1e} off, {nulls} null directions"));
        let fallen = residual.norm_squared() - (&residual - &jacobian * &step).norm_squared();
        let predicted = sums.predicted_decrease(&step);
        let what = format_args!("{name}: predicted over actual decrease");
        failures.near(what, predicted / fallen, 1.0, 1e-8);
    }
}

#[test]
fn the_damped_step_is_the_augmented_least_squares_solution() {
    let mut failures = Failures::default();
    for (name, Problem { sums, jacobian, residual, .. }) in problems() {
        for damping in [1e-3, 0.1] {
            let (rows, columns) = jacobian.shape();
            let added = (damping * jacobian.tr_mul(&jacobian).diagonal().mean()).sqrt();
            let mut augmented = jacobian.clone().resize_vertically(rows + columns, 0.0);
            for column in 0..columns {
                augmented[(rows + column, column)] = added;
            }
            let data = residual.clone().resize_vertically(rows + columns, 0.0);
            let dense = augmented.svd(true, true).solve(&data, 0.0).unwrap();
            let error = (sums.step(damping) - &dense).norm() / dense.norm();
            failures.expect(error < 1e-8, format_args!("{name}, damping {damping}: {error:.1e} off"));
        }
    }
}

/// Compares what a prior adds with differences of its weighted residuals √w ρ(X), written out again here.
fn check_prior(
    name: &str,
    parameters: Parameters,
    pose: &Pose,
    add: impl Fn(&mut NormalEquations, &Pose),
    residual: impl Fn(&Pose) -> Vec<f64>,
    failures: &mut Failures,
) {
    let columns = parameters.columns(pose.rotations.len());
    let mut equations = NormalEquations::zeros(columns);
    add(&mut equations, pose);
    let here = DVector::from_vec(residual(pose));
    let h = 1e-5;
    let mut jacobian = DMatrix::zeros(here.len(), columns);
    for column in 0..columns {
        let at = |offset: f64| DVector::from_vec(residual(&pose.nudged(parameters, column, offset)));
        // Fourth order; the residual is data − prediction, so J = −∂ρ/∂X.
        let difference = (at(-h) - at(h)) * (8.0 / (12.0 * h)) - (at(-2.0 * h) - at(2.0 * h)) / (12.0 * h);
        jacobian.set_column(column, &difference);
    }
    compare(&format!("{name}, {parameters:?}"), &equations, &jacobian, &here, 1e-8, failures);
    assert!(equations.cost > 0.0, "{name}: nothing to compare");
}

/// √w times some vectors, in one list.
fn weighted(weight: f64, vectors: impl IntoIterator<Item = DVec3>) -> Vec<f64> {
    vectors.into_iter().flat_map(|v| (v * weight.sqrt()).to_array()).collect()
}

#[test]
fn priors_match_differences_of_their_residuals() {
    let mut failures = Failures::default();
    for (name, model, _) in bodies() {
        for parameters in BOTH {
            for (phase, size) in [(0.3, 0.15), (1.7, 0.4), (4.0, 0.6)] {
                let pose = pose(&model, parameters, phase, size);
                let from = |what: &str| format!("{name}, {what}, pose {phase}");

                let reference = self::pose(&model, Parameters::Tangent, 2.1, 0.3);
                let (turn, root) = (30.0, 330.0);
                check_prior(
                    &from("proximal prior"),
                    parameters,
                    &pose,
                    |equations, pose| {
                        let loss = Loss::Squares;
                        let factor = root / turn;
                        pose_prior::add_proximal(equations, parameters, pose, &reference, turn, factor, loss);
                    },
                    |pose| {
                        let turns = pose.rotations.iter().zip(&reference.rotations);
                        let turns = turns.map(|(q, from)| -log((*q * from.inverse()).normalize()));
                        let mut all = weighted(root, [reference.root - pose.root]);
                        all.extend(weighted(turn, turns));
                        all
                    },
                    &mut failures,
                );

                check_prior(
                    &from("rest prior"),
                    parameters,
                    &pose,
                    |equations, pose| pose_prior::add_rest(equations, parameters, &model, pose, 7.0),
                    |pose| {
                        let twist = |(rotation, q): (usize, &DQuat)| {
                            let owner = model.rotation_owners()[rotation];
                            model.rotation_parents()[rotation]?;
                            let axis = model.limbs()[owner].direction;
                            Some(-swing_twist(q.normalize(), axis).twist * 7.0_f64.sqrt())
                        };
                        pose.rotations.iter().enumerate().filter_map(twist).collect()
                    },
                    &mut failures,
                );

                check_point(&from("point"), &model, parameters, &pose, &mut failures);
                if model.limbs().iter().any(|limb| limb.limits.is_some()) {
                    check_limits(&from("limits"), &model, parameters, &pose, &mut failures);
                }
            }
        }
    }
}

fn check_limits(name: &str, model: &Model, parameters: Parameters, pose: &Pose, failures: &mut Failures) {
    let weight = 300.0;
    let excess = |pose: &Pose| {
        let each = model.rotation_owners().iter().zip(&pose.rotations).filter_map(|(&owner, q)| {
            let limb = &model.limbs()[owner];
            let (limits, angles) = (limb.limits?, limb.angles(q.normalize()));
            Some(-DVec3::new(
                limits.flexion.excess(angles.flexion),
                limits.sideways.excess(angles.sideways),
                limits.twist.excess(angles.twist),
            ))
        });
        weighted(weight, each)
    };
    let add = |equations: &mut NormalEquations, pose: &Pose| {
        pose_prior::add_limits(equations, parameters, model, pose, weight);
    };
    check_prior(name, parameters, pose, add, excess, failures);
}

fn check_point(name: &str, model: &Model, parameters: Parameters, pose: &Pose, failures: &mut Failures) {
    let targets = [None, Some(0), Some(3), Some(model.limbs().len() - 1)].map(|limb| PointTarget {
        limb,
        target: DVec3::new(0.2, 0.4, -0.3),
        weight: 2.5,
    });
    for target in targets {
        check_prior(
            &format!("{name} {:?}", target.limb),
            parameters,
            pose,
            |equations, pose| {
                point::add(equations, parameters, &Kinematics::new(model, pose), pose.root, &target);
            },
            |pose| {
                let end = |limb: usize| Kinematics::new(model, pose).ends()[limb];
                weighted(target.weight, [target.target - target.limb.map_or(pose.root, end)])
            },
            failures,
        );
    }
}

#[test]
fn a_pose_within_its_limits_costs_nothing() {
    let model = builtin::full_body();
    let mut equations = NormalEquations::zeros(Parameters::Tangent.columns(model.rotation_count()));
    pose_prior::add_limits(&mut equations, Parameters::Tangent, &model, &Pose::rest(&model), 300.0);
    assert_eq!(equations, NormalEquations::zeros(equations.columns()));
}
