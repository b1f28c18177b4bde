//! One run of a target: cases from its seeds, each within a second and 500 MB, and what came of them.
//!
//! A run is decided by its seed and its count of cases. A case whose answer was not seen before (another message, but for its
//! numbers and names) joins the seeds that later cases are made from: so the run goes on from inputs that got further.

use std::collections::{BTreeSet, VecDeque};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Duration;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::mutate::{Mutator, Syntax};

/// Longest time of one case.
pub(crate) const LONGEST: Duration = Duration::from_secs(1);
/// Most memory that one case may hold at a time, bytes.
pub(crate) const MOST_MEMORY: u64 = 500 << 20;
/// Longest message of an error, characters: two names of files, what is there, what was expected.
const LONGEST_MESSAGE: usize = 600;
/// Cases of each kind that are kept beside the seeds.
const MOST_KEPT: usize = 300;
/// Words of the program's own language, which say nothing to the reader of a message.
const FOREIGN: &str = "u16 u32 u64 i32 i64 f32 f64 usize serde struct enum variant seq private unwrap None Some Err \
    DVec3 deserialize";

/// A reader to be tried.
pub(crate) struct Target {
    pub(crate) name: &'static str,
    pub(crate) syntax: Syntax,
    /// Whole files, made by our own writers or by hand.
    pub(crate) seeds: Vec<Vec<u8>>,
    /// What the format's files say, between `¦`.
    pub(crate) words: &'static str,
    /// Reads; panics where what it read does not survive its own file.
    pub(crate) read: fn(&[u8]) -> Outcome,
    /// Cases of the short run.
    pub(crate) short: u64,
}

/// What a reader said.
pub(crate) enum Outcome {
    Read,
    Refused(String),
}

impl<T, E: std::fmt::Display> From<Result<T, E>> for Outcome {
    fn from(result: Result<T, E>) -> Self {
        match result {
            Ok(_) => Self::Read,
            Err(error) => Self::Refused(error.to_string()),
        }
    }
}

/// What a run took.
#[derive(Debug, Default)]
pub(crate) struct Figures {
    pub(crate) cases: u64,
    pub(crate) read: u64,
    pub(crate) answers: usize,
    pub(crate) seconds: f64,
    pub(crate) slowest: Duration,
    pub(crate) most_memory: u64,
}

/// A case that breaks a promise.
#[derive(Debug)]
pub(crate) struct Fault {
    pub(crate) what: String,
    pub(crate) bytes: Vec<u8>,
}

/// Time of this thread on a processor: others that use the machine do not count.
pub(crate) fn processor_time() -> Duration {
    cpu_time::ThreadTime::now().as_duration()
}

/// Runs a target, for `most_seconds` of processor time at most; every case is told to `watch` before it runs.
pub(crate) fn run(
    target: &Target,
    cases: u64,
    most_seconds: f64,
    watch: &dyn Fn(&[u8]),
) -> Result<Figures, Box<Fault>> {
    let began = processor_time();
    let mut random = Pcg64Mcg::seed_from_u64(16);
    let seeds = &target.seeds;
    // Long cases are tried, but none is made longer still.
    let largest = 2000 + 3 * seeds.iter().map(Vec::len).max().unwrap_or(0);
    let mutator = Mutator::new(target.syntax, target.words, seeds);
    // What was read, and what was refused in a way that is new.
    let (mut read, mut refused) = (VecDeque::from(seeds.clone()), VecDeque::new());
    let mut seen = BTreeSet::new();
    let mut figures = Figures { cases, ..Figures::default() };
    for seed in seeds {
        let answer = one(target, seed, &mut figures)?;
        seen.insert(shape(&answer));
        assert!(matches!(answer, Outcome::Read), "{}: a seed is refused: {}", target.name, words_of(&answer));
    }
    assert!(!seeds.is_empty(), "{}: there are no seeds", target.name);
    for case in 0..cases {
        if case % 1024 == 1023 && (processor_time() - began).as_secs_f64() > most_seconds {
            figures.cases = case;
            break;
        }
        let pick = |random: &mut Pcg64Mcg| {
            let pool = if refused.is_empty() || random.random_range(0..10) < 6 { &read } else { &refused };
            &pool[random.random_range(0..pool.len())]
        };
        let (from, other) = (pick(&mut random), pick(&mut random));
        let bytes = mutator.mutate(from, other, &mut random);
        watch(&bytes);
        let answer = one(target, &bytes, &mut figures)?;
        let is_read = matches!(answer, Outcome::Read);
        figures.read += u64::from(is_read);
        let is_new = seen.insert(shape(&answer));
        if bytes.len() > largest {
            continue;
        }
        if is_read && read.len() < seeds.len() + MOST_KEPT {
            read.push_back(bytes);
        } else if is_read && random.random_range(0..20) == 0 {
            // The seeds stay; of the others some are replaced.
            let at = random.random_range(seeds.len()..read.len());
            read[at] = bytes;
        } else if is_new {
            if refused.len() >= MOST_KEPT {
                refused.pop_front();
            }
            refused.push_back(bytes);
        }
    }
    figures.answers = seen.len();
    figures.seconds = (processor_time() - began).as_secs_f64();
    Ok(figures)
}

