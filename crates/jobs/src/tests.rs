use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use super::*;

const SCREEN: u8 = priority(Crew::Screen, 6);
const LONG: u8 = priority(Crew::Long, 2);
const SAVING: u8 = priority(Crew::Saving, 0);

/// Sends the numbers of a range; breaks down at thirteen.
fn count(&[mut from, to]: &[u32; 2]) -> impl Job<u32> + use<> {
    move |out: &Outbox<u32>| {
        assert!(from != 13, "thirteen");
        out.send(from);
        from += 1;
        if from == to || out.cancel().is_cancelled() { Turn::Done } else { Turn::Again }
    }
}

/// Says that its step is under way, and stays in it until it is let go; its steps are counted.
fn gate() -> (impl Job<u32>, Receiver<()>, Sender<()>, Arc<AtomicUsize>) {
    let (entered, is_in) = channel();
    let (open, go) = channel::<()>();
    let steps = Arc::new(AtomicUsize::new(0));
    let counted = steps.clone();
    let job = move |out: &Outbox<u32>| {
        counted.fetch_add(1, Ordering::SeqCst);
        entered.send(()).unwrap();
        go.recv().unwrap();
        out.send(99);
        Turn::Again
    };
    (job, is_in, open, steps)
}

/// Never ends by itself, in one step.
fn endless(out: &Outbox<u32>) -> Turn {
    until(|| out.cancel().is_cancelled());
    Turn::Done
}

type Said = Arc<Mutex<Vec<&'static str>>>;

/// Does two steps and writes its name for each.
fn write(name: &'static str, said: &Said) -> impl Job<u32> + use<> {
    let (said, mut steps) = (said.clone(), 0);
    move |_: &Outbox<u32>| {
        said.lock().unwrap().push(name);
        steps += 1;
        if steps == 2 { Turn::Done } else { Turn::Again }
    }
}

type Counting = Task<[u32; 2], u32>;

fn counting(pool: &Pool, priority: u8, range: [u32; 2]) -> Counting {
    let mut task = Counting::new(priority);
    assert!(task.ask(pool, range, count));
    task
}

fn doing(pool: &Pool, priority: u8, job: impl Job<u32> + 'static) -> Task<(), u32> {
    let mut task = Task::new(priority);
    task.ask(pool, (), |()| job);
    task
}

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

fn wait<I>(pool: &Pool, task: &mut Task<I, u32>) -> Vec<TaskEvent<u32>> {
    let mut events = Vec::new();
    until(|| {
        pool.turn();
        events.extend(task.poll());
        !task.is_busy()
    });
    events
}

fn outputs_and_end(outputs: &[u32]) -> Vec<TaskEvent<u32>> {
    outputs.iter().copied().map(TaskEvent::Output).chain([TaskEvent::Ended]).collect()
}

#[test]
fn a_job_reports_and_ends_with_and_without_threads() {
    for pool in both_pools() {
        assert!(pool.is_idle());
        let mut task = counting(&pool, SCREEN, [0, 3]);
        assert!(!pool.is_idle() && task.is_busy());
        assert_eq!(wait(&pool, &mut task), outputs_and_end(&[0, 1, 2]));
        assert!(pool.is_idle() && task.poll().is_empty() && task.failure().is_none());
        let word = "seven".to_owned();
        let once = once(move |cancel| word.len() as u32 + u32::from(cancel.is_cancelled()));
        assert_eq!(wait(&pool, &mut doing(&pool, SCREEN, once)), outputs_and_end(&[5]));
    }
}

#[test]
fn unread_news_are_not_idle_and_those_of_superseded_work_are_dropped() {
    let pool = Pool::inline();
    let mut task = counting(&pool, SCREEN, [20, 30]);
    pool.turn();
    pool.turn();
    task.ask(&pool, [0, 1], count);
    assert!(task.poll().is_empty());
    pool.turn();
    assert!(!pool.is_idle() && task.is_busy());
    assert_eq!(task.poll(), outputs_and_end(&[0]));
    assert!(pool.is_idle());
}

