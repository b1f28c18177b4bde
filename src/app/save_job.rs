//! Writing the copy of unsaved work.

use std::path::PathBuf;

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
    /// What stands beside it.
    pub beside: (About, Option<Picture>),
}

impl Job<Event> for SaveJob {
    fn step(&mut self, out: &Outbox<Event>) -> Step {
        let (about, picture) = &self.beside;
        let written = write_project(&self.path, &self.document).and_then(|()| about.write(&self.path));
        if let (Ok(()), Some(picture)) = (&written, picture) {
            // The work is safe without it.
            let _ = picture.write(&self.path);
        }
        out.send(match written {
            Ok(()) => Event::CopySaved { revision: self.revision },
            Err(error) => Event::CopyFailed(error.to_string()),
        });
        Step::Done
    }
}