pub(crate) fn one(target: &Target, bytes: &[u8], figures: &mut Figures) -> Result<Outcome, Box<Fault>> {
    let began = processor_time();
    let mut answer = None;
    let memory = allocation_counter::measure(|| {
        answer = catch_unwind(AssertUnwindSafe(|| (target.read)(bytes))).ok();
    });
    let took = processor_time() - began;
    figures.slowest = figures.slowest.max(took);
    figures.most_memory = figures.most_memory.max(memory.bytes_max);
    let fault = |what: String| {
        Err(Box::new(Fault { what: format!("{}: {what}", target.name), bytes: bytes.to_vec() }))
    };
    let Some(answer) = answer else { return fault("it panics".to_owned()) };
    if took > LONGEST {
        return fault(format!("it takes {took:?}"));
    }
    if memory.bytes_max > MOST_MEMORY {
        return fault(format!("it holds {} bytes", memory.bytes_max));
    }
    match message_fault(&answer, bytes) {
        Some(what) => fault(what),
        None => Ok(answer),
    }
}

/// What is wrong with an error's message about a case. Words that the case itself has are quoted, not said.
fn message_fault(answer: &Outcome, case: &[u8]) -> Option<String> {
    let Outcome::Refused(message) = answer else { return None };
    if message.chars().count() > LONGEST_MESSAGE {
        let head: String = message.chars().take(300).collect();
        return Some(format!("its message has {} characters: {head}…", message.chars().count()));
    }
    if let Some(letter) = message.chars().find(|letter| letter.is_control()) {
        return Some(format!("its message has {letter:?}: {message:?}"));
    }
    // Between backticks stand words of the file.
    let own = message.split('`').step_by(2);
    let mut words = own.flat_map(|text| {
        text.split(|letter: char| letter.is_whitespace() || "\"'()[]<>,;:".contains(letter))
    });
    let is_quoted = |word: &str| case.windows(word.len()).any(|part| part == word.as_bytes());
    let foreign =
        words.find(|word| FOREIGN.split(' ').any(|foreign| foreign == *word) && !is_quoted(word))?;
    Some(format!("its message says {foreign}: {message}"))
}

fn words_of(answer: &Outcome) -> &str {
    match answer {
        Outcome::Read => "read",
        Outcome::Refused(message) => message,
    }
}

/// An answer without its numbers and quoted names.
fn shape(answer: &Outcome) -> u64 {
    let mut hasher = DefaultHasher::new();
    for (index, part) in words_of(answer).split('"').enumerate() {
        if index % 2 == 0 {
            part.chars().filter(|letter| letter.is_alphabetic()).for_each(|letter| letter.hash(&mut hasher));
        }
    }
    hasher.finish()
}
