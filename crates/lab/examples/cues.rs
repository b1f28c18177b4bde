//! The experiment on cues from the command line, as a table.
//!
//! `cargo run --release -p backlit-lab --example cues -- [seconds=3] [every=1,4,8] [movement=0,1,…] [ways=0,1,…] [wide=0.045]`

use backlit_lab::experiment::cues::{Options, run};
use backlit_lab::synthetic::occlusions::Occlusion;
use backlit_tracking::cancel::CancelToken;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut options = Options::default();
    for argument in std::env::args().skip(1) {
        let (name, value) = argument.split_once('=').ok_or("expected NAME=VALUE")?;
        let numbers = || value.split(',').map(str::parse::<usize>).collect::<Result<Vec<_>, _>>();
        match name {
            "seconds" => options.seconds = value.parse()?,
            "wide" => options.too_wide = value.parse()?,
            "pattern" => options.pattern = value.parse()?,
            "seed" => options.seed = value.parse()?,
            "every" => options.every = numbers()?,
            "movement" => {
                let all = Occlusion::ALL;
                options.movements =
                    numbers()?.iter().filter_map(|&number| all.get(number).copied()).collect();
            }
            "ways" => {
                let all = options.ways.clone();
                options.ways = numbers()?.iter().filter_map(|&number| all.get(number).cloned()).collect();
            }
            _ => return Err(format!("{name} is no option").into()),
        }
    }
    let report = run(&options, &CancelToken::new(), |progress| {
        eprintln!("{} of {}", progress.done, progress.total);
    })?;
    let mm = |value: Option<f64>| value.map_or("–".to_owned(), |value| format!("{value:.0}"));
    println!(
        "| movement | fps | way | covered, mm | 95 % | lost, % | seen, mm | nothing covered, mm | all, mm | lost and said so, % | unsure, % | frames lost | ms |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    for case in &report.cases {
        println!(
            "| {} | {} | {} | {} | {} | {:.1} | {} | {} | {:.0} | {} | {:.0} | {} | {:.2} |",
            case.movement.name(),
            case.rate,
            case.way,
            mm(case.covered_mm),
            mm(case.covered_p95_mm),
            100.0 * case.covered_lost,
            mm(case.seen_mm),
            mm(case.nothing_covered_mm),
            case.all_mm,
            mm(case.lost_said.map(|share| 100.0 * share)),
            100.0 * case.unsure,
            case.frames_lost,
            case.frame_ms,
        );
    }
    Ok(())
}
