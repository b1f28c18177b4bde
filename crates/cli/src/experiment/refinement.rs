//! Cameras whose calibration is wrong, refined by the silhouettes of a person.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use anyhow::{Context, Result};
use backlit_formats::Footage;
use backlit_lab::experiment::disturbed_cameras::{Disturbance, RigError, film};
use backlit_lab::synthetic::{exercise, two_people};
use backlit_tracking::body::{Kinematics, Model, Pose, builtin};
use backlit_tracking::body_fit::{
    BodyFit, BodyFitOptions, CameraRefinementError, CameraRefinementOptions, WELL_SEEN, refine_cameras,
};
use backlit_tracking::camera::Camera;
use backlit_tracking::fit::{FitOptions, FitView};
use backlit_tracking::metrics::ReferenceJoints;
use backlit_tracking::statistics::upper_median;
use clap::Args;
use serde::Serialize;

use super::{Experiment, Run};
use crate::numbers::within;
use crate::output::number;
use crate::refine_cameras::FreeNumbers;
use crate::take_options::{self, StartArguments};

/// Cameras whose calibration is wrong, refined by the silhouettes of a person
#[derive(Debug, Args, Serialize)]
pub(crate) struct RefinedRigs {
    /// A take whose calibration is right [default: a simulated person before four cameras]
    #[arg(long)]
    take: Option<PathBuf>,
    /// Turn of every camera, degrees [0 to 20]
    #[arg(long, value_name = "DEGREES", default_value_t = 1.0, value_parser = within(0.0..=20.0_f64))]
    turn: f64,
    /// Move of every camera, metres [0 to 1]
    #[arg(long, value_name = "METRES", default_value_t = 0.0, value_parser = within(0.0..=1.0_f64))]
    shift: f64,
    /// Error of every focal length, per cent [0 to 50]
    #[arg(long, value_name = "PERCENT", default_value_t = 0.0, value_parser = within(0.0..=50.0_f64))]
    focal: f64,
    /// By how much every clock but the first is early or late, seconds; of simulated cameras [0 to 1]
    #[arg(long, value_name = "SECONDS", default_value_t = 0.0, value_parser = within(0.0..=1.0_f64))]
    offset: f64,
    #[command(flatten)]
    free: FreeNumbers,
    /// Disturbances that are tried [1 to 100]
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = within(1..=100_u64))]
    seeds: u64,
    /// Frames that are fitted to [3 to 64]
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = within(3..=64_usize))]
    count: usize,
    /// Height of simulated pictures, pixels [60 to 2160]
    #[arg(long, value_name = "PIXELS", default_value_t = 480, value_parser = within(60..=2160_u64))]
    height: u64,
}

#[derive(Debug, Serialize)]
pub(crate) struct Report {
    cases: Vec<Case>,
}

/// One disturbance: before and after.
#[derive(Debug, Serialize)]
struct Case {
    seed: u64,
    turn_deg: [f64; 2],
    shift_mm: [f64; 2],
    focal_percent: [f64; 2],
    /// Mean error of the clocks beside their mean.
    offset_ms: [f64; 2],
    /// Distance of the body's joints from the true ones, the rigs aligned: the median, and the mean.
    joints_mm: [Option<f64>; 2],
    joints_mean_mm: [Option<f64>; 2],
    /// IoU of all silhouettes in the frames that were fitted to.
    iou: [Option<f64>; 2],
    /// Mean IoU of cameras held out.
    held_out_iou: [Option<f64>; 2],
    /// Deviations told of turn and place.
    told: [f64; 2],
    seconds: f64,
}

/// What is filmed.
enum Scene {
    Simulated { model: Arc<Model>, cameras: Vec<Arc<Camera>>, frame_rate: f64 },
    Take(Arc<Footage>),
}

impl Scene {
    fn views(&self, frame: usize, late_s: &[f64]) -> Result<Vec<FitView>> {
        Ok(match self {
            Self::Simulated { model, cameras, frame_rate } => {
                film(model, cameras, late_s, frame as f64 / frame_rate, 1)?
            }
            Self::Take(footage) => {
                let all: Vec<usize> = (0..footage.take().rig().count()).collect();
                footage.single_views(&all, frame)?
            }
        })
    }

