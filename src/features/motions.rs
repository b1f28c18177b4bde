//! What the tracked motion is called: walking, running, boxing. Names come from `backlit_recognition`, which knows nothing of
//! silhouettes; here are the joints of the document's track, a lane's worth of names for the timeline, and the plane
//! on which a motion is a curve. Nothing here is saved or undone, and nothing changes the document.

mod job;
mod panel;
#[cfg(test)]
mod tests;
mod update;
mod words;

use std::path::PathBuf;
use std::sync::Arc;

use backlit_jobs::Task;
use backlit_recognition::Method;
use serde::{Deserialize, Serialize};

use crate::context::file_dialog::FileDialogs;
use crate::context::marks::MotionMarks;
use crate::context::priority;
use job::{Inputs, Missing, RecognisedMotions};

/// What the plane is of.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Plane {
    /// Axes that tell motions apart.
    #[default]
    Apart,
    /// Principal components of single frames.
    Principal,
}

/// All that is chosen.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct MotionsPreferences {
    pub(crate) method: Method,
    /// What the plane is of.
    pub(crate) plane: Plane,
}

impl Default for MotionsPreferences {
    fn default() -> Self {
        Self { method: Method::Combined, plane: Plane::default() }
    }
}

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
