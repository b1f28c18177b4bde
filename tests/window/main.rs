//! The real window without a display: driven by label and role, looked at through the CPU painter.
//!
//! One program for all of them: each would weigh what the window weighs.

#![expect(clippy::unwrap_used, reason = "helpers of tests, where a panic is the answer")]

mod background;
mod basin;
mod bookmarks;
mod camera_check;
mod camera_plan;
mod camera_refinement;
mod camera_tile;
mod changed_backgrounds;
mod compare;
mod cues;
mod curves;
mod demonstrations;
mod docking;
mod drop;
mod export;
mod exported_state;
mod failing_disk;
mod first_users;
#[path = "../../crates/tracking/tests/tracking/footage.rs"]
mod footage;
mod laboratory;
mod names;
mod new_take;
mod observability;
mod opening;
mod painter;
mod panels;
mod people;
mod posing;
mod readable;
mod recovery;
mod scene;
mod silhouettes;
mod support;
mod timeline;
mod tour;
mod workflow;
