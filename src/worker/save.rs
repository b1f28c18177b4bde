//! Writing a project.

use std::path::PathBuf;

use super::{Event, Job, Outbox, Step};
use crate::document::Document;
use crate::project::write_project;
use crate::recovery::About;

/// A document to be written.
#[derive(Debug)]
pub struct SaveJob {
    /// The document.
    pub document: Document,
    /// Its revision.
    pub revision: u64,
    /// The file.
    pub path: PathBuf,
    /// Where the user is, if it is the copy for the next start.
    pub about: Option<About>,
}

impl Job<Event> for SaveJob {
    fn step(&mut self, out: &Outbox<Event>) -> Step {
        let mut written = write_project(&self.path, &self.document);
        if let (Ok(()), Some(about)) = (&written, &self.about) {
            written = about.write(&self.path);
        }
        let (path, revision) = (self.path.clone(), self.revision);
        out.send(match (written, &self.about) {
            (Ok(()), None) => Event::Saved { path, revision },
            (Ok(()), Some(_)) => Event::CopySaved { revision },
            (Err(error), None) => {
                Event::Failed(format!("Not saved: {error}. Your work is kept; save to another place."))
            }
            (Err(error), Some(_)) => Event::CopyFailed(error.to_string()),
        });
        Step::Done
    }
}
