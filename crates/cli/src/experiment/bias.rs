//! The bias of a ramp: where a fit goes that begins at the truth.
//!
//! Cameras see hard masks of a known pose. A ramp whose half grey does not lie on the limb's surface, or whose
//! slopes inside and outside weigh differently, has its least cost beside the truth. Every fit begins at the
//! truth and goes down to where the cost is least near it; the mean joint error there is the bias.

use std::sync::Arc;

use anyhow::Result;
use backlit_lab::synthetic::{capsules, upper_body};
use backlit_plot::{Axis, Drawn, Figure, Line};
use backlit_tracking::body::{Model, Pose, builtin};
use backlit_tracking::camera::Camera;
use backlit_tracking::fit::{DataView, Evidence, FitView};
use backlit_tracking::render::Ramp;
use backlit_tracking::search::start::perturb;
use backlit_tracking::silhouette::{Label, Measurement};
use backlit_tracking::statistics::Statistics;
use clap::Args;
use serde::Serialize;

use super::arguments::PictureSize;
use super::measures::FitCurve;
use super::{Experiment, Run, check_least};
use crate::output::number;
use crate::table::Table;

/// Sub-pixels across and down of [`Data::Area`].
const SUBPIXELS: u64 = 8;

/// Where a fit that begins at the truth ends: the bias of each ramp on hard masks, by number of cameras
#[derive(Debug, Args, Serialize)]
pub(crate) struct RampBias {
    /// Numbers of cameras, at most 4
    #[arg(long, value_name = "N,…", value_delimiter = ',', default_values_t = [1, 2, 4])]
    cameras: Vec<usize>,
    /// Size of the pictures, pixels
    #[arg(long = "size", value_name = "WIDTHxHEIGHT", default_value = "192x144")]
    size_px: PictureSize,
    /// How many true poses, each a start of its own
    #[arg(long = "starts", value_name = "N", default_value_t = 10)]
    poses: usize,
    /// Seed of the true poses
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// How far every joint of a true pose is turned from the same first pose.
    #[arg(skip = 10f64.to_radians())]
    angle_rad: f64,
    #[arg(skip = ramps())]
    #[serde(rename = "looks")]
    ramps: Vec<RampAndData>,
}

/// What is made of the hard mask.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
enum Data {
    /// Black and white.
    Hard,
    /// The share of the pixel's area that the subject covers: what a camera sees of a sharp edge.
    Area,
    /// By the distance to the border of the hard mask.
    Distance,
}

/// The prediction's ramp, and the data that it is fitted to.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
struct RampAndData {
    ramp: Ramp,
    data: Data,
}

fn ramps() -> Vec<RampAndData> {
    let width = Ramp::Width { px: 1.0 };
    let distance = Ramp::Distance { inner_px: 1.5, outer_px: 1.5 };
    [
        (Ramp::Thesis, Data::Hard),
        (Ramp::Half, Data::Hard),
        (width, Data::Hard),
        (width, Data::Area),
        (distance, Data::Distance),
    ]
    .map(|(ramp, data)| RampAndData { ramp, data })
    .into()
}

impl RampAndData {
    fn name(&self) -> String {
        match self.data {
            Data::Hard => format!("{}, hard mask", self.ramp),
            Data::Area => format!("{}, area-averaged", self.ramp),
            Data::Distance => format!("{}, distances", self.ramp),
        }
    }
}

#[derive(Debug, Serialize)]
pub(crate) struct Report {
    looks: Vec<OfRamp>,
}

#[derive(Debug, Serialize)]
struct OfRamp {
    name: String,
    biases: Vec<Bias>,
}

/// Mean joint errors over the poses, with one number of cameras.
#[derive(Debug, Serialize)]
struct Bias {
    cameras: usize,
    median_mm: f64,
    mean_mm: f64,
    max_mm: f64,
    errors_mm: Vec<f64>,
}

impl Experiment for RampBias {
    const NAME: &'static str = "bias";
    type Report = Report;

