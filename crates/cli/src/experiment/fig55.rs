//! Figs. 5.5 and 5.6: a body followed through a sequence, at 192 × 144 and at 48 × 36 pixels.
//!
//! Two cameras, 50 frames. The report's figures are of real data (section 5.2); ours are of a take, or of a simulated upper
//! body. As in the report, its method takes 25 iterations a frame and begins each at the last one's pose; where the
//! truth is known it is also given its own grey levels. All others see hard masks and do as their preset does.

use std::sync::Arc;

use anyhow::Result;
use backlit_lab::experiment::sequence::Sequence;
use backlit_lab::experiment::{Simulation, scene};
use backlit_plot::{Axis, Figure, FigureOrSheet, Line, Sheet};
use backlit_runs::track_summary::Distances;
use backlit_tracking::body::Pose;
use backlit_tracking::fit::FitView;
use backlit_tracking::statistics::Statistics;
use backlit_tracking::track::{LOST_BELOW_IOU, Tracker};
use clap::Args;
use serde::Serialize;

use super::arguments::Starts;
use super::measures::medians;
use super::sequence::{SequenceArguments, SequenceMethod, ViewPictures};
use super::{Experiment, Run, check_least};
use crate::numbers::within;
use crate::output::number;
use crate::table::Table;

/// The frames that the report shows, counted from 0.
const FRAMES: [usize; 5] = [0, 8, 16, 24, 32];

/// A sequence followed in pictures of this many pixels.
#[derive(Debug, Args, Serialize)]
#[command(
    about = if WIDTH == 192 {
        "A take, or the simulated upper body, followed in 192 × 144 pixels: joint error and overlap per frame"
    } else {
        "The same with 48 × 36 pixels"
    },
    mut_arg("starts", |starts| starts.default_value("20")),
    mut_arg("start_noise", |noise| noise.default_value("5deg,3cm"))
)]
pub(crate) struct Followed<const WIDTH: u64, const HEIGHT: u64> {
    #[command(flatten)]
    #[serde(flatten)]
    starts: Starts,
    #[arg(skip)]
    #[serde(rename = "ways")]
    methods: Vec<SequenceMethod>,
    /// Frames of the sequence, from its first [1 to 1000]
    #[arg(long, value_name = "N", default_value_t = 50, value_parser = within(1..=1000_usize))]
    #[serde(skip)]
    frames: usize,
    #[command(flatten)]
    #[serde(flatten)]
    arguments: SequenceArguments,
    /// What is followed, kept for its pictures.
    #[arg(skip)]
    #[serde(skip)]
    sequence: Option<Sequence>,
}

#[derive(Debug, Serialize)]
pub(crate) struct Report {
    ways: Vec<ByMethod>,
}

#[derive(Debug, Serialize)]
struct ByMethod {
    name: String,
    /// Over the starts, frame by frame.
    median_joint_error_mm: Vec<f64>,
    /// Overlap of all cameras together, over the starts, frame by frame.
    median_iou: Vec<f64>,
    /// Of all frames of all starts; `None` where no joint is known.
    joint_error_mm: Option<Distances>,
    /// Frames of all starts that count as lost.
    lost: usize,
    sequences: Vec<FromStart>,
}

/// One start, followed to the end: frame by frame.
#[derive(Debug, Default, Serialize)]
struct FromStart {
    /// Of the frames in which joints are known.
    joint_errors_mm: Vec<f64>,
    iou: Vec<f64>,
    iterations: Vec<usize>,
    lost: usize,
    #[serde(skip)]
    poses: Vec<Pose>,
}

impl<const WIDTH: u64, const HEIGHT: u64> Experiment for Followed<WIDTH, HEIGHT> {
    const NAME: &'static str = if WIDTH == 192 { "fig5.5" } else { "fig5.6" };
    type Report = Report;

    fn run(&mut self, run: &Run) -> Result<Report> {
        let sequence = self.arguments.open([WIDTH, HEIGHT], self.frames)?;
        self.methods = self.arguments.methods();
        let report = self.follow(&sequence, run)?;
        self.sequence = Some(sequence);
        Ok(report)
    }

