//! What the window and the command line say and write of results alike.
//!
//! | module | holds |
//! |---|---|
//! | [`basin`] | the basin of a frame: ways of fitting that are compared, results, tables, pictures |
//! | [`motions`] | tracks as the recognizer reads them, and its models |
//! | [`observability`] | what cameras see of a pose, in words |

pub mod basin;
pub mod motions;
pub mod observability;
