//! Where a take comes from: a folder, the built-in one, demonstrations, motions without footage, files that are dropped on the window.

pub mod builtin;
pub mod demonstration;
pub mod dropped;
pub mod motion;
pub mod source;
