//! Lanes, generations, and the threads.

use std::collections::BTreeMap;
use std::panic::AssertUnwindSafe;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

use backlit_tracking::cancel::CancelToken;

/// The threads: each does the most urgent of its lanes. A search that takes seconds must not hold up a drag, neither may
/// hold up the copy of unsaved work, and the scene is drawn while silhouettes are predicted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Crew {
    /// What the screen waits for.
    Screen,
    /// What is written.
    Files,
}

impl Crew {
    const ALL: [(Self, &'static str); 2] = [(Self::Screen, "backlit worker"), (Self::Files, "backlit files")];
}

/// A kind of work, the most urgent first. At most one job of a lane is alive.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Lane {
    /// Writing a file.
    Save,
    /// The fit of one frame.
    Fit,
}

impl Lane {
    const fn crew(self) -> Crew {
        match self {
            Self::Fit => Crew::Screen,
            Self::Save => Crew::Files,
        }
    }
}

/// Whether a job wants another turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    /// Call again, after more urgent work.
    Again,
    /// Done.
    Done,
}

/// Work that is done in short steps.
pub trait Job<E>: Send {
    /// Does a little, and sends what came of it.
    fn step(&mut self, out: &Outbox<E>) -> Step;
}

/// Where a job sends its events.
#[derive(Debug)]
pub struct Outbox<E> {
    lane: Lane,
    generation: u64,
    cancel: CancelToken,
    events: Sender<(Lane, u64, Message<E>)>,
    wake: Wake,
}

impl<E> Outbox<E> {
    /// Sends an event and wakes the window.
    pub fn send(&self, event: E) {
        // Nobody listens any more when the window is closing.
        let _ = self.events.send((self.lane, self.generation, Message::Event(event)));
        (self.wake.0)();
    }

    /// What a job asks while it works.
    #[must_use]
    pub fn cancel(&self) -> &CancelToken {
        &self.cancel
    }
}

#[derive(Clone)]
struct Wake(Arc<dyn Fn() + Send + Sync>);

impl std::fmt::Debug for Wake {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Wake")
    }
}

#[derive(Debug)]
enum Message<E> {
    Event(E),
    Panicked(String),
    Ended,
}

/// What the worker says to the window.
#[derive(Debug, PartialEq, Eq)]
pub enum Report<E> {
    /// A job sent it.
    Event(E),
    /// The job of this lane broke down; what it said.
    Panicked(Lane, String),
    /// The job of this lane is over.
    Ended(Lane),
}

struct Slot<E> {
    generation: u64,
    cancel: CancelToken,
    job: Box<dyn Job<E>>,
}

struct Queue<E> {
    slots: BTreeMap<Lane, Slot<E>>,
    closing: bool,
}

struct Shared<E> {
    queue: Mutex<Queue<E>>,
    changed: Condvar,
}

impl<E> Shared<E> {
    /// A panic cannot happen while the lock is held by more than a map insertion: the queue stays whole.
    fn lock(&self) -> MutexGuard<'_, Queue<E>> {
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The threads and their lanes.
pub struct Worker<E> {
    shared: Arc<Shared<E>>,
    events: Receiver<(Lane, u64, Message<E>)>,
    alive: BTreeMap<Lane, (u64, CancelToken)>,
    next_generation: u64,
    threads: Vec<JoinHandle<()>>,
}

impl<E> std::fmt::Debug for Worker<E> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Worker").field("alive", &self.alive).finish_non_exhaustive()
    }
}

