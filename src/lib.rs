//! The inspector.

pub mod action;
pub mod cli;
pub mod document;
pub mod edit;
pub mod format;
pub mod history;
pub mod panels;
pub mod picture;
pub mod project;
pub mod raster;
pub mod selection;
pub mod theme;
pub mod widgets;
