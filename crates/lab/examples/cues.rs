//! The experiment on cues from the command line, as a table.
//!
//! `cargo run --release -p backlit-lab --example cues -- [seconds=3] [every=1,4,8] [movement=0,1,…] [ways=0,1,…] [wide=0.045]
//! [keypoints.weight=NUMBER …] [variant='WAY/keypoints.weight:NUMBER;flow.scale_m:NUMBER' …]`; ways are
//! counted from 0. With `prior=FILE` each way is followed with a prior learnt from motion, too; `prior=FILE,POSE,STEP,APART` sets the
//! weights of poses, steps and of limbs inside one another, and `cameras=1` leaves the second telephone out.

use std::path::Path;
use std::sync::Arc;

use backlit_formats::prior_file;
use backlit_lab::experiment::cues::{Options, Report, run, ways, with_prior};
use backlit_lab::synthetic::occlusions::Occlusion;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::residual::learnt_prior::LearntPrior;

/// Changes a number of all ways that have it: `keypoints.weight`, `flow.scale_m`, `coverage.seen_share` and so on. A cue that
/// a way does without stays off.
fn tune(options: &mut Options, name: &str, value: f64) -> Result<(), String> {
    for cues in options.ways.iter_mut().filter_map(|way| way.cues.as_mut()) {
        let (group, field) = name.split_once('.').unwrap_or_default();
        let strength = match group {
            "keypoints" => &mut cues.keypoints,
            "flow" => &mut cues.flow,
            "edges" => &mut cues.edges,
            "stereo" => &mut cues.stereo,
            "coverage" => {
                match field {
                    "seen_share" => cues.coverage.seen_share = value,
                    "margin_m" => cues.coverage.margin_m = value,
                    "enough_cameras" => cues.coverage.enough_cameras = value as usize,
                    _ => return Err(format!("{name} is no option")),
                }
                continue;
            }
            _ => return Err(format!("{name} is no option")),
        };
        match field {
            "weight" if strength.weight > 0.0 => strength.weight = value,
            "weight" => {}
            "scale_m" => strength.scale_m = value,
            _ => return Err(format!("{name} is no option")),
        }
    }
    Ok(())
}

fn print_table(report: &Report) {
    let mm = |value: Option<f64>| value.map_or("–".to_owned(), |value| format!("{value:.0}"));
    println!(
        "| movement | fps | way | covered, mm | 95 % | lost, % | feet, mm | seen, mm | nothing covered, mm | all, mm | lost and said so, % | unsure, % | frames lost | ms |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    for case in &report.cases {
        println!(
            "| {} | {} | {} | {} | {} | {:.1} | {} | {} | {} | {:.0} | {} | {:.0} | {} | {:.2} |",
            case.movement.name(),
            case.rate,
            case.way,
            mm(case.covered_mm),
            mm(case.covered_p95_mm),
            100.0 * case.covered_lost,
            mm(case.feet_mm),
            mm(case.seen_mm),
            mm(case.nothing_covered_mm),
            case.all_mm,
            mm(case.lost_said.map(|share| 100.0 * share)),
            100.0 * case.unsure,
            case.frames_lost,
            case.frame_ms,
        );
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (mut options, mut priors) = (Options::default(), Vec::new());
    for argument in std::env::args().skip(1) {
        let (name, value) = argument.split_once('=').ok_or("expected NAME=VALUE")?;
        let numbers = || value.split(',').map(str::parse::<usize>).collect::<Result<Vec<_>, _>>();
        match name {
            "seconds" => options.seconds = value.parse()?,
            "wide" => options.too_wide = value.parse()?,
            "pattern" => options.pattern = value.parse()?,
            "prior" => priors.push(value.to_owned()),
            "cameras" => options.cameras = value.parse()?,
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
            "size" => {
                let height: u64 = value.parse()?;
                options.size_px = [height * 9 / 16, height];
            }
            "variant" => {
                let (base, changes) = value.split_once('/').ok_or("expected WAY/NAME:VALUE;…")?;
                let mut way = ways().get(base.parse::<usize>()?).cloned().ok_or("no such way")?;
                way.name = format!("{}, {changes}", way.name);
                let mut one = Options { ways: vec![way], ..Options::default() };
                for change in changes.split(';') {
                    let (name, value) = change.split_once(':').ok_or("expected NAME:VALUE")?;
                    tune(&mut one, name, value.parse()?)?;
                }
                options.ways.push(one.ways.remove(0));
            }
            _ if name.contains('.') => tune(&mut options, name, value.parse()?)?,
            _ => return Err(format!("{name} is no option").into()),
        }
    }
    let plain = options.ways.clone();
    for words in &priors {
        let mut words = words.split(',');
        let statistics = prior_file::read(Path::new(words.next().unwrap_or_default()))?;
        let mut prior = LearntPrior::new(Arc::new(statistics));
        let weights = words.map(str::parse::<f64>).collect::<Result<Vec<_>, _>>()?;
        let mut more = match weights[..] {
            [pose_weight, step_weight, ..] => {
                (prior.pose_weight, prior.step_weight) = (pose_weight, step_weight);
                with_prior(&plain, &prior)
            }
            _ => with_prior(&plain, &prior),
        };
        for way in more.iter_mut().filter(|_| !weights.is_empty()) {
            way.name += &format!(" {weights:?}");
            way.fit.interpenetration_weight = weights.get(2).copied().unwrap_or(0.0);
        }
        options.ways.extend(more);
    }
    let report = run(&options, &CancelToken::new(), |progress| {
        eprintln!("{} of {}", progress.done, progress.total);
    })?;
    print_table(&report);
    Ok(())
}
