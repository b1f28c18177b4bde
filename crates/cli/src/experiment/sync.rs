//! Cameras whose clocks are off by known times, and what is found of that from the motion of the silhouettes.
//!
//! Every camera records on its own, at its own times, fractions of a frame included: moving bodies before cameras all
//! around, before two telephones 37° apart, before two cameras face to face, masks exact or with one thing wrong at a time.
//! A person who stands still is to be refused. Real footage that is synchronous is shifted by whole frames.

mod offsets;

use std::path::PathBuf;
use std::sync::Arc;

use anyhow::Result;
use backlit_lab::synthetic::masks::{noisy, widened};
use backlit_lab::synthetic::people::BREADTH;
use backlit_lab::synthetic::{capsules, motion, squats, studio};
use backlit_tracking::body::{Model, Pose, builtin};
use backlit_tracking::camera::{Camera, CameraError, CameraFromWorld};
use backlit_tracking::fit::Evidence;
use backlit_tracking::geometry::rotation::exp;
use backlit_tracking::silhouette::Mask;
use backlit_tracking::synchronise::Recording;
use clap::Args;
use glam::{DMat3, DVec3};
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};
use rayon::prelude::*;
use serde::Serialize;

use self::offsets::{Case, ClockOffset, Report, find_offsets};
use super::arguments::OutputArguments;
use super::{Experiment, ExperimentArguments, Run};
use crate::take_options;

/// Cameras whose clocks are off by known times, found from the motion of the silhouettes
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// A take whose cameras are synchronous, to be shifted by whole frames [default: simulated people]
    take: Option<PathBuf>,
    /// Frames that every other camera of a take is shifted by
    #[arg(long, value_name = "N,…", value_delimiter = ',', default_values_t = [0, 1, 7, -12, 20], allow_hyphen_values = true)]
    shifts: Vec<i64>,
    #[command(flatten)]
    drawn: DrawnClocks,
    #[command(flatten)]
    output: OutputArguments,
}

impl ExperimentArguments for Arguments {
    const NAME: &'static str = DrawnClocks::NAME;

    fn run(mut self) -> Result<()> {
        match self.take {
            None => self.drawn.perform(&self.output),
            Some(take) => ShiftedTake { take, shifts: self.shifts }.perform(&self.output),
        }
    }
}

/// Simulated people before cameras whose clocks are drawn.
#[derive(Debug, Args, Serialize)]
struct DrawnClocks {
    #[arg(skip = Setting::ALL.to_vec())]
    settings: Vec<Setting>,
    #[arg(skip = Trouble::ALL.to_vec())]
    troubles: Vec<Trouble>,
    /// Draws of the clocks of simulated cameras
    #[arg(long, value_name = "N", default_value_t = 6)]
    trials: usize,
    #[arg(skip = [144, 192])]
    size_px: [u64; 2],
    /// Seed of clocks and noise
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// A take whose cameras are synchronous, every other camera of a set shifted by whole frames.
#[derive(Debug, Serialize)]
struct ShiftedTake {
    take: PathBuf,
    shifts: Vec<i64>,
}

/// Who looks on, and at what.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
enum Setting {
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
    const ALL: [Self; 5] = [Self::Around, Self::Quarter, Self::Phones, Self::FaceToFace, Self::Still];

    fn label(self) -> &'static str {
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

