//! The second worker: experiments that take minutes, and files that are made of results. Stepping never waits for
//! them, since they have a thread of their own.

use std::collections::VecDeque;
use std::path::Path;

use super::App;
use crate::app::write_job::WriteJob;
use crate::worker::{BackgroundEvent, Lane, Report, Worker};

/// The worker, and what waits for it.
#[derive(Debug)]
pub(crate) struct Background {
    pub(crate) worker: Worker<BackgroundEvent>,
    waiting: VecDeque<WriteJob>,
}

impl Background {
    pub(crate) fn start(context: &egui::Context) -> std::io::Result<Self> {
        let context = context.clone();
        let worker = Worker::start(move || context.request_repaint())?;
        Ok(Self { worker, waiting: VecDeque::new() })
    }

    pub(crate) fn is_idle(&self) -> bool {
        self.worker.is_idle() && self.waiting.is_empty()
    }
}

impl App {
    /// Writes a file; `make` makes it on the worker's thread.
    pub(crate) fn write(
        &mut self,
        path: &Path,
        make: impl FnOnce() -> anyhow::Result<Vec<u8>> + Send + 'static,
    ) {
        self.background.waiting.push_back(WriteJob::new(path.to_owned(), make));
        self.write_next();
    }

    fn write_next(&mut self) {
        if !self.background.worker.is_busy(Lane::Save)
            && let Some(job) = self.background.waiting.pop_front()
        {
            self.background.worker.request(Lane::Save, job);
        }
    }

    /// Takes in what the second worker has done.
    pub(crate) fn hear_background(&mut self) {
        for report in self.background.worker.poll() {
            match report {
                Report::Event(BackgroundEvent::Written(path)) => {
                    let name =
                        path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
                    self.state.notices.info(self.state.now, format!("Wrote {name}."), None);
                }
                Report::Event(BackgroundEvent::Failed(text)) => self.state.notices.error(text),
                Report::Ended(Lane::Save) => self.write_next(),
                Report::Ended(_) => {}
                Report::Panicked(lane, why) => {
                    self.broke(lane, &why);
                    self.write_next();
                }
            }
        }
    }
}
