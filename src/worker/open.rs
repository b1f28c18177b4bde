//! Opening a take or a project.

use std::path::PathBuf;
use std::sync::Arc;

use anyhow::Context;
use backlit_tracking::io::Take;

use super::{Event, Job, Outbox, Step};
use crate::document::{Document, TakeSource};
use crate::footage::Footage;
use crate::project::read_project;

/// What is to be opened.
#[derive(Debug)]
pub enum OpenJob {
    /// A take.
    Take(TakeSource),
    /// A take that has been read.
    Ready(Box<Take>),
    /// A project, and the take that it names.
    Project(PathBuf),
}

impl Job<Event> for OpenJob {
    fn step(&mut self, out: &Outbox<Event>) -> Step {
        out.send(match self.open() {
            Ok((footage, project)) => Event::TakeOpened { footage: Arc::new(footage), project },
            Err(error) => Event::Failed(format!("{error:#}")),
        });
        Step::Done
    }
}

type Opened = (Footage, Option<(Box<Document>, PathBuf)>);

impl OpenJob {
    fn open(&self) -> anyhow::Result<Opened> {
        match self {
            Self::Take(source) => Ok((open_take(source)?, None)),
            Self::Ready(take) => Ok((Footage::new((**take).clone(), None), None)),
            Self::Project(path) => {
                let document = read_project(path)?;
                let source = document.take.clone().context("the project names no take")?;
                let footage = open_take(&source).context("the project's take cannot be opened")?;
                anyhow::ensure!(
                    document.cameras.len() == footage.cameras.len(),
                    "the project has {} cameras, its take {}",
                    document.cameras.len(),
                    footage.cameras.len()
                );
                Ok((footage, Some((Box::new(document), path.clone()))))
            }
        }
    }
}

/// Opens a take from where it is.
fn open_take(source: &TakeSource) -> anyhow::Result<Footage> {
    let take = match source {
        TakeSource::BuiltIn => crate::builtin_take::open()?,
        TakeSource::Demonstration(which) => which.take()?,
        TakeSource::Path(path) => Take::open(path)?,
    };
    Ok(Footage::new(take, Some(source.clone())))
}
