//! Deterministic fuzzing of every reader: the same data back or a typed error in plain words, within 1 s and 500 MB.
//!
//! `cargo test -p backlit-formats --test fuzz` runs some hundred cases a target. The long run is
//! `BACKLIT_FUZZ_CASES=1000000 cargo test -p backlit-formats --test fuzz -- --ignored --nocapture --test-threads 1`, in a development
//! build, where sums that run over are panics; `BACKLIT_FUZZ=NAME,NAME` runs these targets only, `BACKLIT_FUZZ_SECONDS` ends each after
//! that much processor time. Its figures stand in `docs/trust.md`. A case that breaks the promise is written to the folder for temporary
//! files and named; it is kept in `corpus/TARGET/found-…` once it is mended.

#![expect(clippy::unwrap_used, reason = "tests, where a panic is the answer")]

mod engine;
mod mutate;
mod seeds;
mod targets;

use std::path::PathBuf;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use engine::{Fault, Figures, Target};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// A case that still runs after this many looks, one a second, is a fault.
const PATIENCE_LOOKS: u32 = 30;

fn keep(target: &str, bytes: &[u8]) -> PathBuf {
    let path = std::env::temp_dir().join(format!("backlit-fuzz-{target}"));
    std::fs::write(&path, bytes).unwrap();
    path
}

fn check(target: &Target, result: Result<Figures, Box<Fault>>) -> Figures {
    match result {
        Ok(figures) => figures,
        Err(fault) => panic!("{}; the case is {}", fault.what, keep(target.name, &fault.bytes).display()),
    }
}

#[test]
fn a_few_hundred_cases_of_every_reader() {
    for target in targets::all() {
        check(&target, engine::run(&target, target.short, f64::INFINITY, &|_| ()));
    }
}

/// Every reader answers each seed that is cut, with one byte changed, or whose beginning noise follows; and texts that are nested
/// without end are refused.
#[test]
fn cut_changed_and_deep_files_are_answered() {
    let mut random = Pcg64Mcg::seed_from_u64(1);
    for target in targets::all() {
        let answer = |bytes: &[u8]| {
            let outcome = engine::one(&target, bytes, &mut Figures::default());
            outcome.unwrap_or_else(|fault| panic!("{}; {}", fault.what, keep(target.name, bytes).display()))
        };
        for seed in &target.seeds {
            for place in (0..seed.len()).step_by(1 + seed.len() / 100) {
                answer(&seed[..place]);
                let mut changed = seed.clone();
                changed[place] = random.random();
                answer(&changed);
            }
            for head in 0..12 {
                let noise: [u8; 200] = random.random();
                answer(&[&seed[..head.min(seed.len())], &noise].concat());
            }
        }
        // A table of labels without rows is empty, whatever its header.
        if target.syntax == mutate::Syntax::Text && target.name != "labels" {
            for (head, open) in
                [("{\"format\": \"backlit-pose 1\", \"root\": ", "["), ("a = ", "["), ("", "<a>")]
            {
                let bytes = head.to_owned() + &open.repeat(100_000);
                assert!(matches!(answer(bytes.as_bytes()), engine::Outcome::Refused(_)), "{}", target.name);
            }
        }
    }
}

#[test]
fn runs_are_the_same_every_time() {
    let target = targets::all().remove(0);
    let cases = || {
        let all = Mutex::new(Vec::new());
        engine::run(&target, 50, f64::INFINITY, &|bytes| all.lock().unwrap().push(bytes.to_vec())).unwrap();
        all.into_inner().unwrap()
    };
    assert_eq!(cases(), cases());
}

#[test]
fn what_was_found_once_is_answered() {
    for target in targets::all() {
        for bytes in seeds::kept(target.name, true) {
            let mut figures = Figures::default();
            if let Err(fault) = engine::one(&target, &bytes, &mut figures) {
                panic!("{}", fault.what);
            }
        }
    }
}

