//! Cameras whose clocks are off by known times, and what is found of that from the motion of the silhouettes.
//!
//! Every camera records on its own, at its own times, fractions of a frame included: moving bodies before cameras all
//! around, before two telephones 37° apart, before two cameras face to face, masks exact or with one thing wrong at a time.
//! A person who stands still is to be refused. Real footage that is synchronous is shifted by whole frames.

use std::sync::Arc;
use std::time::Instant;

use backlit_formats::Footage;
use backlit_tracking::body::{Model, Pose, builtin};
use backlit_tracking::camera::{Camera, CameraFromWorld, Distortion, Intrinsics};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::Evidence;
use backlit_tracking::silhouette::Mask;
use backlit_tracking::synchronise::{
    CameraOffset, Recording, Synchronisation, SynchroniseOptions, synchronise,
};
use glam::DVec3;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};
use rayon::prelude::*;
use serde::Serialize;

use super::robustness::turned;
use super::track::{noisy, widened};
use super::{ExperimentError, Progress};
use crate::synthetic::{capsules, motion, squats, studio};

/// Across the shoulders of the average adult, metres: what a mask's widening is a share of.
const BREADTH: f64 = 0.5;

/// Who looks on, and at what.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Setting {
    /// Four cameras all around, a movement of two seconds.
    Around,
    /// The first two of them, a quarter turn apart.
    Quarter,
    /// Two telephones 37° apart, squats for eight seconds.
    Phones,
    /// Two cameras that look at each other with the person between them, squats.
    FaceToFace,
    /// Four cameras all around a person who stands still.
    Still,
}

impl Setting {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Around, Self::Quarter, Self::Phones, Self::FaceToFace, Self::Still];

    /// What it is called in tables.
    #[must_use]
    pub fn label(self) -> &'static str {
        match self {
            Self::Around => "four cameras around",
            Self::Quarter => "two, a quarter turn apart",
            Self::Phones => "two phones, 37°, squats",
            Self::FaceToFace => "two face to face, squats",
            Self::Still => "four around, standing still",
        }
    }

    /// How long every camera records, and how far clocks are off at most, seconds.
    fn times(self) -> [f64; 2] {
        match self {
            Self::Around | Self::Quarter | Self::Still => [2.5, 0.5],
            Self::Phones | Self::FaceToFace => [8.0, 2.0],
        }
    }

    fn cameras(self, size_px: [u64; 2]) -> Result<Vec<Arc<Camera>>, ExperimentError> {
        let of_studio = |count: usize| -> Result<Vec<Arc<Camera>>, ExperimentError> {
            let rig = studio::cameras();
            let resized = |camera: &Camera| camera.without_distortion().resized(size_px[0], size_px[1]);
            Ok(rig.cameras()[..count].iter().map(|c| resized(c).map(Arc::new)).collect::<Result<_, _>>()?)
        };
        match self {
            Self::Around | Self::Still => of_studio(4),
            Self::Quarter => of_studio(2),
            Self::Phones => Ok(squats::cameras(size_px)?),
            Self::FaceToFace => {
                let face = |(name, y): (&str, f64)| {
                    let focal = 1.25 * size_px[1] as f64;
                    let [cx, cy] = size_px.map(|side| 0.5 * (side as f64 - 1.0));
                    let pinhole = Intrinsics { fx: focal, fy: focal, cx, cy };
                    let target = DVec3::new(0.0, 0.0, 0.85);
                    let place = CameraFromWorld::looking_at(DVec3::new(0.1, y, 1.1), target, DVec3::Z);
                    Ok(Arc::new(Camera::new(name, size_px, pinhole, Distortion::None, place)?))
                };
                [("front", 2.9), ("back", -3.1)].into_iter().map(face).collect()
            }
        }
    }

    fn pose(self, model: &Model, seconds: f64) -> Pose {
        match self {
            Self::Around | Self::Quarter => motion::pose(model, motion::FRAME_RATE * (seconds - 0.25)),
            Self::Phones | Self::FaceToFace => squats::pose(model, seconds),
            Self::Still => motion::pose(model, 12.0),
        }
    }
}

