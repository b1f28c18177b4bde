//! The bias of a ramp: where a fit goes that begins at the truth.
//!
//! Cameras see hard masks of a known pose. A ramp whose half grey does not lie on the limb's surface, or whose
//! slopes inside and outside weigh differently, has its least cost beside the truth. Every fit begins at the
//! truth and goes down to where the cost is least near it; the mean joint error there is the bias.

use std::sync::Arc;

use backlit_tracking::body::{Model, Parameters, Pose, builtin};
use backlit_tracking::camera::Camera;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{DataView, Evidence, FitOptions, FitView, Preset, Stage};
use backlit_tracking::optimize::Method;
use backlit_tracking::render::Ramp;
use backlit_tracking::search::start::perturb;
use backlit_tracking::silhouette::{Label, Measurement};
use backlit_tracking::statistics::Statistics;
use serde::Serialize;

use super::curve::Curve;
use super::{ExperimentError, Progress};
use crate::synthetic::{capsules, upper_body};

/// Sub-pixels across and down of [`Data::Area`].
const SUBPIXELS: u64 = 8;
/// Most iterations of a fit, and the relative decrease at which it counts as converged.
const ITERATIONS: usize = 200;
const TOLERANCE: f64 = 1e-7;
/// Damping at the start.
const DAMPING: f64 = 1e-3;

/// What is made of the hard mask.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Data {
    /// Black and white.
    Hard,
    /// The share of the pixel's area that the subject covers: what a camera sees of a sharp edge.
    Area,
    /// By the distance to the border of the hard mask.
    Distance,
}

/// A ramp, and the data that it is fitted to.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Look {
    /// The prediction's ramp.
    pub ramp: Ramp,
    /// The data.
    pub data: Data,
}

impl Look {
    /// Words for tables and plots.
    #[must_use]
    pub fn name(&self) -> String {
        match self.data {
            Data::Hard => format!("{}, hard mask", self.ramp),
            Data::Area => format!("{}, area-averaged", self.ramp),
            Data::Distance => format!("{}, distances", self.ramp),
        }
    }

    /// The fit that goes down to the least cost: tangent Levenberg-Marquardt without priors.
    #[must_use]
    pub fn fit(&self) -> FitOptions {
        let data = if self.data == Data::Distance { DataView::Distance } else { DataView::Hard };
        let (iterations, tolerance) = (ITERATIONS, Some(TOLERANCE));
        FitOptions {
            parameters: Parameters::Tangent,
            method: Method::LevenbergMarquardt,
            damping: DAMPING,
            stages: vec![Stage { ramp: self.ramp, data, stride: 1, iterations, tolerance, priors: 1.0 }],
            ..FitOptions::preset(Preset::Report)
        }
    }
}

/// What to vary.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Options {
    /// Numbers of cameras.
    pub cameras: Vec<usize>,
    /// Pixels across and down.
    pub size_px: [u64; 2],
    /// Number of true poses.
    pub poses: usize,
    /// Seed of the poses.
    pub seed: u64,
    /// How far every joint of a true pose is turned from the same first pose, radians.
    pub angle_rad: f64,
    /// Ramps and data.
    pub looks: Vec<Look>,
}

impl Default for Options {
    fn default() -> Self {
        let look = |ramp, data| Look { ramp, data };
        let width = Ramp::Width { px: 1.0 };
        let distance = Ramp::Distance { inner_px: 1.5, outer_px: 1.5 };
        Self {
            cameras: vec![1, 2, 4],
            size_px: [192, 144],
            poses: 10,
            seed: 1,
            angle_rad: 10f64.to_radians(),
            looks: vec![
                look(Ramp::Thesis, Data::Hard),
                look(Ramp::Half, Data::Hard),
                look(width, Data::Hard),
                look(width, Data::Area),
                look(distance, Data::Distance),
            ],
        }
    }
}

/// What came of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// One entry a look.
    pub looks: Vec<LookReport>,
}

/// What came of one look.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LookReport {
    /// Its name.
    pub name: String,
    /// One entry a number of cameras.
    pub biases: Vec<Bias>,
}

/// The bias with one number of cameras.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Bias {
    /// Cameras.
    pub cameras: usize,
    /// Median over the poses of the mean joint error, millimetres.
    pub median_mm: f64,
    /// Mean over the poses.
    pub mean_mm: f64,
    /// The largest.
    pub max_mm: f64,
    /// Mean joint error of each pose.
    pub errors_mm: Vec<f64>,
}

