//! An iteration allocates nothing but what is kept of it.

use std::slice::from_ref;
use std::sync::Arc;

use allocation_counter::measure;
use backlit_tracking::body::{Kinematics, Parameters, Pose, builtin};
use backlit_tracking::camera::{Camera, CameraFromWorld, Distortion, Intrinsics};
use backlit_tracking::fit::{Evidence, FitOptions, FitView, Objective, Preset};
use backlit_tracking::optimize::{LeastSquares, NormalEquations, StepMemory};
use backlit_tracking::render::{Ramp, RendererKind, predict};
use backlit_tracking::search::start;
use backlit_tracking::silhouette::Measurement;
use glam::DVec3;
use nalgebra::DVector;

#[test]
fn evaluating_and_solving_allocate_nothing_after_the_first_time() {
    let model = Arc::new(builtin::full_body());
    let pose = start::perturb(&model, &Pose::rest(&model), 0.1, 0.02, 1);
    let place = CameraFromWorld::looking_at(DVec3::new(0.5, 0.3, 4.0), DVec3::new(0.0, -0.2, 0.0), DVec3::Y);
    let pinhole = Intrinsics { fx: 150.0, fy: 150.0, cx: 95.5, cy: 71.5 };
    let camera = Camera::new("camera", [192, 144], pinhole, Distortion::None, place).unwrap();
    let rest = Kinematics::new(&model, &Pose::rest(&model));
    let lambda = predict(&model, &rest, &camera, RendererKind::Capsule, Ramp::Half).lambda;
    let weights = vec![1.0; lambda.len()];
    let data = Measurement::new(192, 144, lambda, weights).unwrap();
    let view =
        FitView { camera: Arc::new(camera), evidence: Evidence::Measurement(Arc::new(data)), weight: 1.0 };
    let spheres = RendererKind::SphereTree { spheres: None };
    for renderer in [RendererKind::Capsule, RendererKind::Cylinder, spheres] {
        for parameters in [Parameters::Raw, Parameters::Tangent] {
            let options = FitOptions { renderer, parameters, ..FitOptions::preset(Preset::Robust) };
            let stage = options.stages[0];
            let reference = pose.clone();
            let mut objective =
                Objective::new(Arc::clone(&model), from_ref(&view), &[None], &options, stage, reference);
            let mut equations = NormalEquations::zeros(objective.columns());
            let mut step = DVector::zeros(objective.columns());
            let mut memory = StepMemory::default();
            let mut iteration = || {
                equations.clear();
                objective.evaluate(&pose, &mut equations);
                equations.step_into(0.1, &mut memory, &mut step);
                std::hint::black_box(equations.predicted_decrease(&step));
            };
            iteration();
            let found = measure(iteration).count_total;
            assert_eq!(found, 0, "{renderer}, {parameters:?}: {found} allocations");
        }
    }
}