    fn cameras(self, size_px: [u64; 2]) -> Result<Vec<Arc<Camera>>> {
        match self {
            Self::Around | Self::Still => Ok(studio::pinholes(size_px)?),
            Self::Quarter => Ok(studio::pinholes(size_px)?[..2].to_vec()),
            Self::Phones => Ok(squats::cameras(size_px)?),
            Self::FaceToFace => {
                let face = |(name, y): (&str, f64)| {
                    let (from, target) = (DVec3::new(0.1, y, 1.1), DVec3::new(0.0, 0.0, 0.85));
                    let focal = 1.25 * size_px[1] as f64;
                    Ok(studio::pinhole(name, size_px, focal, [from, target], DVec3::Z)?)
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
enum Trouble {
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
    /// Every other camera has this many frames a second in the place of 30.
    OtherRate(f64),
    /// All cameras have this many frames a second.
    Rate(f64),
}

impl Trouble {
    const ALL: [Self; 7] = [
        Self::Nothing,
        Self::Wide(0.05),
        Self::OneWide(0.05),
        Self::Noise(0.3),
        Self::Turned(0.5),
        Self::OtherRate(25.0),
        Self::Rate(10.0),
    ];

    fn label(self) -> String {
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

    fn of(self, mask: Mask, camera: usize, px_per_m: f64, seed: u64) -> Result<Mask> {
        Ok(match self {
            Self::OneWide(_) if camera % 2 == 0 => mask,
            Self::Wide(share) | Self::OneWide(share) => widened(mask, 0.5 * share * BREADTH * px_per_m)?,
            Self::Noise(share) => noisy(&mask, share, 5e-4, &mut Pcg64Mcg::seed_from_u64(seed)),
            _ => mask,
        })
    }
}

impl Experiment for DrawnClocks {
    const NAME: &'static str = "sync";
    type Report = Report;

    fn run(&mut self, run: &Run) -> Result<Report> {
        let total = self.settings.len() * self.troubles.len() * self.trials;
        let (mut done, mut cases) = (0, Vec::new());
        for &setting in &self.settings {
            for &trouble in &self.troubles {
                let mut found = Vec::new();
                for trial in 0..self.trials {
                    run.progress(done, total)?;
                    found.append(&mut one(setting, trouble, trial, self)?);
                    done += 1;
                }
                cases.push(Case { setting: setting.label().to_owned(), trouble: trouble.label(), found });
            }
        }
        Ok(Report { cases })
    }

    fn table(&self, report: &Report) -> String {
        report.markdown()
    }
}

impl Experiment for ShiftedTake {
    const NAME: &'static str = DrawnClocks::NAME;
    type Report = Report;

    fn run(&mut self, run: &Run) -> Result<Report> {
        let footage = take_options::open(&self.take)?;
        let take = footage.take();
        let cameras: Vec<usize> = (0..take.rig().count()).collect();
        let total = take.frame_count();
        let mut masks: Vec<Vec<Arc<Mask>>> = vec![Vec::new(); cameras.len()];
        for frame in 0..total {
            run.progress(frame, total)?;
            for (camera, view) in footage.fit_views(&cameras, frame)?.into_iter().enumerate() {
                if let Evidence::Mask(mask) = view.evidence {
                    masks[camera].push(mask);
                }
            }
        }
        let period_s = 1.0 / take.frame_rate();
        let pairs = cameras.iter().flat_map(|&a| cameras[a + 1..].iter().map(move |&b| vec![a, b]));
        let mut sets: Vec<Vec<usize>> = pairs.collect();
        if cameras.len() > 2 {
            sets.push(cameras);
        }
        let mut cases = Vec::new();
        for set in sets {
            let mut found = Vec::new();
            for (trial, &shift) in self.shifts.iter().enumerate() {
                // Every other camera began later, or earlier, by the shift.
                let ahead = |at: usize| if at % 2 == 1 { shift as f64 * period_s } else { 0.0 };
                let ahead: Vec<f64> = (0..set.len()).map(ahead).collect();
                let record = |(&camera, ahead): (&usize, &f64)| {
                    let times = (0..).map(|frame| f64::from(frame) * period_s + ahead);
                    recording(
                        (*footage.cameras[camera]).clone(),
                        times,
                        masks[camera].iter().map(|mask| &**mask),
                    )
                };
                let recordings: Vec<Recording> = set.iter().zip(&ahead).map(record).collect();
                found.append(&mut find_offsets(&recordings, &ahead, period_s, trial));
            }
            let names: Vec<&str> = set.iter().map(|&camera| footage.cameras[camera].name()).collect();
            cases.push(Case { setting: names.join(", "), trouble: "real footage".to_owned(), found });
        }
        Ok(Report { cases })
    }

    fn table(&self, report: &Report) -> String {
        report.markdown()
    }
}

/// The camera turned about its centre, about an axis in any direction.
fn turned(camera: &Camera, angle: f64, random: &mut Pcg64Mcg) -> Result<Camera, CameraError> {
    let axis = loop {
        let axis = DVec3::from_array(std::array::from_fn(|_| random.random_range(-1.0..1.0)));
        if (0.01..1.0).contains(&axis.length_squared()) {
            break axis.normalize();
        }
    };
    let turn = exp(axis * angle);
    let place = camera.camera_from_world();
    let place = CameraFromWorld {
        rotation: DMat3::from_quat(turn) * place.rotation,
        translation: turn * place.translation,
    };
    let size = [camera.width() as u64, camera.height() as u64];
    Camera::new(camera.name(), size, *camera.intrinsics(), *camera.distortion(), place)
}

/// A number between −1 and 1.
fn centred(random: &mut Pcg64Mcg) -> f64 {
    (random.next_u64() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

fn one(setting: Setting, trouble: Trouble, trial: usize, options: &DrawnClocks) -> Result<Vec<ClockOffset>> {
    let model = builtin::full_body();
    let cameras = setting.cameras(options.size_px)?;
    let [length, farthest] = setting.times();
    let mut random = Pcg64Mcg::seed_from_u64(options.seed ^ (trial as u64) << 32);
    // A camera's clock shows `ahead` at the moment at which the first one's shows 0.
    let mut ahead = vec![0.0];
    ahead.extend(cameras[1..].iter().map(|_| farthest * centred(&mut random)));
    let mut recordings = Vec::new();
    for (index, camera) in cameras.iter().enumerate() {
        let rate = trouble.rate(index);
        let frames = (rate * length) as usize;
        let px_per_m = camera.intrinsics().mean_focal_px() / camera.depth(DVec3::new(0.0, 0.0, 0.85));
        let mask = |frame: usize| -> Result<Mask> {
            let moment = frame as f64 / rate - ahead[index];
            let mask = capsules::hard_mask(&model, &setting.pose(&model, moment), camera)?;
            let seed = options.seed + ((trial * 16 + index) * 10_000 + frame) as u64;
            trouble.of(mask, index, px_per_m, seed)
        };
        let masks: Vec<Mask> = (0..frames).into_par_iter().map(mask).collect::<Result<_>>()?;
        let seen_by = match trouble {
            Trouble::Turned(degrees) => turned(camera, degrees.to_radians(), &mut random)?,
            _ => (**camera).clone(),
        };
        recordings.push(recording(seen_by, (0..).map(|frame| f64::from(frame) / rate), &masks));
    }
    let period_s = 1.0 / (0..cameras.len()).map(|camera| trouble.rate(camera)).fold(f64::INFINITY, f64::min);
    Ok(find_offsets(&recordings, &ahead, period_s, trial))
}

/// What a camera recorded at these times.
fn recording<'a>(
    camera: Camera,
    times: impl Iterator<Item = f64>,
    masks: impl IntoIterator<Item = &'a Mask>,
) -> Recording {
    let mut recording = Recording::new(camera);
    for (time, mask) in times.zip(masks) {
        recording.push(time, mask);
    }
    recording
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::arguments::defaults;

    fn cases(settings: &[Setting], troubles: &[Trouble]) -> Vec<Case> {
        let (settings, troubles) = (settings.to_vec(), troubles.to_vec());
        let mut small = DrawnClocks { settings, troubles, trials: 1, size_px: [108, 144], ..defaults() };
        small.run(&Run::hidden()).unwrap().cases
    }

    /// Offsets that were told, share.
    fn told(case: &Case) -> f64 {
        let told = case.found.iter().filter(|found| found.error_s.is_some()).count();
        told as f64 / case.found.len().max(1) as f64
    }

    #[test]
    fn clocks_are_found_whatever_is_wrong_with_the_masks() {
        let troubles = [Trouble::Nothing, Trouble::Wide(0.05), Trouble::Noise(0.3), Trouble::OtherRate(25.0)];
        for case in cases(&[Setting::Around], &troubles) {
            assert!(
                told(&case) > 0.99 && case.errors_in_frames().iter().all(|error| *error < 0.25),
                "{case:#?}"
            );
        }
    }

    #[test]
    fn two_telephones_37_degrees_apart_are_enough() {
        for case in cases(&[Setting::Phones], &[Trouble::OneWide(0.05), Trouble::Noise(0.3)]) {
            assert!(told(&case) > 0.99 && case.errors_in_frames()[0] < 0.25, "{case:#?}");
        }
    }

    #[test]
    fn a_person_who_stands_still_is_refused() {
        for case in cases(&[Setting::Still], &[Trouble::Nothing, Trouble::Noise(0.3)]) {
            assert!(told(&case) < 0.01, "{case:#?}");
            let is_said = |why: &str| why.starts_with("nothing moves enough to tell");
            assert!(case.found.iter().all(|found| found.why.as_deref().is_some_and(is_said)), "{case:#?}");
        }
    }
}
