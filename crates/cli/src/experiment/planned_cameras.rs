//! Whether a plan of cameras is right: its ranking of sets of cameras beside how far off tracks by those sets are.
//!
//! A clothed figure does the built-in take's movement before simulated cameras. Each set of them tracks it from a start that
//! is a little off; the plan knows nothing but the cameras and the floor under the movement.

use std::collections::BTreeMap;
use std::sync::Arc;

use anyhow::Result;
use backlit_formats::{FootageError, prior_file};
use backlit_lab::synthetic::figure::{Build, Figure};
use backlit_lab::synthetic::masks::silhouette;
use backlit_lab::synthetic::{motion, studio};
use backlit_runs::camera_plan::{CandidateRing, PlanRun, PlanSubject};
use backlit_runs::track::{FrameReader, TrackEnding, TrackMessage, TrackPlan, TrackRun};
use backlit_tracking::body::{Kinematics, Model, Pose, builtin};
use backlit_tracking::camera::Camera;
use backlit_tracking::cues::FrameCues;
use backlit_tracking::fit::{FitOptions, FitView};
use backlit_tracking::observability::plan::{
    CameraPlan, Floor, FloorArea, LOST_M, PLANNED_NOISE, PlannedSet, camera_ring,
};
use backlit_tracking::observability::{Noise, articulated_joints};
use backlit_tracking::residual::learnt_prior::LearntPrior;
use backlit_tracking::search::start;
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
/// Of the movement's poses the plan for it takes one in this many.
const POSES_EVERY: usize = 4;
/// How far off starts are.
const START: (f64, f64) = (3.0, 0.02);

/// A plan of cameras beside how far off tracks are by each set of the cameras
#[derive(Debug, Args, Serialize)]
pub(crate) struct PlannedCameras {
    /// Cameras evenly on a ring in place of the built-in take's four [2 to 12]
    #[arg(long, value_name = "N", value_parser = within(2..=12_usize))]
    ring: Option<usize>,
    /// Height of the pictures, pixels [32 to 1080]
    #[arg(long, value_name = "PIXELS", default_value_t = studio::HEIGHT, value_parser = within(32..=1080_u64))]
    height: u64,
    /// Use only every Kth frame of the movement [1 to 20]
    #[arg(long, value_name = "K", default_value_t = 1, value_parser = within(1..=20_usize))]
    every: usize,
    /// Starts of each track, by seeds from 1 on [1 to 20]
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = within(1..=20_u64))]
    seeds: u64,
}

#[derive(Debug, Serialize)]
pub(crate) struct Report {
    sets: Vec<JudgedSet>,
    /// Spearman's rank correlations with what was tracked, of pairs and of all sets: of the plan for anybody, and of that for this
    /// movement.
    pairs: [Option<f64>; 2],
    all: [Option<f64>; 2],
}

/// A set of cameras: planned, and tracked.
#[derive(Debug, Serialize)]
struct JudgedSet {
    cameras: Vec<String>,
    /// For anybody near the movement, turned all ways.
    planned_mm: f64,
    /// For the true poses of the movement.
    planned_movement_mm: f64,
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
            let found = self.track(filmed, set, seed, run)?;
            for (frame, truth, _) in &filmed.frames {
                let Some(found) = found.get(frame) else { continue };
                let [found, truth] = [found, truth].map(|pose| Kinematics::new(model, pose));
                for &joint in &joints {
                    let off = found.ends()[joint].distance(truth.ends()[joint]);
                    sums = [sums[0] + off.min(LOST_M), sums[1] + off];
                    count += 1;
                }
            }
        }
        Ok(sums.map(|sum| 1e3 * sum / f64::from(count.max(1))))
    }

    /// The poses by frame, as `backlit track` finds them without options.
    fn track(&self, filmed: &Filmed, set: &[usize], seed: u64, run: &Run) -> Result<BTreeMap<usize, Pose>> {
        let first = start::perturb(&filmed.model, &filmed.frames[0].1, START.0.to_radians(), START.1, seed);
        let prior = LearntPrior::new(prior_file::people());
        let frames = filmed.frames.iter().map(|(frame, ..)| *frame).collect();
        let rate = motion::FRAME_RATE / self.every as f64;
        let plan = TrackPlan {
            fit: Arc::new(FitOptions { prior: Some(prior), ..FitOptions::default() }),
            ..TrackPlan::new(filmed.model.clone(), rate, first, frames)
        };
        let mut track = TrackRun::new(Arc::new(Handed), plan);
        let (mut found, mut failed) = (BTreeMap::new(), None);
        for (_, _, views) in &filmed.frames {
            run.check()?;
            let views = Arc::new(set.iter().map(|&camera| views[camera].clone()).collect());
            track.step_with(&views, &run.cancel, &mut |message| match message {
                TrackMessage::Frame { estimate, .. } => drop(found.insert(estimate.frame, estimate.pose)),
                TrackMessage::Rewound(mended) => {
                    found.extend(mended.into_iter().map(|one| (one.frame, one.pose)));
                }
                TrackMessage::Done(TrackEnding::Failed { error, .. }) => failed = Some(error),
                _ => {}
            });
        }
        failed.map_or(Ok(found), |error| Err(error.into()))
    }
}

