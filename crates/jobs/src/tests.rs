use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use super::*;

/// Sends the numbers of a range; breaks down at thirteen.
struct Count {
    from: u32,
    to: u32,
}

impl Job<u32> for Count {
    fn step(&mut self, out: &Outbox<u32>) -> Turn {
        assert!(self.from != 13, "thirteen");
        out.send(self.from);
        self.from += 1;
        if self.from == self.to || out.cancel().is_cancelled() { Turn::Done } else { Turn::Again }
    }
}

fn count([from, to]: &[u32; 2]) -> Count {
    Count { from: *from, to: *to }
}

/// Says that its step is under way, and stays in it until it is let go.
struct Gate {
    entered: Sender<()>,
    go: Receiver<()>,
    steps: Arc<AtomicUsize>,
}

impl Job<u32> for Gate {
    fn step(&mut self, out: &Outbox<u32>) -> Turn {
        self.steps.fetch_add(1, Ordering::SeqCst);
        self.entered.send(()).unwrap();
        self.go.recv().unwrap();
        out.send(99);
        Turn::Again
    }
}

fn gate() -> (Gate, Receiver<()>, Sender<()>, Arc<AtomicUsize>) {
    let (entered, is_in) = channel();
    let (open, go) = channel();
    let steps = Arc::new(AtomicUsize::new(0));
    (Gate { entered, go, steps: steps.clone() }, is_in, open, steps)
}

/// Never ends by itself, in one step.
struct Endless;

impl Job<u32> for Endless {
    fn step(&mut self, out: &Outbox<u32>) -> Turn {
        while !out.cancel().is_cancelled() {
            std::thread::yield_now();
        }
        Turn::Done
    }
}

/// Does two steps and writes its name for each.
struct Write(&'static str, u32, Arc<Mutex<Vec<&'static str>>>);

impl Job<u32> for Write {
    fn step(&mut self, _: &Outbox<u32>) -> Turn {
        self.2.lock().unwrap().push(self.0);
        self.1 += 1;
        if self.1 == 2 { Turn::Done } else { Turn::Again }
    }
}

type Counting = Task<[u32; 2], u32>;
type Plain = Task<(), u32>;
type Numbered = Task<u32, u32>;

fn both_pools() -> [Pool; 2] {
    [Pool::start(|| {}).unwrap(), Pool::inline()]
}

fn until(mut is_so: impl FnMut() -> bool) {
    let start = Instant::now();
    while !is_so() {
        assert!(start.elapsed() < Duration::from_secs(20), "the pool hangs");
        std::thread::yield_now();
    }
}

fn wait<I>(pool: &Pool, task: &mut Task<I, u32>) -> Vec<News<u32>> {
    let mut news = Vec::new();
    until(|| {
        pool.turn();
        news.extend(task.poll());
        !task.is_busy()
    });
    news
}

fn outputs_and_end(outputs: &[u32]) -> Vec<News<u32>> {
    outputs.iter().copied().map(News::Output).chain([News::Ended]).collect()
}

#[test]
fn a_job_reports_and_ends_with_and_without_threads() {
    for pool in both_pools() {
        let mut task = Counting::new(Priority::screen(6));
        assert!(pool.is_idle() && !task.is_busy() && task.inputs().is_none());
        assert!(task.ask(&pool, [0, 3], count));
        assert!(!pool.is_idle() && task.is_busy());
        assert_eq!(wait(&pool, &mut task), outputs_and_end(&[0, 1, 2]));
        assert!(pool.is_idle() && task.poll().is_empty() && task.failure().is_none());
    }
}

#[test]
fn unread_news_are_not_idle() {
    let pool = Pool::inline();
    let mut task = Counting::new(Priority::screen(6));
    task.ask(&pool, [0, 1], count);
    pool.turn();
    assert!(!pool.is_idle() && task.is_busy());
    assert_eq!(task.poll(), outputs_and_end(&[0]));
    assert!(pool.is_idle());
}

#[test]
fn work_of_one_step_is_a_closure() {
    for pool in both_pools() {
        let mut task = Plain::new(Priority::screen(2));
        let word = "seven".to_owned();
        task.ask(&pool, (), |()| once(move |cancel| word.len() as u32 + u32::from(cancel.is_cancelled())));
        assert_eq!(wait(&pool, &mut task), outputs_and_end(&[5]));
    }
}

