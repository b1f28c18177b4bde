//! What a track is worth: joint errors, overlap, times; as a table and as JSON.

use std::collections::BTreeMap;

use backlit_formats::Take;
use backlit_formats::export::resume_file::{Resume, WaitingFrames};
use backlit_tracking::fit::FitView;
use backlit_tracking::metrics::{self, JointErrors};
use backlit_tracking::render::RendererKind;
use backlit_tracking::statistics::{Statistics, mean};
use backlit_tracking::track::{FrameEstimate, KalmanOptions, Smoother, SmoothingError, Track, TrackerMemory};
use serde::Serialize;

use super::own_body::Begun;
use super::table::Table;
use super::take_options::reference_joints;

/// A track so far, and how good it is.
#[derive(Debug)]
pub(crate) struct TrackReport {
    cameras: Vec<String>,
    /// Names of the body's limbs.
    limbs: Vec<String>,
    track: Track,
    /// Smooths frames by later ones, where that is asked for: by so many, or by all.
    smoother: Option<Smoother>,
    lag: Option<usize>,
    /// The frames that waited when the rest was smoothed too.
    waiting: Option<WaitingFrames>,
    /// What the tracker knew after the newest frame.
    pub(crate) memory: Option<TrackerMemory>,
    /// Whether what the filter believed of a frame is needed after it.
    keeps_beliefs: bool,
    /// Milliseconds of every frame, in the order in which they were tracked.
    times_ms: Vec<f64>,
    errors: JointErrors,
    last_iou: Option<f64>,
    jitter_mm: Option<f64>,
    /// What was found before tracking began.
    pub(crate) begun: Option<Begun>,
    /// It was stopped before its last frame.
    pub(crate) is_partial: bool,
}

/// The summary as JSON has it.
#[derive(Debug, Serialize)]
pub(crate) struct TrackSummary {
    frames: usize,
    lost: usize,
    /// In how many frames a camera was left out because it saw nobody.
    left_out: BTreeMap<String, usize>,
    /// In how many frames nothing held a limb, neither silhouettes nor cues; only where cues are used.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    unsure: BTreeMap<String, usize>,
    iou: IouSummary,
    /// Millimetres; null without reference keypoints.
    joint_error_mm: Option<ErrorSummary>,
    /// Mean second difference of all joints from frame to frame; null for fewer than three frames.
    jitter_mm: Option<f64>,
    ms_per_frame: TimeSummary,
    /// What was found before tracking began: a start, sizes.
    #[serde(skip_serializing_if = "Option::is_none")]
    begun: Option<Begun>,
    /// It was stopped before its last frame.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    partial: bool,
}

#[derive(Debug, Serialize)]
struct IouSummary {
    mean: Option<f64>,
    by_camera: BTreeMap<String, Option<f64>>,
}

#[derive(Debug, Serialize)]
struct ErrorSummary {
    #[serde(flatten)]
    overall: Distances,
    /// After each joint's constant offset in its limb's frame was taken off.
    without_offsets: Option<Distances>,
    by_joint: BTreeMap<String, Distances>,
}

#[derive(Debug, Serialize)]
struct Distances {
    mean: f64,
    median: f64,
    p95: f64,
    max: f64,
}

#[derive(Debug, Serialize)]
struct TimeSummary {
    median: f64,
    p95: f64,
}

impl TrackSummary {
    /// Mean and largest joint error, and the mean without constant offsets; none without reference keypoints.
    pub(crate) fn errors_mm(&self) -> [Option<f64>; 3] {
        let errors = self.joint_error_mm.as_ref();
        let without = errors.and_then(|errors| errors.without_offsets.as_ref());
        [errors.map(|e| e.overall.mean), errors.map(|e| e.overall.max), without.map(|d| d.mean)]
    }

    /// Mean overlap of all cameras.
    pub(crate) fn iou(&self) -> Option<f64> {
        self.iou.mean
    }

    /// Frames in which the subject was lost.
    pub(crate) fn lost(&self) -> usize {
        self.lost
    }

    /// Mean second difference of the joints.
    pub(crate) fn jitter_mm(&self) -> Option<f64> {
        self.jitter_mm
    }
}

impl From<Statistics> for Distances {
    fn from(statistics: Statistics) -> Self {
        let Statistics { mean, median, p95, max, .. } = statistics;
        Self { mean, median, p95, max }
    }
}

/// How later frames smooth earlier ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Smoothing {
    /// So many frames after each; all where `None`.
    pub(crate) lag: Option<usize>,
}

