//! One frame from pixels to pose on one thread: segmentation, distances, the robust fit.
//!
//! `BACKLIT_DATA=… cargo bench -p backlit-tracking --bench frame`, or with `-- TAKE RESULTS` a take of one's own, with the body and
//! the first pose of what `backlit track TAKE --out RESULTS` wrote.
//!
//! The real footage, four cameras of 272 × 480, full body; without `BACKLIT_DATA` the built-in take. The pictures are
//! decoded and rectified beforehand. Frames are followed in their order, as a tracker does, and each is timed once a
//! round: the figures are of all frames of all rounds, in the thread's processor time, so that other programs count little.

#![expect(clippy::unwrap_used, reason = "a measurement without its input is none")]

use std::env;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use backlit_formats::export::track_read;
use backlit_formats::{Footage, Take, model_file};
use backlit_tracking::body::Pose;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{Evidence, FitOptions, FitView, Preset};
use backlit_tracking::search::start;
use backlit_tracking::silhouette::{Mask, SignedDistance};
use backlit_tracking::track::{Motion, Tracker};
use cpu_time::ThreadTime;
use image::RgbImage;

/// Passes over all frames.
const ROUNDS: usize = 5;

/// How far the distances of a tracked frame reach: the widest ramp of its stages and a pixel.
const REACH_PX: f32 = 13.0;

fn main() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let real = env::var_os("BACKLIT_DATA").map(PathBuf::from).filter(|data| data.join("balancing").is_dir());
    // Cargo adds options of its own.
    let named: Vec<String> = env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    let (name, footage, begin) = match (named.as_slice(), real) {
        ([take, results], _) => {
            let (footage, pose) = tracked(Path::new(take), Path::new(results));
            (take.as_str(), footage, Some(pose))
        }
        (_, Some(_)) => ("Real footage", open(&folder.join("../../tests/takes/balancing")), None),
        (_, None) => ("Built-in take (no BACKLIT_DATA)", open(&folder.join("../../assets/take")), None),
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    pool.install(|| table(name, &footage, begin));
}

fn open(take: &Path) -> Footage {
    Footage::new(Take::open(take).unwrap())
}

/// A take with the body that it was tracked with, and its first pose.
fn tracked(take: &Path, results: &Path) -> (Footage, Pose) {
    let body = results.join("body.toml");
    let body = body.exists().then(|| model_file::read(&body).unwrap());
    let written = track_read::read(&results.join("track.json"), body.as_ref()).unwrap();
    let first = written.track.frames.values().next().unwrap().pose.clone();
    (Footage::new(Take::open_with_model(take, written.model).unwrap()), first)
}

fn table(name: &str, footage: &Footage, begin: Option<Pose>) {
    let take = footage.take();
    let cameras = take.rig().count();
    let pictures: Vec<Vec<RgbImage>> = (0..take.frame_count())
        .map(|frame| (0..cameras).map(|camera| footage.picture(camera, frame).unwrap()).collect())
        .collect();
    let of_take =
        || take.start().cloned().or_else(|| start::from_joints(take.model(), &take.reference()?.joints(0)));
    let begin = begin.or_else(of_take);
    // Milliseconds of each part, by frame.
    let mut parts = ["segmentation", "distances within 13 px", "fit, distances included", "whole frame"]
        .map(|name| (name, Vec::new()));
    let mut iterations = Vec::new();
    for round in 0..=ROUNDS {
        let options = FitOptions::preset(Preset::Robust);
        let tracker = Tracker::new(Arc::clone(take.model()), options, begin.clone().unwrap()).unwrap();
        let mut tracker = tracker.with_motion(Motion::Velocity, take.frame_rate()).unwrap();
        for (frame, pictures) in pictures.iter().enumerate() {
            let began = ThreadTime::now();
            let masks: Vec<Arc<Mask>> = pictures
                .iter()
                .enumerate()
                .map(|(camera, picture)| {
                    Arc::new(footage.mask(camera, frame, picture, &take.measurement()[camera]).unwrap())
                })
                .collect();
            let segmented = began.elapsed().as_secs_f64();
            let views = masks.iter().zip(footage.cameras.iter()).map(|(mask, camera)| FitView {
                camera: Arc::clone(camera),
                evidence: Evidence::Mask(Arc::clone(mask)),
                weight: 1.0,
            });
            let found = tracker.track_frame(frame, views.collect(), &CancelToken::new()).unwrap();
            let whole = began.elapsed().as_secs_f64();
            let again = ThreadTime::now();
            masks.iter().for_each(|mask| {
                drop(std::hint::black_box(SignedDistance::from_mask_within(mask, REACH_PX)));
            });
            // The first frame begins from far, and the first round warms up.
            if frame > 0 && round > 0 {
                let times = [segmented, again.elapsed().as_secs_f64(), whole - segmented, whole];
                parts.iter_mut().zip(times).for_each(|((_, ms), seconds)| ms.push(1e3 * seconds));
                iterations.push(found.iterations as f64);
            }
        }
    }
    let size = footage.cameras[0].as_ref();
    println!(
        "\n{name}: {cameras} × {} × {}, {} frames × {ROUNDS}, one thread",
        size.width(),
        size.height(),
        take.frame_count()
    );
    println!("{:<28} {:>10} {:>10} {:>10} {:>10}", "", "median ms", "quarter", "3 quarters", "95 %");
    for (name, ms) in &mut parts {
        ms.sort_by(f64::total_cmp);
        let at = |share: f64| ms[((ms.len() - 1) as f64 * share) as usize];
        println!("{name:<28} {:>10.2} {:>10.2} {:>10.2} {:>10.2}", at(0.5), at(0.25), at(0.75), at(0.95));
    }
    println!("{:<28} {:>10.1}", "iterations, mean", iterations.iter().sum::<f64>() / iterations.len() as f64);
}