impl<E: Send + 'static> Worker<E> {
    /// Starts the threads. `wake` is called, on the thread of its lane, for every event.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn start(wake: impl Fn() + Send + Sync + 'static) -> std::io::Result<Self> {
        let queue = Queue { slots: BTreeMap::new(), closing: false };
        let shared = Arc::new(Shared { queue: Mutex::new(queue), changed: Condvar::new() });
        let (sender, events) = channel();
        let wake = Wake(Arc::new(wake));
        let threads = Vec::with_capacity(Crew::ALL.len());
        let mut worker = Self { shared, events, alive: BTreeMap::new(), next_generation: 1, threads };
        for (crew, name) in Crew::ALL {
            let (shared, sender, wake) = (worker.shared.clone(), sender.clone(), wake.clone());
            let thread = std::thread::Builder::new().name(name.to_owned());
            // Should one be refused, dropping the worker ends the others.
            worker.threads.push(thread.spawn(move || work(crew, &shared, &sender, &wake))?);
        }
        Ok(worker)
    }

    /// Gives a lane new work; the old is cancelled and its events are dropped.
    pub fn request(&mut self, lane: Lane, job: impl Job<E> + 'static) {
        self.drop_lane(lane);
        let (generation, cancel) = (self.next_generation, CancelToken::default());
        self.next_generation += 1;
        self.alive.insert(lane, (generation, cancel.clone()));
        self.shared.lock().slots.insert(lane, Slot { generation, cancel, job: Box::new(job) });
        self.shared.changed.notify_all();
    }

    /// Asks the job of a lane to end soon; its last events still arrive.
    pub fn cancel(&self, lane: Lane) {
        if let Some((_, cancel)) = self.alive.get(&lane) {
            cancel.cancel();
        }
    }

    /// Ends the job of a lane; nothing more is heard of it.
    pub fn drop_lane(&mut self, lane: Lane) {
        if let Some((_, cancel)) = self.alive.remove(&lane) {
            cancel.cancel();
            self.shared.lock().slots.remove(&lane);
        }
    }

    /// Whether a lane has work.
    #[must_use]
    pub fn is_busy(&self, lane: Lane) -> bool {
        self.alive.contains_key(&lane)
    }

    /// Whether no lane has work.
    #[must_use]
    pub fn is_idle(&self) -> bool {
        self.alive.is_empty()
    }

    /// Whether no other lane has work.
    #[must_use]
    pub fn is_idle_but(&self, lane: Lane) -> bool {
        self.alive.keys().all(|other| *other == lane)
    }

    /// What has happened since the last call, in order, without events of superseded jobs.
    pub fn poll(&mut self) -> Vec<Report<E>> {
        let mut reports = Vec::new();
        while let Ok((lane, generation, message)) = self.events.try_recv() {
            if self.alive.get(&lane).map(|(alive, _)| *alive) != Some(generation) {
                continue;
            }
            reports.push(match message {
                Message::Event(event) => Report::Event(event),
                Message::Panicked(text) => {
                    self.alive.remove(&lane);
                    Report::Panicked(lane, text)
                }
                Message::Ended => {
                    self.alive.remove(&lane);
                    Report::Ended(lane)
                }
            });
        }
        reports
    }
}

impl<E> Drop for Worker<E> {
    fn drop(&mut self) {
        for (_, cancel) in self.alive.values() {
            cancel.cancel();
        }
        self.shared.lock().closing = true;
        self.shared.changed.notify_all();
        for thread in self.threads.drain(..) {
            // It has told its panics already.
            let _ = thread.join();
        }
    }
}

fn work<E>(crew: Crew, shared: &Shared<E>, events: &Sender<(Lane, u64, Message<E>)>, wake: &Wake) {
    loop {
        let (lane, mut slot) = {
            let mut queue = shared.lock();
            loop {
                // What was to be saved is saved, even by a window that is closing.
                if queue.closing && crew != Crew::Files {
                    return;
                }
                let next = queue.slots.keys().copied().find(|lane| lane.crew() == crew);
                if let Some(next) = next.and_then(|lane| queue.slots.remove_entry(&lane)) {
                    break next;
                }
                if queue.closing {
                    return;
                }
                queue = shared.changed.wait(queue).unwrap_or_else(PoisonError::into_inner);
            }
        };
        let outbox = Outbox {
            lane,
            generation: slot.generation,
            cancel: slot.cancel.clone(),
            events: events.clone(),
            wake: wake.clone(),
        };
        let result = std::panic::catch_unwind(AssertUnwindSafe(|| slot.job.step(&outbox)));
        let last = match result {
            Ok(Step::Again) => {
                // Unless the lane has newer work by now.
                shared.lock().slots.entry(lane).or_insert(slot);
                continue;
            }
            Ok(Step::Done) => Message::Ended,
            Err(panic) => Message::Panicked(panic_text(&*panic)),
        };
        let _ = events.send((lane, outbox.generation, last));
        (wake.0)();
    }
}

