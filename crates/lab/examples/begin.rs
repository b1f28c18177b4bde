//! Ways to begin, one beside another, with every number to be chosen:
//!
//! ```text
//! cargo run --release -p backlit-lab --example begin -- cameras=1,2,4 starts=10 angles=10,30,45
//! cargo run --release -p backlit-lab --example begin -- no-start methods=particles,templates,search
//! BACKLIT_DATA=… cargo run --release -p backlit-lab --example begin -- take=tests/takes/balancing frames=0,35 no-start
//! ```
//!
//! `starts` may be a file of starts; `particles`, `layers`, `alive`, `decay`, `trunk` and `chain` (radians), `move` (metres), `heads`,
//! `whole` (no partitions) and `seed` are the options of particles and templates.

use std::error::Error;
use std::path::Path;

use backlit_formats::{Footage, Take, starts_file};
use backlit_lab::experiment::begin::{self, Options, Report, footage};
use backlit_lab::experiment::starts::Draw;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::particles::ParticleOptions;
use backlit_tracking::search::start::{LEVELS, Level};

type Answer<T> = Result<T, Box<dyn Error>>;

fn main() -> Answer<()> {
    let mut options = Options::default();
    let (mut starts, mut angles, mut take) = ("10".to_owned(), vec![10, 30], None);
    let mut frames = vec![0];
    let mut draw_seed = 1;
    for argument in std::env::args().skip(1) {
        let (key, value) = argument.split_once('=').unwrap_or((&argument, ""));
        match key {
            "starts" => starts = value.to_owned(),
            "angles" => angles = list(value)?,
            "cameras" => options.cameras = list(value)?,
            "methods" => options.methods = list(value)?,
            "no-start" => options.no_start = true,
            "take" => take = Some(value.to_owned()),
            "frames" => frames = list(value)?,
            "draw" => draw_seed = value.parse()?,
            "heads" => options.heads = value.parse()?,
            _ => {
                let chosen =
                    if options.no_start { &mut options.particles_no_start } else { &mut options.particles };
                set(chosen, key, value)?;
            }
        }
    }
    let levels: Vec<Level> = LEVELS.into_iter().filter(|level| angles.contains(&level.degrees)).collect();
    let cancel = CancelToken::new();
    let report = if let Some(take) = take {
        let footage = Footage::new(Take::open(Path::new(&take))?);
        let frames = footage::Frames { frames, levels, within_mm: 25.0, seed: draw_seed };
        footage::run(&footage, &options, &frames, &cancel, |_| {})?
    } else if let Ok(count) = starts.parse() {
        let cameras = options.cameras.clone();
        let starts = Draw { starts: count, levels, cameras, seed: draw_seed, ..Draw::default() }.draw()?;
        begin::run(&options, &starts, &cancel, |_| {})?
    } else {
        let mut starts = starts_file::read(Path::new(&starts))?;
        starts.retain(|start| angles.contains(&start.degrees));
        begin::run(&options, &starts, &cancel, |_| {})?
    };
    print(&report);
    Ok(())
}

fn set(options: &mut ParticleOptions, key: &str, value: &str) -> Answer<()> {
    match key {
        "particles" => options.particles = value.parse()?,
        "layers" => options.layers = value.parse()?,
        "alive" => options.alive = value.parse()?,
        "decay" => options.decay = value.parse()?,
        "trunk" => options.trunk_turn_rad = value.parse()?,
        "chain" => options.chain_turn_rad = value.parse()?,
        "move" => options.move_m = value.parse()?,
        "whole" => options.partitioned = false,
        "seed" => options.seed = value.parse()?,
        _ => return Err(format!("no option is called \"{key}\"").into()),
    }
    Ok(())
}

fn list<T: std::str::FromStr>(text: &str) -> Answer<Vec<T>>
where
    T::Err: std::fmt::Display,
{
    text.split(',')
        .map(|one| one.parse().map_err(|error: T::Err| format!("\"{one}\": {error}").into()))
        .collect()
}

fn print(report: &Report) {
    println!("cameras  off  method      found        median mm  before  evaluations  ms");
    for row in &report.rows {
        let degrees = row.degrees.map_or_else(|| "–".to_owned(), |degrees| format!("{degrees}°"));
        let before = row.median_before_mm.map_or_else(|| "–".to_owned(), |mm| format!("{mm:.0}"));
        println!(
            "{:7}  {degrees:>3}  {:10}  {:3} of {:3}   {:9.1}  {before:>6}  {:11.0}  {:.1}",
            row.cameras,
            row.method.name(),
            row.found,
            row.tried,
            row.median_mm,
            row.evaluations,
            row.ms
        );
    }
}
