//! Long work on a take, without a window: what the command line and the inspector both drive.

pub mod basin;
pub mod camera_check;
pub mod camera_plan;
pub mod camera_refinement;
pub mod changes;
pub mod comparison;
pub mod imported_motion;
pub mod initialisation;
pub mod motions;
pub mod people;
pub mod person;
pub mod report;
pub mod results;
pub mod silhouettes;
pub mod track;
pub mod track_summary;
