//! Writing a project.

use std::path::PathBuf;

use crate::context::write_advice::remedy;
use crate::document::Document;
use crate::document::project::write_project;
use crate::features::recovery::{About, Picture};
use crate::worker::{Event, Job, Outbox, Step};

/// A document to be written.
#[derive(Debug)]
pub struct SaveJob {
    /// The document.
    pub document: Document,
    /// Its revision.
    pub revision: u64,
    /// The file.
    pub path: PathBuf,
    /// What stands beside it, if it is the copy for the next start.
    pub beside: Option<(About, Option<Picture>)>,
}

impl Job<Event> for SaveJob {
    fn step(&mut self, out: &Outbox<Event>) -> Step {
        let mut written = write_project(&self.path, &self.document);
        if let (Ok(()), Some((about, picture))) = (&written, &self.beside) {
            written = about.write(&self.path);
            if let Some(picture) = picture {
                // The work is safe without it.
                let _ = picture.write(&self.path);
            }
        }
        let (path, revision) = (self.path.clone(), self.revision);
        out.send(match (written, &self.beside) {
            (Ok(()), None) => Event::Saved { path, revision },
            (Ok(()), Some(_)) => Event::CopySaved { revision },
            (Err(error), None) => Event::NotSaved(format!(
                "Not saved: {error}. Your work is still here, and the file is as it was. {}",
                remedy(&error)
            )),
            (Err(error), Some(_)) => Event::CopyFailed(error.to_string()),
        });
        Step::Done
    }
}
