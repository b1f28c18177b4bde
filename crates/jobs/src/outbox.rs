//! What a job says, and how it ends.

use std::any::Any;
use std::sync::mpsc::Sender;

use backlit_cancel::CancelToken;

use super::pool::Wake;

/// What a task hears of its work.
#[derive(Debug, PartialEq, Eq)]
pub enum TaskEvent<O> {
    /// The job sent it.
    Output(O),
    /// The job is over.
    Ended,
    /// The job broke down.
    Failed(Failure),
}

/// A job panicked; its words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Failure(String);

impl Failure {
    pub(super) fn of_panic(panic: &(dyn Any + Send)) -> Self {
        let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
        let text = text.or_else(|| panic.downcast_ref::<String>().cloned());
        Self(text.unwrap_or_else(|| "no reason given".to_owned()))
    }
}

impl std::fmt::Display for Failure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Failure {}

/// Where a job sends its outputs.
pub struct Outbox<O> {
    cancel: CancelToken,
    events: Sender<TaskEvent<O>>,
    wake: Wake,
}

impl<O> Outbox<O> {
    pub(super) const fn new(cancel: CancelToken, events: Sender<TaskEvent<O>>, wake: Wake) -> Self {
        Self { cancel, events, wake }
    }

    /// Sends an output and wakes the window.
    pub fn send(&self, output: O) {
        self.tell(TaskEvent::Output(output));
    }

    /// What a job asks while it works.
    pub const fn cancel(&self) -> &CancelToken {
        &self.cancel
    }

    pub(super) fn tell(&self, event: TaskEvent<O>) {
        // Nobody listens any more when the work is superseded or its task is gone.
        let _ = self.events.send(event);
        (self.wake)();
    }
}

impl<O> std::fmt::Debug for Outbox<O> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Outbox").field("cancel", &self.cancel).finish_non_exhaustive()
    }
}
