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

/// Work that is done in short steps.
pub trait Job<O>: Send {
    /// Does a little, and sends what came of it.
    fn step(&mut self, out: &Outbox<O>) -> Turn;
}

/// Work that is done in one step, see [`once`].
#[derive(Debug)]
pub struct Once<F>(Option<F>);

/// A job of one step and one output.
pub const fn once<O, F: FnOnce(&CancelToken) -> O + Send>(work: F) -> Once<F> {
    Once(Some(work))
}

impl<O, F: FnOnce(&CancelToken) -> O + Send> Job<O> for Once<F> {
    fn step(&mut self, out: &Outbox<O>) -> Turn {
        if let Some(work) = self.0.take() {
            out.send(work(out.cancel()));
        }
        Turn::Done
    }
}

/// Work that is done in one step, see [`one_step`].
#[derive(Debug)]
pub struct OneStep<F>(Option<F>);

/// A job of one step, which sends what it likes.
pub const fn one_step<O, F: FnOnce(&Outbox<O>) + Send>(work: F) -> OneStep<F> {
    OneStep(Some(work))
}

impl<O, F: FnOnce(&Outbox<O>) + Send> Job<O> for OneStep<F> {
    fn step(&mut self, out: &Outbox<O>) -> Turn {
        if let Some(work) = self.0.take() {
            work(out);
        }
        Turn::Done
    }
}