fn panic_text(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "no reason given".to_owned())
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use super::*;

    struct Count {
        from: u32,
        to: u32,
    }

    impl Job<u32> for Count {
        fn step(&mut self, out: &Outbox<u32>) -> Step {
            assert!(self.from != 13, "thirteen");
            out.send(self.from);
            self.from += 1;
            if self.from == self.to || out.cancel().is_cancelled() { Step::Done } else { Step::Again }
        }
    }

    fn wait(worker: &mut Worker<u32>) -> Vec<Report<u32>> {
        let start = Instant::now();
        let mut reports = Vec::new();
        while !worker.is_idle() {
            assert!(start.elapsed() < Duration::from_secs(20), "the worker hangs");
            reports.extend(worker.poll());
            std::thread::yield_now();
        }
        reports
    }

    #[test]
    fn a_job_reports_and_ends() {
        let mut worker = Worker::start(|| {}).unwrap();
        worker.request(Lane::Fit, Count { from: 0, to: 3 });
        let expected = [Report::Event(0), Report::Event(1), Report::Event(2), Report::Ended(Lane::Fit)];
        assert_eq!(wait(&mut worker), expected);
    }

    #[test]
    fn new_work_supersedes_old_and_is_not_held_up_by_other_lanes() {
        let mut worker = Worker::start(|| {}).unwrap();
        worker.request(Lane::Save, Count { from: 100, to: u32::MAX });
        worker.request(Lane::Fit, Count { from: 20, to: u32::MAX });
        worker.request(Lane::Fit, Count { from: 0, to: 2 });
        let start = Instant::now();
        let mut fit = Vec::new();
        while worker.is_busy(Lane::Fit) {
            assert!(start.elapsed() < Duration::from_secs(20), "the worker hangs");
            fit.extend(worker.poll().into_iter().filter(|r| !matches!(r, Report::Event(100..))));
        }
        assert_eq!(fit, [Report::Event(0), Report::Event(1), Report::Ended(Lane::Fit)]);
        worker.cancel(Lane::Save);
        assert_eq!(wait(&mut worker).last(), Some(&Report::Ended(Lane::Save)));
    }

    struct Sleep;

    impl Job<u32> for Sleep {
        fn step(&mut self, out: &Outbox<u32>) -> Step {
            while !out.cancel().is_cancelled() {
                std::thread::yield_now();
            }
            Step::Done
        }
    }

    #[test]
    fn a_long_step_holds_up_no_file() {
        let mut worker = Worker::start(|| {}).unwrap();
        worker.request(Lane::Fit, Sleep);
        worker.request(Lane::Save, Count { from: 1, to: 2 });
        let start = Instant::now();
        while worker.is_busy(Lane::Save) {
            assert!(start.elapsed() < Duration::from_secs(20), "the worker hangs");
            worker.poll();
        }
        assert!(worker.is_busy(Lane::Fit));
    }

    #[test]
    fn a_panic_is_a_message_and_the_thread_lives_on() {
        let mut worker = Worker::start(|| {}).unwrap();
        worker.request(Lane::Fit, Count { from: 13, to: 20 });
        let reports = wait(&mut worker);
        assert!(
            matches!(&reports[..], [Report::Panicked(Lane::Fit, text)] if text == "thirteen"),
            "{reports:?}"
        );
        worker.request(Lane::Fit, Count { from: 1, to: 2 });
        assert_eq!(wait(&mut worker), [Report::Event(1), Report::Ended(Lane::Fit)]);
    }

    #[test]
    fn dropping_the_worker_ends_endless_jobs() {
        let mut worker = Worker::start(|| {}).unwrap();
        worker.request(Lane::Fit, Count { from: 100, to: u32::MAX });
        drop(worker);
    }
}
