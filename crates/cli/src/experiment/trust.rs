//! Tracks that are made to fail, and some that are clear, and what the tracker tells of each limb: how many of the wrong ones are told, how many of the
//! right ones are doubted, and how large errors are beside those that are told.
//!
//! Simulated movements hide limbs from two telephones, two or three cameras see exercises, and bodies amid cameras are clear. A take with keypoints is tracked
//! from starts that are far off, by few of its cameras, and by few of its frames. A joint is wrong where it is more than 250 mm
//! off, and right within 100 mm. Half of the tracks are held out: nothing is learnt from them, and what is told is judged on them.

mod cases;
mod counts;

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use anyhow::{Context, Result};
use backlit_formats::prior_file;
use backlit_lab::synthetic::occlusions::PERIOD;
use backlit_runs::track::{RIVALS, TrackEnding, TrackMessage, TrackPlan, TrackRun};
use backlit_tracking::belief::{ErrorNetwork, KnownError, LimbTrust, Reason, Signs, learn};
use backlit_tracking::body::Kinematics;
use backlit_tracking::fit::FitOptions;
use backlit_tracking::residual::learnt_prior::LearntPrior;
use backlit_tracking::track::FrameEstimate;
use clap::Args;
use rayon::prelude::*;
use serde::Serialize;

use self::cases::{Case, CaseReader};
use self::counts::{Counts, JudgedJoint, RANGES};
use super::{Experiment, Run};
use crate::numbers::within;
use crate::output::number;
use crate::table::Table;
use crate::take_options;

/// Seed of what is learnt.
const SEED: u64 = 29;

/// Tracks that are made to fail: how many limbs that are wrong are told, and how many that are right are doubted
#[derive(Debug, Args, Serialize)]
pub(crate) struct Trust {
    /// A take with reference keypoints, tracked from far starts, by few cameras and by few of its frames
    #[arg(long, value_name = "TAKE")]
    #[serde(skip)]
    take: Option<PathBuf>,
    /// Hypotheses that are carried from frame to frame [1 to 16]
    #[arg(long, value_name = "N", default_value_t = RIVALS + 1, value_parser = within(1..=16_usize))]
    hypotheses: usize,
    /// Track without the prior learnt from motion; it judges all the same
    #[arg(long)]
    without_prior: bool,
    /// Seconds of every simulated movement [0.1 to 20]
    #[arg(long, value_name = "S", default_value_t = 2.0 * PERIOD, value_parser = within(0.1..=20.0_f64))]
    seconds: f64,
    /// Learn what is told from the half that is not held out, and write it to this file of source
    #[arg(long, value_name = "FILE")]
    #[serde(skip)]
    learn: Option<PathBuf>,
}

#[derive(Debug, Serialize)]
pub(crate) struct Report {
    tracks: Vec<JudgedTrack>,
    /// Of the tracks that are held out.
    held_out: Counts,
    held_out_simulated: Counts,
    held_out_real: Counts,
}

/// One track beside its truth or its keypoints.
#[derive(Debug, Serialize)]
struct JudgedTrack {
    name: String,
    frames: usize,
    is_held_out: bool,
    #[serde(flatten)]
    counts: Counts,
}

/// The joints of a case that was tracked: by what signs, and how far off, metres.
struct Tracked {
    case: Case,
    joints: Vec<(Signs, f64)>,
}

