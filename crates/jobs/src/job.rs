//! What is done on another thread.

use backlit_cancel::CancelToken;

use super::Outbox;

/// Whether a job wants another turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Turn {
    /// Call again, after more urgent work.
    Again,
    /// Done.
    Done,
}

/// Work that is done in short steps; a closure is a job too.
pub trait Job<O>: Send {
    /// Does a little, and sends what came of it.
    fn step(&mut self, out: &Outbox<O>) -> Turn;
}

impl<O, F: FnMut(&Outbox<O>) -> Turn + Send> Job<O> for F {
    fn step(&mut self, out: &Outbox<O>) -> Turn {
        self(out)
    }
}

/// A job of one step and one output.
pub fn once<O>(work: impl FnOnce(&CancelToken) -> O + Send) -> impl Job<O> {
    one_step(move |out: &Outbox<O>| out.send(work(out.cancel())))
}

/// A job of one step, which sends what it likes.
pub fn one_step<O>(work: impl FnOnce(&Outbox<O>) + Send) -> impl Job<O> {
    let mut work = Some(work);
    move |out: &Outbox<O>| {
        if let Some(work) = work.take() {
            work(out);
        }
        Turn::Done
    }
}
