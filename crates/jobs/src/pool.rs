//! The threads and their queue.

use std::collections::BTreeMap;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

use backlit_cancel::CancelToken;

use super::priority::Crew;
use super::{Task, Turn};

/// What is called for every message, on the thread of its job.
pub(super) type Wake = Arc<dyn Fn() + Send + Sync>;

/// A handle of the threads. When the last is dropped all work is cancelled, except what is to be saved: that is finished,
/// and the threads end.
#[derive(Clone)]
pub struct Pool(Arc<Owner>);

impl Pool {
    /// Starts the threads. `wake` is called, on the thread of the job, for every message.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn start(wake: impl Fn() + Send + Sync + 'static) -> std::io::Result<Self> {
        let mut owner = Owner::new(Arc::new(wake));
        for (crew, name) in Crew::ALL {
            let shared = owner.shared.clone();
            let thread = std::thread::Builder::new().name(name.to_owned());
            // Should one be refused, dropping the owner ends the others.
            owner.threads.push(thread.spawn(move || while shared.wait_for_turn(crew) {})?);
        }
        Ok(Self(Arc::new(owner)))
    }

    /// A pool without threads, whose jobs work in [`Self::turn`].
    pub fn inline() -> Self {
        Self(Arc::new(Owner::new(Arc::new(|| {}))))
    }

    /// Does a step of the most urgent job of each crew, on this thread. A pool with threads does nothing.
    pub fn turn(&self) {
        if self.0.threads.is_empty() {
            for (crew, _) in Crew::ALL {
                self.0.shared.turn(crew);
            }
        }
    }

    /// Whether no task has work or events that it has not read.
    pub fn is_idle(&self) -> bool {
        Arc::strong_count(&self.0.shared.open) == 1
    }

    /// Whether no other task has; what is written counts as another's.
    pub fn is_idle_but<I, O, const P: u8>(&self, task: &Task<I, O, P>) -> bool {
        Arc::strong_count(&self.0.shared.open) == 1 + usize::from(task.is_busy())
    }

    pub(super) fn shared(&self) -> &Arc<Shared> {
        &self.0.shared
    }
}

impl std::fmt::Debug for Pool {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (threads, is_idle) = (self.0.threads.len(), self.is_idle());
        f.debug_struct("Pool").field("threads", &threads).field("is_idle", &is_idle).finish()
    }
}

/// What the handles own and the threads do not.
struct Owner {
    shared: Arc<Shared>,
    threads: Vec<JoinHandle<()>>,
}

impl Owner {
    fn new(wake: Wake) -> Self {
        let shared = Shared { queue: Mutex::default(), changed: Condvar::new(), open: Arc::new(()), wake };
        Self { shared: Arc::new(shared), threads: Vec::new() }
    }
}

impl Drop for Owner {
    fn drop(&mut self) {
        self.shared.close();
        if self.threads.is_empty() {
            while self.shared.turn(Crew::Saving) {}
        }
        // A job may have held the last handle: its thread cannot wait for itself.
        let here = std::thread::current().id();
        for thread in self.threads.drain(..).filter(|thread| thread.thread().id() != here) {
            // It has told its panics already.
            let _ = thread.join();
        }
    }
}

/// Where a job stands: the most urgent first, of the same priority the one that was asked for first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct QueuePosition {
    priority: u8,
    number: u64,
}

impl QueuePosition {
    fn is_kept(self) -> bool {
        Crew::of(self.priority) == Crew::Saving
    }
}

pub(super) type RunTurn = Box<dyn FnMut() -> Turn + Send>;

pub(super) struct Slot {
    pub(super) cancel: CancelToken,
    pub(super) run: RunTurn,
}

#[derive(Default)]
struct Queue {
    waiting: BTreeMap<QueuePosition, Slot>,
    /// Jobs whose step is under way and that may go on after it.
    stepping: BTreeMap<QueuePosition, CancelToken>,
    next_number: u64,
    closing: bool,
}

/// What handles, tasks and threads share. No job is dropped while the queue is locked.
pub(super) struct Shared {
    queue: Mutex<Queue>,
    changed: Condvar,
    /// Has another owner for each piece of work that is not over.
    pub(super) open: Arc<()>,
    pub(super) wake: Wake,
}

impl Shared {
    /// A panic cannot happen while the lock is held by more than a map insertion: the queue stays whole.
    fn lock(&self) -> MutexGuard<'_, Queue> {
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Queues a job, in the place of the one that it supersedes or behind those of its priority.
    pub(super) fn put(&self, priority: u8, supersedes: Option<QueuePosition>, slot: Slot) -> QueuePosition {
        let mut queue = self.lock();
        queue.next_number += 1;
        let place = supersedes.unwrap_or(QueuePosition { priority, number: queue.next_number });
        let old = (queue.waiting.insert(place, slot), queue.stepping.remove(&place));
        drop(queue);
        self.changed.notify_all();
        drop(old);
        place
    }

    /// Takes a job out; if its step is under way, it is the last.
    pub(super) fn withdraw(&self, place: QueuePosition) {
        let mut queue = self.lock();
        let old = (queue.waiting.remove(&place), queue.stepping.remove(&place));
        drop(queue);
        drop(old);
    }

    /// Cancels everything but what is to be saved.
    fn close(&self) {
        let mut queue = self.lock();
        queue.closing = true;
        let waiting = queue.waiting.extract_if(.., |place, _| !place.is_kept()).collect::<Vec<_>>();
        let stepping = queue.stepping.extract_if(.., |place, _| !place.is_kept()).collect::<Vec<_>>();
        drop(queue);
        let waiting = waiting.iter().map(|(_, slot)| &slot.cancel);
        waiting.chain(stepping.iter().map(|(_, cancel)| cancel)).for_each(CancelToken::cancel);
        self.changed.notify_all();
    }

    /// Does a step of a crew's most urgent job, if it has one.
    fn turn(&self, crew: Crew) -> bool {
        let next = self.lock().next(crew);
        let Some((place, slot)) = next else { return false };
        self.step(place, slot);
        true
    }

    /// Waits for a job and does a step of it; not so if the pool is closing.
    fn wait_for_turn(&self, crew: Crew) -> bool {
        let mut queue = self.lock();
        let (place, slot) = loop {
            if let Some(next) = queue.next(crew) {
                break next;
            }
            if queue.closing {
                return false;
            }
            queue = self.changed.wait(queue).unwrap_or_else(PoisonError::into_inner);
        };
        drop(queue);
        self.step(place, slot);
        true
    }

    fn step(&self, place: QueuePosition, mut slot: Slot) {
        let step = (slot.run)();
        let mut queue = self.lock();
        // Unless it has been superseded, withdrawn or closed by now.
        if queue.stepping.remove(&place).is_some() && step == Turn::Again {
            queue.waiting.insert(place, slot);
        }
    }
}

impl Queue {
    fn next(&mut self, crew: Crew) -> Option<(QueuePosition, Slot)> {
        let place = self.waiting.keys().copied().find(|place| Crew::of(place.priority) == crew)?;
        let (place, slot) = self.waiting.remove_entry(&place)?;
        self.stepping.insert(place, slot.cancel.clone());
        Some((place, slot))
    }
}
