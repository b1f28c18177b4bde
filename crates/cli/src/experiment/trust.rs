//! Tracks that are made to fail, and what the tracker tells of each limb: how many of the wrong ones are told, how many of the
//! right ones are doubted.
//!
//! The simulated movements hide limbs from two telephones. A take with keypoints is tracked from starts that are far off, by each
//! camera alone, and by few of its frames. A joint is wrong where it is more than 250 mm off, and right within 100 mm.

use std::path::PathBuf;
use std::sync::Arc;

use anyhow::{Context, Result, ensure};
use backlit_formats::{Footage, prior_file};
use backlit_lab::synthetic::masks::widened;
use backlit_lab::synthetic::occlusions::{Occlusion, PERIOD};
use backlit_lab::synthetic::{capsules, people::BREADTH};
use backlit_runs::track::RIVALS;
use backlit_tracking::belief::Verdict;
use backlit_tracking::body::{Kinematics, Model, Pose, builtin};
use backlit_tracking::fit::{FitOptions, FitView};
use backlit_tracking::metrics::ReferenceJoints;
use backlit_tracking::residual::learnt_prior::LearntPrior;
use backlit_tracking::search::start;
use backlit_tracking::track::{Motion, Tracker, WhenToSearch};
use clap::Args;
use serde::Serialize;

use super::{Experiment, Run};
use crate::output::number;
use crate::table::Table;
use crate::take_options;

/// A joint farther off than this is wrong, one nearer than that is right, millimetres.
const WRONG_MM: f64 = 250.0;
const RIGHT_MM: f64 = 100.0;
/// The second area under the curve is for errors above this, millimetres.
const NEAR_MM: f64 = 50.0;
/// Pictures of the simulated telephones.
const SIZE_PX: [u64; 2] = [180, 320];
/// How much too wide simulated masks are all round, as a share of the breadth of the shoulders.
const TOO_WIDE: f64 = 0.045;
/// Frames a second of the simulated telephones.
const RATE: usize = 30;
/// Starts that are far off, and how far.
const FAR_STARTS: u64 = 8;
const FAR_DEGREES: f64 = 30.0;
/// Only every 12th frame of the take is seen, and so on.
const SPARSE: [usize; 4] = [12, 14, 16, 20];

/// Tracks that are made to fail: how many limbs that are wrong are told, and how many that are right are doubted
#[derive(Debug, Args, Serialize)]
pub(crate) struct Trust {
    /// A take with reference keypoints, tracked from far starts, by single cameras and by few of its frames
    #[arg(long, value_name = "TAKE")]
    #[serde(skip)]
    take: Option<PathBuf>,
    /// Hypotheses that are carried from frame to frame
    #[arg(long, value_name = "N", default_value_t = RIVALS + 1, value_parser = hypotheses)]
    hypotheses: usize,
    /// Track without the prior learnt from motion; it judges all the same
    #[arg(long)]
    without_prior: bool,
    /// Seconds of every simulated movement
    #[arg(long, value_name = "S", default_value_t = 2.0 * PERIOD, value_parser = seconds)]
    seconds: f64,
}

fn hypotheses(text: &str) -> Result<usize, &'static str> {
    text.parse().ok().filter(|count| (1..=16).contains(count)).ok_or("expected 1 to 16")
}

fn seconds(text: &str) -> Result<f64, &'static str> {
    text.parse().ok().filter(|seconds| (0.1..=600.0).contains(seconds)).ok_or("expected 0.1 to 600 seconds")
}

#[derive(Debug, Serialize)]
pub(crate) struct Report {
    tracks: Vec<JudgedTrack>,
    all: Counts,
}

/// One track beside its truth or its keypoints.
#[derive(Debug, Serialize)]
struct JudgedTrack {
    name: String,
    frames: usize,
    #[serde(flatten)]
    counts: Counts,
}

/// Joints of all frames.
#[derive(Debug, Default, Clone, Serialize)]
struct Counts {
    joints: usize,
    mean_mm: f64,
    max_mm: f64,
    /// More than 250 mm off; told as doubtful or wrong; told as wrong.
    wrong: usize,
    wrong_told: usize,
    wrong_called_wrong: usize,
    /// Less than 100 mm off; told as doubtful or wrong; told as wrong.
    right: usize,
    right_told: usize,
    right_called_wrong: usize,
    /// Area under the curve of P(wrong) for errors above 250 and above 50 mm: 1 where it ranks them perfectly, 0.5 by chance.
    auc_250: Option<f64>,
    auc_50: Option<f64>,
}

/// What is told of a joint, and how far off it is.
#[derive(Debug, Clone, Copy)]
struct Told {
    error_mm: f64,
    wrong: f64,
    verdict: Verdict,
}

