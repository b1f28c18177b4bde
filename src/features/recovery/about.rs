//! What stands beside a copy.

use std::path::{Path, PathBuf};

use backlit_document::project::ProjectError;
use backlit_formats::{DiskFiles, TakeFiles, atomic};
use serde::{Deserialize, Serialize};

/// No more is ever written.
const MAX_BYTES: u64 = 1 << 20;

/// What a copy's project does not say.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct About {
    /// The frame on the screen.
    pub(crate) frame: usize,
    /// Frames of the take.
    pub(crate) frames: Option<usize>,
    /// The take's name.
    pub(crate) take: Option<String>,
    /// The project file that the work belongs to.
    pub(crate) project: Option<PathBuf>,
}

impl About {
    /// The file beside a copy.
    pub(crate) fn path_of(copy: &Path) -> PathBuf {
        copy.with_extension("about.json")
    }

    /// Writes it beside a copy.
    ///
    /// # Errors
    /// The file system says no.
    pub(crate) fn write(&self, copy: &Path) -> Result<(), ProjectError> {
        let path = Self::path_of(copy);
        let json =
            serde_json::to_vec(self).map_err(|error| ProjectError::Json { path: path.clone(), error })?;
        Ok(atomic::write(&path, &json)?)
    }

    /// What was written beside a copy; nothing is known if that cannot be read.
    pub(crate) fn read(copy: &Path) -> Self {
        let text = DiskFiles.read(&Self::path_of(copy), MAX_BYTES).unwrap_or_default();
        serde_json::from_slice(&text).unwrap_or_default()
    }
}
