//! The damped step of an iteration's normal equations: ours, by nalgebra's Cholesky and by faer's.
//!
//! `cargo run --release --manifest-path crates/tracking/benches/factors/Cargo.toml`

#[path = "../../iteration/scene.rs"]
mod scene;
#[path = "../../timing.rs"]
mod timing;

use std::hint::black_box;
use std::time::Duration;

use backlit_tracking::fit::{FitOptions, Preset};
use backlit_tracking::optimize::{LeastSquares, NormalEquations, StepMemory};
use faer::linalg::solvers::Solve;
use faer::{Col, Mat, Side};
use nalgebra::DVector;

const DAMPING: f64 = 0.1;
const BUDGET: Duration = Duration::from_secs(4);

fn main() {
    let scene = scene::Scene::new(192, 144, 2);
    let options = FitOptions::preset(Preset::Report);
    let mut objective = scene.objective(&options, options.stages[0]);
    let mut equations = NormalEquations::zeros(objective.columns());
    objective.evaluate(&scene.pose, &mut equations);
    let (columns, added) = (equations.columns(), DAMPING * equations.mean_diagonal());
    let (mut step, mut memory) = (DVector::zeros(columns), StepMemory::default());

    let by_nalgebra = || {
        let mut damped = equations.jtj.clone();
        (0..columns).for_each(|column| damped[(column, column)] += added);
        damped.cholesky().map(|factor| factor.solve(&equations.jtr))
    };
    let by_faer = || {
        let damped = Mat::from_fn(columns, columns, |row, column| {
            equations.jtj[(row, column)] + if row == column { added } else { 0.0 }
        });
        let right = Col::from_fn(columns, |row| equations.jtr[row]);
        damped.llt(Side::Lower).map(|factor| factor.solve(&right))
    };

    // All three must find the same step but for its sign, or their times say nothing.
    equations.step_into(DAMPING, &mut memory, &mut step);
    let (nalgebra, faer) = (by_nalgebra().expect("a factor"), by_faer().expect("a factor"));
    for row in 0..columns {
        let tolerance = 1e-9 * step.amax();
        assert!((step[row].abs() - nalgebra[row].abs()).abs() < tolerance, "nalgebra, row {row}");
        assert!((step[row].abs() - faer[row].abs()).abs() < tolerance, "faer, row {row}");
    }

    timing::Table::new(format!("The damped step, {columns} columns"))
        .add("ours", || equations.step_into(DAMPING, &mut memory, &mut step))
        .add("by nalgebra's Cholesky", || {
            black_box(by_nalgebra());
        })
        .add("by faer's Cholesky", || {
            black_box(by_faer().ok());
        })
        .run(BUDGET);
}
