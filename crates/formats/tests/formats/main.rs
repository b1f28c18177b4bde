//! Files through the public face of their readers: whole takes, real ones, and damaged bytes.

#![expect(clippy::unwrap_used, reason = "helpers of tests, where a panic is the answer")]

mod bombs;
mod calibration_files;
mod calibration_texts;
#[path = "../../src/damaged.rs"]
mod damaged;
#[path = "../../../tracking/tests/tracking/footage.rs"]
mod footage;
mod given_masks;
mod import;
mod import_projects;
mod keypoint_files;
mod motion_files;
mod real_take;
mod recordings;
mod small_videos;
mod take_files;
mod take_outside;
mod take_videos;
mod video_files;
mod video_makings;
mod videos;