/// What is wrong with the silhouettes or the cameras.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Trouble {
    /// Nothing.
    Nothing,
    /// All silhouettes are too wide by this share of the shoulders.
    Wide(f64),
    /// Only every other camera's are.
    OneWide(f64),
    /// This share of the pixels at the border are wrong, and one in 2000 elsewhere.
    Noise(f64),
    /// Cameras stand turned by this many degrees.
    Turned(f64),
    /// Every other camera has so many frames a second in the place of 30.
    OtherRate(f64),
    /// All cameras have so many frames a second.
    Rate(f64),
}

impl Trouble {
    /// Those of the table.
    pub const ALL: [Self; 7] = [
        Self::Nothing,
        Self::Wide(0.05),
        Self::OneWide(0.05),
        Self::Noise(0.3),
        Self::Turned(0.5),
        Self::OtherRate(25.0),
        Self::Rate(10.0),
    ];

    /// What it is called in tables.
    #[must_use]
    pub fn label(self) -> String {
        match self {
            Self::Nothing => "nothing".to_owned(),
            Self::Wide(share) => format!("{:.0} % too wide", 100.0 * share),
            Self::OneWide(share) => format!("every other camera {:.0} % too wide", 100.0 * share),
            Self::Noise(share) => format!("{:.0} % of border pixels wrong", 100.0 * share),
            Self::Turned(degrees) => format!("cameras turned by {degrees}°"),
            Self::OtherRate(rate) => format!("{rate} beside 30 frames a second"),
            Self::Rate(rate) => format!("{rate} frames a second"),
        }
    }

    fn rate(self, camera: usize) -> f64 {
        match self {
            Self::OtherRate(rate) if camera % 2 == 1 => rate,
            Self::Rate(rate) => rate,
            _ => 30.0,
        }
    }

    fn of(self, mask: Mask, camera: usize, px_per_m: f64, seed: u64) -> Result<Mask, ExperimentError> {
        Ok(match self {
            Self::Wide(share) => widened(mask, 0.5 * share * BREADTH * px_per_m)?,
            Self::OneWide(share) if camera % 2 == 1 => widened(mask, 0.5 * share * BREADTH * px_per_m)?,
            Self::Noise(share) => noisy(&mask, share, 5e-4, &mut Pcg64Mcg::seed_from_u64(seed)),
            _ => mask,
        })
    }
}

/// What to vary.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Options {
    /// Cameras and movements.
    pub settings: Vec<Setting>,
    /// What is wrong.
    pub troubles: Vec<Trouble>,
    /// Draws of the clocks.
    pub trials: usize,
    /// Pixels across and down.
    pub size_px: [u64; 2],
    /// Seed of the clocks and of all noise.
    pub seed: u64,
}

impl Default for Options {
    fn default() -> Self {
        let (settings, troubles) = (Setting::ALL.to_vec(), Trouble::ALL.to_vec());
        Self { settings, troubles, trials: 6, size_px: [144, 192], seed: 1 }
    }
}

/// What came of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// One entry a setting and a trouble.
    pub cases: Vec<Case>,
}

/// One setting with one trouble.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Case {
    /// Cameras and movement, in words.
    pub setting: String,
    /// What is wrong, in words.
    pub trouble: String,
    /// What was found.
    pub found: Vec<Found>,
}

impl Case {
    /// Offsets that were told, share.
    #[must_use]
    pub fn told(&self) -> f64 {
        let told = self.found.iter().filter(|found| found.error_s.is_some()).count();
        told as f64 / self.found.len().max(1) as f64
    }

    /// Of those that were told, how many are more than half a frame off.
    #[must_use]
    pub fn wrong(&self) -> usize {
        self.errors_in_frames().iter().filter(|error| **error > 0.5).count()
    }

    /// Sizes of the errors, frames, ascending.
    #[must_use]
    pub fn errors_in_frames(&self) -> Vec<f64> {
        let frames = |found: &Found| Some((found.error_s? / found.period_s).abs());
        let mut errors: Vec<f64> = self.found.iter().filter_map(frames).collect();
        errors.sort_by(f64::total_cmp);
        errors
    }
}