impl Counts {
    fn of(told: &[Told]) -> Self {
        let mut counts = Self { joints: told.len(), ..Self::default() };
        for joint in told {
            counts.mean_mm += joint.error_mm / told.len() as f64;
            counts.max_mm = counts.max_mm.max(joint.error_mm);
            let (is_told, is_wrong) = (joint.verdict > Verdict::Good, joint.verdict == Verdict::Wrong);
            if joint.error_mm > WRONG_MM {
                counts.wrong += 1;
                counts.wrong_told += usize::from(is_told);
                counts.wrong_called_wrong += usize::from(is_wrong);
            } else if joint.error_mm < RIGHT_MM {
                counts.right += 1;
                counts.right_told += usize::from(is_told);
                counts.right_called_wrong += usize::from(is_wrong);
            }
        }
        counts.auc_250 = auc(told, WRONG_MM);
        counts.auc_50 = auc(told, NEAR_MM);
        counts
    }
}

/// How often a joint above the error has the larger P(wrong) than one below, ties by half (Mann and Whitney 1947). `None`
/// where all are on one side.
fn auc(told: &[Told], above_mm: f64) -> Option<f64> {
    let mut sorted: Vec<&Told> = told.iter().collect();
    sorted.sort_by(|a, b| a.wrong.total_cmp(&b.wrong));
    let (mut below, mut above, mut sum, mut at) = (0.0, 0.0, 0.0, 0);
    while at < sorted.len() {
        let same = sorted[at..].iter().take_while(|joint| joint.wrong == sorted[at].wrong).count();
        let more = sorted[at..at + same].iter().filter(|joint| joint.error_mm > above_mm).count() as f64;
        let fewer = same as f64 - more;
        sum += more * (below + 0.5 * fewer);
        (below, above, at) = (below + fewer, above + more, at + same);
    }
    (below > 0.0 && above > 0.0).then(|| sum / (below * above))
}

/// A track to be made.
struct Case {
    name: String,
    model: Arc<Model>,
    rate: f64,
    start: Pose,
    search: WhenToSearch,
    frames: Vec<(usize, Vec<FitView>, ReferenceJoints)>,
}

impl Experiment for Trust {
    const NAME: &'static str = "trust";
    type Report = Report;

    fn run(&mut self, run: &Run) -> Result<Report> {
        let mut cases = simulated(self.seconds)?;
        if let Some(take) = &self.take {
            cases.extend(of_take(&*take_options::open(take)?)?);
        }
        let mut prior = LearntPrior::new(prior_file::people());
        if self.without_prior {
            prior.pose_weight = 0.0;
        }
        let fit = FitOptions { prior: Some(prior), ..FitOptions::default() };
        let total: usize = cases.iter().map(|case| case.frames.len()).sum();
        let (mut done, mut tracks, mut all) = (0, Vec::new(), Vec::new());
        for case in cases {
            let tracker = Tracker::new(case.model.clone(), fit.clone(), case.start.clone())?;
            let tracker = tracker.with_motion(Motion::Velocity, case.rate)?.with_search(case.search);
            let mut tracker = tracker.with_rivals(self.hypotheses - 1).with_trust();
            let mut told = Vec::new();
            for (frame, views, joints) in &case.frames {
                run.progress(done, total)?;
                done += 1;
                let estimate = tracker.track_frame(*frame, views.clone(), &run.cancel)?;
                let kinematics = Kinematics::new(&case.model, &estimate.pose);
                for (limb, at) in joints {
                    let Some(trust) = limb.and_then(|limb| estimate.trust.get(limb)) else { continue };
                    let error_mm = 1e3 * kinematics.ends()[trust.limb].distance(*at);
                    told.push(Told { error_mm, wrong: trust.wrong, verdict: trust.verdict });
                }
            }
            let (name, frames) = (case.name, case.frames.len());
            tracks.push(JudgedTrack { name, frames, counts: Counts::of(&told) });
            all.extend(told);
        }
        Ok(Report { tracks, all: Counts::of(&all) })
    }

    fn table(&self, report: &Report) -> String {
        let share = |count: usize, of: usize| match of {
            0 => "–".to_owned(),
            _ => format!("{:.1} %", 100.0 * count as f64 / of as f64),
        };
        let row = |name: &str, frames: usize, counts: &Counts| {
            let Counts {
                wrong, wrong_told, wrong_called_wrong, right, right_told, right_called_wrong, ..
            } = *counts;
            [
                name.to_owned(),
                frames.to_string(),
                number(Some(counts.mean_mm), 1),
                number(Some(counts.max_mm), 0),
                wrong.to_string(),
                share(wrong_told, wrong),
                share(wrong_called_wrong, wrong),
                share(right_told, right),
                share(right_called_wrong, right),
            ]
        };
        let mut table = Table::new([
            "track",
            "frames",
            "error, mm: mean",
            "max",
            "joints > 250 mm",
            "told",
            "called wrong",
            "of those < 100 mm told",
            "called wrong",
        ]);
        for JudgedTrack { name, frames, counts } in &report.tracks {
            table.row(row(name, *frames, counts));
        }
        let frames = report.tracks.iter().map(|track| track.frames).sum();
        table.row(row("all", frames, &report.all));
        let (far, near) = (number(report.all.auc_250, 3), number(report.all.auc_50, 3));
        format!(
            "{}\narea under the curve: {far} for errors above 250 mm, {near} above 50 mm\n",
            table.to_text()
        )
    }
}