    fn run(&mut self, run: &Run) -> Result<Report> {
        check_least("poses", self.poses, 1)?;
        let model = Arc::new(builtin::upper_body());
        let first = upper_body::motion(&model, 0);
        let pose = |index| perturb(&model, &first, self.angle_rad, 0.0, self.seed.wrapping_add(index as u64));
        let truths: Vec<Pose> = (0..self.poses).map(pose).collect();
        let (mut done, total) = (0, self.ramps.len() * self.cameras.len() * self.poses);
        let mut looks = Vec::new();
        for ramp in &self.ramps {
            let mut biases = Vec::new();
            for &count in &self.cameras {
                let cameras = upper_body::cameras(count, self.size_px.0)?;
                let mut errors_mm = Vec::new();
                for truth in &truths {
                    run.progress(done, total)?;
                    done += 1;
                    errors_mm.push(ramp.bias_mm(&model, truth, &cameras, run)?);
                }
                let [median_mm, mean_mm, max_mm] =
                    Statistics::of(&errors_mm).map_or([0.0; 3], |all| [all.median, all.mean, all.max]);
                biases.push(Bias { cameras: count, median_mm, mean_mm, max_mm, errors_mm });
            }
            looks.push(OfRamp { name: ramp.name(), biases });
        }
        Ok(Report { looks })
    }

    fn table(&self, report: &Report) -> String {
        let rows = report.looks.iter().flat_map(|ramp| ramp.biases.iter().map(move |bias| (ramp, bias)));
        Table::of(
            rows,
            &[
                ("ramp, data: cameras", &|(ramp, bias)| format!("{}: {}", ramp.name, bias.cameras)),
                ("mean joint error, mm", &|(_, bias)| number(bias.mean_mm, 2)),
                ("median", &|(_, bias)| number(bias.median_mm, 2)),
                ("max", &|(_, bias)| number(bias.max_mm, 2)),
            ],
        )
    }

    fn pictures(&self, report: &Report) -> Vec<(String, Drawn)> {
        let PictureSize([width, height]) = self.size_px;
        let line = |(style, ramp): (_, &OfRamp)| {
            let points = ramp.biases.iter().map(|bias| [bias.cameras as f64, bias.mean_mm]);
            Line::of_points(&ramp.name, style, points.collect())
        };
        let figure = Figure {
            title: "Bias of a ramp: where a fit ends that began at the truth".to_owned(),
            subtitle: format!("upper body, {width} × {height} pixels, mean of {} poses", self.poses),
            x: Axis::linear("cameras"),
            y: Axis::log("mean joint error, mm"),
            lines: report.looks.iter().enumerate().map(line).collect(),
        };
        vec![("bias".to_owned(), Drawn::Figure(figure))]
    }
}

impl RampAndData {
    fn bias_mm(&self, model: &Arc<Model>, truth: &Pose, cameras: &[Arc<Camera>], run: &Run) -> Result<f64> {
        let views = cameras.iter().map(|camera| self.view(model, truth, camera));
        let views = views.collect::<Result<Vec<_>>>()?;
        let data = if self.data == Data::Distance { DataView::Distance } else { DataView::Hard };
        let fit = upper_body::least_cost_fit(self.ramp, data);
        Ok(FitCurve::of("", model, truth, views, truth, fit, run)?.final_joint_error_mm())
    }

    fn view(&self, model: &Model, truth: &Pose, camera: &Arc<Camera>) -> Result<FitView> {
        let evidence = match self.data {
            Data::Hard | Data::Distance => {
                Evidence::Mask(Arc::new(capsules::hard_mask(model, truth, camera)?))
            }
            Data::Area => Evidence::Measurement(Arc::new(area_averaged(model, truth, camera)?)),
        };
        Ok(FitView { camera: Arc::clone(camera), evidence, weight: 1.0 })
    }
}

/// 255 times the share of background in each pixel's area.
fn area_averaged(model: &Model, truth: &Pose, camera: &Camera) -> Result<Measurement> {
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
    use crate::experiment::arguments::defaults;

    #[test]
    fn the_thesis_ramp_is_biased_on_hard_masks_and_half_is_less() {
        let size_px = PictureSize([96, 72]);
        let mut small = RampBias { cameras: vec![1, 2], size_px, poses: 2, ..defaults() };
        let report = small.run(&Run::hidden()).unwrap();
        let mean = |ramp: usize, cameras: usize| report.looks[ramp].biases[cameras].mean_mm;
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
