//! The tracking core through its public face: what it computes, what it does with bad input.

#![expect(clippy::unwrap_used, reason = "helpers of tests, where a panic is the answer")]

mod acquisition;
mod bad_evidence;
mod bad_input;
mod camera_plan;
mod cues;
mod drawing;
mod errata;
mod finite_differences;
mod fit;
mod fixtures;
mod footage;
mod golden;
mod initialisation;
mod kernel_parity;
mod lens_distortion;
mod lost_limb;
mod more_garbow_hillstrom;
mod motion;
mod normal_equations;
mod observability;
mod particles;
mod robust_terms;
mod segment_footage;
mod sphere_trees;
mod synchronise;
mod templates;
mod vectors;
