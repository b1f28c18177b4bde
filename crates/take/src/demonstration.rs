//! Demonstrations: the report's experiments, prepared so that the window shows them. They are takes made in memory,
//! with fits that the laboratory shows side by side, and a sentence or two that say what to look at.
//!
//! | file | holds |
//! |---|---|
//! | `kind` | [`Demonstration`]: which there are, their names and explanations |
//! | `choices` | the fits that each shows |
//! | `take` | the simulated take of each |
//! | `carved` | a figure before four cameras, its poses known |
//! | `occluded` | squats that silhouettes do not hold |
//! | `real` | the real footage in small pictures |

mod carved;
pub mod choices;
pub mod kind;
mod occluded;
pub mod real;
pub mod take;

pub use kind::Demonstration;
