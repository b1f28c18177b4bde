//! The one thread that works while the window draws: typed jobs in, events out.
//!
//! Every kind of work has a [`Lane`]. A new job supersedes the one of its lane: that one is cancelled, and
//! events of it that are still on their way are dropped by their generation. Jobs work in short steps, so a
//! prediction for a drag does not wait for a tracker. Dropping the [`Worker`] cancels everything. A panic in a
//! job is an event, and the thread lives on.

mod body;
mod calibrate;
mod fit;
mod hull;
mod laboratory;
mod load;
mod open;
mod predict;
mod queue;
mod save;
mod survey;
mod take_in;
mod track;
mod write;

use std::path::PathBuf;
use std::sync::Arc;

pub use body::BodyJob;
pub use calibrate::CalibrateJob;
pub use fit::{FitJob, FitStart, LiveFit};
pub use hull::HullJob;
pub use laboratory::{
    LaboratoryCheckJob, LaboratoryEvent, LaboratoryJob, LaboratoryLookJob, LaboratoryPlotJob, LiveLaboratory,
};
pub use load::LoadJob;
pub use open::OpenJob;
pub use predict::{CameraPrediction, Derivatives, PredictJob, Predicted, Scene};
pub use queue::{Job, Lane, Outbox, Report, Step, Worker};
pub use save::SaveJob;
pub use survey::{Extent, SurveyJob};
pub use take_in::TakeInJob;
pub use track::TrackJob;
pub use write::WriteJob;

use backlit_tracking::track::fit_body::BodyFit;
use backlit_tracking::track::visual_hull::VisualHull;

use crate::document::{Document, Estimate};
use crate::edit::Edit;
use crate::footage::Footage;
use crate::session::{FrameData, RunEnding, RunStep};

/// What the jobs say.
#[derive(Debug)]
pub enum Event {
    /// A take was opened, and the project that named it, if it was one.
    TakeOpened {
        /// The take.
        footage: Arc<Footage>,
        /// The project and its file.
        project: Option<(Box<Document>, PathBuf)>,
    },
    /// A frame was read and segmented.
    FrameLoaded(Arc<FrameData>),
    /// Where the subject is over the whole take, by camera.
    Surveyed(Vec<Option<Extent>>),
    /// What a pose predicts.
    Predicted(Arc<Predicted>),
    /// The visual hull of a frame, if its silhouettes leave one.
    HullCarved(Arc<FrameData>, Option<Arc<VisualHull>>),
    /// A step of the fit; the first is the start.
    FitStep(Box<RunStep>, Arc<Predicted>),
    /// The fit has ended or was stopped; `None` if it may go on.
    FitEnded(Option<RunEnding>),
    /// A frame was tracked.
    FrameTracked(usize, Arc<Estimate>),
    /// The body's own sizes were found.
    BodyFitted(Box<BodyFit>),
    /// A project was written.
    Saved {
        /// The file.
        path: PathBuf,
        /// The document's revision.
        revision: u64,
        /// Whether it is the copy for the next start.
        is_autosave: bool,
    },
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
    /// Something did not work; what it was.
    Failed(String),
}

/// What the jobs of the second worker say: of experiments and of files.
#[derive(Debug)]
pub enum BackgroundEvent {
    /// A file was written.
    Written(PathBuf),
    /// Something did not work; what it was.
    Failed(String),
}
