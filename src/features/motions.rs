//! What the tracked motion is called: walking, running, boxing. Names come from `backlit_recognition`, which knows nothing of
//! silhouettes; here are the joints of the document's track, a lane's worth of names for the timeline, and the plane
//! on which a motion is a curve. Nothing here is saved or undone, and nothing changes the document.
//!
//! | file | holds |
//! |---|---|
//! | [`joints`] | joints of a track as the recognizer reads them, the same for `backlit recognise` |
//! | [`model`] | what was learnt: the program's own, or a file |
//! | `job` | names of a track's frames, run by run |
//! | `update` | asked for when the track has changed, and taken in |
//! | `words` | classes and methods in plain words |
//! | `preferences` | what is chosen, kept from start to start |
//! | `panel` | the Motions pane: the plane, and the probabilities of the frame on the screen |

mod job;
mod panel;
mod preferences;
#[cfg(test)]
mod tests;
mod update;
mod words;

use std::path::PathBuf;
use std::sync::Arc;

use backlit_jobs::Task;

use crate::context::file_dialog::FileDialogs;
use crate::context::marks::MotionMarks;
use crate::context::priority;
use job::{Inputs, Missing, RecognisedMotions};
pub(crate) use preferences::MotionsPreferences;

/// The feature.
#[derive(Debug, Default)]
pub(crate) struct Motions {
    /// What is chosen, kept from start to start.
    pub(crate) preferences: MotionsPreferences,
    /// What was learnt elsewhere and is used instead of the program's own.
    model: Option<PathBuf>,
    found: Option<Arc<RecognisedMotions>>,
    /// Why there are no names, once somebody has looked.
    missing: Option<Missing>,
    marks: MotionMarks,
    task: Task<Inputs, Result<Arc<RecognisedMotions>, Missing>, { priority::MOTIONS }>,
    dialogs: FileDialogs<()>,
}
