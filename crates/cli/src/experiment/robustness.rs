//! What goes wrong with a fit, and by how much: one trouble at a time.
//!
//! The built-in full body in moments of the built-in movement, before the four cameras around it, with hard masks of
//! its own capsules. Fits begin near the truth, so that errors are of what the data or the body say, and not of the
//! start.

use std::mem::discriminant;
use std::sync::Arc;

use anyhow::{Result, ensure};
use backlit_lab::experiment::scene;
use backlit_lab::synthetic::masks::noisy;
use backlit_lab::synthetic::{capsules, motion, studio};
use backlit_plot::{Axis, Drawn, Figure, Line};
use backlit_tracking::body::{Kinematics, Model, Pose, builtin};
use backlit_tracking::camera::{Camera, CameraError, CameraFromWorld};
use backlit_tracking::fit::{Fit, FitOptions, FitView, Preset};
use backlit_tracking::geometry::rotation::exp;
use backlit_tracking::residual::Loss;
use backlit_tracking::search::start::perturb;
use backlit_tracking::silhouette::{Label, Mask, Overlap};
use clap::Args;
use glam::DVec3;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;
use serde::Serialize;

use super::arguments::Starts;
use super::measures::{ErrorStatistics, NamedFit, masked};
use super::{Experiment, Run, check_least};
use crate::output::number;
use crate::table::Table;

/// Ellipses in every picture.
const ELLIPSES: usize = 3;
/// Short half axis of an ellipse, of the long one.
const FLATNESS: f64 = 0.5;
/// Residuals beyond this are doubted by the third fit, grey levels.
const DOUBT: f64 = 30.0;

/// The full body with one thing wrong at a time: noise, holes, cameras, sizes, calibration
#[derive(Debug, Args, Serialize)]
#[command(
    mut_arg("starts", |starts| starts.default_value("3")),
    mut_arg("start_noise", |noise| noise.default_value("5deg,3cm"))
)]
pub(crate) struct Robustness {
    /// Moments of the built-in movement (its frames, 0 to 59) to look at
    #[arg(long, value_name = "K,…", value_delimiter = ',', default_values_t = [0.0, 12.0, 24.0, 36.0, 48.0])]
    moments: Vec<f64>,
    #[command(flatten)]
    #[serde(flatten)]
    starts: Starts,
    #[arg(skip = [studio::WIDTH, studio::HEIGHT])]
    size_px: [u64; 2],
    #[arg(skip = troubles())]
    troubles: Vec<Trouble>,
    #[arg(skip = fits())]
    #[serde(rename = "ways")]
    fits: Vec<NamedFit>,
}

/// One thing that is not as the fit believes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
enum Trouble {
    /// Everything is.
    None,
    /// This share of the pixels at the silhouettes' borders is wrong.
    Border(f64),
    /// This share of all other pixels is wrong.
    Speckle(f64),
    /// Three ellipses in every silhouette are missing; long half axis in pixels.
    Holes(f64),
    /// Three ellipses about pixels of every silhouette are unknown; long half axis in pixels.
    Hidden(f64),
    /// Three ellipses in every background are spurious; long half axis in pixels.
    Blobs(f64),
    /// Only the first cameras see.
    Cameras(usize),
    /// The body of the fit has limbs of this times the true lengths.
    Lengths(f64),
    /// The body of the fit has limbs of this times the true radii.
    Radii(f64),
    /// Every camera is turned about its centre from where the fit believes it, about any axis, radians.
    Turned(f64),
}

impl Trouble {
    fn label(self) -> String {
        match self {
            Self::None => "nothing wrong".to_owned(),
            Self::Border(share) => format!("border noise {:.0} %", 100.0 * share),
            Self::Speckle(share) => format!("speckle {:.0} %", 100.0 * share),
            Self::Holes(radius) => format!("holes of {radius:.0} px"),
            Self::Hidden(radius) => format!("hidden by {radius:.0} px"),
            Self::Blobs(radius) => format!("blobs of {radius:.0} px"),
            Self::Cameras(1) => "1 camera".to_owned(),
            Self::Cameras(count) => format!("{count} cameras"),
            Self::Lengths(factor) => format!("lengths {:+.0} %", 100.0 * (factor - 1.0)),
            Self::Radii(factor) => format!("radii {:+.0} %", 100.0 * (factor - 1.0)),
            Self::Turned(angle) => format!("cameras turned {:.1}°", angle.to_degrees()),
        }
    }
}

