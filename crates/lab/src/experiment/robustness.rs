//! What goes wrong with a fit, and by how much: one trouble at a time.
//!
//! The built-in full body in moments of the built-in movement, before the four cameras around it, with hard masks of
//! its own capsules. Fits begin near the truth, so that errors are of what the data or the body say, and not of the
//! start.

use std::sync::Arc;

use backlit_tracking::body::{Kinematics, Model, Pose, builtin};
use backlit_tracking::camera::{Camera, CameraError, CameraFromWorld};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{Evidence, Fit, FitOptions, FitView, Preset};
use backlit_tracking::geometry::rotation::exp;
use backlit_tracking::residual::Loss;
use backlit_tracking::search::start::perturb;
use backlit_tracking::silhouette::{Label, Mask, Overlap};
use backlit_tracking::statistics::Statistics;
use glam::DVec3;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;
use serde::Serialize;

use super::track::noisy;
use super::{ExperimentError, Progress, scene};
use crate::synthetic::capsules;
use crate::synthetic::{motion, studio};

/// Ellipses in every picture.
const ELLIPSES: usize = 3;
/// Short half axis of an ellipse, of the long one.
const FLATNESS: f64 = 0.5;
/// Residuals beyond this are doubted by the third way, grey levels.
const DOUBT: f64 = 30.0;

/// One thing that is not as the fit believes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Trouble {
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
    /// What it is called in tables.
    #[must_use]
    pub fn label(self) -> String {
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

/// A way to fit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Way {
    /// What it is called.
    pub name: String,
    /// Every choice.
    pub fit: FitOptions,
}

/// What to vary.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Options {
    /// Moments of the built-in movement, in its frames.
    pub moments: Vec<f64>,
    /// Starts of each moment, each with troubles of its own.
    pub starts: usize,
    /// Pixels across and down of each of the four cameras.
    pub size_px: [u64; 2],
    /// How far every rotation starts from the truth, radians.
    pub angle_rad: f64,
    /// How far the root starts from the truth, metres.
    pub distance_m: f64,
    /// Seed of starts and troubles.
    pub seed: u64,
    /// The troubles, one at a time.
    pub troubles: Vec<Trouble>,
    /// The ways that are compared.
    pub ways: Vec<Way>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            moments: vec![0.0, 12.0, 24.0, 36.0, 48.0],
            starts: 3,
            size_px: [studio::WIDTH, studio::HEIGHT],
            angle_rad: 5f64.to_radians(),
            distance_m: 0.03,
            seed: 1,
            troubles: troubles(),
            ways: ways(),
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
#[must_use]
pub fn ways() -> Vec<Way> {
    let robust = FitOptions::preset(Preset::Robust);
    let doubting = FitOptions { pixel_loss: Loss::Cauchy { scale: DOUBT }, ..robust.clone() };
    let way = |name: &str, fit| Way { name: name.to_owned(), fit };
    vec![
        way("Report 2004", FitOptions::preset(Preset::Report)),
        way("Robust", robust),
        way("Robust, doubting pixels", doubting),
    ]
}

/// What came of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// One entry a trouble and way: all ways of the first trouble first.
    pub cases: Vec<Case>,
}

/// One way under one trouble: the joints of all fits.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Case {
    /// What is wrong.
    pub trouble: Trouble,
    /// The way's name.
    pub way: String,
    /// Mean joint error, millimetres.
    pub mean_mm: f64,
    /// 95 % of the joints lie below, millimetres.
    pub p95_mm: f64,
    /// Worst joint of all fits, millimetres.
    pub max_mm: f64,
    /// Overlap with the masks that the fits saw, by the cameras that they believed; all pixels together.
    pub iou: Option<f64>,
    /// Fits.
    pub fits: usize,
}

/// Fits every moment from every start, in every way, under every trouble. Ways meet the same starts and noise.
///
/// # Errors
/// Options that make no sense, or `cancel`.
pub fn run(
    options: &Options,
    cancel: &CancelToken,
    mut on_progress: impl FnMut(Progress),
) -> Result<Report, ExperimentError> {
    for (option, value) in [("starts", options.starts), ("moments", options.moments.len())] {
        if value == 0 {
            return Err(ExperimentError::Option { option, value: 0.0, expected: "1 or more" });
        }
    }
    let (mut done, total) = (0, options.troubles.len() * options.ways.len());
    let mut cases = Vec::new();
    for &trouble in &options.troubles {
        let scenes = scenes(options, trouble)?;
        for way in &options.ways {
            on_progress(Progress { done, total });
            done += 1;
            cases.push(case(trouble, way, &scenes, cancel)?);
        }
    }
    on_progress(Progress { done, total });
    Ok(Report { cases })
}

/// What one fit gets, and its truth.
struct Scene {
    believed: Arc<Model>,
    cameras: Vec<Arc<Camera>>,
    masks: Vec<Mask>,
    start: Pose,
    true_joints: Vec<DVec3>,
}