impl TrackReport {
    /// A report of these cameras (indices in the take), its frames smoothed by later ones if that is asked for.
    pub(crate) fn new(take: &Take, cameras: &[usize], smoothing: Option<Smoothing>) -> Self {
        let names = cameras.iter().map(|&camera| take.rig().cameras()[camera].name().to_owned());
        Self {
            cameras: names.collect(),
            limbs: take.model().limbs().iter().map(|limb| limb.name.clone()).collect(),
            track: Track::default(),
            smoother: smoothing.map(|smoothing| Smoother::new(smoothing.lag)),
            lag: smoothing.and_then(|smoothing| smoothing.lag),
            waiting: None,
            memory: None,
            keeps_beliefs: false,
            times_ms: Vec::new(),
            errors: JointErrors::default(),
            last_iou: None,
            jitter_mm: None,
            begun: None,
            is_partial: false,
        }
    }

    /// The same with all beliefs kept: they are by far the largest part of a track.
    pub(crate) fn with_beliefs(mut self) -> Self {
        self.keeps_beliefs = true;
        self
    }

    /// Adds a frame that took so many milliseconds.
    ///
    /// # Errors
    /// A frame that cannot be smoothed.
    pub(crate) fn add(
        &mut self,
        take: &Take,
        estimate: FrameEstimate,
        time_ms: f64,
    ) -> Result<(), SmoothingError> {
        self.times_ms.push(time_ms);
        self.last_iou = estimate.iou();
        let known = match &mut self.smoother {
            Some(smoother) => {
                // What is written on the way has the newest frames too, unsmoothed.
                let newest = FrameEstimate { belief: None, ..estimate.clone() };
                self.track.frames.insert(newest.frame, newest);
                smoother.push(estimate)?
            }
            None => vec![estimate],
        };
        known.into_iter().for_each(|estimate| self.keep(take, estimate));
        Ok(())
    }

    /// Takes over the frames of an earlier run, of which some wait to be smoothed by a filter of that noise.
    pub(crate) fn resume(
        &mut self,
        take: &Take,
        mut track: Track,
        waiting: Option<(WaitingFrames, KalmanOptions)>,
    ) {
        if let Some((WaitingFrames { frames: waiting, .. }, noise)) = waiting
            && let Some(smoother) = self.smoother.take()
        {
            let known = waiting.iter().map(|waiting| {
                let known = track.frames.remove(&waiting.frame);
                known.unwrap_or_else(|| FrameEstimate::of_pose(waiting.frame, waiting.pose.clone()))
            });
            let known: Vec<FrameEstimate> = known.collect();
            for (known, waiting) in known.iter().zip(&waiting) {
                let newest = FrameEstimate { pose: waiting.pose.clone(), ..known.clone() };
                self.track.frames.insert(newest.frame, newest);
            }
            self.smoother = Some(smoother.with_waiting(known, waiting, noise, take.frame_rate()));
        }
        track.frames.into_values().for_each(|estimate| self.keep(take, estimate));
    }

    /// What is needed to go on after the newest frame, if there is one.
    pub(crate) fn resume_point(&self) -> Option<Resume> {
        let smoothing = self.waiting.clone().or_else(|| {
            let frames = self.smoother.as_ref()?.waiting();
            Some(WaitingFrames { lag: self.lag, frames })
        });
        Some(Resume { memory: self.memory.clone()?, smoothing })
    }

    fn keep(&mut self, take: &Take, mut estimate: FrameEstimate) {
        self.errors.add(take.model(), &estimate.pose, &reference_joints(take, estimate.frame));
        if !self.keeps_beliefs {
            estimate.belief = None;
        }
        self.track.frames.insert(estimate.frame, estimate);
    }

    /// Smooths the newest frames too, by as many later ones as there are. Costs stay those of the poses before, overlaps
    /// until they are measured again.
    ///
    /// # Errors
    /// A track that cannot be smoothed.
    pub(crate) fn smooth(&mut self, take: &Take) -> Result<(), SmoothingError> {
        if let Some(mut smoother) = self.smoother.take() {
            self.waiting = Some(WaitingFrames { lag: self.lag, frames: smoother.waiting() });
            smoother.finish()?.into_iter().for_each(|estimate| self.keep(take, estimate));
        }
        Ok(())
    }

    /// Measures all frames against a take's reference keypoints.
    pub(crate) fn judge(&mut self, take: &Take) {
        self.errors = JointErrors::default();
        for estimate in self.track.frames.values() {
            self.errors.add(take.model(), &estimate.pose, &reference_joints(take, estimate.frame));
        }
    }

    /// Measures a frame's overlap again.
    pub(crate) fn measure_overlap(
        &mut self,
        take: &Take,
        frame: usize,
        views: &[FitView],
        renderer: RendererKind,
    ) {
        if let Some(estimate) = self.track.frames.get_mut(&frame) {
            estimate.measure_overlap(take.model(), renderer, views);
        }
    }

    /// Ends the report: frames are judged together.
    pub(crate) fn finish(&mut self, take: &Take) {
        let poses = self.track.frames.values().map(|estimate| &estimate.pose);
        self.jitter_mm = metrics::jitter_mm(take.model(), poses);
    }

    /// The frames so far.
    pub(crate) fn frames(&self) -> Vec<usize> {
        self.track.frames.keys().copied().collect()
    }

