//! First bodies, grown from nothing known, beside fitted ones, and the movement tracked with each:
//!
//! ```text
//! cargo run --release -p backlit-lab --example acquire
//! cargo run --release -p backlit-lab --example acquire -- 2 0,8
//! BACKLIT_DATA=… cargo run --release -p backlit-lab --example acquire -- tests/takes/balancing
//! ```
//!
//! How many of the builds, and the moments of the movement, the first of which nothing is known. Of a take the first frame.

use std::error::Error;

use backlit_formats::{Footage, Take};
use backlit_lab::experiment::acquire::{self, Options, footage};
use backlit_tracking::body::builtin;
use backlit_tracking::cancel::CancelToken;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let first = arguments.next();
    let cancel = CancelToken::new();
    if let Some(take) = first.as_ref().filter(|first| first.parse::<usize>().is_err()) {
        let footage = Footage::new(Take::open_with_model(take.as_ref(), builtin::full_body())?);
        let by_hand = Take::open(take.as_ref())?;
        let options = footage::Options::default();
        let report = footage::run(&footage, by_hand.model(), &options, &cancel, |_| {})?;
        println!("{}", acquire::table(&report));
        return Ok(());
    }
    let mut options = Options::default();
    if let Some(people) = first {
        options.people = people.parse()?;
    }
    if let Some(moments) = arguments.next() {
        options.moments = moments.split(',').map(str::parse).collect::<Result<_, _>>()?;
    }
    let report = acquire::run(&options, &cancel, |_| {})?;
    println!("{}\n{}", acquire::table(&report), acquire::means(&report));
    Ok(())
}