/// The engine itself: a reader that panics, one that dawdles, one that hoards and one that shouts are all found.
#[test]
fn faults_are_found() {
    type Reader = fn(&[u8]) -> engine::Outcome;
    let readers: [(&str, Reader); 4] = [
        ("panics", |bytes| {
            assert!(!bytes.starts_with(b"[["));
            engine::Outcome::Read
        }),
        ("takes", |bytes| {
            // On a machine that others use three seconds of the clock may be less than one of work.
            let began = engine::processor_time();
            while bytes.starts_with(b"[[") && engine::processor_time() - began < Duration::from_secs(2) {}
            engine::Outcome::Read
        }),
        ("holds", |bytes| {
            let more = if bytes.starts_with(b"[[") { 1 << 30 } else { 1 };
            drop(std::hint::black_box(Vec::<u8>::with_capacity(more)));
            engine::Outcome::Read
        }),
        ("\\u{1b}", |bytes| match bytes.starts_with(b"[[") {
            true => engine::Outcome::Refused("a\u{1b}[31m".to_owned()),
            false => engine::Outcome::Read,
        }),
    ];
    for (what, read) in readers {
        let (syntax, seeds) = (mutate::Syntax::Text, vec![b"[1, 2, 3]".to_vec()]);
        let target = Target { name: "none", syntax, seeds, words: "", read, short: 0 };
        let fault = engine::run(&target, 2000, f64::INFINITY, &|_| ()).unwrap_err();
        assert!(fault.what.contains(what) && fault.bytes.starts_with(b"[["), "{}", fault.what);
    }
}

/// The case that runs now: how many went before, its target, its bytes.
type Current = Mutex<(u64, &'static str, Vec<u8>)>;

/// Ends the program where one case does not end, and keeps the case. It counts its own looks and not the clock's time, which goes on
/// while a machine sleeps.
fn watch(current: &Current) {
    let (mut last, mut looks) = (0, 0);
    loop {
        std::thread::sleep(Duration::from_secs(1));
        let current = current.lock().unwrap();
        looks = if current.0 == last { looks + 1 } else { 0 };
        last = current.0;
        if looks > PATIENCE_LOOKS && !current.1.is_empty() {
            let path = keep(current.1, &current.2);
            eprintln!("{}: a case does not end; it is {}", current.1, path.display());
            std::process::exit(1);
        }
    }
}

/// The long run; see above.
#[test]
#[ignore = "a million cases a target take hours"]
fn many_cases_of_every_reader() {
    let number = |name: &str| std::env::var(name).ok().and_then(|text| text.parse::<u64>().ok());
    let cases = number("BACKLIT_FUZZ_CASES").unwrap_or(1_000_000);
    let seconds = number("BACKLIT_FUZZ_SECONDS").map_or(f64::INFINITY, |seconds| seconds as f64);
    let only = std::env::var("BACKLIT_FUZZ").ok();
    let current: Arc<Current> = Arc::default();
    let watched = Arc::clone(&current);
    std::thread::spawn(move || watch(&watched));
    println!("\n| target | cases | read | answers | seconds | slowest, ms | most memory, MB |");
    println!("|---|---|---|---|---|---|---|");
    let wanted =
        |target: &Target| only.as_deref().is_none_or(|only| only.split(',').any(|name| name == target.name));
    let mut faults = Vec::new();
    for target in targets::all().into_iter().filter(wanted) {
        let tell = |bytes: &[u8]| {
            let mut current = current.lock().unwrap();
            current.0 += 1;
            current.1 = target.name;
            bytes.clone_into(&mut current.2);
        };
        let result = engine::run(&target, cases, seconds, &tell);
        current.lock().unwrap().1 = "";
        match result {
            Ok(Figures { cases, read, answers, seconds, slowest, most_memory }) => println!(
                "| {} | {cases} | {read} | {answers} | {seconds:.0} | {:.1} | {:.1} |",
                target.name,
                slowest.as_secs_f64() * 1e3,
                most_memory as f64 / 1e6
            ),
            Err(fault) => {
                println!("FAULT {}; the case is {}", fault.what, keep(target.name, &fault.bytes).display());
                faults.push(target.name);
            }
        }
    }
    assert!(faults.is_empty(), "{faults:?}");
}