    /// The estimates so far.
    pub(crate) fn track(&self) -> &Track {
        &self.track
    }

    /// Distances from the reference keypoints so far.
    pub(crate) fn errors(&self) -> &JointErrors {
        &self.errors
    }

    /// Names of the cameras, in the order of the estimates' overlaps.
    pub(crate) fn cameras(&self) -> &[String] {
        &self.cameras
    }

    /// A few words while it goes on.
    pub(crate) fn progress_text(&self) -> String {
        self.last_iou.map(|iou| format!("IoU {iou:.3}")).unwrap_or_default()
    }

    /// Frames in which nothing held a limb, by limb.
    fn unsure(&self) -> BTreeMap<String, usize> {
        let mut counts = BTreeMap::new();
        let holds = self.track.frames.values().flat_map(|frame| &frame.holds);
        for hold in holds.filter(|hold| hold.is_unsure()) {
            *counts.entry(self.limbs[hold.limb].clone()).or_default() += 1;
        }
        counts
    }

    /// Everything in numbers.
    pub(crate) fn summary(&self) -> TrackSummary {
        let frames = || self.track.frames.values();
        let of_camera = |camera: usize| {
            mean(frames().filter_map(|frame| frame.overlap[camera]).filter_map(|overlap| overlap.iou()))
        };
        let cameras = self.cameras.iter().enumerate();
        let times = Statistics::of(&self.times_ms);
        let by_joint = self.errors.by_joint();
        TrackSummary {
            frames: frames().count(),
            lost: frames().filter(|frame| frame.is_lost()).count(),
            left_out: frames().flat_map(|frame| &frame.empty_cameras).fold(
                BTreeMap::new(),
                |mut counts, name| {
                    *counts.entry(name.clone()).or_default() += 1;
                    counts
                },
            ),
            unsure: self.unsure(),
            iou: IouSummary {
                mean: mean(frames().filter_map(FrameEstimate::iou)),
                by_camera: cameras.map(|(index, name)| (name.clone(), of_camera(index))).collect(),
            },
            joint_error_mm: self.errors.overall().map(|overall| ErrorSummary {
                overall: overall.into(),
                without_offsets: self.errors.overall_without_offsets().map(Into::into),
                by_joint: by_joint
                    .into_iter()
                    .map(|(name, errors)| (name.to_owned(), errors.into()))
                    .collect(),
            }),
            jitter_mm: self.jitter_mm,
            ms_per_frame: TimeSummary {
                median: times.map_or(0.0, |times| times.median),
                p95: times.map_or(0.0, |times| times.p95),
            },
            begun: self.begun.clone(),
            partial: self.is_partial,
        }
    }

    /// Everything as tables for people.
    pub(crate) fn text(&self) -> String {
        let summary = self.summary();
        let lost = if summary.lost == 0 { "none".to_owned() } else { summary.lost.to_string() };
        let frames = if summary.frames == 1 { "frame" } else { "frames" };
        let mut out = format!("{} {frames} tracked, {lost} lost\n", summary.frames);
        for (camera, count) in &summary.left_out {
            out.push_str(&format!("{camera} was left out of {count} because it saw nobody\n"));
        }
        for (limb, count) in &summary.unsure {
            out.push_str(&format!("{limb}: nothing held it in {count}\n"));
        }
        if let Some(errors) = &summary.joint_error_mm {
            let mut table = Table::new(["joint error, mm", "mean", "median", "95 %", "max"]);
            let row = |name: &str, d: &Distances| {
                let [mean, median, p95, max] = [d.mean, d.median, d.p95, d.max].map(|mm| format!("{mm:.1}"));
                [name.to_owned(), mean, median, p95, max]
            };
            for (name, distances) in &errors.by_joint {
                table.row(row(name, distances));
            }
            table.row(row("all joints", &errors.overall));
            if let Some(distances) = &errors.without_offsets {
                table.row(row("without each joint's offset", distances));
            }
            out.push('\n');
            out.push_str(&table.to_text());
        }
        let mut table = Table::new(["overlap", "IoU"]);
        let number = |iou: Option<f64>| iou.map_or_else(|| "–".to_owned(), |iou| format!("{iou:.3}"));
        for name in &self.cameras {
            let iou = summary.iou.by_camera.get(name).copied().flatten();
            table.row([name.clone(), number(iou)]);
        }
        table.row(["all cameras".to_owned(), number(summary.iou.mean)]);
        out.push('\n');
        out.push_str(&table.to_text());
        if let Some(jitter) = summary.jitter_mm {
            out.push_str(&format!("\njitter (mean second difference of the joints): {jitter:.1} mm\n"));
        }
        let TimeSummary { median, p95 } = summary.ms_per_frame;
        out.push_str(&format!("\ntime of a frame: median {median:.0} ms, 95 % within {p95:.0} ms\n"));
        out
    }
}