    fn table(&self, report: &Report) -> String {
        let spread = |method: &&ByMethod, of: fn(Distances) -> f64| number(method.joint_error_mm.map(of), 1);
        let mean = |list: &[f64]| list.iter().sum::<f64>() / list.len().max(1) as f64;
        Table::of(
            &report.ways,
            &[
                ("fit", &|method| method.name.clone()),
                ("joint error, mm: mean", &|method| spread(method, |all| all.mean)),
                ("median", &|method| spread(method, |all| all.median)),
                ("95 %", &|method| spread(method, |all| all.p95)),
                ("max", &|method| spread(method, |all| all.max)),
                ("IoU", &|method| number(mean(&method.median_iou), 3)),
                ("lost frames", &|method| method.lost.to_string()),
            ],
        )
    }

    fn pictures(&self, report: &Report) -> Vec<(String, FigureOrSheet)> {
        let Some(sequence) = &self.sequence else { return Vec::new() };
        let words = format!("{}; medians of {}", self.arguments.conditions.text(), self.starts.text());
        let figure = |what: &str, y: Axis, values: fn(&ByMethod) -> &[f64]| {
            let methods = report.ways.iter().enumerate();
            FigureOrSheet::Figure(Figure {
                title: format!("A sequence followed: {what} per frame"),
                subtitle: words.clone(),
                x: Axis::linear("frame"),
                y,
                lines: methods.map(|(style, one)| Line::of_values(&one.name, style, values(one))).collect(),
            })
        };
        let mut drawn = Vec::new();
        if report.ways.iter().any(|method| method.joint_error_mm.is_some()) {
            let y = Axis::log("mean joint error, mm");
            let joints = figure("joint error", y, |method| &method.median_joint_error_mm);
            drawn.push((format!("{}-joints", Self::NAME), joints));
        }
        let overlap = figure("overlap", Axis::linear("intersection over union"), |method| &method.median_iou);
        drawn.push((format!("{}-overlap", Self::NAME), overlap));
        let presets = self.methods.iter().filter(|method| method.simulation == Simulation::Mask).take(2);
        for method in presets {
            if let Some(found) = report.ways.iter().find(|found| found.name == method.name) {
                let sheet = FigureOrSheet::Sheet(self.sheet(sequence, method, found));
                drawn.push((format!("{}-{}", Self::NAME, method.short_name()), sheet));
            }
        }
        drawn
    }
}

impl<const WIDTH: u64, const HEIGHT: u64> Followed<WIDTH, HEIGHT> {
    /// Follows the sequence by every method from every start. Methods that need a truth which is not known are left out.
    fn follow(&self, sequence: &Sequence, run: &Run) -> Result<Report> {
        check_least("starts", self.starts.starts, 1)?;
        let total = self.methods.len() * self.starts.starts;
        let mut ways = Vec::new();
        for method in &self.methods {
            let views = (0..sequence.moments.len()).map(|frame| method.views(sequence, frame));
            let views = views.collect::<Result<Option<Vec<_>>>>()?;
            let Some(views) = views else { continue };
            let mut sequences = Vec::new();
            for start in 0..self.starts.starts {
                run.progress(ways.len() * self.starts.starts + start, total)?;
                let from = self.starts.from(&sequence.model, &sequence.start, start);
                sequences.push(FromStart::of(sequence, &views, from, method, run)?);
            }
            ways.push(ByMethod::of(&method.name, sequences));
        }
        Ok(Report { ways })
    }

    /// D and Λ of both cameras in the frames that the report shows, from the first start.
    fn sheet(&self, sequence: &Sequence, method: &SequenceMethod, found: &ByMethod) -> Sheet {
        let poses = found.sequences.first().map(|first| first.poses.as_slice()).unwrap_or_default();
        let column = |frame: usize| {
            let (pose, moment) = (poses.get(frame)?, sequence.moments.get(frame)?);
            let error = moment.joint_error_mm(&sequence.model, pose);
            let error = error.map_or_else(String::new, |mm| format!(", {mm:.0} mm"));
            let pictures = ViewPictures::at_the_end(&sequence.model, pose, &moment.views, &method.fit);
            Some((format!("frame {}{error}", frame + 1), pictures))
        };
        let columns = FRAMES.into_iter().filter_map(column).collect();
        self.arguments.conditions.sheet(format!("A sequence followed: {}", method.name), columns)
    }
}

