//! Whether a plan of cameras is right: its ranking of sets of cameras beside how far off tracks by those sets are.
//!
//! A clothed figure does the built-in take's movement before simulated cameras. Each set of them tracks it from a start that
//! is a little off; the plan knows nothing but the cameras and the floor under the movement.

use std::sync::Arc;

use anyhow::Result;
use backlit_lab::synthetic::figure::{Build, Figure};
use backlit_lab::synthetic::masks::silhouette;
use backlit_lab::synthetic::{motion, studio};
use backlit_runs::camera_plan::{CandidateRing, PlanRun, PlanSubject};
use backlit_tracking::body::{Kinematics, Model, Pose, builtin};
use backlit_tracking::camera::Camera;
use backlit_tracking::fit::{FitOptions, FitView};
use backlit_tracking::observability::articulated_joints;
use backlit_tracking::observability::plan::{Floor, FloorArea, LOST_M, PlannedSet, camera_ring};
use backlit_tracking::search::start;
use backlit_tracking::track::Tracker;
use clap::Args;
use glam::DVec3;
use rayon::prelude::*;
use serde::Serialize;

use super::{Experiment, Run};
use crate::numbers::within;
use crate::output::number;
use crate::table::Table;

/// The floor under the movement, and places along it.
const SIDE_M: f64 = 1.0;
const CELLS: usize = 2;
/// A ring of cameras: radius and height, metres.
const RING_M: [f64; 2] = [3.4, 1.6];
/// Fewer cameras than that do not track.
const FEWEST: usize = 2;
/// How far off starts are.
const START: (f64, f64) = (3.0, 0.02);

/// A plan of cameras beside how far off tracks are by each set of the cameras
#[derive(Debug, Args, Serialize)]
pub(crate) struct PlannedCameras {
    /// Cameras evenly on a ring in place of the built-in take's four [2 to 12]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = within(2..=12_usize))]
    ring: Option<usize>,
    /// Height of the pictures, pixels [32 to 1080]
    #[arg(long, value_name = "PIXELS", default_value_t = studio::HEIGHT, allow_negative_numbers = true, value_parser = within(32..=1080_u64))]
    height: u64,
    /// Use only every Kth frame of the movement [1 to 20]
    #[arg(long, value_name = "K", default_value_t = 1, allow_negative_numbers = true, value_parser = within(1..=20_usize))]
    every: usize,
    /// Starts of each track, by seeds from 1 on [1 to 20]
    #[arg(long, value_name = "N", default_value_t = 2, allow_negative_numbers = true, value_parser = within(1..=20_u64))]
    seeds: u64,
}

#[derive(Debug, Serialize)]
pub(crate) struct Report {
    sets: Vec<JudgedSet>,
    /// Spearman's rank correlation of planned and tracked, of pairs and of all sets.
    pairs: Option<f64>,
    all: Option<f64>,
}

/// A set of cameras: planned, and tracked.
#[derive(Debug, Serialize)]
struct JudgedSet {
    cameras: Vec<String>,
    planned_mm: f64,
    /// Mean distance of joints from the true ones over all frames and starts, each at most as far as a joint that is lost.
    tracked_mm: f64,
    /// Mean distance as it is.
    tracked_whole_mm: f64,
}

/// The movement before all cameras.
struct Filmed {
    model: Arc<Model>,
    cameras: Vec<Arc<Camera>>,
    frames: Vec<(usize, Pose, Vec<FitView>)>,
}

impl PlannedCameras {
    fn film(&self, run: &Run) -> Result<Filmed> {
        let model = Arc::new(builtin::full_body());
        let size = [self.height * studio::WIDTH / studio::HEIGHT, self.height];
        let mut cameras = studio::pinholes(size)?;
        if let Some(count) = self.ring {
            let floor = Floor { up: DVec3::Z, height_m: 0.0 };
            cameras = camera_ring(&cameras[0], &floor, [0.0; 2], RING_M, count, "cam")?;
        }
        let frames: Vec<usize> = (0..motion::FRAMES).step_by(self.every).collect();
        let film = |&frame: &usize| {
            run.check()?;
            let truth = motion::pose(&model, frame as f64);
            let figure = Figure::new(&model, &truth, Build::default());
            let view = |camera: &Arc<Camera>| {
                let mask = figure.as_ref().map(|figure| silhouette(figure, camera)).transpose()?;
                Ok(mask.map(|mask| FitView::of_mask(camera.clone(), mask)))
            };
            let views = cameras.iter().filter_map(|camera| view(camera).transpose());
            Ok((frame, truth, views.collect::<Result<Vec<_>>>()?))
        };
        let frames = frames.par_iter().map(film).collect::<Result<_>>()?;
        Ok(Filmed { model, cameras, frames })
    }

    /// Mean error, each joint's at most [`LOST_M`] and as it is, millimetres.
    fn tracked(&self, filmed: &Filmed, set: &[usize], run: &Run) -> Result<[f64; 2]> {
        let model = &filmed.model;
        let joints = articulated_joints(model);
        let (mut sums, mut count) = ([0.0; 2], 0);
        for seed in 1..=self.seeds {
            let first = start::perturb(model, &filmed.frames[0].1, START.0.to_radians(), START.1, seed);
            let mut tracker = Tracker::new(model.clone(), FitOptions::default(), first)?;
            for (frame, truth, views) in &filmed.frames {
                run.check()?;
                let views = set.iter().map(|&camera| views[camera].clone()).collect();
                let found = tracker.track_frame(*frame, views, &run.cancel)?;
                let [found, truth] = [&found.pose, truth].map(|pose| Kinematics::new(model, pose));
                for &joint in &joints {
                    let off = found.ends()[joint].distance(truth.ends()[joint]);
                    sums = [sums[0] + off.min(LOST_M), sums[1] + off];
                    count += 1;
                }
            }
        }
        Ok(sums.map(|sum| 1e3 * sum / f64::from(count.max(1))))
    }
}

