//! Times pieces of work against each other in one process.
//!
//! Clock rates and neighbours on the machine change from second to second, so the works of a table take turns: one sample
//! of each per round. What travels from machine to machine is the ratio to the first work.

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

    /// Runs all works in turn for about `budget` and prints the table: the median and the fastest of all rounds, in
    /// microseconds, from the first to the third quartile as a fraction of the median, and the fastest round over that of
    /// the first work: neighbours disturb it least.
    pub(crate) fn run(mut self, budget: Duration) {
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
        println!("\n{} ({} rounds)", self.title, samples[0].len());
        println!("{:<46} {:>11} {:>11} {:>7} {:>9}", "", "median µs", "min µs", "spread", "ratio");
        for ((name, _), sorted) in self.works.iter().zip(&samples) {
            let at = |part: usize| sorted[part * (sorted.len() - 1) / 4];
            let (median, min, ratio) = (at(2), at(0), at(0) / unit);
            let spread = 100.0 * ((at(3) - at(1)) / median);
            println!("{name:<46} {median:>11.1} {min:>11.1} {spread:>6.0}% {ratio:>9.2}");
        }
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