/// Frames are handed to the track; none is read.
struct Handed;

impl FrameReader for Handed {
    type Data = Vec<FitView>;

    fn read(&self, _: usize) -> Result<Vec<FitView>, FootageError> {
        Ok(Vec::new())
    }

    fn views(&self, views: &Vec<FitView>) -> Vec<FitView> {
        views.clone()
    }

    fn cues(&self, _: &Vec<FitView>) -> Result<FrameCues, FootageError> {
        Ok(FrameCues::default())
    }
}

/// What is planned for the floor under the movement, each set with its mean for the true poses.
fn planned(filmed: &Filmed) -> Result<Vec<(PlannedSet, f64)>> {
    let roots = filmed.frames.iter().map(|(_, truth, _)| truth.root);
    let middle = roots.fold(DVec3::ZERO, |sum, root| sum + root) / filmed.frames.len() as f64;
    let floor = Floor { up: DVec3::Z, height_m: 0.0 };
    let mut subject = PlanSubject::new(filmed.model.clone(), filmed.cameras.clone(), floor);
    subject.area = FloorArea::new(floor.place(middle), [SIDE_M; 2], CELLS);
    subject.candidates = CandidateRing { around: 0, ..subject.candidates };
    let area = subject.area;
    let mut run = PlanRun::new(subject)?;
    while run.step() {}
    let mut sets = run.result().sets;
    sets.retain(|set| set.cameras.len() >= FEWEST);
    let cameras = sets.iter().map(|set| set.cameras.clone()).collect();
    let (noise, fit) = (Noise::white(PLANNED_NOISE), FitOptions::default());
    let movement = CameraPlan::new(&filmed.model, (floor, &area), &filmed.cameras, cameras, noise, &fit)?;
    let poses = filmed.frames.iter().step_by(POSES_EVERY).map(|(_, truth, _)| truth.clone());
    let of_movement = movement.with_bodies(poses.collect()).at([0.0; 2]);
    Ok(sets.into_iter().zip(of_movement.iter().map(|figures| figures.mean_m)).collect())
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
        let planned = planned(&filmed)?;
        let mut sets = Vec::new();
        for (done, (set, for_movement)) in planned.iter().enumerate() {
            run.progress(done, planned.len())?;
            let [tracked_mm, tracked_whole_mm] = self.tracked(&filmed, &set.cameras, run)?;
            let name = |&camera: &usize| filmed.cameras[camera].name().to_owned();
            let cameras = set.cameras.iter().map(name).collect();
            let [planned_mm, planned_movement_mm] = [set.mean_m(), *for_movement].map(|metres| 1e3 * metres);
            sets.push(JudgedSet { cameras, planned_mm, planned_movement_mm, tracked_mm, tracked_whole_mm });
        }
        let of = |keep: &dyn Fn(&JudgedSet) -> bool| {
            let kept: Vec<&JudgedSet> = sets.iter().filter(|set| keep(set)).collect();
            let planned: [fn(&JudgedSet) -> f64; 2] = [|set| set.planned_mm, |set| set.planned_movement_mm];
            planned.map(|planned| {
                let both = kept.iter().map(|set| [planned(set), set.tracked_mm]);
                rank_correlation(&both.collect::<Vec<_>>())
            })
        };
        let (pairs, all) = (of(&|set| set.cameras.len() == FEWEST), of(&|_| true));
        Ok(Report { sets, pairs, all })
    }

    fn table(&self, report: &Report) -> String {
        let mut table = Table::new([
            "cameras",
            "planned for anybody, mm",
            "for this movement, mm",
            "tracked, mm",
            "lost joints as far as they are, mm",
        ]);
        for set in &report.sets {
            let planned = [set.planned_mm, set.planned_movement_mm];
            let [anybody, movement, tracked, whole] =
                [planned[0], planned[1], set.tracked_mm, set.tracked_whole_mm].map(|mm| number(mm, 1));
            table.row([set.cameras.join(", "), anybody, movement, tracked, whole]);
        }
        format!(
            "{}\nrank correlation with tracked: planned for anybody, pairs {}, all sets {}; for this movement, pairs {}, \
             all sets {}\n",
            table.to_text(),
            number(report.pairs[0], 2),
            number(report.all[0], 2),
            number(report.pairs[1], 2),
            number(report.all[1], 2),
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
        assert!(report.all[0].unwrap() > 0.0, "{report:?}");
        assert!(experiment.table(&report).contains("rank correlation"));
    }
}
