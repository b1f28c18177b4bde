//! The sizes of people of several builds, found from hard silhouettes and an average adult's body.
//!
//! Each person goes through the moments of the built-in movement; the fit begins with the generic body, and with
//! poses that are off in every joint. With `--widened` it is [`OwnSizes`] instead.

use std::sync::Arc;

use anyhow::{Context, Result, bail};
use backlit_lab::experiment::{Simulation, scene};
use backlit_lab::synthetic::people::{PEOPLE, Person};
use backlit_lab::synthetic::{motion, studio};
use backlit_tracking::body::{Kinematics, Model, Pose, SizeKind, builtin};
use backlit_tracking::body_fit::{BodyFit, BodyFitError, BodyFitOptions, BodyFrame, WELL_SEEN, fit_body};
use backlit_tracking::camera::Camera;
use backlit_tracking::render::{Ramp, RendererKind};
use backlit_tracking::search::start;
use clap::Args;
use serde::Serialize;

use super::arguments::OutputArguments;
use super::own_sizes::OwnSizes;
use super::{Experiment, ExperimentArguments, Run};
use crate::interrupt::Interrupted;
use crate::output::number;
use crate::table::Table;

/// Lengths and radii of people of several builds, from silhouettes and an average adult's body
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    exact: Sizes,
    /// Find sizes from a track with the average body instead, through silhouettes that are wider than the person by these
    /// per cent of the person's breadth, and track with them: four cameras around, and two phones
    #[arg(long, value_name = "PERCENT,…", value_delimiter = ',', value_parser = percent)]
    widened: Option<Vec<f64>>,
    /// With --widened: only every Nth frame of the movement is seen
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=20))]
    every: u32,
    #[command(flatten)]
    output: OutputArguments,
}

/// 0 to 50 %, as a share.
fn percent(text: &str) -> Result<f64> {
    match text.parse::<f64>() {
        Ok(percent) if (0.0..=50.0).contains(&percent) => Ok(percent / 100.0),
        _ => bail!("expected per cent from 0 to 50"),
    }
}

impl ExperimentArguments for Arguments {
    const NAME: &'static str = Sizes::NAME;

    fn run(mut self) -> Result<()> {
        let Some(widened) = self.widened else { return self.exact.perform(&self.output) };
        OwnSizes::new(widened, self.every as usize, self.exact.seed).perform(&self.output)
    }
}

/// From silhouettes as they are.
#[derive(Debug, Args, Serialize)]
struct Sizes {
    /// Moments of the built-in movement (its frames, 0 to 59) to look at
    #[arg(long, value_name = "K,…", value_delimiter = ',',
        default_values_t = [0.0, 8.0, 16.0, 24.0, 31.0, 41.0, 50.0, 59.0])]
    moments: Vec<f64>,
    #[arg(skip = [studio::WIDTH, studio::HEIGHT])]
    size_px: [u64; 2],
    #[arg(skip = 5.0_f64.to_radians())]
    start_angle_rad: f64,
    #[arg(skip = 0.03)]
    start_distance_m: f64,
    /// Seed of the poses that the fits begin with
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    #[arg(skip = BodyFitOptions::default().with_proportions(WELL_SEEN))]
    fit: BodyFitOptions,
}

#[derive(Debug, Serialize)]
struct Report {
    people: Vec<OfPerson>,
}

#[derive(Debug, Serialize)]
struct OfPerson {
    name: &'static str,
    /// Of the body, as a factor of the average adult's.
    true_size: f64,
    size: f64,
    /// Of the body scaled as a whole and of the body found.
    iou: [Option<f64>; 2],
    /// Mean over the joints of all moments.
    joint_error_mm: f64,
    iterations: usize,
    sizes: Vec<SizeError>,
}

#[derive(Debug, Serialize)]
struct SizeError {
    /// The limb, without its side.
    name: String,
    kind: SizeKind,
    truth_mm: f64,
    found_mm: f64,
    /// As the fit states it.
    deviation_mm: f64,
    /// Deviation over that of the proportions alone: 1 if the silhouettes say nothing.
    uncertainty: f64,
    /// Whether the fit says that the silhouettes hardly show it.
    held_by_prior: bool,
}

impl SizeError {
    fn error_mm(&self) -> f64 {
        (self.found_mm - self.truth_mm).abs()
    }
}

impl OfPerson {
    /// The size of the largest error of a kind; of all sizes, or of those that silhouettes show.
    fn worst(&self, kind: SizeKind, seen_only: bool) -> Option<&SizeError> {
        let of_kind =
            self.sizes.iter().filter(|size| size.kind == kind && !(seen_only && size.held_by_prior));
        of_kind.max_by(|a, b| a.error_mm().total_cmp(&b.error_mm()))
    }

    fn mean_mm(&self, kind: SizeKind) -> f64 {
        let errors: Vec<f64> =
            self.sizes.iter().filter(|size| size.kind == kind).map(SizeError::error_mm).collect();
        errors.iter().sum::<f64>() / errors.len().max(1) as f64
    }
}

impl Experiment for Sizes {
    const NAME: &'static str = "sizes";
    type Report = Report;

