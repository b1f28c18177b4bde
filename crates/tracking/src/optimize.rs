//! Least squares: normal equations and the two ways of stepping on them. Knows nothing of bodies or cameras.
//!
//! A problem gives residuals ρ(X) = data − prediction with J = ∂prediction/∂X; a step solves
//! (JᵀJ + damping) δ = Jᵀρ and X moves by its own [`retract`](LeastSquares::retract). The cost is Σ w ρ².
//!
//! A [`Solver`] steps a [`LeastSquares`] problem by a [`Method`]; [`descend`] is Levenberg-Marquardt on a problem that solves
//! its own equations.

mod cholesky;
pub mod gradient_check;
mod levenberg_marquardt;
mod normal_equations;
mod solver;
mod termination;

pub use cholesky::Cholesky as StepMemory;
pub use levenberg_marquardt::{DescentOptions, StructuredLeastSquares, descend};
pub use normal_equations::NormalEquations;
pub use solver::{Iteration, LeastSquares, Method, ParseMethodError, Solver, SolverOptions};
pub use termination::{Termination, Tolerances};
