//! What a track is worth: joint errors, overlap, times; as a table and as JSON.

use std::collections::BTreeMap;
use std::sync::Arc;

use backlit_formats::Take;
use backlit_formats::take::Reference;
use backlit_runs::track_summary::{Distances, Doubts, ErrorSummary, IouSummary, TrackMaking, why_doubtful};
use backlit_tracking::body::Model;
use backlit_tracking::metrics::{self, JointErrors, MarkerPlacement};
use backlit_tracking::statistics::Statistics;
use backlit_tracking::track::{FrameEstimate, SmoothingError, Track};
use serde::Serialize;

use crate::output::number;
use crate::person::Begun;
use crate::table::Table;
use crate::take_options::reference_joints;

/// Limbs that the first line names.
const NAMED_DOUBTS: usize = 3;

/// A track so far, and how good it is.
#[derive(Debug)]
pub(crate) struct TrackReport {
    /// Names of the cameras, in the order of the estimates' overlaps.
    pub(crate) cameras: Vec<String>,
    /// The body.
    model: Arc<Model>,
    /// The estimates so far.
    pub(crate) track: Track,
    /// Why the track could not be smoothed.
    pub(crate) not_smoothed: Option<SmoothingError>,
    /// Milliseconds of every frame, in the order in which they were tracked.
    times_ms: Vec<f64>,
    /// Distances from the reference keypoints so far.
    pub(crate) errors: JointErrors,
    /// Where the keypoints' tool puts its markers, if that is known.
    placement: Option<MarkerPlacement>,
    jitter_mm: Option<f64>,
    /// What was found before tracking began.
    pub(crate) begun: Option<Begun>,
    /// The backgrounds that were learnt again, in words.
    pub(crate) background_changes: Vec<String>,
    /// The take, the command and its choices.
    pub(crate) made: Option<TrackMaking>,
    /// It was stopped before its last frame.
    pub(crate) is_partial: bool,
}

/// The summary as JSON has it.
#[derive(Debug, Serialize)]
pub(crate) struct TrackSummary {
    frames: usize,
    pub(crate) lost: usize,
    /// In how many frames a camera was left out because it saw nobody.
    left_out: BTreeMap<String, usize>,
    /// In how many frames nothing held a limb, neither silhouettes nor cues; only where cues are used.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    unsure: BTreeMap<String, usize>,
    /// In how many frames a limb is doubtful or wrong, as far as can be told.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    trust: BTreeMap<String, Doubts>,
    /// Why the track is not to be trusted as it is, if it is not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) doubtful: Option<String>,
    pub(crate) iou: IouSummary,
    /// Millimetres; null without reference keypoints.
    pub(crate) joint_error_mm: Option<ErrorSummary>,
    /// Mean second difference of all joints from frame to frame; null for fewer than three frames.
    pub(crate) jitter_mm: Option<f64>,
    ms_per_frame: TimeSummary,
    /// What was found before tracking began: a start, sizes.
    #[serde(skip_serializing_if = "Option::is_none")]
    begun: Option<Begun>,
    /// The backgrounds that were learnt again, in words.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    background_changes: Vec<String>,
    /// The take, the command and its choices.
    #[serde(skip_serializing_if = "Option::is_none")]
    made: Option<TrackMaking>,
    /// It was stopped before its last frame.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    partial: bool,
}

#[derive(Debug, Serialize)]
struct TimeSummary {
    median: f64,
    p95: f64,
}

impl TrackReport {
    /// A report of these cameras (indices in the take).
    pub(crate) fn new(take: &Take, cameras: &[usize]) -> Self {
        let names = cameras.iter().map(|&camera| take.rig().cameras()[camera].name().to_owned());
        Self {
            cameras: names.collect(),
            model: Arc::clone(take.model()),
            track: Track::default(),
            not_smoothed: None,
            times_ms: Vec::new(),
            errors: JointErrors::default(),
            placement: take.reference().and_then(Reference::placement).cloned(),
            jitter_mm: None,
            begun: None,
            background_changes: Vec::new(),
            made: None,
            is_partial: false,
        }
    }

    /// Adds a frame. One that is not final is written on the way, and judged once it is smoothed.
    pub(crate) fn add(&mut self, take: &Take, estimate: FrameEstimate, is_final: bool, time_ms: f64) {
        self.times_ms.push(time_ms);
        if is_final { self.keep(take, estimate) } else { self.insert(estimate) }
    }

    /// Writes a frame down without beliefs, rivals and signs: they are by far the largest part of a track.
    fn insert(&mut self, mut estimate: FrameEstimate) {
        (estimate.belief, estimate.modes, estimate.signs) = (None, Vec::new(), Vec::new());
        self.track.frames.insert(estimate.frame, estimate);
    }

    /// Keeps and judges the final estimate of a frame.
    pub(crate) fn keep(&mut self, take: &Take, estimate: FrameEstimate) {
        self.errors.add(take.model(), &estimate.pose, &reference_joints(take, estimate.frame));
        self.insert(estimate);
    }

    /// Takes better estimates of frames that were kept before.
    pub(crate) fn mend(&mut self, take: &Take, mended: Vec<FrameEstimate>) {
        mended.into_iter().for_each(|estimate| self.insert(estimate));
        self.judge(take);
    }

    /// Measures all frames against a take's reference keypoints.
    pub(crate) fn judge(&mut self, take: &Take) {
        self.errors = JointErrors::default();
        self.placement = take.reference().and_then(Reference::placement).cloned();
        for estimate in self.track.frames.values() {
            self.errors.add(take.model(), &estimate.pose, &reference_joints(take, estimate.frame));
        }
    }

