//! Opening a take or a project.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use backlit_document::Document;
use backlit_document::project::{Project, read_project};
use backlit_document::run::Run;
use backlit_document::take_match::match_take;
use backlit_formats::{Footage, Take, TakeError};
use backlit_take::source::TakeSource;

use crate::context::activity::WorkShare;

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
    pub(crate) document: Box<Document>,
    pub(crate) runs: Vec<Run>,
    pub(crate) path: PathBuf,
    /// Whether it is not any more as it is in the file: its take has moved.
    pub(crate) is_changed: bool,
    /// What there is to know about its take.
    pub(crate) note: Option<String>,
}

/// What came of opening something.
#[derive(Debug)]
pub(crate) enum Opened {
    /// A take, where it came from, and the project that named it, if it was one.
    Take(Arc<Footage>, Option<TakeSource>, Option<OpenedProject>),
    /// The take of a project is not where it was.
    TakeMissing { project: PathBuf, why: String },
    /// Nothing; why not.
    Nothing(String),
    /// Not yet: so many pictures of a simulated take are drawn.
    Drawn(WorkShare),
}

/// The footage of a take, where it came from, and the project that named it.
type OpenedParts = (Footage, Option<TakeSource>, Option<OpenedProject>);

impl Opening {
    /// Opens it; `tell` hears how far that is.
    pub(crate) fn read(&self, tell: impl Fn(WorkShare)) -> Opened {
        let mut tell = |done, total| tell(WorkShare { done, total });
        let parts = match self {
            Self::Take(source) => source
                .footage(&mut tell)
                .map(|footage| (footage, Some(source.clone()), None))
                .map_err(Opened::nothing),
            Self::Ready(take) => Ok((Footage::new((**take).clone()), None, None)),
            Self::Project(path) => open_project(path, None, &mut tell),
            Self::Moved { project, take } => open_project(project, Some(take), &mut tell),
        };
        match parts {
            Ok((footage, source, project)) => Opened::Take(Arc::new(footage), source, project),
            Err(not_opened) => not_opened,
        }
    }
}

impl Opened {
    fn nothing(error: impl Into<anyhow::Error>) -> Self {
        Self::Nothing(format!("{:#}", error.into()))
    }
}

fn open_project(
    path: &Path,
    moved_to: Option<&Path>,
    tell: &mut dyn FnMut(usize, usize),
) -> Result<OpenedParts, Opened> {
    let Project { mut document, runs } = read_project(path).map_err(Opened::nothing)?;
    let no_take = || Opened::Nothing(format!("{}: the project names no take", path.display()));
    let source = match (moved_to, document.take.take().ok_or_else(no_take)?) {
        (Some(take), _) => TakeSource::Path(take.to_owned()),
        (None, source) => source.named_by(path),
    };
    let footage = source.footage(tell).map_err(|error| {
        let is_missing = is_missing(&error) && matches!(source, TakeSource::Path(_));
        let error = error.context("the project's take cannot be opened");
        match is_missing {
            true => Opened::TakeMissing { project: path.to_owned(), why: format!("{error:#}") },
            false => Opened::nothing(error),
        }
    })?;
    let names: Vec<&str> = footage.cameras.iter().map(|camera| camera.name()).collect();
    let note = match_take(&mut document, &names, footage.take().measurement(), footage.frame_count())
        .map_err(|error| Opened::Nothing(format!("{}: {error}", path.display())))?;
    document.take = Some(source.clone());
    let (document, is_changed) = (Box::new(document), moved_to.is_some());
    let project = OpenedProject { document, runs, path: path.to_owned(), is_changed, note };
    Ok((footage, Some(source), Some(project)))
}

/// Whether the take, or a file of it, is not there.
fn is_missing(error: &anyhow::Error) -> bool {
    matches!(error.downcast_ref::<TakeError>(), Some(TakeError::File(file)) if file.is_missing())
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;

    use backlit_take::demonstration::Demonstration;

    use super::*;

    #[test]
    fn a_take_that_is_drawn_tells_how_far_it_is() {
        let told = RefCell::new(Vec::new());
        let opening = Opening::Take(TakeSource::Demonstration(Demonstration::TwoCameras));
        let opened = opening.read(|share| told.borrow_mut().push(share));
        assert!(matches!(opened, Opened::Take(..)));
        assert_eq!(told.into_inner(), [0, 1].map(|done| WorkShare { done, total: 2 }));
    }
}