/// One camera's clock.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Found {
    /// The trial and the camera.
    pub trial: usize,
    /// The camera's index.
    pub camera: usize,
    /// How far its clock is ahead of the first one's, seconds.
    pub truth_s: f64,
    /// What was found less that; `None` where nothing was told.
    pub error_s: Option<f64>,
    /// Standard deviation as it was told.
    pub deviation_s: Option<f64>,
    /// Probability as it was told.
    pub probability: Option<f64>,
    /// Why nothing was told.
    pub why: Option<String>,
    /// A frame of the slowest camera, seconds.
    pub period_s: f64,
    /// Time that it took for all cameras, silhouettes given, seconds.
    pub took_s: f64,
    /// How far pairs contradict one another.
    pub loop_error_s: Option<f64>,
}

/// Runs all settings with all troubles.
///
/// # Errors
/// Numbers that make no cameras, or `cancel`.
pub fn run(
    options: &Options,
    cancel: &CancelToken,
    mut on_progress: impl FnMut(Progress),
) -> Result<Report, ExperimentError> {
    let total = options.settings.len() * options.troubles.len() * options.trials;
    let (mut done, mut cases) = (0, Vec::new());
    for &setting in &options.settings {
        for &trouble in &options.troubles {
            let mut found = Vec::new();
            for trial in 0..options.trials {
                on_progress(Progress { done, total });
                if cancel.is_cancelled() {
                    return Err(ExperimentError::Cancelled);
                }
                found.append(&mut one(setting, trouble, trial, options)?);
                done += 1;
            }
            let setting = setting.label().to_owned();
            cases.push(Case { setting, trouble: trouble.label(), found });
        }
    }
    on_progress(Progress { done, total });
    Ok(Report { cases })
}