/// Fits every pose from itself, with every look and number of cameras.
///
/// # Errors
/// Options that make no sense, or `cancel`.
pub fn run(
    options: &Options,
    cancel: &CancelToken,
    mut on_progress: impl FnMut(Progress),
) -> Result<Report, ExperimentError> {
    if options.poses == 0 {
        return Err(ExperimentError::Option { option: "poses", value: 0.0, expected: "1 or more" });
    }
    let model = Arc::new(builtin::upper_body());
    let first = upper_body::motion(&model, 0);
    let pose = |index: usize| {
        perturb(&model, &first, options.angle_rad, 0.0, options.seed.wrapping_add(index as u64))
    };
    let truths: Vec<Pose> = (0..options.poses).map(pose).collect();
    let (mut done, total) = (0, options.looks.len() * options.cameras.len() * options.poses);
    let mut looks = Vec::new();
    for look in &options.looks {
        let mut biases = Vec::new();
        for &count in &options.cameras {
            let cameras = upper_body::cameras(count, options.size_px)?;
            let mut errors_mm = Vec::new();
            for truth in &truths {
                on_progress(Progress { done, total });
                done += 1;
                errors_mm.push(bias_mm(&model, truth, &cameras, look, cancel)?);
            }
            biases.push(Bias::of(count, errors_mm));
        }
        looks.push(LookReport { name: look.name(), biases });
    }
    on_progress(Progress { done, total });
    Ok(Report { looks })
}

impl Bias {
    fn of(cameras: usize, errors_mm: Vec<f64>) -> Self {
        let [median_mm, mean_mm, max_mm] =
            Statistics::of(&errors_mm).map_or([0.0; 3], |all| [all.median, all.mean, all.max]);
        Self { cameras, median_mm, mean_mm, max_mm, errors_mm }
    }
}

fn bias_mm(
    model: &Arc<Model>,
    truth: &Pose,
    cameras: &[Arc<Camera>],
    look: &Look,
    cancel: &CancelToken,
) -> Result<f64, ExperimentError> {
    let views = cameras.iter().map(|camera| view(model, truth, camera, look.data));
    let views = views.collect::<Result<Vec<_>, _>>()?;
    let curve = Curve::of("", model, truth, views, truth, look.fit(), cancel)?;
    Ok(curve.final_joint_error_mm())
}

fn view(model: &Model, truth: &Pose, camera: &Arc<Camera>, data: Data) -> Result<FitView, ExperimentError> {
    let evidence = match data {
        Data::Hard | Data::Distance => Evidence::Mask(Arc::new(capsules::hard_mask(model, truth, camera)?)),
        Data::Area => Evidence::Measurement(Arc::new(area_averaged(model, truth, camera)?)),
    };
    Ok(FitView { camera: Arc::clone(camera), evidence, weight: 1.0 })
}

/// 255 times the share of background in each pixel's area.
fn area_averaged(model: &Model, truth: &Pose, camera: &Camera) -> Result<Measurement, ExperimentError> {
    let (width, height) = (camera.width(), camera.height());
    let fine = camera.resized(width as u64 * SUBPIXELS, height as u64 * SUBPIXELS)?;
    let mask = capsules::hard_mask(model, truth, &fine)?;
    let mut values = vec![0.0_f32; width * height];
    let share = 255.0 / (SUBPIXELS * SUBPIXELS) as f32;
    for (at, label) in mask.labels().iter().enumerate() {
        let (x, y) = (at % mask.width(), at / mask.width());
        if *label == Label::Background {
            values[y / SUBPIXELS as usize * width + x / SUBPIXELS as usize] += share;
        }
    }
    let weights = vec![1.0; values.len()];
    Ok(Measurement::new(width, height, values, weights)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_thesis_ramp_is_biased_on_hard_masks_and_half_is_less() {
        let options = Options { cameras: vec![1, 2], size_px: [96, 72], poses: 2, ..Options::default() };
        let report = run(&options, &CancelToken::new(), |_| {}).unwrap();
        let mean = |look: usize, cameras: usize| report.looks[look].biases[cameras].mean_mm;
        let [thesis, half] = [mean(0, 1), mean(1, 1)];
        assert!(half < 0.5 * thesis, "with two cameras thesis {thesis} mm, half {half} mm");
        assert!(thesis > 5.0, "{thesis} mm");
        assert!(mean(0, 0) > 3.0 * thesis, "with one camera {} mm, with two {thesis} mm", mean(0, 0));
        let area = mean(3, 1);
        assert!(area < 0.6 * half, "area-averaged {area} mm, half {half} mm");
    }

    #[test]
    fn area_averaging_keeps_the_area() {
        let model = builtin::upper_body();
        let camera = &upper_body::cameras(1, [48, 36]).unwrap()[0];
        let truth = upper_body::motion(&model, 0);
        let covered =
            |data: &Measurement| data.values().iter().map(|v| 1.0 - f64::from(*v) / 255.0).sum::<f64>();
        let grey = area_averaged(&model, &truth, camera).unwrap();
        let hard = Measurement::from_mask_hard(&capsules::hard_mask(&model, &truth, camera).unwrap());
        let (grey_px, hard_px) = (covered(&grey), covered(&hard));
        assert!((grey_px - hard_px).abs() < 0.05 * hard_px, "{grey_px} {hard_px}");
        assert!(grey.values().iter().any(|&v| v > 1.0 && v < 254.0));
    }
}
