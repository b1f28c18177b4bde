//! What a track is worth: joint errors, overlap, times; as a table and as JSON.

use std::collections::BTreeMap;

use backlit_formats::Take;
use backlit_formats::take::Reference;
use backlit_tracking::belief::Verdict;
use backlit_tracking::metrics::{self, JointErrors, MarkerPlacement};
use backlit_tracking::silhouette::Overlap;
use backlit_tracking::statistics::{Statistics, mean};
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
    /// Names of the body's limbs.
    limbs: Vec<String>,
    /// Which of them have a rotation of their own.
    is_jointed: Vec<bool>,
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
    /// It was stopped before its last frame.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    partial: bool,
}

/// How many frames a limb is not believed in.
#[derive(Debug, Default, Clone, Copy, Serialize)]
struct Doubts {
    doubtful: usize,
    wrong: usize,
}

#[derive(Debug, Serialize)]
pub(crate) struct IouSummary {
    pub(crate) mean: Option<f64>,
    by_camera: BTreeMap<String, Option<f64>>,
    /// The share of the body's pixels that it leaves out, because the silhouettes are unknown there.
    pub(crate) left_out: Option<f64>,
}

#[derive(Debug, Serialize)]
pub(crate) struct ErrorSummary {
    #[serde(flatten)]
    pub(crate) overall: Distances,
    /// Without what the markers are defined otherwise: each joint's offset, learnt in other frames than those that are judged.
    pub(crate) placed: Option<Distances>,
    /// The tool whose placement, from a file, took them off; none where offsets were learnt in this track.
    #[serde(skip_serializing_if = "Option::is_none")]
    placement: Option<String>,
    /// How far the reference itself scatters in the mean; null where none of its distances cannot vary.
    pub(crate) reference_noise: Option<f64>,
    by_joint: BTreeMap<String, JointSummary>,
}

#[derive(Debug, Serialize)]
struct JointSummary {
    #[serde(flatten)]
    raw: Distances,
    /// Mean, placed.
    placed: Option<f64>,
}

/// Statistics of joint errors, millimetres.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct Distances {
    pub(crate) mean: f64,
    pub(crate) median: f64,
    pub(crate) p95: f64,
    pub(crate) max: f64,
}

#[derive(Debug, Serialize)]
struct TimeSummary {
    median: f64,
    p95: f64,
}

impl From<Statistics> for Distances {
    fn from(statistics: Statistics) -> Self {
        let Statistics { mean, median, p95, max, .. } = statistics;
        Self { mean, median, p95, max }
    }
}

impl TrackReport {
    /// A report of these cameras (indices in the take).
    pub(crate) fn new(take: &Take, cameras: &[usize]) -> Self {
        let names = cameras.iter().map(|&camera| take.rig().cameras()[camera].name().to_owned());
        Self {
            cameras: names.collect(),
            limbs: take.model().limbs().iter().map(|limb| limb.name.clone()).collect(),
            is_jointed: take.model().limbs().iter().map(|limb| limb.has_own_rotation).collect(),
            track: Track::default(),
            not_smoothed: None,
            times_ms: Vec::new(),
            errors: JointErrors::default(),
            placement: take.reference().and_then(Reference::placement).cloned(),
            jitter_mm: None,
            begun: None,
            background_changes: Vec::new(),
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
        let of_camera = |camera: usize| {
            mean(frames().filter_map(|frame| frame.overlap[camera]).filter_map(|overlap| overlap.iou()))
        };
        let cameras = self.cameras.iter().enumerate();
        let times = Statistics::of(&self.times_ms);
        let unsure = frames().flat_map(|frame| &frame.holds).filter(|hold| hold.is_unsure());
        TrackSummary {
            frames: frames().count(),
            lost: frames().filter(|frame| frame.is_lost()).count(),
            left_out: counts(frames().flat_map(|frame| &frame.empty_cameras)),
            unsure: counts(unsure.map(|hold| &self.limbs[hold.limb])),
            trust: self.doubts(),
            iou: IouSummary {
                mean: mean(frames().filter_map(FrameEstimate::iou)),
                by_camera: cameras.map(|(index, name)| (name.clone(), of_camera(index))).collect(),
                left_out: frames()
                    .flat_map(|frame| frame.overlap.iter().flatten().copied())
                    .reduce(Overlap::merge)
                    .and_then(|overlap| overlap.left_out()),
            },
            joint_error_mm: self.error_summary(),
            jitter_mm: self.jitter_mm,
            ms_per_frame: TimeSummary {
                median: times.map_or(0.0, |times| times.median),
                p95: times.map_or(0.0, |times| times.p95),
            },
            begun: self.begun.clone(),
            background_changes: self.background_changes.clone(),
            partial: self.is_partial,
        }
    }

    /// By limb, those that are doubtful or wrong anywhere.
    fn doubts(&self) -> BTreeMap<String, Doubts> {
        let mut doubts: BTreeMap<String, Doubts> = BTreeMap::new();
        let all = self.track.frames.values().flat_map(|frame| &frame.trust);
        for limb in all.filter(|limb| limb.verdict > Verdict::Good && self.is_jointed[limb.limb]) {
            let counts = doubts.entry(self.limbs[limb.limb].clone()).or_default();
            match limb.verdict {
                Verdict::Wrong => counts.wrong += 1,
                _ => counts.doubtful += 1,
            }
        }
        doubts
    }

    fn error_summary(&self) -> Option<ErrorSummary> {
        let placed = self.errors.placed(self.placement.as_ref());
        let all: Vec<f64> = placed.values().flatten().copied().collect();
        let joint = |(name, raw): (&str, Statistics)| {
            let placed = placed.get(name).and_then(|distances| mean(distances.iter().copied()));
            (name.to_owned(), JointSummary { raw: raw.into(), placed })
        };
        Some(ErrorSummary {
            overall: self.errors.overall()?.into(),
            placed: Statistics::of(&all).map(Into::into),
            placement: self.placement.as_ref().map(|placement| placement.tool.clone()),
            reference_noise: self.errors.reference_noise_mm(),
            by_joint: self.errors.by_joint().into_iter().map(joint).collect(),
        })
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
    for (limb, Doubts { doubtful, wrong }) in worst.iter().take(NAMED_DOUBTS) {
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
