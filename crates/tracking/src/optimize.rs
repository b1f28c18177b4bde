//! Least squares: normal equations and the two ways of stepping on them. Knows nothing of bodies or cameras.
//!
//! A problem gives residuals ρ(X) = data − prediction with J = ∂prediction/∂X; a step solves
//! (JᵀJ + damping) δ = Jᵀρ and X moves by its own [`retract`](LeastSquares::retract). The cost is Σ w ρ².
//!
//! | | |
//! |---|---|
//! | [`LeastSquares`] | a problem, evaluated as [`NormalEquations`] |
//! | [`NormalEquations`] | JᵀJ, Jᵀρ and the cost; sums of them; damped solution |
//! | [`Solver`] | steps a problem by a [`Method`]: [`SolverOptions`] in, one [`Iteration`] a step |
//! | [`descend`] | Levenberg-Marquardt on a problem that solves its own equations ([`StructuredLeastSquares`]) |
//! | [`Tolerances`] | when it has converged, by gain, step and gradient; [`Termination`]: why it stopped |
//! | [`gradient_check`] | analytic derivatives against differences, all mismatches by name |

mod cholesky;
pub mod gradient_check;
mod levenberg_marquardt;
mod normal_equations;
mod solver;
mod termination;

pub use levenberg_marquardt::{DescentOptions, StructuredLeastSquares, descend};
pub use normal_equations::{NormalEquations, StepMemory};
pub use solver::{Iteration, LeastSquares, Method, ParseMethodError, Solver, SolverOptions};
pub use termination::{Termination, Tolerances};