fn troubles() -> Vec<Trouble> {
    use Trouble::{Blobs, Border, Cameras, Hidden, Holes, Lengths, Radii, Speckle, Turned};
    let mut troubles = vec![Trouble::None];
    troubles.extend([0.1, 0.3].map(Border));
    troubles.extend([0.01, 0.03].map(Speckle));
    troubles.extend([4.0, 8.0, 16.0].map(Holes));
    troubles.extend([8.0, 16.0, 32.0].map(Hidden));
    troubles.extend([4.0, 8.0, 16.0].map(Blobs));
    troubles.extend([3, 2, 1].map(Cameras));
    troubles.extend([0.9, 1.1].map(Lengths));
    troubles.extend([0.9, 1.1].map(Radii));
    troubles.extend([0.5, 1.0].map(|degrees: f64| Turned(degrees.to_radians())));
    troubles
}

/// The two presets, and the robust one with doubt in single pixels.
fn fits() -> Vec<NamedFit> {
    let robust = FitOptions::preset(Preset::Robust);
    let doubting = FitOptions { pixel_loss: Loss::Cauchy { scale: DOUBT }, ..robust.clone() };
    vec![
        NamedFit::new("Report 2004", FitOptions::preset(Preset::Report)),
        NamedFit::new("Robust", robust),
        NamedFit::new("Robust, doubting pixels", doubting),
    ]
}

#[derive(Debug, PartialEq, Serialize)]
pub(crate) struct Report {
    /// All fits of the first trouble first.
    cases: Vec<Case>,
}

/// One fit under one trouble, from all starts.
#[derive(Debug, PartialEq, Serialize)]
struct Case {
    trouble: Trouble,
    #[serde(rename = "way")]
    fit: String,
    /// Of all joints of all fits.
    #[serde(flatten)]
    joints: ErrorStatistics,
    /// Overlap with the masks that the fits saw, by the cameras that they believed; all pixels together.
    iou: Option<f64>,
    fits: usize,
}

/// What one fit gets, and its truth.
struct Trial {
    believed: Arc<Model>,
    views: Vec<FitView>,
    start: Pose,
    true_joints: Vec<DVec3>,
}

impl Experiment for Robustness {
    const NAME: &'static str = "robustness";
    type Report = Report;

    /// All fits meet the same starts and noise.
    fn run(&mut self, run: &Run) -> Result<Report> {
        check_least("starts", self.starts.starts, 1)?;
        check_least("moments", self.moments.len(), 1)?;
        let total = self.troubles.len() * self.fits.len();
        let mut cases = Vec::new();
        for &trouble in &self.troubles {
            let trials = self.trials(trouble)?;
            for fit in &self.fits {
                run.progress(cases.len(), total)?;
                cases.push(case(trouble, fit, &trials, run)?);
            }
        }
        Ok(Report { cases })
    }

    fn table(&self, report: &Report) -> String {
        let row = |index: &usize| index / self.fits.len().max(1) + 1;
        Table::of(
            report.cases.iter().enumerate(),
            &[
                ("what is wrong", &|(index, case)| format!("{:2} {}", row(index), case.trouble.label())),
                ("way", &|(_, case)| case.fit.clone()),
                ("joint error, mm: mean", &|(_, case)| number(case.joints.mean_mm, 1)),
                ("95 %", &|(_, case)| number(case.joints.p95_mm, 1)),
                ("max", &|(_, case)| number(case.joints.max_mm, 0)),
                ("IoU", &|(_, case)| number(case.iou, 3)),
            ],
        )
    }

    fn pictures(&self, report: &Report) -> Vec<(String, Drawn)> {
        let [width, height] = self.size_px;
        let (moments, starts) = (self.moments.len(), self.starts.starts);
        let lines = self.fits.iter().enumerate().map(|(style, fit)| {
            let cases = report.cases.iter().filter(|case| case.fit == fit.name);
            Line::of_points(&fit.name, style, points(cases))
        });
        let figure = Figure {
            title: "Full body, one thing wrong at a time: mean joint error".to_owned(),
            subtitle: format!(
                "four cameras of {width} × {height} pixels, {moments} moments, {starts} starts each; rows are the table's"
            ),
            x: Axis::linear("row of the table"),
            y: Axis::log("mean joint error, mm"),
            lines: lines.collect(),
        };
        vec![("robustness".to_owned(), Drawn::Figure(figure))]
    }
}

/// One curve, with gaps between one kind of trouble and the next.
fn points<'a>(cases: impl Iterator<Item = &'a Case>) -> Vec<[f64; 2]> {
    let (mut points, mut before) = (Vec::new(), None);
    for (row, case) in cases.enumerate() {
        let kind = discriminant(&case.trouble);
        if before.is_some_and(|before| before != kind) {
            points.push([row as f64 + 0.5, f64::NAN]);
        }
        before = Some(kind);
        points.push([row as f64 + 1.0, case.joints.mean_mm]);
    }
    points
}