    /// Ends the report: frames are judged together.
    pub(crate) fn finish(&mut self, take: &Take) {
        let poses = self.track.frames.values().map(|estimate| &estimate.pose);
        self.jitter_mm = metrics::jitter_mm(take.model(), poses);
    }

    pub(crate) fn summary(&self) -> TrackSummary {
        let frames = || self.track.frames.values();
        let times = Statistics::of(&self.times_ms);
        let unsure = frames().flat_map(|frame| &frame.holds).filter(|hold| hold.is_unsure());
        let (count, lost) = (frames().count(), frames().filter(|frame| frame.is_lost()).count());
        let trust = Doubts::by_limb(&self.model, &self.track);
        TrackSummary {
            frames: count,
            lost,
            left_out: counts(frames().flat_map(|frame| &frame.empty_cameras)),
            unsure: counts(unsure.map(|hold| &self.model.limbs()[hold.limb].name)),
            doubtful: why_doubtful(count, lost, &trust),
            trust,
            iou: IouSummary::of(&self.cameras, &self.track),
            joint_error_mm: ErrorSummary::of(&self.errors, self.placement.as_ref()),
            jitter_mm: self.jitter_mm,
            ms_per_frame: TimeSummary {
                median: times.map_or(0.0, |times| times.median),
                p95: times.map_or(0.0, |times| times.p95),
            },
            begun: self.begun.clone(),
            background_changes: self.background_changes.clone(),
            made: self.made.clone(),
            partial: self.is_partial,
        }
    }

    pub(crate) fn text(&self) -> String {
        let summary = self.summary();
        let lost = if summary.lost == 0 { "none".to_owned() } else { summary.lost.to_string() };
        let frames = if summary.frames == 1 { "frame" } else { "frames" };
        let mut out =
            format!("{} {frames} tracked, {lost} lost{}\n", summary.frames, doubts_text(&summary.trust));
        for (camera, count) in &summary.left_out {
            out.push_str(&format!("{camera} was left out of {count} because it saw nobody\n"));
        }
        for (limb, count) in &summary.unsure {
            out.push_str(&format!("{limb}: nothing held it in {count}\n"));
        }
        if let Some(errors) = &summary.joint_error_mm {
            let mut table = Table::new(["joint error, mm", "mean", "median", "95 %", "max", "placed"]);
            let row = |name: &str, d: &Distances, placed: Option<f64>| {
                let [mean, median, p95, max] = [d.mean, d.median, d.p95, d.max].map(|mm| format!("{mm:.1}"));
                [name.to_owned(), mean, median, p95, max, number(placed, 1)]
            };
            for (name, joint) in &errors.by_joint {
                table.row(row(name, &joint.raw, joint.placed));
            }
            table.row(row("all joints", &errors.overall, errors.placed.map(|placed| placed.mean)));
            if let Some(placed) = &errors.placed {
                let by = errors.placement.as_ref().map_or("learnt in other frames", String::as_str);
                table.row(row(&format!("all joints, placed ({by})"), placed, None));
            }
            if let Some(noise) = errors.reference_noise {
                table.row(["noise of the reference".to_owned(), format!("{noise:.1}")]);
            }
            out.push('\n');
            out.push_str(&table.to_text());
        }
        let mut table = Table::new(["overlap", "IoU"]);
        for name in &self.cameras {
            let iou = summary.iou.by_camera.get(name).copied().flatten();
            table.row([name.clone(), number(iou, 3)]);
        }
        table.row(["all cameras".to_owned(), number(summary.iou.mean, 3)]);
        out.push('\n');
        out.push_str(&table.to_text());
        if let Some(share) = summary.iou.left_out.filter(|share| *share > 0.0) {
            let percent = 100.0 * share;
            out.push_str(&format!(
                "IoU leaves out {percent:.1} % of the body's pixels: the silhouettes are unknown there\n"
            ));
        }
        if let Some(jitter) = summary.jitter_mm {
            out.push_str(&format!("\njitter (mean second difference of the joints): {jitter:.1} mm\n"));
        }
        let TimeSummary { median, p95 } = summary.ms_per_frame;
        out.push_str(&format!("\ntime of a frame: median {median:.0} ms, 95 % within {p95:.0} ms\n"));
        out
    }
}

/// The limbs that are believed least, a few of them.
fn doubts_text(doubts: &BTreeMap<String, Doubts>) -> String {
    let mut worst: Vec<(&String, &Doubts)> = doubts.iter().collect();
    worst.sort_by_key(|(_, counts)| std::cmp::Reverse((counts.wrong, counts.doubtful)));
    let mut text = String::new();
    for (limb, Doubts { doubtful, wrong, .. }) in worst.iter().take(NAMED_DOUBTS) {
        text.push_str(&match (doubtful, wrong) {
            (0, wrong) => format!("; {limb} wrong in {wrong}"),
            (doubtful, 0) => format!("; {limb} doubtful in {doubtful}"),
            (doubtful, wrong) => format!("; {limb} doubtful in {doubtful}, wrong in {wrong}"),
        });
    }
    match worst.len().saturating_sub(NAMED_DOUBTS) {
        0 => text,
        more => format!("{text}; {more} more limbs doubtful or wrong (frames.csv)"),
    }
}

fn counts<'a>(names: impl Iterator<Item = &'a String>) -> BTreeMap<String, usize> {
    let mut counts = BTreeMap::new();
    names.for_each(|name| *counts.entry(name.clone()).or_default() += 1);
    counts
}
