//! The features, one folder each: all of a feature is in its folder, and it is known elsewhere only to the shell and the app.

pub mod basin;
pub(crate) mod beginnings;
pub mod camera_views;
pub(crate) mod convergence;
pub(crate) mod demonstrations;
pub mod export;
pub(crate) mod fit;
pub mod laboratory;
pub(crate) mod motions;
pub(crate) mod new_take;
pub(crate) mod observability;
pub(crate) mod offsets;
pub(crate) mod pose;
pub mod recovery;
pub mod scene;
pub(crate) mod timeline;
pub(crate) mod tour;
pub(crate) mod tracking;

/// All features, by name.
#[derive(Debug, Default)]
pub(crate) struct Features {
    pub(crate) basin: basin::Basin,
    pub(crate) beginnings: beginnings::Beginnings,
    pub(crate) camera_views: camera_views::CameraViews,
    pub(crate) convergence: convergence::Convergence,
    pub(crate) demonstrations: demonstrations::Demonstrations,
    pub(crate) export: export::Export,
    pub(crate) fit: fit::Fit,
    pub(crate) laboratory: laboratory::Laboratory,
    pub(crate) motions: motions::Motions,
    pub(crate) new_take: new_take::NewTake,
    pub(crate) observability: observability::Observability,
    pub(crate) offsets: offsets::Offsets,
    pub(crate) pose: pose::Posing,
    pub(crate) recovery: recovery::Recovery,
    pub(crate) scene: scene::Scene,
    pub(crate) timeline: timeline::Timeline,
    pub(crate) tour: tour::Tour,
    pub(crate) tracking: tracking::Tracking,
}
