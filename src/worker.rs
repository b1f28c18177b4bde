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

use backlit_lab::experiment::basin_map::Cell;
use backlit_lab::experiment::frame_basin::Trial;
use backlit_tracking::body_fit::BodyFit;
use backlit_tracking::search::Hypothesis;
use backlit_tracking::visual_hull::VisualHull;

use crate::app::open_job::OpenedProject;
use crate::document::Estimate;
use crate::document::edit::Edit;
use crate::document::run::{RunEnding, RunStep};
use crate::features::laboratory::job::LaboratoryEvent;
use crate::features::observability::observed::Observed;
use crate::features::scene::SceneDrawing;
use crate::session::prediction::Predicted;
use crate::session::{Extent, FrameData};
use crate::take::footage::Footage;

/// What the jobs say.
#[derive(Debug)]
pub enum Event {
    /// A take was opened, and the project that named it, if it was one.
    TakeOpened {
        /// The take.
        footage: Arc<Footage>,
        /// The project and its file.
        project: Option<OpenedProject>,
    },
    /// The take of a project is not where it was.
    TakeMissing {
        /// The project.
        project: PathBuf,
        /// What is missing.
        why: String,
    },
    /// A frame was read and segmented.
    FrameLoaded(Arc<FrameData>),
    /// Where the subject is over the whole take, by camera.
    Surveyed(Vec<Option<Extent>>),
    /// What a pose predicts.
    Predicted(Arc<Predicted>),
    /// The visual hull of a frame, if its silhouettes leave one.
    HullCarved(Arc<FrameData>, Option<Arc<VisualHull>>),
    /// The 3-D scene as it was ordered.
    SceneDrawn(Arc<SceneDrawing>),
    /// What the cameras see of a pose, and what they do not.
    Observed(Arc<Observed>),
    /// A step of the fit; the first is the start.
    FitStep(Box<RunStep>, Arc<Predicted>),
    /// The fit has ended or was stopped; `None` if it may go on.
    FitEnded(Option<RunEnding>),
    /// A frame was tracked.
    FrameTracked(usize, Arc<Estimate>),
    /// What was tracked before is now known better: smoothed by later frames, or joined with another track.
    TrackRevised(Vec<(usize, Arc<Estimate>)>),
    /// Two tracks were joined after this frame; so far apart were their joints there, metres.
    TracksJoined {
        /// The last frame of the forward track.
        frame: usize,
        /// Mean distance of the joints.
        distance_m: f64,
        /// Whether that is one movement.
        meets: bool,
    },
    /// Other poses that fit a frame, best first.
    PosesFound(usize, Vec<Hypothesis>),
    /// The body's own sizes were found.
    BodyFitted(Box<BodyFit>),
    /// A project was written.
    Saved {
        /// The file.
        path: PathBuf,
        /// The document's revision.
        revision: u64,
    },
    /// A project was not written; why, and what can be done.
    NotSaved(String),
    /// The footage is seen by other cameras.
    Recalibrated(Arc<Footage>),
    /// Dropped files were read.
    TakenIn {
        /// The change of the document.
        edit: Box<Edit>,
        /// What is said of it.
        said: String,
    },
    /// The laboratory's news.
    Laboratory(Box<LaboratoryEvent>),
    /// The copy of unsaved work was written.
    CopySaved {
        /// The document's revision.
        revision: u64,
    },
    /// The settings were written, or why they were not.
    SettingsWritten(Result<(), String>),
    /// The copy of unsaved work was not written; why.
    CopyFailed(String),
    /// Something did not work; what it was.
    Failed(String),
}

/// What the jobs of the second worker say: of experiments and of files.
#[derive(Debug)]
pub enum BackgroundEvent {
    /// A fit of a basin.
    BasinTrial(Trial),
    /// A cell of a basin's map.
    BasinCell(Cell),
    /// A file was written.
    Written(PathBuf),
    /// Something did not work; what it was.
    Failed(String),
}
