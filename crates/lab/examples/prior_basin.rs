//! How far off a start may be with and without a prior learnt from motion, in frames of a take with reference keypoints:
//!
//! ```text
//! BACKLIT_DATA=… cargo run --release -p backlit-lab --example prior_basin -- tests/takes/balancing people 3 10
//! ```
//!
//! The second word is a file of `backlit prior`, or `people`; then come weights of its poses. The pose of a frame is where a fit
//! without the prior ends that begins at the keypoints; a fit that ends within 40 mm of it has found it.

use std::error::Error;
use std::path::Path;
use std::sync::Arc;

use backlit_formats::{Footage, Take, prior_file};
use backlit_runs::basin::{Basin, BasinOptions, FitChoice, RandomStarts, Starts, Subject, Target};
use backlit_tracking::body::builtin;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{Fit, FitOptions};
use backlit_tracking::residual::learnt_prior::LearntPrior;
use backlit_tracking::search::start::{self, Level};

const FRAMES: [usize; 4] = [0, 20, 40, 60];
const CAMERAS: [&[usize]; 2] = [&[0, 1], &[0, 1, 2, 3]];
const LEVELS: [Level; 3] = [
    Level { degrees: 15, metres: 0.08 },
    Level { degrees: 30, metres: 0.15 },
    Level { degrees: 45, metres: 0.2 },
];
const STARTS: usize = 10;
const FOUND_MM: f64 = 40.0;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let usage = "usage: prior_basin TAKE PRIOR WEIGHT …";
    let (take, file) = (arguments.next().ok_or(usage)?, arguments.next().ok_or(usage)?);
    let footage = Footage::new(Take::open_with_model(take.as_ref(), builtin::full_body())?);
    let learnt = LearntPrior::new(Arc::new(prior_file::read_or_built_in(Path::new(&file))?));
    let mut choices = vec![FitChoice::downhill("silhouettes alone", FitOptions::default())];
    for word in arguments {
        let prior = LearntPrior { pose_weight: word.parse()?, ..learnt.clone() };
        let fit = FitOptions { prior: Some(prior), ..FitOptions::default() };
        choices.push(FitChoice::downhill(&format!("weight {word}"), fit));
    }
    let (take, model, cancel) = (footage.take(), footage.take().model(), CancelToken::new());
    let reference = take.reference().ok_or("the take has no reference keypoints")?;
    println!("| cameras | way | found from 15° and 8 cm | 30° and 15 cm | 45° and 20 cm |");
    println!("|---|---|---|---|---|");
    for cameras in CAMERAS {
        let mut found = vec![[0_usize; LEVELS.len()]; choices.len()];
        for frame in FRAMES {
            let views = footage.fit_views(cameras, frame)?;
            let start = start::from_joints(model, &reference.joints(frame)).ok_or("too few keypoints")?;
            let mut fit = Fit::new(Arc::clone(model), views.clone(), start, FitOptions::default())?;
            let subject =
                Subject { model: Arc::clone(model), views, reference: fit.run(&cancel, |_| {}).pose };
            let levels = LEVELS.to_vec();
            let options = BasinOptions {
                choices: choices.clone(),
                starts: Starts::Random(RandomStarts { rotation: None, levels, starts: STARTS, seed: 1 }),
                target: Target::Reference,
                success_mm: FOUND_MM,
            };
            let basin = Basin::new(subject, &options, &cancel)?;
            for trial in 0..basin.trials() {
                let trial = basin.run(trial, &cancel)?;
                found[trial.choice][trial.place[0]] += usize::from(trial.error_mm < FOUND_MM);
            }
        }
        for (choice, found) in choices.iter().zip(&found) {
            let of = FRAMES.len() * STARTS;
            let cells: Vec<String> = found.iter().map(|found| format!("{found} of {of}")).collect();
            println!("| {} | {} | {} |", cameras.len(), choice.name, cells.join(" | "));
        }
    }
    Ok(())
}
