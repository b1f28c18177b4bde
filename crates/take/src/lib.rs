//! Footage: where a take comes from, its pictures as the window wants them, the built-in one, demonstrations, and what a user
//! puts in the place of a take's own cameras and silhouettes.

pub mod builtin;
pub mod demonstration;
pub mod dropped;
pub mod footage;
pub mod replacement;
pub mod source;