impl FromStart {
    fn of(
        sequence: &Sequence,
        views: &[Vec<FitView>],
        from: Pose,
        method: &SequenceMethod,
        run: &Run,
    ) -> Result<Self> {
        let model = &sequence.model;
        let mut tracker = Tracker::new(Arc::clone(model), method.fit.clone(), from)?
            .with_motion(method.motion, sequence.frame_rate)?;
        let mut followed = Self::default();
        for (frame, (moment, views)) in sequence.moments.iter().zip(views).enumerate() {
            let estimate = tracker.track_frame(frame, views.clone(), &run.cancel)?;
            run.check()?;
            let overlap = scene::overlap(model, &estimate.pose, &moment.views, method.fit.renderer);
            let iou = overlap.iou().unwrap_or(0.0);
            followed.joint_errors_mm.extend(moment.joint_error_mm(model, &estimate.pose));
            followed.iou.push(iou);
            followed.iterations.push(estimate.iterations);
            followed.lost += usize::from(iou < LOST_BELOW_IOU);
            followed.poses.push(estimate.pose);
        }
        Ok(followed)
    }
}

impl ByMethod {
    fn of(name: &str, sequences: Vec<FromStart>) -> Self {
        let all: Vec<f64> = sequences.iter().flat_map(|one| one.joint_errors_mm.iter().copied()).collect();
        Self {
            name: name.to_owned(),
            median_joint_error_mm: medians(sequences.iter().map(|one| one.joint_errors_mm.clone())),
            median_iou: medians(sequences.iter().map(|one| one.iou.clone())),
            joint_error_mm: Statistics::of(&all).map(Distances::from),
            lost: sequences.iter().map(|one| one.lost).sum(),
            sequences,
        }
    }
}

#[cfg(test)]
mod tests {
    use backlit_tracking::track::Motion;

    use super::*;
    use crate::experiment::arguments::defaults;
    use crate::experiment::measures::last;
    use crate::experiment::sequence::ITERATIONS;

    fn follow<const WIDTH: u64, const HEIGHT: u64>(sequence: &Sequence, starts: usize) -> Report {
        let starts = Starts::new(starts, 5.0, 0.03);
        let mut options = Followed::<WIDTH, HEIGHT> { starts, ..defaults() };
        options.methods = options.arguments.methods();
        options.follow(sequence, &Run::hidden()).unwrap()
    }

    #[test]
    fn both_presets_follow_the_movement_and_the_robust_one_is_nearer() {
        let report = follow::<192, 144>(&Sequence::simulated([192, 144], 2, 8).unwrap(), 2);
        let [own, thesis, robust] = [0, 1, 2].map(|method| &report.ways[method]);
        assert_eq!(thesis.sequences[0].iterations, [ITERATIONS; 8]);
        assert!(robust.sequences.iter().all(|one| one.iterations.iter().all(|&n| n <= ITERATIONS)));
        assert!(last(&thesis.median_joint_error_mm) < 60.0, "{:?}", thesis.median_joint_error_mm);
        assert!(last(&own.median_joint_error_mm) < 0.5 * last(&thesis.median_joint_error_mm));
        assert!(last(&robust.median_joint_error_mm) < 0.7 * last(&thesis.median_joint_error_mm));
        assert!(last(&robust.median_iou) > 0.9, "{:?}", robust.median_iou);
    }

    /// As in section 5.2, the report's frames begin at the last one's pose. Without a truth nothing is given that
    /// needs one, and no error is made up.
    #[test]
    fn what_is_not_known_is_not_told() {
        let methods = defaults::<Followed<48, 36>>().arguments.methods();
        let motion = |name: &str| methods.iter().find(|method| method.name == name).unwrap().motion;
        assert_eq!(motion("Report 2004, masks"), Motion::Still);
        assert_eq!(motion("Robust, masks"), Motion::Velocity);
        let mut sequence = Sequence::simulated([48, 36], 2, 2).unwrap();
        for moment in &mut sequence.moments {
            moment.truth = None;
            moment.joints.clear();
        }
        let report = follow::<48, 36>(&sequence, 1);
        let names: Vec<&str> = report.ways.iter().map(|method| method.name.as_str()).collect();
        assert_eq!(names, ["Report 2004, masks", "Robust, masks", "LM, half ramp, weak prior, masks"]);
        assert!(
            report
                .ways
                .iter()
                .all(|method| { method.joint_error_mm.is_none() && method.median_iou.len() == 2 })
        );
    }
}
