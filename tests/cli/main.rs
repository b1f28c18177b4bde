//! The built program, run as people and programs run it.

#![expect(clippy::unwrap_used, reason = "helpers of tests may panic")]

mod camera_plan;
mod cameras;
mod changed_backgrounds;
mod check;
mod compare;
#[path = "../window/support/disturbed_take.rs"]
mod disturbed_take;
mod experiment;
mod export;
mod fit;
mod fit_body;
#[path = "../../crates/tracking/tests/tracking/footage.rs"]
mod footage;
mod formats;
mod golden;
mod import;
mod join;
mod observability;
mod people;
mod person;
mod placement;
mod prior;
mod project_take;
mod real_footage;
mod recognise;
mod refine_cameras;
mod render;
mod report;
mod scene;
mod screenshot;
mod sphere_tree;
mod synth;
mod take_remarks;
mod track;
mod words;
