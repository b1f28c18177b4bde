//! Opening a take or a project.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::Context;
use backlit_document::Document;
use backlit_document::project::{Project, read_project};
use backlit_document::run::Run;
use backlit_document::take_match::match_take;
use backlit_formats::{Take, TakeError};
use backlit_take::footage::Footage;
use backlit_take::source::TakeSource;

/// Something to open.
#[derive(Debug)]
pub enum Opening {
    /// A take.
    Take(TakeSource),
    /// A take that has been read.
    Ready(Box<Take>),
    /// A project file, and the take that it names.
    Project(PathBuf),
    /// A project file whose take has moved.
    Moved {
        /// The project file.
        project: PathBuf,
        /// Where its take is now.
        take: PathBuf,
    },
}

#[derive(Debug)]
pub(crate) struct OpenedProject {
    /// What it holds.
    pub(crate) document: Box<Document>,
    /// Its runs of the fit.
    pub(crate) runs: Vec<Run>,
    /// The file.
    pub(crate) path: PathBuf,
    /// Whether it is not any more as it is in the file: its take has moved.
    pub(crate) is_changed: bool,
    /// What there is to know about its take.
    pub(crate) note: Option<String>,
}

/// Why nothing was opened.
#[derive(Debug)]
enum OpenError {
    /// The project's take is not where it was.
    TakeMissing {
        project: PathBuf,
        error: anyhow::Error,
    },
    Other(anyhow::Error),
}

impl<E: Into<anyhow::Error>> From<E> for OpenError {
    fn from(error: E) -> Self {
        Self::Other(error.into())
    }
}

/// What came of opening something.
#[derive(Debug)]
pub(crate) enum Opened {
    /// A take, and the project that named it, if it was one.
    Take(Arc<Footage>, Option<OpenedProject>),
    /// The take of a project is not where it was.
    TakeMissing {
        /// The project.
        project: PathBuf,
        /// What is missing.
        why: String,
    },
    /// Nothing; why not.
    Nothing(String),
}

impl Opening {
    pub(crate) fn read(&self) -> Opened {
        match self.footage() {
            Ok((footage, project)) => Opened::Take(Arc::new(footage), project),
            Err(OpenError::TakeMissing { project, error }) => {
                Opened::TakeMissing { project, why: format!("{error:#}") }
            }
            Err(OpenError::Other(error)) => Opened::Nothing(format!("{error:#}")),
        }
    }

    fn footage(&self) -> Result<(Footage, Option<OpenedProject>), OpenError> {
        match self {
            Self::Take(source) => Ok((open_take(source)?, None)),
            Self::Ready(take) => Ok((Footage::new((**take).clone(), None), None)),
            Self::Project(path) => open_project(path, None),
            Self::Moved { project, take } => open_project(project, Some(take)),
        }
    }
}

fn open_project(path: &Path, moved_to: Option<&Path>) -> Result<(Footage, Option<OpenedProject>), OpenError> {
    let Project { mut document, runs } = read_project(path)?;
    let source =
        document.take.clone().with_context(|| format!("{}: the project names no take", path.display()))?;
    let source = match (moved_to, source) {
        (Some(take), _) => TakeSource::Path(take.to_owned()),
        (None, source) => source.named_by(path),
    };
    let footage = open_take(&source).map_err(|error| {
        let is_missing = is_missing(&error) && matches!(source, TakeSource::Path(_));
        let error = error.context("the project's take cannot be opened");
        let project = path.to_owned();
        if is_missing { OpenError::TakeMissing { project, error } } else { OpenError::Other(error) }
    })?;
    let names: Vec<&str> = footage.cameras.iter().map(|camera| camera.name()).collect();
    let note = match_take(&mut document, &names, footage.measurement(), footage.frame_count())
        .with_context(|| path.display().to_string())?;
    let is_changed = moved_to.is_some();
    document.take = Some(source);
    Ok((
        footage,
        Some(OpenedProject { document: Box::new(document), runs, path: path.to_owned(), is_changed, note }),
    ))
}

fn open_take(source: &TakeSource) -> anyhow::Result<Footage> {
    Ok(Footage::new(source.open()?, Some(source.clone())))
}

/// Whether the take, or a file of it, is not there.
fn is_missing(error: &anyhow::Error) -> bool {
    matches!(error.downcast_ref::<TakeError>(), Some(TakeError::File(file)) if file.is_missing())
}
