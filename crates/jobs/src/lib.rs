//! Work that must not hold up the window: a feature owns a `Task`, the threads are those of one `Pool`.
//!
//! A task is keyed by its inputs: to ask for the same again is free, to ask for something else supersedes what was under way,
//! and of superseded work nothing more is heard. Dropping a task cancels its work, except what is to be saved. A panic is the
//! task's `Failure`, and the thread lives on.
//!
//! Jobs work in steps. What the screen waits for, the 3-D scene, files, and what takes its time have a thread each, so
//! neither a drag nor the copy of unsaved work waits for a tracker; each thread does a step of its most urgent job, see
//! [`priority()`]. An inline pool does the same without threads, for tests that are the same every time.
//!
//! ```
//! use backlit_jobs::{Crew, TaskEvent, Pool, Task, once, priority};
//!
//! let pool = Pool::inline();
//! let mut square: Task<u64, u64> = Task::new(priority(Crew::Screen, 0));
//! assert!(square.ask(&pool, 12, |&side| once(move |_| side * side)));
//! assert!(!square.ask(&pool, 12, |&side| once(move |_| side * side)), "it is under way");
//! pool.turn();
//! assert_eq!(square.poll(), [TaskEvent::Output(144), TaskEvent::Ended]);
//! ```

mod job;
mod outbox;
mod pool;
mod priority;
mod task;
#[cfg(test)]
mod tests;

pub use job::{Job, Turn, once, one_step};
pub use outbox::{Failure, Outbox, TaskEvent};
pub use pool::Pool;
pub use priority::{Crew, priority};
pub use task::Task;
