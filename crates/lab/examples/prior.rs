//! Recorded people followed with and without a prior that was learnt from others.
//!
//! `cargo run --release -p backlit-lab --example prior -- motions=DIR [hold=05,60,94] [cameras=24,-13] [wide=2] [rate=15] [seconds=4]
//! [components=12] [floor=0.15] [degrees=4] [weights=POSE,STEP,APART …]`: files of DIR whose names begin with one of `hold` are
//! followed, the prior is learnt from all others.

use std::path::PathBuf;
use std::sync::Arc;

use backlit_formats::{bvh, prior_file};
use backlit_lab::experiment::cues::Way;
use backlit_lab::experiment::prior::{Options, run};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::FitOptions;
use backlit_tracking::prior::{Clip, TrainOptions, train};
use backlit_tracking::residual::learnt_prior::LearntPrior;

type Error = Box<dyn std::error::Error>;

struct Settings {
    folder: PathBuf,
    hold: Vec<String>,
    training: TrainOptions,
    weights: Vec<Vec<f64>>,
    options: Options,
    out: Option<PathBuf>,
}

fn settings() -> Result<Settings, Error> {
    let options = Options {
        cameras_degrees: vec![24.0, -13.0],
        every_seconds: 1.0 / 15.0,
        seconds: 4.0,
        size_px: [180, 320],
        too_wide_px: 2.0,
        seed: 1,
        ways: Vec::new(),
    };
    let hold = ["05", "60", "94"].map(str::to_owned).to_vec();
    let training = TrainOptions::default();
    let mut all =
        Settings { folder: PathBuf::new(), hold, training, weights: Vec::new(), options, out: None };
    for argument in std::env::args().skip(1) {
        let (name, value) = argument.split_once('=').ok_or("expected NAME=VALUE")?;
        let numbers = || value.split(',').map(str::parse::<f64>).collect::<Result<Vec<_>, _>>();
        match name {
            "motions" => all.folder = value.into(),
            "out" => all.out = Some(value.into()),
            "hold" => all.hold = value.split(',').map(str::to_owned).collect(),
            "cameras" => all.options.cameras_degrees = numbers()?,
            "wide" => all.options.too_wide_px = value.parse()?,
            "rate" => all.options.every_seconds = 1.0 / value.parse::<f64>()?,
            "seconds" => all.options.seconds = value.parse()?,
            "components" => all.training.components = value.parse()?,
            "floor" => all.training.floor = value.parse()?,
            "degrees" => all.training.degrees = value.parse()?,
            "weights" => all.weights.push(numbers()?),
            _ => return Err(format!("{name} is no option").into()),
        }
    }
    Ok(all)
}

fn main() -> Result<(), Error> {
    let Settings { folder, hold, training, weights, mut options, out } = settings()?;
    let mut files: Vec<PathBuf> = Vec::new();
    for entry in std::fs::read_dir(&folder)? {
        files.push(entry?.path());
    }
    files.retain(|path| path.extension().is_some_and(|extension| extension == "bvh"));
    files.sort();
    let (mut held, mut learnt): (Vec<(String, Clip)>, Vec<Clip>) = Default::default();
    for path in files {
        let clip = bvh::read(&path)?.body_points(&path)?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        match hold.iter().any(|subject| name.starts_with(subject)) {
            true => held.push((name, clip)),
            false => learnt.push(clip),
        }
    }
    let prior = train(&learnt, &training, "others")?;
    if let Some(out) = out {
        prior_file::write(&out, &prior)?;
    }
    for part in prior.parts() {
        let density = |clips: &mut dyn Iterator<Item = &Clip>| {
            let points = clips.flat_map(|clip| clip.frames.iter().step_by(5));
            let numbers = points.filter_map(|points| points.numbers(part.directions()));
            let all: Vec<f64> = numbers.map(|x| part.poses().log_density(&x.into())).collect();
            all.iter().sum::<f64>() / all.len().max(1) as f64
        };
        let (seen, unseen) = (density(&mut learnt.iter()), density(&mut held.iter().map(|one| &one.1)));
        let step = part.step();
        println!("{}: ln p {seen:.2}, of others {unseen:.2}; steps as t^{:.2}", part.name(), step.exponent);
    }
    let statistics = Arc::new(prior);
    let way = |name: String, fit| Way { name, cues: None, fit };
    options.ways.push(way("silhouettes alone".to_owned(), FitOptions::default()));
    for numbers in &weights {
        let [pose_weight, step_weight, apart] = numbers[..] else {
            return Err("expected weights=POSE,STEP,APART".into());
        };
        let prior = LearntPrior { pose_weight, step_weight, ..LearntPrior::new(Arc::clone(&statistics)) };
        let prior = (pose_weight + step_weight > 0.0).then_some(prior);
        let fit = FitOptions { prior, interpenetration_weight: apart, ..FitOptions::default() };
        options.ways.push(way(format!("prior {pose_weight}, steps {step_weight}, apart {apart}"), fit));
    }
    let cases = run(&held, &options, &CancelToken::new(), |progress| {
        eprintln!("{} of {}", progress.done, progress.total);
    })?;
    println!("\n| motion | way | mean, mm | 95 % | lost, % | ms |\n|---|---|---|---|---|---|");
    for case in &cases {
        println!(
            "| {} | {} | {:.0} | {:.0} | {:.1} | {:.2} |",
            case.motion,
            case.way,
            case.mean_mm,
            case.p95_mm,
            100.0 * case.lost,
            case.frame_ms
        );
    }
    for way in &options.ways {
        let of_way: Vec<_> = cases.iter().filter(|case| case.way == way.name).collect();
        let mean = |value: fn(&backlit_lab::experiment::prior::Case) -> f64| {
            of_way.iter().map(|case| value(case)).sum::<f64>() / of_way.len().max(1) as f64
        };
        println!(
            "| **all** | {} | {:.0} | {:.0} | {:.1} | {:.2} |",
            way.name,
            mean(|case| case.mean_mm),
            mean(|case| case.p95_mm),
            100.0 * mean(|case| case.lost),
            mean(|case| case.frame_ms)
        );
    }
    Ok(())
}