impl Trust {
    fn track(&self, case: Case, run: &Run, done: &AtomicUsize) -> Result<Tracked> {
        let mut prior = LearntPrior::new(prior_file::people());
        if self.without_prior {
            prior.pose_weight = 0.0;
        }
        let frames = case.frames.iter().map(|one| one.frame).collect();
        let plan = TrackPlan {
            fit: Arc::new(FitOptions { prior: Some(prior), ..FitOptions::default() }),
            search: case.search,
            rivals: if case.has_rivals { self.hypotheses - 1 } else { 0 },
            ..TrackPlan::new(case.model.clone(), case.rate, case.start.clone(), frames)
        };
        let mut track = TrackRun::new(Arc::new(CaseReader(case.frames.clone())), plan);
        let (mut estimates, mut failed) = (BTreeMap::new(), None);
        for frame in &case.frames {
            track.step_with(&Arc::new(frame.views.clone()), &run.cancel, &mut |message| match message {
                TrackMessage::Frame { estimate, .. } => drop(estimates.insert(estimate.frame, *estimate)),
                TrackMessage::Rewound(mended) => {
                    estimates.extend(mended.into_iter().map(|one| (one.frame, one)));
                }
                TrackMessage::Done(TrackEnding::Failed { error, .. }) => failed = Some(error),
                _ => {}
            });
            done.fetch_add(1, Ordering::Relaxed);
            if run.cancel.is_cancelled() {
                break;
            }
        }
        if let Some(error) = failed {
            return Err(error).context(case.name);
        }
        let joints =
            case.frames.iter().filter_map(|frame| Some((estimates.get(&frame.frame)?, &frame.joints)));
        let joints = joints.flat_map(|(estimate, truth)| {
            let kinematics = Kinematics::new(&case.model, &estimate.pose);
            truth.iter().filter_map(move |(limb, at)| {
                Some((signs(estimate, (*limb)?)?, kinematics.ends()[(*limb)?].distance(*at)))
            })
        });
        Ok(Tracked { joints: joints.collect(), case })
    }
}

fn signs(estimate: &FrameEstimate, limb: usize) -> Option<Signs> {
    estimate.signs.get(limb).copied()
}

/// What a network tells of joints.
fn judged(network: &ErrorNetwork, joints: &[(Signs, f64)]) -> Vec<JudgedJoint> {
    let of_joint = |(signs, error_m): &(Signs, f64)| {
        let error = network.distribution(signs);
        let verdict = LimbTrust::of_error(0, &error, Reason::Loose).verdict;
        JudgedJoint { error_mm: 1e3 * error_m, error, verdict }
    };
    joints.iter().map(of_joint).collect()
}

impl Experiment for Trust {
    const NAME: &'static str = "trust";
    type Report = Report;

    fn run(&mut self, run: &Run) -> Result<Report> {
        let mut cases = cases::simulated(self.seconds, run)?;
        if let Some(take) = &self.take {
            cases.extend(cases::of_take(&*take_options::open(take)?)?);
        }
        let total: usize = cases.iter().map(|case| case.frames.len()).sum();
        let done = AtomicUsize::new(0);
        let tracked = |case| {
            run.progress(done.load(Ordering::Relaxed), total)?;
            self.track(case, run, &done)
        };
        let tracked: Vec<Tracked> = cases.into_par_iter().map(tracked).collect::<Result<_>>()?;
        run.progress(total, total)?;
        let learnt = match &self.learn {
            Some(path) => {
                let known = tracked.iter().filter(|one| !one.case.is_held_out);
                let known = known.flat_map(|one| {
                    let weight = one.case.weight();
                    let of_joint =
                        move |&(signs, error_m): &(Signs, f64)| KnownError { signs, error_m, weight };
                    one.joints.iter().map(of_joint)
                });
                let known: Vec<_> = known.collect();
                let network = learn(&known, SEED);
                std::fs::write(path, source(&network)).with_context(|| path.display().to_string())?;
                network
            }
            None => ErrorNetwork::learnt().clone(),
        };
        let held_out = |is_wanted: &dyn Fn(&Case) -> bool| {
            let joints = tracked.iter().filter(|one| one.case.is_held_out && is_wanted(&one.case));
            let joints: Vec<_> = joints.flat_map(|one| one.joints.iter().copied()).collect();
            Counts::of(&judged(&learnt, &joints))
        };
        Ok(Report {
            held_out: held_out(&|_| true),
            held_out_simulated: held_out(&|case| !case.is_real),
            held_out_real: held_out(&|case| case.is_real),
            tracks: tracked
                .iter()
                .map(|Tracked { case, joints }| JudgedTrack {
                    name: case.name.clone(),
                    frames: case.frames.len(),
                    is_held_out: case.is_held_out,
                    counts: Counts::of(&judged(&learnt, joints)),
                })
                .collect(),
        })
    }

