//! The inspector and the command line.

pub mod app;
pub mod cli;
pub mod context;
pub mod document;
pub mod features;
pub mod session;
pub mod shell;
pub mod take;