    fn run(&mut self, run: &Run) -> Result<Report> {
        let adult = Arc::new(builtin::full_body());
        let cameras = studio::pinholes(self.size_px)?;
        let mut people = Vec::new();
        for person in &PEOPLE {
            run.progress(people.len(), PEOPLE.len())?;
            let body = person.of(&adult)?;
            let stands = |&moment: &f64| person.standing(motion::pose(&body, moment));
            let truths: Vec<Pose> = self.moments.iter().map(stands).collect();
            let frames = self.frames(&adult, &body, &truths, &cameras)?;
            let fit = fit_body(adult.clone(), frames, None, &self.fit, &run.cancel, |_| {});
            people.push(report(person, &body, &truths, &of_person(person, fit)?));
        }
        Ok(Report { people })
    }

    fn table(&self, report: &Report) -> String {
        let worst = |person: &&OfPerson, kind, seen_only| {
            let size = person.worst(kind, seen_only);
            size.map_or_else(|| "–".to_owned(), |size| format!("{:.1} {}", size.error_mm(), size.name))
        };
        let (length, radius) = (SizeKind::Length, SizeKind::Radius);
        let table = Table::of(
            &report.people,
            &[
                ("error, mm", &|person| person.name.to_owned()),
                ("lengths: mean", &|person| number(person.mean_mm(length), 1)),
                ("worst seen", &|person| worst(person, length, true)),
                ("worst", &|person| worst(person, length, false)),
                ("radii: mean", &|person| number(person.mean_mm(radius), 1)),
                ("worst seen", &|person| worst(person, radius, true)),
                ("worst", &|person| worst(person, radius, false)),
                ("joints", &|person| number(person.joint_error_mm, 1)),
                ("IoU", &|person| number(person.iou[1], 3)),
            ],
        );
        table + "\nSeen: sizes that the fit does not mark as held by the proportions alone.\n"
    }
}

/// Names the person that sizes could not be fitted to.
pub(crate) fn of_person<T>(person: &Person, fit: Result<T, BodyFitError>) -> Result<T> {
    match fit {
        Err(BodyFitError::Cancelled) => Err(Interrupted.into()),
        fit => fit.context(person.name),
    }
}

impl Sizes {
    fn frames(
        &self,
        adult: &Model,
        body: &Model,
        truths: &[Pose],
        cameras: &[Arc<Camera>],
    ) -> Result<Vec<BodyFrame>> {
        let frame = |(index, truth): (usize, &Pose)| {
            let see = |camera| {
                scene::view(body, truth, camera, Simulation::Mask, RendererKind::Capsule, Ramp::Half)
            };
            let seed = self.seed.wrapping_add(index as u64);
            Ok(BodyFrame {
                frame: index,
                views: cameras.iter().map(see).collect::<Result<_, _>>()?,
                start: start::perturb(adult, truth, self.start_angle_rad, self.start_distance_m, seed),
                joints: Vec::new(),
            })
        };
        truths.iter().enumerate().map(frame).collect()
    }
}

fn report(person: &Person, body: &Model, truths: &[Pose], fit: &BodyFit) -> OfPerson {
    let (mut sum, mut count) = (0.0, 0.0);
    for (&frame, pose) in fit.frames.iter().zip(&fit.poses) {
        let (truth, found) = (Kinematics::new(body, &truths[frame]), Kinematics::new(&fit.model, pose));
        for (truth, found) in truth.ends().iter().zip(found.ends()) {
            sum += truth.distance(*found);
            count += 1.0;
        }
    }
    let sizes = fit.sizes.iter().map(|size| {
        let is_it = |name: &str| name == size.name || name.strip_prefix("right ") == Some(&size.name);
        let limb = body.limbs().iter().find(|limb| is_it(&limb.name));
        let truth = limb.map_or(f64::NAN, |limb| match size.kind {
            SizeKind::Length => limb.length,
            SizeKind::Radius => limb.radius,
        });
        SizeError {
            name: size.name.clone(),
            kind: size.kind,
            truth_mm: 1000.0 * truth,
            found_mm: 1000.0 * size.found,
            deviation_mm: 1000.0 * size.deviation,
            uncertainty: size.uncertainty(),
            held_by_prior: size.is_held_by_prior(),
        }
    });
    OfPerson {
        name: person.name,
        true_size: person.stature,
        size: fit.size,
        iou: fit.iou,
        joint_error_mm: 1000.0 * sum / count,
        iterations: fit.iterations,
        sizes: sizes.collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::arguments::defaults;

    /// Half of the experiment's moments.
    #[test]
    fn people_of_all_builds_get_their_sizes() {
        let mut half = Sizes { moments: vec![0.0, 16.0, 31.0, 50.0], ..defaults() };
        let report = half.run(&Run::hidden()).unwrap();
        let mut failures = Vec::new();
        for person in &report.people {
            for (kind, most_mm) in [(SizeKind::Length, 10.0), (SizeKind::Radius, 5.0)] {
                let worst = person.worst(kind, true).unwrap();
                if worst.error_mm() > most_mm {
                    failures.push(format!("{}: {worst:?}", person.name));
                }
            }
        }
        assert!(failures.is_empty(), "{}", failures.join("\n"));
    }
}
