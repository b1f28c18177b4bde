//! One iteration: render, Jacobian, JᵀJ, Jᵀρ, solve, against the naive dense one in the same run.
//!
//! `cargo bench -p backlit-tracking --bench iteration [-- quick]`

#![expect(clippy::expect_used, reason = "a bench may end with a message")]

mod naive;
mod pictures;
mod scene;
#[path = "../timing.rs"]
mod timing;

use std::hint::black_box;
use std::time::Duration;

use backlit_tracking::body::{Kinematics, Parameters};
use backlit_tracking::fit::{FitOptions, Preset};
use backlit_tracking::optimize::{LeastSquares, NormalEquations, StepMemory};
use backlit_tracking::render::wrench::WrenchBlock;
use backlit_tracking::render::{Ramp, RendererKind, View};
use backlit_tracking::residual::silhouette::{KernelMemory, SampledData, StateMap, WorldBlocks};
use nalgebra::DVector;
use rayon::ThreadPoolBuilder;

use scene::Scene;
use timing::Table;

/// Cameras and their pictures.
const SIZES: [(usize, u64, u64); 4] = [(2, 48, 36), (2, 192, 144), (4, 640, 480), (8, 1920, 1080)];
/// The naive iteration of anything larger needs gigabytes.
const LARGEST_NAIVE_PIXELS: u64 = 4 * 640 * 480;
const DAMPING: f64 = 0.1;

fn main() {
    // Tables are of one thread but where they say otherwise.
    ThreadPoolBuilder::new().num_threads(1).build_global().expect("one thread");
    let quick = std::env::args().any(|argument| argument == "quick");
    let budget = Duration::from_millis(if quick { 1000 } else { 8000 });
    pictures::tables(budget);
    if std::env::args().any(|argument| argument == "pictures") {
        return;
    }
    for (count, width, height) in SIZES {
        let scene = Scene::new(width, height, count);
        let title = format!("{count} × {width} × {height}");
        let mut table = Table::new(format!("One iteration, {title}, one thread"));
        for (name, options) in iterations() {
            table = table.add(name, iteration(&scene, &options));
        }
        if count as u64 * width * height <= LARGEST_NAIVE_PIXELS {
            table = table.add("naive dense f64", || {
                let solid = (RendererKind::Capsule, Ramp::Thesis);
                let equations =
                    naive::equations(&scene.model, &scene.pose, &scene.cameras, solid, Parameters::Raw);
                let step = equations.step(DAMPING);
                black_box(equations.predicted_decrease(&step));
                black_box(scene.pose.retract(Parameters::Raw, step.as_slice()));
            });
        }
        table.run(budget);
        parts(&scene, &title, budget / 4);
        threads(&scene, &title, budget / 4);
    }
}

/// What an iteration consists of, each part by itself.
fn parts(scene: &Scene, title: &str, budget: Duration) {
    let (model, parameters) = (&*scene.model, Parameters::Raw);
    let (renderer, ramp) = (RendererKind::Capsule, Ramp::Thesis);
    let kinematics = Kinematics::new(model, &scene.pose);
    let mut moved = kinematics.clone();
    let mut cameras: Vec<(View, SampledData, KernelMemory, Vec<WrenchBlock>)> = scene
        .cameras
        .iter()
        .map(|(camera, data)| {
            let view = View::new(model, &kinematics, camera, renderer, ramp);
            let blocks = vec![WrenchBlock::default(); model.limbs().len()];
            (view, SampledData::new(data, 1), KernelMemory::default(), blocks)
        })
        .collect();
    let mut winners = cameras.clone();
    let mut views = cameras.clone();
    for (view, data, memory, blocks) in &mut cameras {
        data.accumulate(view, memory, blocks);
    }
    let blocks: Vec<Vec<WrenchBlock>> = cameras.iter().map(|(.., blocks)| blocks.clone()).collect();
    let mut equations = NormalEquations::zeros(parameters.columns(model.rotation_count()));
    let mut world = WorldBlocks::new(model.limbs().len());
    let mut state_map = StateMap::default();
    let mut map = |equations: &mut NormalEquations| {
        equations.clear();
        world.clear();
        for ((camera, _), blocks) in scene.cameras.iter().zip(&blocks) {
            world.add(camera, blocks, 1.0);
        }
        world.add_to(&kinematics, parameters, &mut state_map, equations);
    };
    map(&mut equations);
    let solved = equations.clone();
    let (mut step, mut memory) = (DVector::zeros(solved.columns()), StepMemory::default());
    let (mut other_step, mut other_memory) = (step.clone(), StepMemory::default());
    Table::new(format!("Its parts, capsule, raw, {title}"))
        .add("spans, winners, cost", || {
            for (view, data, memory, _) in &mut winners {
                black_box(data.cost(view, memory));
            }
        })
        .add("the same and gradients", || {
            for (view, data, memory, blocks) in &mut cameras {
                blocks.fill(WrenchBlock::default());
                black_box(data.accumulate(view, memory, blocks));
            }
        })
        .add("kinematics", || moved.update(model, black_box(&scene.pose)))
        .add("solids in camera axes", || {
            for ((view, ..), (camera, _)) in views.iter_mut().zip(&scene.cameras) {
                view.prepare(model, &kinematics, camera, renderer, ramp);
            }
        })
        .add("map to the state", || map(&mut equations))
        .add("solve", || {
            solved.step_into(DAMPING, &mut memory, &mut step);
            black_box(solved.predicted_decrease(&step));
        })
        .add("its step by nalgebra", || {
            let mut damped = solved.jtj.clone();
            let added = DAMPING * solved.mean_diagonal();
            for column in 0..solved.columns() {
                damped[(column, column)] += added;
            }
            black_box(damped.cholesky().map(|factor| factor.solve(&solved.jtr)));
        })
        .add("its step", || solved.step_into(DAMPING, &mut other_memory, &mut other_step))
        .run(budget);
}

/// One thread against two.
fn threads(scene: &Scene, title: &str, budget: Duration) {
    let pool = |threads| ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    let (one, two) = (pool(1), pool(2));
    let options = FitOptions::preset(Preset::Report);
    let (mut on_one, mut on_two) = (iteration(scene, &options), iteration(scene, &options));
    Table::new(format!("Threads, capsule, raw, {title}"))
        .add("one thread", || one.install(&mut on_one))
        .add("two threads", || two.install(&mut on_two))
        .run(budget);
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

fn iteration<'a>(scene: &'a Scene, options: &FitOptions) -> impl FnMut() + Send + use<'a> {
    let mut objective = scene.objective(options, options.stages[0]);
    let mut equations = NormalEquations::zeros(objective.columns());
    let (mut step, mut memory) = (DVector::zeros(objective.columns()), StepMemory::default());
    let parameters = options.parameters;
    move || {
        equations.clear();
        objective.evaluate(&scene.pose, &mut equations);
        equations.step_into(DAMPING, &mut memory, &mut step);
        black_box(equations.predicted_decrease(&step));
        black_box(scene.pose.retract(parameters, step.as_slice()));
    }
}