/// What is planned for the floor under the movement.
fn planned(filmed: &Filmed) -> Result<Vec<PlannedSet>> {
    let roots = filmed.frames.iter().map(|(_, truth, _)| truth.root);
    let middle = roots.fold(DVec3::ZERO, |sum, root| sum + root) / filmed.frames.len() as f64;
    let floor = Floor { up: DVec3::Z, height_m: 0.0 };
    let mut subject = PlanSubject::new(filmed.model.clone(), filmed.cameras.clone(), floor);
    subject.area = FloorArea::new(floor.place(middle), [SIDE_M; 2], CELLS);
    subject.candidates = CandidateRing { around: 0, ..subject.candidates };
    let mut run = PlanRun::new(subject)?;
    while run.step() {}
    Ok(run.result().sets)
}

/// Spearman's rank correlation: Pearson's of the ranks, ties at their mean. `None` of fewer than three pairs, or where all are tied.
fn rank_correlation(pairs: &[[f64; 2]]) -> Option<f64> {
    let ranks = |column: usize| {
        let rank = |pair: &[f64; 2]| {
            let [below, same] = pairs.iter().fold([0.0, 0.0], |[below, same], other| {
                let order = other[column].total_cmp(&pair[column]);
                [below + f64::from(u8::from(order.is_lt())), same + f64::from(u8::from(order.is_eq()))]
            });
            below + 0.5 * (same - 1.0)
        };
        pairs.iter().map(rank).collect::<Vec<f64>>()
    };
    let (a, b) = (ranks(0), ranks(1));
    let middle = 0.5 * (pairs.len() as f64 - 1.0);
    let product =
        |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - middle) * (b - middle)).sum::<f64>();
    let spread = (product(&a, &a) * product(&b, &b)).sqrt();
    (pairs.len() > 2 && spread > 0.0).then(|| product(&a, &b) / spread)
}

impl Experiment for PlannedCameras {
    const NAME: &'static str = "camera-plan";
    type Report = Report;

    fn run(&mut self, run: &Run) -> Result<Report> {
        let filmed = self.film(run)?;
        let planned: Vec<PlannedSet> =
            planned(&filmed)?.into_iter().filter(|set| set.cameras.len() >= FEWEST).collect();
        let mut sets = Vec::new();
        for (done, set) in planned.iter().enumerate() {
            run.progress(done, planned.len())?;
            let [tracked_mm, tracked_whole_mm] = self.tracked(&filmed, &set.cameras, run)?;
            let name = |&camera: &usize| filmed.cameras[camera].name().to_owned();
            let cameras = set.cameras.iter().map(name).collect();
            sets.push(JudgedSet { cameras, planned_mm: 1e3 * set.mean_m(), tracked_mm, tracked_whole_mm });
        }
        let of = |keep: &dyn Fn(&JudgedSet) -> bool| {
            let kept = sets.iter().filter(|set| keep(set));
            rank_correlation(&kept.map(|set| [set.planned_mm, set.tracked_mm]).collect::<Vec<_>>())
        };
        let (pairs, all) = (of(&|set| set.cameras.len() == FEWEST), of(&|_| true));
        Ok(Report { sets, pairs, all })
    }

    fn table(&self, report: &Report) -> String {
        let mut table =
            Table::new(["cameras", "planned, mm", "tracked, mm", "lost joints as far as they are, mm"]);
        for set in &report.sets {
            let [planned, tracked, whole] =
                [set.planned_mm, set.tracked_mm, set.tracked_whole_mm].map(|mm| number(mm, 1));
            table.row([set.cameras.join(", "), planned, tracked, whole]);
        }
        format!(
            "{}\nrank correlation of planned and tracked: pairs {}, all sets {}\n",
            table.to_text(),
            number(report.pairs, 2),
            number(report.all, 2),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_correlate_as_their_order_says() {
        let up = [[1.0, 10.0], [2.0, 11.0], [5.0, 400.0]];
        assert_eq!(rank_correlation(&up), Some(1.0));
        assert_eq!(rank_correlation(&up.map(|[a, b]| [a, -b])), Some(-1.0));
        assert_eq!(rank_correlation(&up[..2]), None);
        assert_eq!(rank_correlation(&[[1.0, 1.0]; 4]), None, "all are tied");
        let tied = rank_correlation(&[[1.0, 1.0], [1.0, 2.0], [2.0, 3.0]]).unwrap();
        assert!((tied - 0.75_f64.sqrt()).abs() < 1e-12, "{tied}");
    }

    #[test]
    fn a_plan_ranks_two_cameras_at_a_right_angle_before_two_that_face_each_other() {
        let mut experiment = PlannedCameras { ring: Some(4), height: 64, every: 20, seeds: 1 };
        let report = experiment.run(&Run::hidden()).unwrap();
        assert_eq!(report.sets.len(), 11);
        let planned = |cameras: [&str; 2]| {
            let is_it = |set: &&JudgedSet| set.cameras == cameras;
            report.sets.iter().find(is_it).unwrap().planned_mm
        };
        assert!(planned(["cam 1", "cam 2"]) < planned(["cam 1", "cam 3"]));
        assert!(report.all.unwrap() > 0.0, "{report:?}");
        assert!(experiment.table(&report).contains("rank correlation"));
    }
}
