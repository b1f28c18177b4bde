//! Demonstrations: the report's experiments, prepared so that the window shows them. They are takes made in memory,
//! with runs of the fit that begin by themselves, and a sentence or two that say what to look at.
//!
//! | file | holds |
//! |---|---|
//! | `kind` | [`Demonstration`]: which there are, their names and explanations |
//! | `runs` | the fits that each shows |
//! | `take` | the simulated take of each |
//! | `real` | the real footage in small pictures |

pub(crate) mod kind;
pub(crate) mod real;
pub(crate) mod runs;
pub(crate) mod take;

pub use kind::Demonstration;
pub(crate) use runs::PreparedRun;
pub(crate) use take::UNKNOWN_GREY;
