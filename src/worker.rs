//! The threads that work while the window draws: typed jobs in, events out.
//!
//! Every kind of work has a [`Lane`]. A new job supersedes the one of its lane: that one is cancelled, and
//! events of it that are still on their way are dropped by their generation. What the screen waits for, the 3-D scene,
//! files, and what takes its time have a thread each, so neither a drag nor the copy of unsaved work waits for a tracker. Jobs
//! work in steps, the most urgent lane of a thread first. Dropping the [`Worker`] cancels everything but what is to
//! be saved. A panic in a job is an event, and the thread lives on.

mod queue;

use std::path::PathBuf;
use std::sync::Arc;

pub use queue::{Job, Lane, Outbox, Report, Step, Worker};

use crate::app::open_job::OpenedProject;
use crate::document::edit::Edit;
use crate::document::run::{RunEnding, RunStep};
use crate::session::prediction::Predicted;
use crate::session::{Extent, FrameData};
use crate::take::footage::Footage;

/// What the jobs say.
#[derive(Debug)]
pub enum Event {
    /// A frame was read and segmented.
    FrameLoaded(Arc<FrameData>),
    /// A step of the fit; the first is the start.
    FitStep(Box<RunStep>, Arc<Predicted>),
    /// The fit has ended or was stopped; `None` if it may go on.
    FitEnded(Option<RunEnding>),
    /// Something did not work; what it was.
    Failed(String),
}
