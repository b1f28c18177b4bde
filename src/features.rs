//! The features, one folder each: all of a feature is in its folder, and it is known elsewhere only to the shell and the app.

pub mod basin;
pub mod camera_views;
pub mod convergence;
pub(crate) mod demonstration;
pub mod export;
pub(crate) mod fit;
pub mod laboratory;
pub mod observability;
pub(crate) mod pose;
pub mod recovery;
pub mod scene;
pub(crate) mod timeline;
pub(crate) mod tour;
pub(crate) mod tracking;
