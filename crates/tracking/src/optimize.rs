//! Least squares: normal equations and the two ways of stepping on them. Knows nothing of bodies or cameras.
//!
//! A problem gives residuals ρ(X) = data − prediction with J = ∂prediction/∂X; a step solves
//! (JᵀJ + damping) δ = Jᵀρ and X moves by its own [`retract`](LeastSquares::retract). The cost is Σ w ρ².
//!
//! | file | holds |
//! |---|---|
//! | [`normal_equations`] | JᵀJ, Jᵀρ and the cost; sums of them; damped solution |
//! | `cholesky` | factors and solves some tens of columns in lanes |
//! | [`solver`] | options, one record an iteration, why it ended; the stepping [`Solver`] |
//! | [`gauss_newton`] | the report's step (4.10) with a fixed damping |
//! | [`levenberg_marquardt`] | trust by damping: a step that raises the cost is taken back |
//! | [`gradient_check`] | analytic derivatives against differences, all mismatches by name |

mod cholesky;
pub mod gauss_newton;
pub mod gradient_check;
pub mod levenberg_marquardt;
pub mod normal_equations;
pub mod solver;

pub use gradient_check::GradientCheck;
pub use normal_equations::{NormalEquations, StepMemory};
pub use solver::{Iteration, LeastSquares, Method, Solver, SolverOptions, Termination};
