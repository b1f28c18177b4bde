//! One iteration: render, Jacobian, JᵀJ, Jᵀρ, solve, against the naive dense one in the same run.
//!
//! `cargo bench -p backlit-tracking --bench iteration [-- quick]`

#![expect(clippy::expect_used, reason = "a bench may end with a message")]

mod naive;
mod scene;
#[path = "../timing/mod.rs"]
mod timing;

use std::hint::black_box;
use std::time::Duration;

use backlit_tracking::body::{Parameters, Pose};
use backlit_tracking::optimize::{LeastSquares, NormalEquations};
use backlit_tracking::render::{Ramp, RendererKind};
use backlit_tracking::track::{FitOptions, Preset};

use scene::Scene;
use timing::Table;

/// Cameras and their pictures.
const SIZES: [(usize, u64, u64); 4] = [(2, 48, 36), (2, 192, 144), (4, 640, 480), (8, 1920, 1080)];
/// The naive iteration of anything larger needs gigabytes.
const LARGEST_NAIVE_PIXELS: u64 = 4 * 640 * 480;
const DAMPING: f64 = 0.1;

fn main() {
    let quick = std::env::args().any(|argument| argument == "quick");
    let budget = Duration::from_millis(if quick { 1000 } else { 8000 });
    for (count, width, height) in SIZES {
        let scene = Scene::new(width, height, count);
        let mut table = Table::new(format!("One iteration, {count} × {width} × {height}, one thread"));
        for (name, options) in iterations() {
            table = table.add(name, iteration(&scene, &options));
        }
        if count as u64 * width * height <= LARGEST_NAIVE_PIXELS {
            table = table.add("naive dense f64", || {
                let solid = (RendererKind::Capsule, Ramp::Thesis);
                let equations =
                    naive::equations(&scene.model, &scene.pose, &scene.cameras, solid, Parameters::Raw);
                black_box(next(&equations, &scene.pose, Parameters::Raw));
            });
        }
        table.run(budget);
    }
}

fn iterations() -> Vec<(&'static str, FitOptions)> {
    let report = FitOptions::preset(Preset::Report);
    let with = |renderer| FitOptions { renderer, ..report.clone() };
    let tangent = FitOptions {
        parameters: Parameters::Tangent,
        proximal_weight: 30.0,
        rest_weight: 30.0,
        limit_weight: 300.0,
        ..report.clone()
    };
    vec![
        ("capsule, raw Gauss-Newton", report.clone()),
        ("cylinder", with(RendererKind::Cylinder)),
        ("sphere tree", with(RendererKind::SphereTree { spheres: None })),
        ("capsule, tangent, priors", tangent),
    ]
}

fn iteration<'a>(scene: &'a Scene, options: &FitOptions) -> impl FnMut() + 'a {
    let mut objective = scene.objective(options, options.stages[0]);
    let mut equations = NormalEquations::zeros(objective.columns());
    let parameters = options.parameters;
    move || {
        equations.clear();
        objective.evaluate(&scene.pose, &mut equations);
        black_box(next(&equations, &scene.pose, parameters));
    }
}

/// Solves, foretells the decrease and moves the pose.
fn next(equations: &NormalEquations, pose: &Pose, parameters: Parameters) -> (f64, Pose) {
    let step = equations.step(DAMPING);
    (equations.predicted_decrease(&step), pose.retract(parameters, step.as_slice()))
}