#[test]
fn asking_for_the_same_is_free_and_beginning_is_not() {
    for pool in both_pools() {
        let made = AtomicUsize::new(0);
        let make = |inputs: &[u32; 2]| {
            made.fetch_add(1, Ordering::SeqCst);
            count(inputs)
        };
        let mut task = Counting::new(Priority::screen(6));
        assert!(task.ask(&pool, [0, 2], make));
        assert!(!task.ask(&pool, [0, 2], make), "it is under way");
        assert_eq!(wait(&pool, &mut task), outputs_and_end(&[0, 1]));
        assert!(!task.ask(&pool, [0, 2], make), "it is done");
        assert_eq!((made.load(Ordering::SeqCst), task.inputs()), (1, Some(&[0, 2])));
        task.begin(&pool, [0, 2], make);
        assert_eq!(wait(&pool, &mut task), outputs_and_end(&[0, 1]));
        assert!(task.ask(&pool, [4, 5], make));
        assert_eq!(wait(&pool, &mut task), outputs_and_end(&[4]));
        assert_eq!(made.load(Ordering::SeqCst), 3);
    }
}

#[test]
fn new_work_supersedes_old_and_is_not_held_up_by_other_tasks() {
    let pool = Pool::start(|| {}).unwrap();
    let (mut track, mut fit) = (Counting::new(Priority::long(2)), Counting::new(Priority::screen(6)));
    track.ask(&pool, [100, u32::MAX], count);
    fit.ask(&pool, [20, u32::MAX], count);
    fit.ask(&pool, [0, 2], count);
    assert_eq!(wait(&pool, &mut fit), outputs_and_end(&[0, 1]));
    track.stop();
    let news = wait(&pool, &mut track);
    assert!(news.len() > 1 && news.last() == Some(&News::Ended), "its last outputs still arrive");
    assert!(pool.is_idle());
}

#[test]
fn outputs_of_superseded_work_are_dropped() {
    let pool = Pool::inline();
    let mut task = Counting::new(Priority::screen(6));
    task.ask(&pool, [20, 30], count);
    pool.turn();
    pool.turn();
    task.ask(&pool, [0, 1], count);
    assert!(task.poll().is_empty());
    pool.turn();
    assert_eq!(task.poll(), outputs_and_end(&[0]));
}

#[test]
fn a_step_under_way_is_the_last_of_superseded_and_forgotten_work() {
    let pool = Pool::start(|| {}).unwrap();
    for is_superseded in [true, false] {
        let (job, is_in, open, steps) = gate();
        let mut task = Counting::new(Priority::screen(6));
        task.ask(&pool, [99, 99], |_| job);
        is_in.recv().unwrap();
        if !is_superseded {
            task.forget();
            assert!(pool.is_idle() && !task.is_busy());
        }
        assert!(task.ask(&pool, [0, 2], count));
        open.send(()).unwrap();
        assert_eq!(wait(&pool, &mut task), outputs_and_end(&[0, 1]));
        assert!(is_in.recv().is_err(), "the job is gone");
        assert_eq!(steps.load(Ordering::SeqCst), 1);
    }
}

#[test]
fn a_long_step_holds_up_neither_the_screen_nor_a_file() {
    let pool = Pool::start(|| {}).unwrap();
    let mut track = Plain::new(Priority::long(2));
    track.ask(&pool, (), |()| Endless);
    for priority in [Priority::screen(0), Priority::drawing(0), Priority::saving(0)] {
        let mut task = Counting::new(priority);
        task.ask(&pool, [0, 1], count);
        assert_eq!(wait(&pool, &mut task), outputs_and_end(&[0]));
    }
    assert!(track.poll().is_empty() && track.is_busy());
}

#[test]
fn a_panic_is_a_failure_that_is_not_tried_again_and_the_thread_lives_on() {
    for pool in both_pools() {
        let mut task = Counting::new(Priority::screen(5));
        task.ask(&pool, [12, 20], count);
        let news = wait(&pool, &mut task);
        assert!(
            matches!(&news[..], [News::Output(12), News::Failed(failure)] if failure.to_string() == "thirteen"),
            "{news:?}"
        );
        assert_eq!(task.failure().map(ToString::to_string).as_deref(), Some("thirteen"));
        assert!(!task.ask(&pool, [12, 20], count) && task.failure().is_some());
        assert!(task.ask(&pool, [1, 2], count) && task.failure().is_none());
        assert_eq!(wait(&pool, &mut task), outputs_and_end(&[1]));
        assert!(task.ask(&pool, [12, 20], count), "other work came between");
        assert_eq!(wait(&pool, &mut task).len(), 2);
        assert!(pool.is_idle());
    }
}

