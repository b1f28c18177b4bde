//! The inspector and the command line.

pub mod app;
pub mod cli;
pub mod context;
pub mod features;
pub mod session;
pub mod shell;