    fn joints(&self, frame: usize) -> ReferenceJoints {
        match self {
            Self::Simulated { model, frame_rate, .. } => {
                let truth = Kinematics::new(model, &exercise::pose(model, frame as f64 / frame_rate));
                truth.ends().iter().enumerate().map(|(limb, end)| (Some(limb), *end)).collect()
            }
            Self::Take(footage) => take_options::reference_joints(footage.take(), frame),
        }
    }

    /// Distances of the joints, moved by the rig's alignment, from the true ones: median and mean.
    fn joint_errors_mm(&self, body: &BodyFit, rig: &RigError) -> [Option<f64>; 2] {
        let mut all = Vec::new();
        for (&frame, pose) in body.frames.iter().zip(&body.poses) {
            let kinematics = Kinematics::new(&body.model, pose);
            for (limb, truth) in self.joints(frame) {
                let own = limb.map_or(pose.root, |limb| kinematics.ends()[limb]);
                all.push(1e3 * rig.alignment.apply(own).distance(truth));
            }
        }
        let mean = all.iter().sum::<f64>() / all.len() as f64;
        [upper_median(&mut all), (!all.is_empty()).then_some(mean)]
    }
}

impl Experiment for RefinedRigs {
    const NAME: &'static str = "refine-cameras";
    type Report = Report;

    fn run(&mut self, run: &Run) -> Result<Report> {
        let (scene, model, start, frames, frame_rate) = self.scene()?;
        let disturbance = Disturbance {
            turn: self.turn.to_radians(),
            shift_m: self.shift,
            focal_length: 0.01 * self.focal,
            offset_s: self.offset,
        };
        let late_none = vec![0.0; scene.views(frames[0], &[0.0; 64])?.len()];
        let truth: Vec<Camera> =
            scene.views(frames[0], &late_none)?.iter().map(|view| (*view.camera).clone()).collect();
        let mut cases = Vec::new();
        for seed in 1..=self.seeds {
            run.progress(seed as usize - 1, self.seeds as usize)?;
            let disturbed = truth.iter().enumerate().map(|(index, own)| disturbance.of(own, index, seed));
            let (given, late_s): (Vec<Camera>, Vec<f64>) =
                disturbed.collect::<Result<Vec<_>, _>>()?.into_iter().unzip();
            let shared: Vec<Arc<Camera>> = given.iter().cloned().map(Arc::new).collect();
            let views = |frame: usize| -> Result<Vec<FitView>> {
                let seen = scene.views(frame, &late_s)?.into_iter().zip(&shared);
                Ok(seen.map(|(view, camera)| FitView { camera: Arc::clone(camera), ..view }).collect())
            };
            let mut options = CameraRefinementOptions::new(FitOptions::default(), frame_rate);
            options.choice = self.free.choice();
            options.fitted = self.count;
            if self.take.is_none() {
                options.fit = BodyFitOptions::default().with_proportions(WELL_SEEN);
            }
            let begun = Instant::now();
            let found = refine_cameras(&model, start.clone(), &frames, &options, &run.cancel, views, |_| {});
            let found = found.map_err(|error: anyhow::Error| {
                let is_stopped =
                    run.cancel.is_cancelled() && error.downcast_ref::<CameraRefinementError>().is_some();
                if is_stopped { crate::interrupt::Interrupted.into() } else { error }
            })?;
            let seconds = begun.elapsed().as_secs_f64();
            let refined: Vec<Camera> = found.cameras.iter().map(|camera| camera.camera.clone()).collect();
            let errors = [&given, &refined].map(|rig| RigError::between(rig, &truth));
            let [Some(before), Some(after)] = errors else {
                anyhow::bail!("the cameras stand in one place");
            };
            let clocks: Vec<f64> = found.cameras.iter().map(|camera| camera.change.late_s).collect();
            let apart: Vec<f64> = late_s.iter().zip(&clocks).map(|(late, found)| late - found).collect();
            let count = found.cameras.len() as f64;
            let held_out = [0, 1].map(|side| {
                let all: Option<Vec<f64>> =
                    found.cameras.iter().map(|camera| camera.held_out_iou[side]).collect();
                all.map(|all| all.iter().sum::<f64>() / count)
            });
            let told = found.cameras.iter().map(|camera| camera.deviation.change);
            let told = told.fold([0.0, 0.0], |[turn, shift], change| {
                [
                    turn + change.turn.length().to_degrees() / count,
                    shift + 1e3 * change.shift.length() / count,
                ]
            });
            let joints = [(&found.before, &before), (&found.body, &after)];
            let joints = joints.map(|(body, rig)| scene.joint_errors_mm(body, rig));
            cases.push(Case {
                seed,
                turn_deg: [before.turn_deg, after.turn_deg],
                shift_mm: [before.shift_mm, after.shift_mm],
                focal_percent: [before.focal_percent, after.focal_percent],
                offset_ms: [spread_ms(&late_s), spread_ms(&apart)],
                joints_mm: joints.map(|[median, _]| median),
                joints_mean_mm: joints.map(|[_, mean]| mean),
                iou: [found.before.iou[1], found.body.iou[1]],
                held_out_iou: held_out,
                told,
                seconds,
            });
        }
        Ok(Report { cases })
    }

