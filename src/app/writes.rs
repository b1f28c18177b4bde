//! Files that are made of what the inspector holds: tables, plots, numbers. They are written one after the other.

use std::path::PathBuf;

use anyhow::anyhow;
use backlit_formats::atomic;
use backlit_jobs::{News, Priority, Task, once};

use super::App;
use crate::context::Write;
use crate::context::write_advice::write_advice;

/// The files that are being written.
#[derive(Debug, Default)]
pub(crate) struct Writes(Vec<Task<PathBuf, anyhow::Result<()>>>);

impl App {
    /// Has a file written.
    pub(crate) fn write(&mut self, write: Write) {
        let mut task = Task::new(Priority::WRITE);
        let Write { path, make } = write;
        let file = path.clone();
        task.begin(&self.inspector.state.pool, path, |_| {
            once(move |_| match make() {
                Ok(bytes) => atomic::write(&file, &bytes)
                    .map_err(|error| anyhow!("Not written: {error}. {}", write_advice(&error))),
                Err(error) => Err(anyhow!("{} was not written: {error:#}.", file.display())),
            })
        });
        self.writes.0.push(task);
    }

    /// Says which files were written, and which were not.
    pub(crate) fn take_in_written(&mut self) {
        let mut writes = std::mem::take(&mut self.writes.0);
        for task in &mut writes {
            for news in task.poll() {
                match news {
                    News::Output(Ok(())) => {
                        let name = task.inputs().and_then(|path| path.file_name());
                        let name = name.map_or_else(String::new, |name| name.to_string_lossy().into_owned());
                        self.inspector.state.notices.info(
                            self.inspector.state.now,
                            format!("Wrote {name}."),
                            None,
                        );
                    }
                    News::Output(Err(said)) => self.inspector.state.notices.error(said.to_string()),
                    News::Ended => {}
                    News::Failed(failure) => self.failed("Writing a file", &failure),
                }
            }
        }
        writes.retain(Task::is_busy);
        self.writes.0 = writes;
    }
}
