use nalgebra::DMatrix;

use super::*;

/// Residuals of two unknowns with their Jacobian; no step is longer than `longest`.
pub(in crate::optimize) struct TwoUnknowns<F> {
    pub(in crate::optimize) evaluate: F,
    pub(in crate::optimize) longest: f64,
}

impl<F: Fn(&[f64; 2]) -> (DMatrix<f64>, DVector<f64>)> LeastSquares for TwoUnknowns<F> {
    type Point = [f64; 2];

    fn evaluate(&mut self, point: &[f64; 2], equations: &mut NormalEquations) {
        let (jacobian, residual) = (self.evaluate)(point);
        equations.jtj = jacobian.tr_mul(&jacobian);
        equations.jtr = jacobian.tr_mul(&residual);
        equations.cost = residual.norm_squared();
    }

    fn columns(&self) -> usize {
        2
    }

    fn retract(&self, point: &[f64; 2], step: &DVector<f64>) -> [f64; 2] {
        [point[0] + step[0], point[1] + step[1]]
    }

    fn cap(&self, step: &mut DVector<f64>) {
        if step.norm() > self.longest {
            *step *= self.longest / step.norm();
        }
    }
}

/// Rosenbrock's valley as two residuals: 1 − x and 10 (y − x²).
fn valley_at(&[x, y]: &[f64; 2]) -> (DMatrix<f64>, DVector<f64>) {
    let jacobian = DMatrix::from_row_slice(2, 2, &[1.0, 0.0, -20.0 * x, 10.0]);
    (jacobian, DVector::from_vec(vec![1.0 - x, -10.0 * (y - x * x)]))
}

fn valley() -> impl LeastSquares<Point = [f64; 2]> {
    TwoUnknowns { evaluate: valley_at, longest: f64::INFINITY }
}

/// Runs to the end.
fn run(
    problem: &mut impl LeastSquares<Point = [f64; 2]>,
    start: [f64; 2],
    options: SolverOptions,
) -> Solver<[f64; 2]> {
    let mut solver = Solver::new(problem, start, options);
    while solver.step(problem).is_some() {}
    solver
}

fn options(method: Method) -> SolverOptions {
    let tolerances = Tolerances::by_gain(Some(1e-14));
    SolverOptions { method, damping: 0.01, least_scale: 0.0, max_iterations: 200, tolerances, run_all: false }
}

/// At the valley's bend a step that is short, by damping or by a cap, gains less than the tolerance.
#[test]
fn a_step_that_was_made_short_is_not_convergence() {
    for start in [[-1.5, 1.0], [-1.2, 1.0], [-12.0, 10.0]] {
        for longest in [f64::INFINITY, 3.0, 0.3, 1e-3] {
            let tolerances = Tolerances::by_gain(Some(1e-3));
            let options =
                SolverOptions { tolerances, max_iterations: 100_000, ..options(Method::LevenbergMarquardt) };
            let mut problem = TwoUnknowns { evaluate: valley_at, longest };
            let solver = run(&mut problem, start, options);
            let (gradient, why) = (solver.equations.jtr.amax(), solver.termination);
            let is_there = solver.cost() < 1e-12 && gradient < 1e-6;
            assert!(is_there, "{start:?}, {longest}: {} {gradient}, {why:?}", solver.cost());
        }
    }
}

#[test]
fn each_test_of_convergence_is_named() {
    let tolerance = 1e-5;
    let only = Tolerances::default();
    let cases = [
        (Tolerances { gain: Some(tolerance), ..only }, Termination::ConvergedByGain { tolerance }),
        (Tolerances { step: Some(tolerance), ..only }, Termination::ConvergedByStep { tolerance }),
        (Tolerances { gradient: Some(tolerance), ..only }, Termination::ConvergedByGradient { tolerance }),
    ];
    for (tolerances, expected) in cases {
        for method in [Method::GaussNewton, Method::LevenbergMarquardt] {
            let options = SolverOptions { tolerances, ..options(method) };
            // A line through three points: the cost at its end is not zero.
            let evaluate = |&[a, b]: &[f64; 2]| {
                let residual = DVector::from_vec(vec![1.0 - a, 3.0 - a - b, 2.0 - a - 2.0 * b]);
                (DMatrix::from_row_slice(3, 2, &[1.0, 0.0, 1.0, 1.0, 1.0, 2.0]), residual)
            };
            let mut line = TwoUnknowns { evaluate, longest: f64::INFINITY };
            let solver = run(&mut line, [-5.0, 7.0], options);
            let [a, b] = solver.point;
            assert_eq!(solver.termination, Some(expected), "{method:?}");
            assert!((a - 1.5).abs() < 2e-2 && (b - 0.5).abs() < 2e-2, "{method:?}: {a} {b}");
        }
    }
}

