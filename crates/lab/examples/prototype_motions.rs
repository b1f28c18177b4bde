//! What the plainest recognizer gives on the same folds: principal components of single frames, a hidden Markov model a
//! class of them, support vectors of what they do in a second. So it can be told what the measures and axes of
//! `backlit-recognition` are worth, and what people left out are.
//!
//! `cargo run --release -p backlit-lab --example prototype_motions -- motions=DIR [left-out=subjects|keep-classes]
//! [noise=0] [seeds=1]`: DIR has BVH files and a labels.csv; noise is in millimetres, root mean square, of the motions
//! that are named.

mod labelled;

use std::path::PathBuf;

use backlit_recognition::augment::{TrackerNoise, mirrored, noisy};
use backlit_recognition::evaluation::{Fold, joined, tracked};
use backlit_recognition::features::{Normalised, body_size};
use backlit_recognition::hmm::{HiddenMarkov, HmmOptions, Network};
use backlit_recognition::observed::{HOP, WINDOW};
use backlit_recognition::principal::PrincipalComponents;
use backlit_recognition::svm::SupportVectors;
use backlit_recognition::{JointMotion, LeftOut, NamedMotion};
use glam::DVec3;
use labelled::{Error, motions};

/// Principal components that hidden Markov models see, and support vectors.
const COMPONENTS: [usize; 2] = [12, 20];
const STATES: usize = 6;
/// Nats that going from one class to another costs.
const SWITCH_NATS: f64 = 70.0;
/// Noise of copies that are learnt from, metres of an adult along each axis.
const LEARNT_NOISE_M: f64 = 0.03;
/// What a sample costs the support vectors, classes counting the same.
const COST: f64 = 1.0;
/// Weight of the root's velocity against places, seconds.
const VELOCITY_S: f64 = 0.25;

struct Prototype {
    components: PrincipalComponents,
    models: Vec<HiddenMarkov>,
    machine: SupportVectors,
    scale: f64,
}

/// Joints about the hips, velocity and height of the hips, frame by frame.
fn frames(motion: &JointMotion) -> Result<Vec<Vec<f64>>, Error> {
    let seen = Normalised::new(motion)?;
    let frame = |at: usize| -> Vec<f64> {
        let hip = seen.hip(at);
        let joints = seen.joints[at].iter().map(|&place| place - hip);
        let root = [VELOCITY_S * seen.velocity[at], DVec3::Y * hip.y];
        joints.chain(root).flat_map(|v| v.to_array()).collect()
    };
    Ok((0..seen.len()).map(frame).collect())
}

fn first(rows: &[Vec<f64>], count: usize) -> Vec<Vec<f64>> {
    rows.iter().map(|row| row[..count.min(row.len())].to_vec()).collect()
}

/// Mean, deviation and mean change of each number in a window.
fn window(rows: &[Vec<f64>], start: usize) -> Vec<f64> {
    let start = start.min(rows.len().saturating_sub(WINDOW));
    let rows = &rows[start..(start + WINDOW).min(rows.len())];
    let number = |at: usize| {
        let mean = rows.iter().map(|row| row[at]).sum::<f64>() / rows.len() as f64;
        let variance = rows.iter().map(|row| (row[at] - mean).powi(2)).sum::<f64>() / rows.len() as f64;
        let change = rows.windows(2).map(|pair| (pair[1][at] - pair[0][at]).abs()).sum::<f64>();
        [mean, variance.sqrt(), change / rows.len() as f64]
    };
    (0..rows[0].len()).flat_map(number).collect()
}

fn starts(length: usize) -> Vec<usize> {
    let room = length.saturating_sub(WINDOW);
    let gaps = room.div_ceil(HOP);
    if gaps == 0 { vec![0] } else { (0..=gaps).map(|gap| gap * room / gaps).collect() }
}

