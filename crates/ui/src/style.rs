//! How everything looks: colours, sizes, and the form of every number.

pub mod format;
pub mod theme;