fn scenes(options: &Options, trouble: Trouble) -> Result<Vec<Scene>, ExperimentError> {
    let body = builtin::full_body();
    let believed = Arc::new(match trouble {
        Trouble::Lengths(factor) => resized(&body, [factor, 1.0])?,
        Trouble::Radii(factor) => resized(&body, [1.0, factor])?,
        _ => body.clone(),
    });
    let [width, height] = options.size_px;
    let mut cameras = Vec::new();
    for camera in studio::cameras().cameras() {
        cameras.push(Arc::new(camera.without_distortion().resized(width, height)?));
    }
    if let Trouble::Cameras(count) = trouble {
        if !(1..=cameras.len()).contains(&count) {
            let value = count as f64;
            return Err(ExperimentError::Option { option: "cameras", value, expected: "1 to 4" });
        }
        cameras.truncate(count);
    }
    let mut scenes = Vec::new();
    for &moment in &options.moments {
        let truth = motion::pose(&body, moment);
        for _ in 0..options.starts {
            let seed = options.seed.wrapping_mul(1_000_003).wrapping_add(scenes.len() as u64);
            let mut random = Pcg64Mcg::seed_from_u64(seed);
            let mut masks = Vec::new();
            let mut believed_cameras = Vec::new();
            for camera in &cameras {
                let mask = capsules::hard_mask(&body, &truth, camera)?;
                masks.push(troubled(mask, trouble, &mut random)?);
                believed_cameras.push(match trouble {
                    Trouble::Turned(angle) => Arc::new(turned(camera, angle, &mut random)?),
                    _ => Arc::clone(camera),
                });
            }
            scenes.push(Scene {
                believed: Arc::clone(&believed),
                cameras: believed_cameras,
                masks,
                start: perturb(&body, &truth, options.angle_rad, options.distance_m, seed),
                true_joints: Kinematics::new(&body, &truth).ends().to_vec(),
            });
        }
    }
    Ok(scenes)
}

fn resized(body: &Model, [length, radius]: [f64; 2]) -> Result<Model, ExperimentError> {
    let sizes = |limb: usize| [length * body.limbs()[limb].length, radius * body.limbs()[limb].radius];
    Ok(body.with_sizes(sizes)?)
}

/// The camera turned about its centre, about an axis in any direction.
pub(super) fn turned(camera: &Camera, angle: f64, random: &mut Pcg64Mcg) -> Result<Camera, CameraError> {
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

fn troubled(mut mask: Mask, trouble: Trouble, random: &mut Pcg64Mcg) -> Result<Mask, ExperimentError> {
    let share = |option, value: f64| {
        let expected = "a share from 0 to 1";
        let is_one = (0.0..=1.0).contains(&value);
        if is_one { Ok(value) } else { Err(ExperimentError::Option { option, value, expected }) }
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

fn case(
    trouble: Trouble,
    way: &Way,
    scenes: &[Scene],
    cancel: &CancelToken,
) -> Result<Case, ExperimentError> {
    let mut errors = Vec::new();
    let mut overlap = Overlap::default();
    for scene in scenes {
        let view = |(camera, mask): (&Arc<Camera>, &Mask)| FitView {
            camera: Arc::clone(camera),
            evidence: Evidence::Mask(Arc::new(mask.clone())),
            weight: 1.0,
        };
        let views: Vec<FitView> = scene.cameras.iter().zip(&scene.masks).map(view).collect();
        let (model, start) = (Arc::clone(&scene.believed), scene.start.clone());
        let mut fit = Fit::new(model, views.clone(), start, way.fit.clone())?;
        let pose = fit.run(cancel, |_| {}).pose;
        if cancel.is_cancelled() {
            return Err(ExperimentError::Cancelled);
        }
        let found = Kinematics::new(&scene.believed, &pose);
        let joints = found.ends().iter().zip(&scene.true_joints);
        errors.extend(joints.map(|(found, truth)| 1000.0 * found.distance(*truth)));
        overlap = overlap.merge(scene::overlap(&scene.believed, &pose, &views, way.fit.renderer));
    }
    let (mean_mm, p95_mm, max_mm) =
        Statistics::of(&errors).map_or((0.0, 0.0, 0.0), |all| (all.mean, all.p95, all.max));
    let iou = overlap.iou();
    Ok(Case { trouble, way: way.name.clone(), mean_mm, p95_mm, max_mm, iou, fits: scenes.len() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn options(troubles: &[Trouble]) -> Options {
        Options {
            moments: vec![0.0, 24.0],
            starts: 1,
            troubles: troubles.to_vec(),
            ways: vec![ways().remove(1)],
            ..Options::default()
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
        let options = options(&troubles);
        let report = run(&options, &CancelToken::new(), |_| {}).unwrap();
        let mean: Vec<f64> = report.cases.iter().map(|case| case.mean_mm).collect();
        assert!(mean[0] < 4.0 && mean[1] < 6.0, "{mean:?}");
        assert!(mean[2..].iter().all(|error| *error > 2.0 * mean[0]), "{mean:?}");
        assert_eq!(run(&options, &CancelToken::new(), |_| {}).unwrap(), report);
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
    fn options_that_make_no_sense_are_named() {
        for (trouble, word) in [(Trouble::Cameras(5), "cameras"), (Trouble::Border(1.5), "border")] {
            let error = run(&options(&[trouble]), &CancelToken::new(), |_| {}).unwrap_err();
            assert!(error.to_string().contains(word), "{error}");
        }
    }
}
