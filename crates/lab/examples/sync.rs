//! Clocks of cameras that are off by known times, found from the motion of the silhouettes:
//!
//! ```text
//! cargo run --release -p backlit-lab --example sync
//! BACKLIT_DATA=… cargo run --release -p backlit-lab --example sync -- tests/takes/balancing
//! ```
//!
//! Without a take the settings are simulated; a take is to be synchronous, and every other camera is shifted by whole frames.

use std::collections::BTreeSet;
use std::error::Error;

use backlit_formats::{Footage, Take};
use backlit_lab::experiment::sync;
use backlit_tracking::cancel::CancelToken;

/// Frames that cameras of a take are shifted by.
const SHIFTS: [i64; 5] = [0, 1, 7, -12, 20];

fn main() -> Result<(), Box<dyn Error>> {
    let cancel = CancelToken::new();
    let report = match std::env::args().nth(1) {
        Some(path) => {
            let footage = Footage::new(Take::open(path.as_ref())?);
            sync::run_take(&footage, &SHIFTS, &cancel, |_| {})?
        }
        None => sync::run(&sync::Options::default(), &cancel, |_| {})?,
    };
    print!("{}", sync::table(&report));
    for case in &report.cases {
        let whys: BTreeSet<&str> = case.found.iter().filter_map(|found| found.why.as_deref()).collect();
        for why in whys {
            eprintln!("{}, {}: {why}", case.setting, case.trouble);
        }
    }
    Ok(())
}