impl Robustness {
    fn trials(&self, trouble: Trouble) -> Result<Vec<Trial>> {
        let body = builtin::full_body();
        let believed = Arc::new(match trouble {
            Trouble::Lengths(factor) => resized(&body, [factor, 1.0])?,
            Trouble::Radii(factor) => resized(&body, [1.0, factor])?,
            _ => body.clone(),
        });
        let mut cameras = studio::pinholes(self.size_px)?;
        if let Trouble::Cameras(count) = trouble {
            ensure!((1..=cameras.len()).contains(&count), "`cameras` is {count}; expected 1 to 4");
            cameras.truncate(count);
        }
        let mut trials = Vec::new();
        for &moment in &self.moments {
            let truth = motion::pose(&body, moment);
            for _ in 0..self.starts.starts {
                let seed = self.starts.seed.wrapping_mul(1_000_003).wrapping_add(trials.len() as u64);
                let mut random = Pcg64Mcg::seed_from_u64(seed);
                let mut views = Vec::new();
                for camera in &cameras {
                    let mask = troubled(capsules::hard_mask(&body, &truth, camera)?, trouble, &mut random)?;
                    let believed = match trouble {
                        Trouble::Turned(angle) => Arc::new(turned(camera, angle, &mut random)?),
                        _ => Arc::clone(camera),
                    };
                    views.push(masked(&believed, mask));
                }
                let noise = self.starts.start_noise;
                trials.push(Trial {
                    believed: Arc::clone(&believed),
                    views,
                    start: perturb(&body, &truth, noise.angle_rad, noise.distance_m, seed),
                    true_joints: Kinematics::new(&body, &truth).ends().to_vec(),
                });
            }
        }
        Ok(trials)
    }
}

fn resized(body: &Model, [length, radius]: [f64; 2]) -> Result<Model> {
    let sizes = |limb: usize| [length * body.limbs()[limb].length, radius * body.limbs()[limb].radius];
    Ok(body.with_sizes(sizes)?)
}

/// The camera turned about its centre, about an axis in any direction.
pub(crate) fn turned(camera: &Camera, angle: f64, random: &mut Pcg64Mcg) -> Result<Camera, CameraError> {
    let axis = loop {
        let axis = DVec3::from_array(std::array::from_fn(|_| random.random_range(-1.0..1.0)));
        if (0.01..1.0).contains(&axis.length_squared()) {
            break axis.normalize();
        }
    };
    let turn = exp(axis * angle);
    let place = camera.camera_from_world();
    let place = CameraFromWorld {
        rotation: glam::DMat3::from_quat(turn) * place.rotation,
        translation: turn * place.translation,
    };
    let size = [camera.width() as u64, camera.height() as u64];
    Camera::new(camera.name(), size, *camera.intrinsics(), *camera.distortion(), place)
}

fn troubled(mut mask: Mask, trouble: Trouble, random: &mut Pcg64Mcg) -> Result<Mask> {
    let share = |option: &str, value: f64| {
        ensure!((0.0..=1.0).contains(&value), "`{option}` is {value}; expected a share from 0 to 1");
        Ok(value)
    };
    match trouble {
        Trouble::Border(value) => mask = noisy(&mask, share("border", value)?, 0.0, random),
        Trouble::Speckle(value) => mask = noisy(&mask, 0.0, share("speckle", value)?, random),
        Trouble::Holes(radius) => paint(&mut mask, Label::Subject, Label::Background, radius, random),
        Trouble::Hidden(radius) => paint(&mut mask, Label::Subject, Label::Unknown, radius, random),
        Trouble::Blobs(radius) => paint(&mut mask, Label::Background, Label::Subject, radius, random),
        _ => {}
    }
    Ok(mask)
}

/// Paints ellipses about pixels of one label in another, each turned at random.
fn paint(mask: &mut Mask, about: Label, paint: Label, radius: f64, random: &mut Pcg64Mcg) {
    let (width, labels) = (mask.width(), mask.labels_mut());
    let places: Vec<usize> = (0..labels.len()).filter(|&pixel| labels[pixel] == about).collect();
    if places.is_empty() {
        return;
    }
    let across_and_down = |pixel: usize| [(pixel % width) as f64, (pixel / width) as f64];
    for _ in 0..ELLIPSES {
        let [x, y] = across_and_down(places[random.random_range(0..places.len())]);
        let (sine, cosine) = random.random_range(0.0..std::f64::consts::PI).sin_cos();
        for (pixel, label) in labels.iter_mut().enumerate() {
            let [dx, dy] = [across_and_down(pixel)[0] - x, across_and_down(pixel)[1] - y];
            let along = (cosine * dx + sine * dy) / radius;
            let beside = (cosine * dy - sine * dx) / (FLATNESS * radius);
            if along * along + beside * beside <= 1.0 {
                *label = paint;
            }
        }
    }
}

