//! The inspector and the command line.

pub mod app;
pub mod cli;
pub mod context;
pub mod document;
pub mod drawing;
pub mod features;
pub mod jobs;
pub mod session;
pub mod shell;
pub mod style;
pub mod take;
pub mod widgets;