impl Prototype {
    /// From the frames of each class's motions.
    fn learn(motions: &[Vec<&Vec<Vec<f64>>>]) -> Self {
        let all: Vec<Vec<f64>> = motions.iter().flatten().flat_map(|rows| rows.iter().cloned()).collect();
        let components = PrincipalComponents::of(&all, COMPONENTS[1]);
        let place = |rows: &&Vec<Vec<f64>>| -> Vec<Vec<f64>> {
            rows.iter().map(|row| components.project(row)).collect()
        };
        let places: Vec<Vec<Vec<Vec<f64>>>> =
            motions.iter().map(|class| class.iter().map(place).collect()).collect();
        let options =
            HmmOptions { states: STATES, least_variance: 1e-3, prior_count: 0.0, ..HmmOptions::default() };
        let model = |class: &Vec<Vec<Vec<f64>>>| {
            let class: Vec<Vec<Vec<f64>>> = class.iter().map(|rows| first(rows, COMPONENTS[0])).collect();
            let sequences: Vec<(&[Vec<f64>], f64)> = class.iter().map(|rows| (&rows[..], 1.0)).collect();
            HiddenMarkov::learn(&sequences, &options)
        };
        let (mut rows, mut classes) = (Vec::new(), Vec::new());
        for (class, motions) in places.iter().enumerate() {
            for motion in motions {
                rows.extend(starts(motion.len()).into_iter().map(|start| window(motion, start)));
                classes.resize(rows.len(), class);
            }
        }
        let square = rows.iter().flatten().map(|x| x * x).sum::<f64>() / (rows.len() * rows[0].len()) as f64;
        let scale = 1.0 / square.sqrt();
        rows.iter_mut().flatten().for_each(|x| *x *= scale);
        let share = |class: &usize| classes.iter().filter(|other| *other == class).count() * places.len();
        let costs: Vec<f64> =
            classes.iter().map(|class| COST * rows.len() as f64 / share(class) as f64).collect();
        Self {
            models: places.iter().map(model).collect(),
            machine: SupportVectors::learn(&rows, &classes, &costs, places.len()),
            components,
            scale,
        }
    }

    fn project(&self, rows: &[Vec<f64>]) -> Vec<Vec<f64>> {
        rows.iter().map(|row| self.components.project(row)).collect()
    }

    fn margins(&self, places: &[Vec<f64>], start: usize) -> Vec<f64> {
        let row: Vec<f64> = window(places, start).iter().map(|x| x * self.scale).collect();
        self.machine.margins(&row)
    }

    fn likelihoods(&self, places: &[Vec<f64>], start: usize) -> Vec<f64> {
        let rows = first(&places[start..(start + WINDOW).min(places.len())], COMPONENTS[0]);
        self.models.iter().map(|model| model.log_likelihood(&rows)).collect()
    }
}

fn largest(values: &[f64]) -> usize {
    (0..values.len()).max_by(|&a, &b| values[a].total_cmp(&values[b])).unwrap_or(0)
}

/// Right and all of clips, windows and joined frames; of hidden Markov models and of support vectors.
type Tally = [[[usize; 2]; 3]; 2];

fn add(count: &mut [usize; 2], is_right: bool) {
    count[0] += usize::from(is_right);
    count[1] += 1;
}

fn name(
    learnt: &Prototype,
    known: &[String],
    motions: &[NamedMotion],
    tally: &mut Tally,
) -> Result<(), Error> {
    let is_right = |values: &[f64], class: &str| known[largest(values)] == class;
    for motion in motions {
        let places = learnt.project(&frames(&motion.motion)?);
        let mut sum = vec![0.0; known.len()];
        for start in starts(places.len()) {
            let margins = learnt.margins(&places, start);
            add(&mut tally[1][1], is_right(&margins, &motion.class));
            add(&mut tally[0][1], is_right(&learnt.likelihoods(&places, start), &motion.class));
            sum.iter_mut().zip(margins).for_each(|(sum, margin)| *sum += margin);
        }
        add(&mut tally[1][0], is_right(&sum, &motion.class));
        let rows = first(&places, COMPONENTS[0]);
        let whole: Vec<f64> = learnt.models.iter().map(|model| model.log_likelihood(&rows)).collect();
        add(&mut tally[0][0], is_right(&whole, &motion.class));
    }
    for (take, truth) in joined(&motions.iter().collect::<Vec<_>>())? {
        let places = learnt.project(&frames(&take.motion)?);
        let evidence: Vec<Vec<Vec<f64>>> = first(&places, COMPONENTS[0])
            .iter()
            .map(|row| learnt.models.iter().map(|model| model.log_densities(row)).collect())
            .collect();
        let walk = Network::new(&learnt.models, SWITCH_NATS).segment(&evidence);
        for (frame, (found, class)) in walk.into_iter().zip(&truth).enumerate() {
            add(&mut tally[0][2], known[found] == *class);
            let margins = learnt.margins(&places, frame.saturating_sub(WINDOW / 2));
            add(&mut tally[1][2], is_right(&margins, class));
        }
    }
    Ok(())
}