/// A number between −1 and 1.
fn centred(random: &mut Pcg64Mcg) -> f64 {
    (random.next_u64() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

fn one(
    setting: Setting,
    trouble: Trouble,
    trial: usize,
    options: &Options,
) -> Result<Vec<Found>, ExperimentError> {
    let model = builtin::full_body();
    let cameras = setting.cameras(options.size_px)?;
    let [length, farthest] = setting.times();
    let mut random = Pcg64Mcg::seed_from_u64(options.seed ^ (trial as u64) << 32);
    // A camera's clock shows `ahead` at the moment at which the first one's shows 0.
    let ahead: Vec<f64> = (0..cameras.len())
        .map(|camera| if camera == 0 { 0.0 } else { farthest * centred(&mut random) })
        .collect();
    let mut recordings = Vec::new();
    for (index, camera) in cameras.iter().enumerate() {
        let rate = trouble.rate(index);
        let frames = (rate * length) as usize;
        let px_per_m = camera.intrinsics().mean_focal_px() / camera.depth(DVec3::new(0.0, 0.0, 0.85));
        let mask = |frame: usize| -> Result<Mask, ExperimentError> {
            let moment = frame as f64 / rate - ahead[index];
            let mask = capsules::hard_mask(&model, &setting.pose(&model, moment), camera)?;
            let seed = options.seed + ((trial * 16 + index) * 10_000 + frame) as u64;
            trouble.of(mask, index, px_per_m, seed)
        };
        let masks: Vec<Mask> = (0..frames).into_par_iter().map(mask).collect::<Result<_, _>>()?;
        let seen_by = match trouble {
            Trouble::Turned(degrees) => turned(camera, degrees.to_radians(), &mut random)?,
            _ => (**camera).clone(),
        };
        let mut recording = Recording::new(seen_by);
        for (frame, mask) in masks.iter().enumerate() {
            recording.push(frame as f64 / rate, mask);
        }
        recordings.push(recording);
    }
    let period_s = 1.0 / (0..cameras.len()).map(|camera| trouble.rate(camera)).fold(f64::INFINITY, f64::min);
    Ok(look(&recordings, &ahead, period_s, trial))
}

fn look(recordings: &[Recording], ahead: &[f64], period_s: f64, trial: usize) -> Vec<Found> {
    let begun = Instant::now();
    let answer = synchronise(recordings, &SynchroniseOptions::default());
    let took_s = begun.elapsed().as_secs_f64();
    let answer =
        answer.unwrap_or(Synchronisation { cameras: Vec::new(), pairs: Vec::new(), loop_error_s: None });
    let found = |(camera, offset): (usize, &CameraOffset)| {
        let (told, why) = match offset {
            CameraOffset::Reference => return None,
            CameraOffset::Found(offset) => (Some(*offset), None),
            CameraOffset::Undecided(why) => (None, Some(why.to_string())),
        };
        Some(Found {
            trial,
            camera,
            truth_s: ahead[camera],
            error_s: told.map(|told| told.seconds - ahead[camera]),
            deviation_s: told.map(|told| told.deviation_s),
            probability: told.map(|told| told.probability),
            why,
            period_s,
            took_s,
            loop_error_s: answer.loop_error_s,
        })
    };
    answer.cameras.iter().enumerate().filter_map(found).collect()
}

/// A take whose cameras are synchronous, one camera after the other shifted by whole frames. A case is a set of cameras.
///
/// # Errors
/// A take of fewer than two cameras, pictures that cannot be read, or `cancel`.
pub fn run_take(
    footage: &Footage,
    shifts: &[i64],
    cancel: &CancelToken,
    mut on_progress: impl FnMut(Progress),
) -> Result<Report, ExperimentError> {
    let take = footage.take();
    let cameras: Vec<usize> = (0..take.rig().count()).collect();
    let total = take.frame_count();
    let mut masks: Vec<Vec<Arc<Mask>>> = vec![Vec::new(); cameras.len()];
    for frame in 0..total {
        on_progress(Progress { done: frame, total });
        if cancel.is_cancelled() {
            return Err(ExperimentError::Cancelled);
        }
        for (camera, view) in footage.fit_views(&cameras, frame)?.into_iter().enumerate() {
            if let Evidence::Mask(mask) = view.evidence {
                masks[camera].push(mask);
            }
        }
    }
    on_progress(Progress { done: total, total });
    let period_s = 1.0 / take.frame_rate();
    let mut sets: Vec<Vec<usize>> = Vec::new();
    for (index, &a) in cameras.iter().enumerate() {
        sets.extend(cameras[index + 1..].iter().map(|&b| vec![a, b]));
    }
    if cameras.len() > 2 {
        sets.push(cameras);
    }
    let mut cases = Vec::new();
    for set in sets {
        let mut found = Vec::new();
        for (trial, &shift) in shifts.iter().enumerate() {
            // Every other camera began later, or earlier, by the shift.
            let ahead: Vec<f64> =
                (0..set.len()).map(|at| if at % 2 == 1 { shift as f64 * period_s } else { 0.0 }).collect();
            let recordings: Vec<Recording> = set
                .iter()
                .zip(&ahead)
                .map(|(&camera, &ahead)| {
                    let mut recording = Recording::new((*footage.cameras[camera]).clone());
                    for (frame, mask) in masks[camera].iter().enumerate() {
                        recording.push(frame as f64 * period_s + ahead, mask);
                    }
                    recording
                })
                .collect();
            found.append(&mut look(&recordings, &ahead, period_s, trial));
        }
        let names: Vec<&str> = set.iter().map(|&camera| footage.cameras[camera].name()).collect();
        cases.push(Case { setting: names.join(", "), trouble: "real footage".to_owned(), found });
    }
    Ok(Report { cases })
}

/// The table of a report, Markdown.
#[must_use]
pub fn table(report: &Report) -> String {
    let mut text = "| cameras | what is wrong | told | wrong | error, frames: median | largest | deviation told, frames | \
                    loops, ms | s |\n|---|---|---|---|---|---|---|---|---|\n"
        .to_owned();
    for case in &report.cases {
        let errors = case.errors_in_frames();
        let of = |index: usize| errors.get(index).map_or("–".to_owned(), |error| format!("{error:.2}"));
        let mut deviations: Vec<f64> =
            case.found.iter().filter_map(|found| Some(found.deviation_s? / found.period_s)).collect();
        deviations.sort_by(f64::total_cmp);
        let deviation = deviations.get(deviations.len() / 2).map_or("–".to_owned(), |d| format!("{d:.2}"));
        let loops = case.found.iter().filter_map(|found| found.loop_error_s).reduce(f64::max);
        let took = case.found.iter().map(|found| found.took_s).fold(0.0, f64::max);
        text += &format!(
            "| {} | {} | {} of {} | {} | {} | {} | {deviation} | {} | {took:.2} |\n",
            case.setting,
            case.trouble,
            errors.len(),
            case.found.len(),
            case.wrong(),
            of(errors.len() / 2),
            of(errors.len().saturating_sub(1)),
            loops.map_or("–".to_owned(), |error| format!("{:.1}", 1e3 * error)),
        );
    }
    text
}
