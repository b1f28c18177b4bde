//! Files that are made of what the session holds: tables, plots, numbers.

use std::path::PathBuf;

use backlit_formats::atomic;

use crate::context::write_advice::remedy;
use crate::worker::{BackgroundEvent, Job, Outbox, Step};

/// Makes the bytes of a file.
type Make = Box<dyn FnOnce() -> anyhow::Result<Vec<u8>> + Send>;

/// Makes a file and writes it.
pub struct WriteJob {
    path: PathBuf,
    make: Option<Make>,
}

impl WriteJob {
    /// What is to be written where; `make` runs on the worker's thread.
    pub fn new(path: PathBuf, make: impl FnOnce() -> anyhow::Result<Vec<u8>> + Send + 'static) -> Self {
        Self { path, make: Some(Box::new(make)) }
    }
}

impl std::fmt::Debug for WriteJob {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("WriteJob").field("path", &self.path).finish_non_exhaustive()
    }
}

impl Job<BackgroundEvent> for WriteJob {
    fn step(&mut self, out: &Outbox<BackgroundEvent>) -> Step {
        let Some(make) = self.make.take() else { return Step::Done };
        let path = std::mem::take(&mut self.path);
        let failed = match make() {
            Ok(bytes) => atomic::write(&path, &bytes).err().map(|error| {
                let remedy = remedy(&error);
                format!("Not written: {error}. {remedy}")
            }),
            Err(error) => Some(format!("{} was not written: {error:#}.", path.display())),
        };
        out.send(failed.map_or(BackgroundEvent::Written(path), BackgroundEvent::Failed));
        Step::Done
    }
}