/// A motion's frames, as they are, mirrored, and both with noise.
fn copies(named: &NamedMotion, seed: u64) -> Result<Vec<Vec<Vec<f64>>>, Error> {
    let deviation = LEARNT_NOISE_M * body_size(&named.motion);
    let noise = TrackerNoise { deviation, smooth: 0.0, memory_s: 1.0 };
    let found = noisy(&named.motion, noise, seed);
    [&named.motion, &mirrored(&named.motion), &found, &mirrored(&found)].into_iter().map(frames).collect()
}

struct Settings {
    folder: PathBuf,
    left_out: LeftOut,
    noise_mm: f64,
    seeds: u64,
}

fn settings() -> Result<Settings, Error> {
    let left_out = LeftOut::SubjectsKeepingClasses;
    let mut all = Settings { folder: PathBuf::new(), left_out, noise_mm: 0.0, seeds: 1 };
    for argument in std::env::args().skip(1) {
        match argument.split_once('=').ok_or("expected NAME=VALUE")? {
            ("motions", value) => all.folder = value.into(),
            ("left-out", "subjects") => all.left_out = LeftOut::Subjects,
            ("left-out", "keep-classes") => all.left_out = LeftOut::SubjectsKeepingClasses,
            ("noise", value) => all.noise_mm = value.parse()?,
            ("seeds", value) => all.seeds = value.parse()?,
            (name, value) => return Err(format!("{name}={value} is no option").into()),
        }
    }
    Ok(all)
}

fn main() -> Result<(), Error> {
    let settings = settings()?;
    let all = motions(&settings.folder)?;
    // Along each of three axes; half of the variance is smooth in time, as in `backlit recognise --noise`.
    let deviation = settings.noise_mm / 1000.0 / 3.0_f64.sqrt();
    let noise = (deviation > 0.0).then_some(TrackerNoise { deviation, smooth: 0.5, memory_s: 0.25 });
    println!(
        "| seed | method | clips | windows of a second | frames of joined clips |\n|---|---|---|---|---|"
    );
    for seed in 0..settings.seeds {
        let seen: Result<Vec<_>, Error> =
            all.iter().zip(0..).map(|(motion, number)| copies(motion, 1000 * seed + number)).collect();
        let seen = seen?;
        let mut tally = Tally::default();
        for Fold { named, learnt } in settings.left_out.folds(&all) {
            let mut known: Vec<String> = learnt.iter().map(|&number| all[number].class.clone()).collect();
            known.sort();
            known.dedup();
            let of_class = |class: &String| {
                learnt.iter().filter(|&&n| all[n].class == *class).flat_map(|&n| &seen[n]).collect()
            };
            let prototype = Prototype::learn(&known.iter().map(of_class).collect::<Vec<_>>());
            let own = named.iter().map(|&number| tracked(&all[number], noise, number as u64));
            name(&prototype, &known, &own.collect::<Vec<_>>(), &mut tally)?;
        }
        for (method, counts) in ["hidden Markov models", "support vectors"].iter().zip(tally) {
            let [clips, windows, joined] =
                counts.map(|[right, all]| format!("{:.3}", right as f64 / all.max(1) as f64));
            println!("| {seed} | {method} | {clips} | {windows} | {joined} |");
        }
    }
    Ok(())
}