/// The movements that hide limbs, seen by two telephones, at the full rate and every fourth frame.
fn simulated(seconds: f64) -> Result<Vec<Case>> {
    let model = Arc::new(builtin::full_body());
    let count = (seconds * RATE as f64) as usize;
    let mut cases = Vec::new();
    for which in Occlusion::ALL {
        let cameras = which.cameras(SIZE_PX)?;
        for every in [1, 4] {
            let mut frames = Vec::new();
            let mut first = None;
            for frame in (0..count).step_by(every) {
                let truth = which.pose(&model, frame as f64 / RATE as f64);
                let views = cameras.iter().map(|camera| {
                    let px_per_m = camera.intrinsics().mean_focal_px() / camera.depth(truth.root);
                    let mask = capsules::hard_mask(&model, &truth, camera)?;
                    let mask = widened(mask, TOO_WIDE * BREADTH * px_per_m)?;
                    Ok(FitView::of_mask(camera.clone(), mask))
                });
                let views = views.collect::<Result<Vec<_>>>()?;
                let kinematics = Kinematics::new(&model, &truth);
                let joints =
                    kinematics.ends().iter().enumerate().map(|(limb, &at)| (Some(limb), at)).collect();
                frames.push((frame, views, joints));
                first.get_or_insert(truth);
            }
            let start = first.context("no frame")?;
            let start = start::perturb(&model, &start, 3_f64.to_radians(), 0.02, 1);
            let name = format!("{}, {} a second", which.name(), RATE as f64 / every as f64);
            let (model, rate, search) = (model.clone(), RATE as f64, WhenToSearch::WhenPoor);
            cases.push(Case { name, model, rate, start, search, frames });
        }
    }
    Ok(cases)
}

/// A take from far starts without a search, by each camera alone, and by few of its frames.
fn of_take(footage: &Footage) -> Result<Vec<Case>> {
    let take = footage.take();
    let (model, count) = (take.model().clone(), take.frame_count());
    let reference =
        take.reference().context("--take: the take has no reference keypoints to compare with")?;
    let cameras: Vec<usize> = (0..take.rig().cameras().len()).collect();
    let frames: Vec<_> = (0..count)
        .map(|frame| Ok((frame, footage.fit_views(&cameras, frame)?, reference.joints(frame))))
        .collect::<Result<_>>()?;
    ensure!(!frames.is_empty(), "--take: the take has no frames");
    let known =
        start::from_joints(&model, &frames[0].2).context("--take: the first frame has no keypoints")?;
    let case = |name: String, every: usize, camera: Option<usize>, start: Pose, search| {
        let views = |views: &Vec<FitView>| match camera {
            Some(camera) => vec![views[camera].clone()],
            None => views.clone(),
        };
        let frames =
            frames.iter().step_by(every).map(|(frame, all, joints)| (*frame, views(all), joints.clone()));
        Case { name, model: model.clone(), rate: take.frame_rate(), start, search, frames: frames.collect() }
    };
    let poor = WhenToSearch::WhenPoor;
    let mut cases = vec![case("as it is".to_owned(), 1, None, known.clone(), poor)];
    for seed in 1..=FAR_STARTS {
        let start = start::perturb(&model, &known, FAR_DEGREES.to_radians(), 0.0, seed);
        cases.push(case(
            format!("start {FAR_DEGREES}° off, seed {seed}"),
            1,
            None,
            start,
            WhenToSearch::Never,
        ));
    }
    for &camera in &cameras {
        let name = format!("{} alone", take.rig().cameras()[camera].name());
        cases.push(case(name, 1, Some(camera), known.clone(), poor));
    }
    for every in SPARSE.into_iter().filter(|every| *every < count) {
        cases.push(case(format!("every {every}th frame"), every, None, known.clone(), poor));
    }
    Ok(cases)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_told_is_counted_by_how_far_off_it_is() {
        let told = |error_mm, wrong, verdict| Told { error_mm, wrong, verdict };
        let all = [
            told(300.0, 0.6, Verdict::Wrong),
            told(400.0, 0.1, Verdict::Doubtful),
            told(260.0, 0.01, Verdict::Good),
            told(20.0, 0.3, Verdict::Wrong),
            told(30.0, 0.01, Verdict::Good),
            told(150.0, 0.9, Verdict::Wrong),
        ];
        let counts = Counts::of(&all);
        assert_eq!((counts.wrong, counts.wrong_told, counts.wrong_called_wrong), (3, 2, 1));
        assert_eq!((counts.right, counts.right_told, counts.right_called_wrong), (2, 1, 1));
        // Of nine pairs 0.6 wins against two, 0.1 against one, 0.01 draws with one.
        assert!((counts.auc_250.unwrap() - 3.5 / 9.0).abs() < 1e-12, "{counts:?}");
        assert_eq!(auc(&all[..2], WRONG_MM), None);
    }
}
