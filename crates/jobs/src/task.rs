//! What a feature owns: one kind of work, at most one piece of it at a time.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use backlit_cancel::CancelToken;

use super::pool::{Pool, QueuePosition, RunTurn, Shared, Slot};
use super::priority::Crew;
use super::{Failure, Job, Outbox, TaskEvent, Turn};

/// One kind of work of a feature, known by its inputs. Dropping it cancels the work, except what is saved. By default it has
/// the [priority](crate::priority()) `PRIORITY`.
pub struct Task<Inputs, Output, const PRIORITY: u8 = 0> {
    priority: u8,
    inputs: Option<Inputs>,
    work: Option<Pending<Output>>,
    failure: Option<Failure>,
}

/// A job whose end has not been heard yet.
struct Pending<O> {
    shared: Arc<Shared>,
    place: QueuePosition,
    cancel: CancelToken,
    events: Receiver<TaskEvent<O>>,
    _open: Arc<()>,
}

impl<I, O, const P: u8> Default for Task<I, O, P> {
    fn default() -> Self {
        Self::new(P)
    }
}

impl<I, O, const P: u8> Task<I, O, P> {
    /// A task that has nothing to do yet.
    pub const fn new(priority: u8) -> Self {
        Self { priority, inputs: None, work: None, failure: None }
    }

    /// What has happened since the last call, in order. The last of a piece of work is its end or its failure.
    pub fn poll(&mut self) -> Vec<TaskEvent<O>> {
        let mut all = Vec::new();
        while let Some(work) = &self.work {
            let event = match work.events.try_recv() {
                Ok(event) => event,
                Err(TryRecvError::Empty) => break,
                // The pool is gone.
                Err(TryRecvError::Disconnected) => TaskEvent::Ended,
            };
            if !matches!(event, TaskEvent::Output(_)) {
                self.work = None;
            }
            if let TaskEvent::Failed(failure) = &event {
                self.failure = Some(failure.clone());
            }
            all.push(event);
        }
        all
    }

    /// What was sent since the last call; `failed` is told if the job broke down.
    pub fn outputs(&mut self, mut failed: impl FnMut(&Failure)) -> Vec<O> {
        let output = |event| match event {
            TaskEvent::Output(output) => Some(output),
            TaskEvent::Ended => None,
            TaskEvent::Failed(failure) => {
                failed(&failure);
                None
            }
        };
        self.poll().into_iter().filter_map(output).collect()
    }

    /// Asks the job to end soon; its last outputs still arrive. To ask for the same again stays free: who wants it again
    /// begins it.
    pub fn stop(&self) {
        if let Some(work) = &self.work {
            work.cancel.cancel();
        }
    }

    /// Cancels the job, also one that saves, and forgets its inputs; nothing more is heard of it.
    pub fn forget(&mut self) {
        if let Some(work) = self.work.take() {
            work.cancel.cancel();
            work.shared.withdraw(work.place);
        }
        self.inputs = None;
        self.failure = None;
    }

    /// Whether there is work whose end [`Self::poll`] has not told yet.
    pub const fn is_busy(&self) -> bool {
        self.work.is_some()
    }

    /// What was asked for last.
    pub const fn inputs(&self) -> Option<&I> {
        self.inputs.as_ref()
    }

    /// Why the work on these inputs broke down, if it did.
    pub const fn failure(&self) -> Option<&Failure> {
        self.failure.as_ref()
    }
}

impl<I, O: Send + 'static, const P: u8> Task<I, O, P> {
    /// Asks for work, unless the last was for the same inputs: then it is under way, or done, or has broken down and would do
    /// so again. Whether it was begun.
    pub fn ask<J: Job<O> + 'static>(&mut self, pool: &Pool, inputs: I, job: impl FnOnce(&I) -> J) -> bool
    where
        I: PartialEq,
    {
        let is_new = self.inputs.as_ref() != Some(&inputs);
        if is_new {
            self.begin(pool, inputs, job);
        }
        is_new
    }

    /// Asks for work whose result is not there, or not any more: as [`Self::ask`], but work that is done is done again.
    pub fn need<J: Job<O> + 'static>(&mut self, pool: &Pool, inputs: I, job: impl FnOnce(&I) -> J)
    where
        I: PartialEq,
    {
        let is_same = self.inputs.as_ref() == Some(&inputs);
        if !(is_same && (self.is_busy() || self.failure.is_some())) {
            self.begin(pool, inputs, job);
        }
    }

    /// Begins work, whatever was before: it is superseded and nothing more is heard of it.
    pub fn begin<J: Job<O> + 'static>(&mut self, pool: &Pool, inputs: I, job: impl FnOnce(&I) -> J) {
        let shared = pool.shared();
        let (sender, events) = channel();
        let cancel = CancelToken::new();
        let out = Outbox::new(cancel.clone(), sender, shared.wake.clone());
        // What is to be saved is under way also when its task is gone.
        let open = (Crew::of(self.priority) == Crew::Saving).then(|| shared.open.clone());
        let run = run(job(&inputs), out, open);
        if self.work.as_ref().is_some_and(|work| !Arc::ptr_eq(&work.shared, shared)) {
            self.forget();
        }
        let superseded = self.work.take().map(|old| {
            old.cancel.cancel();
            old.place
        });
        let place = shared.put(self.priority, superseded, Slot { cancel: cancel.clone(), run });
        let (shared, open) = (shared.clone(), shared.open.clone());
        self.work = Some(Pending { shared, place, cancel, events, _open: open });
        self.inputs = Some(inputs);
        self.failure = None;
    }
}

impl<I, O, const P: u8> Drop for Task<I, O, P> {
    fn drop(&mut self) {
        if Crew::of(self.priority) != Crew::Saving {
            self.forget();
        }
    }
}

impl<I, O, const P: u8> std::fmt::Debug for Task<I, O, P> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut task = f.debug_struct("Task");
        task.field("priority", &self.priority).field("is_busy", &self.is_busy());
        task.field("failure", &self.failure).finish_non_exhaustive()
    }
}

/// A job as the queue sees it: does a step, and tells the end. Until then it keeps the pool `open`, if it is given that.
fn run<O: Send + 'static>(job: impl Job<O> + 'static, out: Outbox<O>, open: Option<Arc<()>>) -> RunTurn {
    let mut job = Some((job, open));
    Box::new(move || {
        let Some((steps, _)) = &mut job else { return Turn::Done };
        let end = match catch_unwind(AssertUnwindSafe(|| steps.step(&out))) {
            Ok(Turn::Again) => return Turn::Again,
            Ok(Turn::Done) => TaskEvent::Ended,
            Err(panic) => TaskEvent::Failed(Failure::of_panic(&*panic)),
        };
        // Whoever hears of the end may rely on it.
        job = None;
        out.tell(end);
        Turn::Done
    })
}