/// Metres, millimetres or light years: the same way down.
#[test]
fn units_of_columns_do_not_matter() {
    let costs = |units: [f64; 2]| {
        let evaluate = |&[x, y]: &[f64; 2]| {
            let (mut jacobian, residual) = valley_at(&[x * units[0], y * units[1]]);
            jacobian.column_mut(0).scale_mut(units[0]);
            jacobian.column_mut(1).scale_mut(units[1]);
            (jacobian, residual)
        };
        let mut problem = TwoUnknowns { evaluate, longest: f64::INFINITY };
        let start = [-1.2 / units[0], 1.0 / units[1]];
        let mut solver = Solver::new(&mut problem, start, options(Method::LevenbergMarquardt));
        std::iter::from_fn(|| solver.step(&mut problem).map(|iteration| iteration.cost)).take(12).collect()
    };
    let (metres, mixed): (Vec<f64>, Vec<f64>) = (costs([1.0, 1.0]), costs([1024.0, 1.0 / 65_536.0]));
    assert_eq!(metres, mixed, "powers of two change no bit");
}

#[test]
fn levenberg_marquardt_descends_the_valley() {
    let mut solver = Solver::new(&mut valley(), [-1.2, 1.0], options(Method::LevenbergMarquardt));
    let mut cost = solver.cost();
    let mut rejected = 0;
    while let Some(iteration) = solver.step(&mut valley()) {
        assert!(iteration.cost <= cost, "an accepted step never raises the cost");
        assert_eq!(iteration.accepted, iteration.trial_cost < cost);
        rejected += usize::from(!iteration.accepted);
        cost = iteration.cost;
    }
    assert!(rejected > 0, "the valley bends: some step must fail");
    let [x, y] = solver.point;
    assert!((x - 1.0).abs() < 1e-5 && (y - 1.0).abs() < 1e-5, "{x} {y}");
}

#[test]
fn gauss_newton_takes_every_step() {
    let mut solver = Solver::new(&mut valley(), [-1.2, 1.0], options(Method::GaussNewton));
    let mut rose = false;
    while let Some(iteration) = solver.step(&mut valley()) {
        assert!(iteration.accepted);
        rose |= iteration.actual_decrease < 0.0;
    }
    assert!(rose, "undamped steps overshoot here");
}

#[test]
fn ends_say_why() {
    let all = |method| SolverOptions { max_iterations: 600, run_all: true, ..options(method) };
    let (gauss_newton, levenberg_marquardt) = (Method::GaussNewton, Method::LevenbergMarquardt);
    let limit = Termination::StepLimit { steps: 600 };
    for (start, options, expected) in [
        ([1.0, 1.0], options(levenberg_marquardt), Termination::NoGradient),
        ([f64::NAN, 1.0], options(levenberg_marquardt), Termination::NotFinite),
        ([-1.2, 1.0], all(gauss_newton), limit),
        ([1.0, 1.0], all(gauss_newton), limit),
        ([-1.2, 1.0], all(levenberg_marquardt), limit),
        ([1.0, 1.0], all(levenberg_marquardt), limit),
    ] {
        let mut solver = Solver::new(&mut valley(), start, options);
        let steps = std::iter::from_fn(|| solver.step(&mut valley())).count();
        assert_eq!(solver.termination, Some(expected), "{start:?}, {options:?}");
        assert_eq!(steps, if options.run_all { 600 } else { 0 }, "{start:?}, {options:?}");
    }
}