#[test]
fn asking_for_the_same_is_free_and_beginning_is_not() {
    for pool in both_pools() {
        let made = AtomicUsize::new(0);
        let make = |inputs: &[u32; 2]| {
            made.fetch_add(1, Ordering::SeqCst);
            count(inputs)
        };
        let mut task = Counting::new(SCREEN);
        assert!(!task.is_busy() && task.inputs().is_none());
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
    let mut track = counting(&pool, LONG, [100, u32::MAX]);
    let mut fit = counting(&pool, SCREEN, [20, u32::MAX]);
    fit.ask(&pool, [0, 2], count);
    assert_eq!(wait(&pool, &mut fit), outputs_and_end(&[0, 1]));
    track.stop();
    let events = wait(&pool, &mut track);
    assert!(events.len() > 1 && events.last() == Some(&TaskEvent::Ended), "its last outputs still arrive");
    assert!(pool.is_idle());
}

#[test]
fn a_step_under_way_is_the_last_of_superseded_and_forgotten_work() {
    let pool = Pool::start(|| {}).unwrap();
    for is_superseded in [true, false] {
        let (job, is_in, open, steps) = gate();
        let mut task = Counting::new(SCREEN);
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
    let mut track = doing(&pool, LONG, endless);
    for crew in [Crew::Screen, Crew::Drawing, Crew::Saving] {
        assert_eq!(wait(&pool, &mut counting(&pool, priority(crew, 0), [0, 1])), outputs_and_end(&[0]));
    }
    assert!(track.poll().is_empty() && track.is_busy());
}

#[test]
fn a_panic_is_a_failure_that_is_not_tried_again_and_the_thread_lives_on() {
    for pool in both_pools() {
        let mut task = counting(&pool, SCREEN, [12, 20]);
        let events = wait(&pool, &mut task);
        assert!(
            matches!(&events[..], [TaskEvent::Output(12), TaskEvent::Failed(failure)] if failure.to_string() == "thirteen"),
            "{events:?}"
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
    let (pool, number) = (Pool::inline(), 7);
    let mut task = doing(&pool, SCREEN, once(move |_| panic!("number {number}")));
    wait(&pool, &mut task);
    assert_eq!(task.failure().unwrap().to_string(), "number 7");
    let mut task = doing(&pool, SCREEN, once(|_| std::panic::panic_any(8)));
    let mut told = Vec::new();
    pool.turn();
    assert!(task.outputs(|failure| told.push(failure.to_string())).is_empty());
    assert_eq!(told, ["no reason given"]);
}

#[test]
fn what_is_forgotten_may_be_asked_for_again() {
    for pool in both_pools() {
        let mut task = counting(&pool, SCREEN, [0, 2]);
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
        drop((counting(&pool, LONG, [100, u32::MAX]), doing(&pool, LONG, endless)));
    }
    assert!(pool.is_idle());
    assert_eq!(wait(&pool, &mut counting(&pool, LONG, [0, 1])), outputs_and_end(&[0]));
}

#[test]
fn dropping_the_pool_ends_endless_jobs_and_their_tasks_hear_of_it() {
    for pool in both_pools() {
        let mut track = counting(&pool, LONG, [100, u32::MAX]);
        let mut basin = counting(&pool, LONG + 1, [100, u32::MAX]);
        drop(pool);
        assert_eq!(track.poll().last(), Some(&TaskEvent::Ended));
        assert_eq!(basin.poll(), [TaskEvent::Ended]);
        assert!(!track.is_busy() && !basin.is_busy());
        let other = Pool::inline();
        assert!(track.ask(&other, [0, 1], count));
        assert_eq!(wait(&other, &mut track), outputs_and_end(&[0]));
    }
}

#[test]
fn the_most_urgent_of_each_crew_does_one_step_a_turn_in_the_order_of_the_crews() {
    let (pool, said) = (Pool::inline(), Said::default());
    let kinds = [
        ("basin", Crew::Long, 6),
        ("save", Crew::Saving, 0),
        ("survey", Crew::Long, 0),
        ("scene", Crew::Drawing, 0),
        ("fit", Crew::Screen, 6),
        ("prediction", Crew::Screen, 0),
        ("another fit", Crew::Screen, 6),
    ];
    let mut tasks = kinds.map(|(name, crew, level)| doing(&pool, priority(crew, level), write(name, &said)));
    let first = ["prediction", "scene", "save", "survey"];
    for expected in [&first[..], &first, &["fit", "basin"], &["fit", "basin"]] {
        pool.turn();
        assert_eq!(std::mem::take(&mut *said.lock().unwrap()), expected);
    }
    (0..3).for_each(|_| pool.turn());
    assert_eq!(*said.lock().unwrap(), ["another fit"; 2]);
    tasks.iter_mut().for_each(|task| assert_eq!(task.poll(), [TaskEvent::Ended]));
    assert!(pool.is_idle());
}

#[test]
fn superseding_work_takes_the_place_of_the_old() {
    let (pool, said) = (Pool::inline(), Said::default());
    let mut first = doing(&pool, SCREEN, write("old", &said));
    let _second = doing(&pool, SCREEN, write("second", &said));
    first.begin(&pool, (), |()| write("new", &said));
    (0..4).for_each(|_| pool.turn());
    assert_eq!(*said.lock().unwrap(), ["new", "new", "second", "second"]);
}

#[test]
fn what_is_to_be_saved_is_saved_without_task_and_pool() {
    for pool in both_pools() {
        let said = Said::default();
        let mut left = doing(&pool, SAVING, write("settings", &said));
        for name in ["one", "two"] {
            drop(doing(&pool, SAVING + 1, write(name, &said)));
        }
        drop(pool);
        assert_eq!(*said.lock().unwrap(), ["settings", "settings", "one", "one", "two", "two"]);
        assert_eq!(left.poll(), [TaskEvent::Ended]);
    }
}

#[test]
fn a_pool_that_still_saves_for_a_task_that_is_gone_is_not_idle() {
    for pool in both_pools() {
        let said = Said::default();
        drop(doing(&pool, SAVING, write("file", &said)));
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
    let mut task = doing(&pool, SAVING, endless);
    task.forget();
    drop((task, pool));
}

#[test]
fn every_message_wakes() {
    let woken = Arc::new(AtomicUsize::new(0));
    let counter = woken.clone();
    let wake = move || {
        counter.fetch_add(1, Ordering::SeqCst);
    };
    let pool = Pool::start(wake).unwrap();
    let mut task = counting(&pool, SCREEN, [0, 3]);
    until(|| woken.load(Ordering::SeqCst) == 4);
    assert_eq!(task.poll(), outputs_and_end(&[0, 1, 2]));
}

#[test]
fn no_thread_is_left_when_the_last_handle_is_dropped() {
    let held = Arc::new(());
    let wakes = held.clone();
    let wake = move || {
        let _ = &wakes;
    };
    let pool = Pool::start(wake).unwrap();
    let second = pool.clone();
    let slow = |cancel: &backlit_cancel::CancelToken| {
        until(|| cancel.is_cancelled());
        std::thread::sleep(Duration::from_millis(50));
        1
    };
    let mut task = doing(&pool, LONG, once(slow));
    drop(pool);
    assert!(Arc::strong_count(&held) > 1 && task.poll().is_empty());
    drop((second, task));
    assert_eq!(Arc::strong_count(&held), 1);
}

#[test]
fn a_job_may_hold_the_last_handle() {
    let pool = Pool::start(|| {}).unwrap();
    let (open, go) = channel::<()>();
    let own = pool.clone();
    let work = move |_: &backlit_cancel::CancelToken| {
        go.recv().unwrap();
        drop(own);
        1
    };
    let mut task = doing(&pool, LONG, once(work));
    drop(pool);
    open.send(()).unwrap();
    assert_eq!(wait(&Pool::inline(), &mut task), outputs_and_end(&[1]));
}