#[test]
fn a_panic_with_words_of_its_own_or_none_is_told() {
    let pool = Pool::inline();
    let mut task = Numbered::new(Priority::screen(5));
    task.ask(&pool, 7, |number| {
        let number = *number;
        once(move |_| panic!("number {number}"))
    });
    wait(&pool, &mut task);
    assert_eq!(task.failure().unwrap().to_string(), "number 7");
    task.ask(&pool, 8, |_| once(|_| std::panic::panic_any(8)));
    wait(&pool, &mut task);
    assert_eq!(task.failure().unwrap().to_string(), "no reason given");
}

#[test]
fn what_is_forgotten_may_be_asked_for_again() {
    for pool in both_pools() {
        let mut task = Counting::new(Priority::screen(6));
        task.ask(&pool, [0, 2], count);
        wait(&pool, &mut task);
        task.forget();
        assert!(task.inputs().is_none() && pool.is_idle());
        assert!(task.ask(&pool, [0, 2], count));
        assert_eq!(wait(&pool, &mut task), outputs_and_end(&[0, 1]));
        task.ask(&pool, [13, 14], count);
        wait(&pool, &mut task);
        task.forget();
        assert!(task.failure().is_none() && task.ask(&pool, [13, 14], count));
        task.forget();
        pool.turn();
        assert!(task.poll().is_empty() && pool.is_idle());
    }
}

#[test]
fn dropping_a_task_cancels_an_endless_job() {
    let pool = Pool::start(|| {}).unwrap();
    for _ in 0..2 {
        let mut endless = Counting::new(Priority::long(2));
        endless.ask(&pool, [100, u32::MAX], count);
        let mut in_one_step = Plain::new(Priority::long(0));
        in_one_step.ask(&pool, (), |()| Endless);
    }
    assert!(pool.is_idle());
    let mut next = Counting::new(Priority::long(6));
    next.ask(&pool, [0, 1], count);
    assert_eq!(wait(&pool, &mut next), outputs_and_end(&[0]));
}

#[test]
fn dropping_the_pool_ends_endless_jobs_and_their_tasks_hear_of_it() {
    for pool in both_pools() {
        let (mut track, mut basin) = (Counting::new(Priority::long(2)), Counting::new(Priority::long(6)));
        track.ask(&pool, [100, u32::MAX], count);
        basin.ask(&pool, [100, u32::MAX], count);
        drop(pool);
        assert_eq!(track.poll().last(), Some(&News::Ended));
        assert_eq!(basin.poll(), [News::Ended]);
        assert!(!track.is_busy() && !basin.is_busy());
        let other = Pool::inline();
        assert!(track.ask(&other, [0, 1], count));
        assert_eq!(wait(&other, &mut track), outputs_and_end(&[0]));
    }
}

#[test]
fn the_most_urgent_of_each_crew_does_one_step_a_turn_in_the_order_of_the_crews() {
    let pool = Pool::inline();
    let said = Arc::new(Mutex::new(Vec::new()));
    let mut tasks = Vec::new();
    for (name, priority) in [
        ("basin", Priority::long(6)),
        ("save", Priority::saving(0)),
        ("survey", Priority::long(0)),
        ("scene", Priority::drawing(0)),
        ("fit", Priority::screen(6)),
        ("prediction", Priority::screen(0)),
        ("another fit", Priority::screen(6)),
    ] {
        let mut task = Plain::new(priority);
        task.ask(&pool, (), |()| Write(name, 0, said.clone()));
        tasks.push(task);
    }
    let turn = || {
        pool.turn();
        std::mem::take(&mut *said.lock().unwrap())
    };
    assert_eq!(turn(), ["prediction", "scene", "save", "survey"]);
    assert_eq!(turn(), ["prediction", "scene", "save", "survey"]);
    assert_eq!(turn(), ["fit", "basin"]);
    assert_eq!(turn(), ["fit", "basin"]);
    assert_eq!(turn(), ["another fit"]);
    assert_eq!(turn(), ["another fit"]);
    assert!(turn().is_empty());
    tasks.iter_mut().for_each(|task| assert_eq!(task.poll(), [News::Ended]));
    assert!(pool.is_idle());
}

