//! What synthetic people are for, through the public face: the take that comes with the program.

#![expect(clippy::unwrap_used, reason = "helpers of tests, where a panic is the answer")]

mod builtin_take;
mod clocks;
mod errata;
mod given_masks;
mod learnt_plates;
mod own_sizes;
mod turned_round;
mod without_start;
