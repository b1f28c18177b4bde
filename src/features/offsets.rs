//! Cameras that were started apart: two of them side by side, one shifted by eye or all as the silhouettes say.
//!
//! | file | holds |
//! |---|---|
//! | `card` | the card with both pictures and the shifts |
//! | `job` | pictures read, and the search for the shifts |
//! | `update` | opened, what was read and found taken in, written to the take |

mod card;
mod job;
#[cfg(test)]
mod tests;
mod update;

use std::path::PathBuf;
use std::sync::Arc;

use backlit_formats::synchronise::TakeClocks;
use backlit_jobs::Task;
use egui::ColorImage;
use glam::DVec2;

use crate::context::priority;

/// The feature.
#[derive(Debug)]
pub(crate) struct Offsets {
    /// The cameras of the left and of the right picture.
    shown: [usize; 2],
    /// The frame of the take.
    frame: usize,
    /// How many of its own frames each camera is shifted by, beside what the take says.
    shifts: Vec<i64>,
    sides: [Side; 2],
    /// A place in a picture, and which: the other picture shows the line on which it can be.
    pointed_at: Option<(usize, DVec2)>,
    find: Task<(), job::Said>,
    /// How far the search is: frames done, and in all.
    progress: Option<[usize; 2]>,
    found: Option<Result<Box<TakeClocks>, String>>,
    write: Task<(), Result<(), String>>,
    /// The take that is written to.
    path: PathBuf,
}

/// One of the two pictures.
#[derive(Debug)]
struct Side {
    task: Task<job::Wanted, job::Picture>,
    /// The picture that was read last, and of what.
    picture: Option<(job::Wanted, Arc<ColorImage>)>,
    /// Why there is none.
    problem: Option<String>,
}

impl Default for Side {
    fn default() -> Self {
        Self { task: Task::new(priority::FRAME), picture: None, problem: None }
    }
}

impl Default for Offsets {
    fn default() -> Self {
        Self {
            shown: [0, 1],
            frame: 0,
            shifts: Vec::new(),
            sides: Default::default(),
            pointed_at: None,
            find: Task::new(priority::TRACK),
            progress: None,
            found: None,
            write: Task::new(priority::EXPORT),
            path: PathBuf::new(),
        }
    }
}