#[test]
fn superseding_work_takes_the_place_of_the_old() {
    let pool = Pool::inline();
    let said = Arc::new(Mutex::new(Vec::new()));
    let mut first = Numbered::new(Priority::screen(6));
    let mut second = Numbered::new(Priority::screen(6));
    first.ask(&pool, 0, |_| Write("old", 0, said.clone()));
    second.ask(&pool, 0, |_| Write("second", 0, said.clone()));
    first.ask(&pool, 1, |_| Write("new", 0, said.clone()));
    (0..4).for_each(|_| pool.turn());
    assert_eq!(*said.lock().unwrap(), ["new", "new", "second", "second"]);
}

#[test]
fn what_is_to_be_saved_is_saved_without_task_and_pool() {
    for pool in both_pools() {
        let said = Arc::new(Mutex::new(Vec::new()));
        let mut left = Plain::new(Priority::saving(1));
        left.ask(&pool, (), |()| Write("settings", 0, said.clone()));
        for name in ["one", "two"] {
            let mut task = Plain::new(Priority::saving(2));
            task.ask(&pool, (), |()| Write(name, 0, said.clone()));
        }
        drop(pool);
        assert_eq!(*said.lock().unwrap(), ["settings", "settings", "one", "one", "two", "two"]);
        assert_eq!(left.poll(), [News::Ended]);
    }
}

#[test]
fn a_pool_that_still_saves_for_a_task_that_is_gone_is_not_idle() {
    for pool in both_pools() {
        let said = Arc::new(Mutex::new(Vec::new()));
        let mut task = Plain::new(Priority::saving(0));
        task.ask(&pool, (), |()| Write("file", 0, said.clone()));
        drop(task);
        until(|| {
            pool.turn();
            pool.is_idle()
        });
        assert_eq!(*said.lock().unwrap(), ["file", "file"]);
    }
}

#[test]
fn what_was_to_be_saved_is_given_up_only_when_it_is_forgotten() {
    let pool = Pool::start(|| {}).unwrap();
    let mut task = Plain::new(Priority::saving(0));
    task.ask(&pool, (), |()| Endless);
    task.forget();
    drop((task, pool));
}

#[test]
fn every_message_wakes() {
    let woken = Arc::new(AtomicUsize::new(0));
    let counter = woken.clone();
    let pool = Pool::start(move || {
        counter.fetch_add(1, Ordering::SeqCst);
    })
    .unwrap();
    let mut task = Counting::new(Priority::screen(6));
    task.ask(&pool, [0, 3], count);
    until(|| woken.load(Ordering::SeqCst) == 4);
    assert_eq!(task.poll(), outputs_and_end(&[0, 1, 2]));
}

#[test]
fn no_thread_is_left_when_the_last_handle_is_dropped() {
    let held = Arc::new(());
    let wakes = held.clone();
    let pool = Pool::start(move || {
        let _ = &wakes;
    })
    .unwrap();
    let second = pool.clone();
    let mut task = Plain::new(Priority::long(2));
    task.ask(&pool, (), |()| {
        once(|cancel| {
            until(|| cancel.is_cancelled());
            std::thread::sleep(Duration::from_millis(50));
            1
        })
    });
    drop(pool);
    assert!(Arc::strong_count(&held) > 1 && task.poll().is_empty());
    drop(second);
    drop(task);
    assert_eq!(Arc::strong_count(&held), 1);
}

#[test]
fn a_job_may_hold_the_last_handle() {
    let pool = Pool::start(|| {}).unwrap();
    let (open, go) = channel::<()>();
    let mut task = Plain::new(Priority::long(2));
    let own = pool.clone();
    task.ask(&pool, (), |()| {
        once(move |_| {
            go.recv().unwrap();
            drop(own);
            1
        })
    });
    drop(pool);
    open.send(()).unwrap();
    let mut news = Vec::new();
    until(|| {
        news.extend(task.poll());
        !task.is_busy()
    });
    assert_eq!(news, outputs_and_end(&[1]));
}
