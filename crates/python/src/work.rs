//! Long work beside the interpreter: a thread computes while the calling one, mostly without the interpreter, looks for Ctrl+C and
//! tells of progress.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, ScopedJoinHandle};
use std::time::Duration;

use anyhow::Context;
use backlit_tracking::cancel::CancelToken;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::errors::{raised, wrong};

/// How long Ctrl+C may wait.
const POLL: Duration = Duration::from_millis(50);
/// As large as that of a program's first thread.
const STACK_BYTES: usize = 8 << 20;
/// More threads than this are a mistake.
const MOST_THREADS: usize = 1024;

/// How far the work is.
#[derive(Debug, Clone)]
pub(crate) struct Progress {
    /// Of `all`.
    pub(crate) done: usize,
    /// 0 where it is not known.
    pub(crate) all: usize,
    /// What is being done.
    pub(crate) text: String,
}

/// What the work shares with the thread that called for it.
#[derive(Debug, Default)]
pub(crate) struct Job {
    /// Asks the work to stop.
    pub(crate) cancel: CancelToken,
    progress: Mutex<Option<Progress>>,
    is_done: Mutex<bool>,
    ends: Condvar,
}

impl Job {
    /// Tells how far the work is.
    pub(crate) fn tell(&self, done: usize, all: usize, text: impl Into<String>) {
        *lock(&self.progress) = Some(Progress { done, all, text: text.into() });
    }

    fn end(&self) {
        *lock(&self.is_done) = true;
        self.ends.notify_all();
    }

    /// Whether the work has ended, after a while at most.
    fn wait(&self) -> bool {
        let is_done = lock(&self.is_done);
        if *is_done {
            return true;
        }
        *self.ends.wait_timeout(is_done, POLL).unwrap_or_else(PoisonError::into_inner).0
    }

    /// Lets Python handle signals, and tells it of what is new.
    fn attend(&self, py: Python<'_>, tell: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        py.check_signals()?;
        let news = lock(&self.progress).take();
        if let (Some(Progress { done, all, text }), Some(tell)) = (news, tell) {
            tell.call1((done, all, text))?;
        }
        Ok(())
    }
}

/// What a panic leaves is as good as before it: single values.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Ends a job also where its work panics.
struct Ending<'a>(&'a Job);

impl Drop for Ending<'_> {
    fn drop(&mut self) {
        self.0.end();
    }
}

/// A pool of that many threads, if a number is asked for: else the program's own threads are used.
pub(crate) fn pool(threads: Option<usize>) -> PyResult<Option<ThreadPool>> {
    let Some(threads) = threads else { return Ok(None) };
    if !(1..=MOST_THREADS).contains(&threads) {
        return Err(wrong("n_threads", &format!("1 to {MOST_THREADS}"), &threads.to_string()));
    }
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    pool.context("threads cannot be started").map(Some).map_err(raised)
}

/// Does work by this number of threads without the interpreter. `progress` is a callable that hears of it: `(done, all, text)`.
///
/// # Errors
/// What Ctrl+C or the callable raises; the work is asked to stop then, and waited for.
pub(crate) fn interruptible<T: Send>(
    py: Python<'_>,
    threads: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Job) -> T + Send,
) -> PyResult<T> {
    let pool = pool(threads)?;
    let job = Job::default();
    let compute = || {
        let _ending = Ending(&job);
        match &pool {
            Some(pool) => pool.install(|| work(&job)),
            None => work(&job),
        }
    };
    thread::scope(|scope| {
        let worker = thread::Builder::new().stack_size(STACK_BYTES).spawn_scoped(scope, compute);
        let worker: ScopedJoinHandle<'_, T> = worker.context("a thread cannot be started").map_err(raised)?;
        let mut raised: Option<PyErr> = None;
        while !py.detach(|| job.wait()) {
            if raised.is_none()
                && let Err(error) = job.attend(py, progress)
            {
                job.cancel.cancel();
                raised = Some(error);
            }
        }
        let result = py.detach(|| worker.join());
        if let Some(error) = raised {
            return Err(error);
        }
        job.attend(py, progress)?;
        result.map_err(|panic| std::panic::resume_unwind(panic))
    })
}