    fn table(&self, report: &Report) -> String {
        let mut table = Table::new([
            "track",
            "held out",
            "frames",
            "error, mm: mean",
            "max",
            "joints > 250 mm",
            "told",
            "called wrong",
            "of those < 100 mm told",
            "called wrong",
        ]);
        for JudgedTrack { name, frames, is_held_out, counts } in &report.tracks {
            table.row(row(name, Some((*frames, *is_held_out)), counts));
        }
        table.row(row("held out", None, &report.held_out));
        table.row(row("simulated", None, &report.held_out_simulated));
        table.row(row("real", None, &report.held_out_real));
        let mut agreement = Table::new([
            "held out",
            "AUC > 250 mm",
            "> 50 mm",
            "rank correlation",
            "within 50 %",
            "68 %",
            "90 %",
            "95 %",
        ]);
        let mut reliability = Table::new(["P(> 250 mm) told", "joints", "mean told", "are"]);
        for (name, counts) in [
            ("all", &report.held_out),
            ("simulated", &report.held_out_simulated),
            ("real", &report.held_out_real),
        ] {
            let measures = [counts.auc_250, counts.auc_50, counts.rank_correlation];
            let [far, near, ranks] = measures.map(|measure| number(measure, 3));
            let [half, deviation, most, nearly_all] = counts.within.map(|share| percent(Some(share)));
            agreement.row([name.to_owned(), far, near, ranks, half, deviation, most, nearly_all]);
        }
        for (to, (joints, told, are)) in RANGES.iter().zip(&report.held_out.reliability) {
            let cells =
                [format!("up to {to}"), joints.to_string(), percent(Some(*told)), percent(Some(*are))];
            reliability.row(cells);
        }
        format!("{}\n{}\n{}", table.to_text(), agreement.to_text(), reliability.to_text())
    }
}

fn percent(share: Option<f64>) -> String {
    share.map_or_else(|| "–".to_owned(), |share| format!("{:.1} %", 100.0 * share))
}

fn row(name: &str, track: Option<(usize, bool)>, counts: &Counts) -> [String; 10] {
    let share = |count: usize, of: usize| percent((of > 0).then(|| count as f64 / of as f64));
    [
        name.to_owned(),
        track.map_or(String::new(), |(_, is_held_out)| if is_held_out { "yes" } else { "" }.to_owned()),
        track.map_or(String::new(), |(frames, _)| frames.to_string()),
        number(Some(counts.mean_mm), 1),
        number(Some(counts.max_mm), 0),
        counts.wrong.to_string(),
        share(counts.wrong_told, counts.wrong),
        share(counts.wrong_called_wrong, counts.wrong),
        share(counts.right_told, counts.right),
        share(counts.right_called_wrong, counts.right),
    ]
}

/// What was learnt, as source.
fn source(network: &ErrorNetwork) -> String {
    let mut out = "//! What [`ErrorNetwork`] learnt, written by `backlit experiment trust --take TAKE --learn FILE`.\n\n\
                   #![allow(clippy::approx_constant, reason = \"learnt numbers come near to such constants by chance\")]\n\n\
                   use super::error_distribution::ErrorNetwork;\n\n\
                   pub(super) static LEARNT: ErrorNetwork = ErrorNetwork {\n"
        .to_owned();
    let list = |numbers: &[f64]| {
        let numbers: Vec<String> = numbers.iter().map(|number| format!("{number:.4}")).collect();
        format!("[{}]", numbers.join(", "))
    };
    let ErrorNetwork { means, scales, usual, members } = network;
    for (name, numbers) in [("means", means), ("scales", scales), ("usual", usual)] {
        out += &format!("{name}: {},\n", list(numbers));
    }
    let members: Vec<String> = members.iter().map(|weights| list(weights)).collect();
    out += &format!("members: [{}],\n", members.join(", "));
    out + "};\n"
}

#[cfg(test)]
mod tests {
    use backlit_tracking::belief::{ErrorDistribution, Verdict};

    use super::counts::WRONG_MM;
    use super::*;

    #[test]
    fn what_is_told_is_counted_by_how_far_off_it_is() {
        let told = |error_mm, wrong: f64, verdict| {
            let error = ErrorDistribution::of_shares([0.0, 0.0, 1.0 - wrong, 0.0, 0.0, wrong, 0.0]);
            JudgedJoint { error_mm, error, verdict }
        };
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
        assert_eq!(Counts::of(&all[..2]).auc_250, None);
        assert_eq!(counts.reliability.iter().map(|range| range.0).sum::<usize>(), all.len());
        assert!(all.iter().all(|one| one.error.beyond(1e-3 * WRONG_MM) <= 1.0));
    }
}