    fn table(&self, report: &Report) -> String {
        let mut text = "| seed | turn, ° | place, mm | focal length, % | clocks, ms | joints, median, mm | mean | IoU | camera held out | told, °, mm | s |\n\
                        |---|---|---|---|---|---|---|---|---|---|---|\n"
            .to_owned();
        for case in &report.cases {
            let pair = |[before, after]: [f64; 2], digits| {
                format!("{} → {}", number(before, digits), number(after, digits))
            };
            let option = |pair: [Option<f64>; 2], digits| {
                let [before, after] =
                    pair.map(|value| value.map_or("–".to_owned(), |value| number(value, digits)));
                format!("{before} → {after}")
            };
            text += &format!(
                "| {} | {} | {} | {} | {} | {} | {} | {} | {} | {}, {} | {} |\n",
                case.seed,
                pair(case.turn_deg, 3),
                pair(case.shift_mm, 1),
                pair(case.focal_percent, 2),
                pair(case.offset_ms, 2),
                option(case.joints_mm, 1),
                option(case.joints_mean_mm, 1),
                option(case.iou, 3),
                option(case.held_out_iou, 3),
                number(case.told[0], 3),
                number(case.told[1], 1),
                number(case.seconds, 1),
            );
        }
        text
    }
}

type Filmed = (Scene, Arc<Model>, Pose, Vec<usize>, f64);

impl RefinedRigs {
    /// What is filmed, the body and pose to begin with, the frames and how many there are a second.
    fn scene(&self) -> Result<Filmed> {
        let Some(path) = &self.take else {
            let model = Arc::new(builtin::full_body());
            let size = [self.height; 2];
            let frame_rate = 30.0;
            let frames: Vec<usize> = (0..(exercise::SECONDS * frame_rate) as usize).collect();
            let (start, cameras) = (exercise::pose(&model, 0.0), two_people::cameras(size)?);
            let scene = Scene::Simulated { model: Arc::clone(&model), cameras, frame_rate };
            return Ok((scene, model, start, frames, frame_rate));
        };
        let footage = take_options::open(path)?;
        let take = footage.take();
        let frames: Vec<usize> = (0..take.frame_count()).collect();
        let start = StartArguments::none().known_pose(take, 0)?;
        let start = start.context("the take has neither a start nor reference keypoints")?;
        let (model, frame_rate) = (Arc::clone(take.model()), take.frame_rate());
        Ok((Scene::Take(footage), model, start, frames, frame_rate))
    }
}

/// Mean distance from the mean, milliseconds.
fn spread_ms(seconds: &[f64]) -> f64 {
    let mean = seconds.iter().sum::<f64>() / seconds.len() as f64;
    1e3 * seconds.iter().map(|value| (value - mean).abs()).sum::<f64>() / seconds.len() as f64
}
