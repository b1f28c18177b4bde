//! Writing a project.

use std::path::PathBuf;

use super::{Event, Job, Outbox, Step};
use crate::document::Document;
use crate::project::write_project;

/// A document to be written.
#[derive(Debug)]
pub struct SaveJob {
    /// The document.
    pub document: Document,
    /// Its revision.
    pub revision: u64,
    /// The file.
    pub path: PathBuf,
    /// Whether it is the copy for the next start.
    pub is_autosave: bool,
}

impl Job<Event> for SaveJob {
    fn step(&mut self, out: &Outbox<Event>) -> Step {
        let folder = self.path.parent().filter(|folder| self.is_autosave && !folder.exists());
        if let Some(folder) = folder {
            // What is wrong with the folder is said by the writing itself.
            let _ = std::fs::create_dir_all(folder);
        }
        out.send(match write_project(&self.path, &self.document) {
            Ok(()) => Event::Saved {
                path: self.path.clone(),
                revision: self.revision,
                is_autosave: self.is_autosave,
            },
            Err(error) => Event::Failed(format!("Not saved: {error}")),
        });
        Step::Done
    }
}