fn case(trouble: Trouble, fit: &NamedFit, trials: &[Trial], run: &Run) -> Result<Case> {
    let mut errors = Vec::new();
    let mut overlap = Overlap::default();
    for Trial { believed, views, start, true_joints } in trials {
        let mut descent = Fit::new(Arc::clone(believed), views.clone(), start.clone(), fit.fit.clone())?;
        let pose = descent.run(&run.cancel, |_| {}).pose;
        run.check()?;
        let found = Kinematics::new(believed, &pose);
        let joints = found.ends().iter().zip(true_joints);
        errors.extend(joints.map(|(found, truth)| 1000.0 * found.distance(*truth)));
        overlap = overlap.merge(scene::overlap(believed, &pose, views, fit.fit.renderer));
    }
    let joints = ErrorStatistics::of(&errors).unwrap_or_default();
    Ok(Case { trouble, fit: fit.name.clone(), joints, iou: overlap.iou(), fits: trials.len() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::arguments::defaults;

    fn options(troubles: &[Trouble]) -> Robustness {
        Robustness {
            moments: vec![0.0, 24.0],
            starts: Starts::new(1, 5.0, 0.03),
            troubles: troubles.to_vec(),
            fits: vec![fits().remove(1)],
            ..defaults()
        }
    }

    #[test]
    fn noise_is_harmless_and_wrong_bodies_and_cameras_are_not() {
        let troubles = [
            Trouble::None,
            Trouble::Border(0.3),
            Trouble::Lengths(1.1),
            Trouble::Radii(0.9),
            Trouble::Turned(1f64.to_radians()),
        ];
        let mut options = options(&troubles);
        let report = options.run(&Run::hidden()).unwrap();
        let mean: Vec<f64> = report.cases.iter().map(|case| case.joints.mean_mm).collect();
        assert!(mean[0] < 4.0 && mean[1] < 6.0, "{mean:?}");
        assert!(mean[2..].iter().all(|error| *error > 2.0 * mean[0]), "{mean:?}");
        assert_eq!(options.run(&Run::hidden()).unwrap(), report);
    }

    #[test]
    fn holes_and_blobs_are_where_they_should_be() {
        let empty = Mask::filled(40, 30, Label::Background).unwrap();
        let full = Mask::filled(40, 30, Label::Subject).unwrap();
        let mut random = Pcg64Mcg::seed_from_u64(1);
        let holed = troubled(full.clone(), Trouble::Holes(4.0), &mut random).unwrap();
        let blobbed = troubled(empty.clone(), Trouble::Blobs(4.0), &mut random).unwrap();
        // An ellipse of half axes 4 and 2 has 25 pixels; three may overlap or leave the picture.
        assert!((12..=90).contains(&holed.count(Label::Background)), "{holed:?}");
        assert!((12..=90).contains(&blobbed.count(Label::Subject)), "{blobbed:?}");
        let hidden = troubled(full.clone(), Trouble::Hidden(4.0), &mut random).unwrap();
        assert!((12..=90).contains(&hidden.count(Label::Unknown)), "{hidden:?}");
        assert_eq!(troubled(empty.clone(), Trouble::Holes(4.0), &mut random).unwrap(), empty);
        assert_eq!(troubled(full.clone(), Trouble::Blobs(4.0), &mut random).unwrap(), full);
    }

    #[test]
    fn a_camera_is_turned_by_as_much_as_is_said_and_stays_where_it_is() {
        let camera = &studio::cameras().cameras()[0].without_distortion();
        let other = turned(camera, 0.02, &mut Pcg64Mcg::seed_from_u64(3)).unwrap();
        assert!(camera.centre().distance(other.centre()) < 1e-9);
        let [a, b] = [camera, &other].map(|camera| camera.camera_from_world().rotation);
        let cosine = 0.5
            * ((a * b.transpose()).to_cols_array_2d().iter().enumerate().map(|(i, c)| c[i]).sum::<f64>()
                - 1.0);
        assert!((cosine.acos() - 0.02).abs() < 1e-6, "{cosine}");
    }

    #[test]
    fn options_out_of_range_are_named() {
        for (trouble, word) in [(Trouble::Cameras(5), "cameras"), (Trouble::Border(1.5), "border")] {
            let error = options(&[trouble]).run(&Run::hidden()).unwrap_err();
            assert!(error.to_string().contains(word), "{error}");
        }
    }
}
