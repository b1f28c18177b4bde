//! Times pieces of work against each other in one process.
//!
//! Clock rates and neighbours on the machine change from second to second, so the works of a table take turns: one sample
//! of each per round. What travels from machine to machine is the ratio to the first work.

use std::fmt;
use std::time::{Duration, Instant};

/// A sample repeats its work until about this long has passed, so that the clock's own cost does not count.
const SAMPLE: Duration = Duration::from_millis(2);

/// And at least so often, as iterations follow each other in life: the caches that the work before it has emptied
/// count once.
const FEWEST_RUNS: u32 = 8;

/// Works that take longer than this run once a sample.
const LONG: Duration = Duration::from_millis(50);

/// Fewer rounds than this have no quartiles worth the name.
const FEWEST_ROUNDS: usize = 15;

/// Works to be compared.
pub(crate) struct Table<'a> {
    title: String,
    works: Vec<(String, Box<dyn FnMut() + 'a>)>,
}

/// How long one work took, in microseconds.
pub(crate) struct Timing {
    /// The work's name.
    pub(crate) name: String,
    /// The median of all rounds.
    pub(crate) median: f64,
    /// The fastest round.
    pub(crate) min: f64,
    /// From the first to the third quartile, as a fraction of the median.
    pub(crate) spread: f64,
    /// The fastest round over that of the table's first work: neighbours disturb it least.
    pub(crate) ratio: f64,
}

impl<'a> Table<'a> {
    /// An empty table.
    pub(crate) fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), works: Vec::new() }
    }

    /// Adds a work. What it computes must go through [`std::hint::black_box`], or there is nothing to time.
    pub(crate) fn add(mut self, name: impl Into<String>, work: impl FnMut() + 'a) -> Self {
        self.works.push((name.into(), Box::new(work)));
        self
    }

    /// Runs all works in turn for about `budget`, prints the table and returns its rows.
    pub(crate) fn run(mut self, budget: Duration) -> Vec<Timing> {
        let repeats: Vec<u32> = self.works.iter_mut().map(|(_, work)| repeats(work)).collect();
        let mut samples = vec![Vec::new(); self.works.len()];
        let start = Instant::now();
        while samples[0].len() < FEWEST_ROUNDS || start.elapsed() < budget {
            for (((_, work), &repeats), samples) in self.works.iter_mut().zip(&repeats).zip(&mut samples) {
                samples.push(sample(work, repeats));
            }
        }
        samples.iter_mut().for_each(|samples| samples.sort_by(f64::total_cmp));
        let unit = samples[0][0];
        let timings: Vec<Timing> = self
            .works
            .iter()
            .zip(&samples)
            .map(|((name, _), sorted)| {
                let at = |part: usize| sorted[part * (sorted.len() - 1) / 4];
                let spread = (at(3) - at(1)) / at(2);
                Timing { name: name.clone(), median: at(2), min: at(0), spread, ratio: at(0) / unit }
            })
            .collect();
        println!("\n{} ({} rounds)", self.title, samples[0].len());
        println!("{:<46} {:>11} {:>11} {:>7} {:>9}", "", "median µs", "min µs", "spread", "ratio");
        timings.iter().for_each(|timing| println!("{timing}"));
        timings
    }
}

impl fmt::Display for Timing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, median, min, spread, ratio } = self;
        write!(f, "{name:<46} {median:>11.1} {min:>11.1} {:>6.0}% {ratio:>9.2}", 100.0 * spread)
    }
}

/// How often a work runs in a sample; warms it up on the way.
fn repeats(work: &mut dyn FnMut()) -> u32 {
    let mut repeats = 1;
    loop {
        let once = sample(work, repeats);
        let is_long = once > LONG.as_secs_f64() * 1e6;
        let fills_the_sample = once * f64::from(repeats) >= SAMPLE.as_secs_f64() * 1e6;
        if is_long || (fills_the_sample && repeats >= FEWEST_RUNS) {
            return repeats;
        }
        repeats *= 2;
    }
}

/// Microseconds of one run, averaged over this many.
fn sample(work: &mut dyn FnMut(), repeats: u32) -> f64 {
    let start = Instant::now();
    (0..repeats).for_each(|_| work());
    start.elapsed().as_secs_f64() * 1e6 / f64::from(repeats)
}
