//! What a track is worth, in numbers, and how it was made: what the command's summary and the page to send both tell.

use std::collections::BTreeMap;
use std::path::PathBuf;

use backlit_document::fit_words;
use backlit_tracking::belief::Verdict;
use backlit_tracking::body::Model;
use backlit_tracking::fit::FitOptions;
use backlit_tracking::metrics::{JointErrors, MarkerPlacement};
use backlit_tracking::silhouette::Overlap;
use backlit_tracking::statistics::{Statistics, mean};
use backlit_tracking::track::{FrameEstimate, Motion, Track, WhenToSearch};
use serde::{Deserialize, Serialize};

use crate::track::TrackPlan;

/// Statistics of joint errors, millimetres.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Distances {
    /// Their mean.
    pub mean: f64,
    /// Half of them are smaller.
    pub median: f64,
    /// 95 of 100 are smaller.
    pub p95: f64,
    /// The largest.
    pub max: f64,
}

impl From<Statistics> for Distances {
    fn from(statistics: Statistics) -> Self {
        let Statistics { mean, median, p95, max, .. } = statistics;
        Self { mean, median, p95, max }
    }
}

/// Joint errors against a reference.
#[derive(Debug, Clone, Serialize)]
pub struct ErrorSummary {
    /// Of all joints in all frames.
    #[serde(flatten)]
    pub overall: Distances,
    /// Without what the markers are defined otherwise: each joint's offset, learnt in other frames than those that are judged.
    pub placed: Option<Distances>,
    /// The tool whose placement, from a file, took them off; none where offsets were learnt in this track.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub placement: Option<String>,
    /// How far the reference itself scatters in the mean; null where none of its distances cannot vary.
    pub reference_noise: Option<f64>,
    /// Joint by joint.
    pub by_joint: BTreeMap<String, JointSummary>,
}

/// Errors of a joint.
#[derive(Debug, Clone, Serialize)]
pub struct JointSummary {
    /// As they are.
    #[serde(flatten)]
    pub raw: Distances,
    /// Mean, placed.
    pub placed: Option<f64>,
}

impl ErrorSummary {
    /// Of these errors; `None` where no joint was compared.
    pub fn of(errors: &JointErrors, placement: Option<&MarkerPlacement>) -> Option<Self> {
        let placed = errors.placed(placement);
        let all: Vec<f64> = placed.values().flatten().copied().collect();
        let joint = |(name, raw): (&str, Statistics)| {
            let placed = placed.get(name).and_then(|distances| mean(distances.iter().copied()));
            (name.to_owned(), JointSummary { raw: raw.into(), placed })
        };
        Some(Self {
            overall: errors.overall()?.into(),
            placed: Statistics::of(&all).map(Into::into),
            placement: placement.map(|placement| placement.tool.clone()),
            reference_noise: errors.reference_noise_mm(),
            by_joint: errors.by_joint().into_iter().map(joint).collect(),
        })
    }
}

/// Overlap of body and silhouettes.
#[derive(Debug, Clone, Serialize)]
pub struct IouSummary {
    /// Of all cameras together, the mean of all frames.
    pub mean: Option<f64>,
    /// The same by camera.
    pub by_camera: BTreeMap<String, Option<f64>>,
    /// The share of the body's pixels that it leaves out, because the silhouettes are unknown there.
    pub left_out: Option<f64>,
}

impl IouSummary {
    /// Of a track whose overlaps are in the order of these cameras.
    pub fn of(cameras: &[String], track: &Track) -> Self {
        let frames = || track.frames.values();
        let of_camera = |camera: usize| {
            let overlaps = frames().filter_map(|frame| frame.overlap.get(camera).copied().flatten());
            mean(overlaps.filter_map(|overlap| overlap.iou()))
        };
        let names = cameras.iter().enumerate();
        let all = frames().flat_map(|frame| frame.overlap.iter().flatten().copied());
        Self {
            mean: mean(frames().filter_map(FrameEstimate::iou)),
            by_camera: names.map(|(index, name)| (name.clone(), of_camera(index))).collect(),
            left_out: all.reduce(Overlap::merge).and_then(|overlap| overlap.left_out()),
        }
    }
}

/// How many frames a limb is not believed in.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Doubts {
    /// Frames in which it is doubtful.
    pub doubtful: usize,
    /// Frames in which it is wrong.
    pub wrong: usize,
    /// The first frame of either.
    #[serde(skip)]
    pub first: usize,
}

impl Doubts {
    /// By limb, those that have a rotation of their own and are doubtful or wrong anywhere.
    pub fn by_limb(model: &Model, track: &Track) -> BTreeMap<String, Self> {
        let mut doubts: BTreeMap<String, Self> = BTreeMap::new();
        let limbs = model.limbs();
        for frame in track.frames.values() {
            let judged = frame.trust.iter().filter(|limb| limb.verdict > Verdict::Good);
            for limb in judged.filter(|limb| limbs[limb.limb].has_own_rotation) {
                let first = Self { first: frame.frame, ..Self::default() };
                let counts = doubts.entry(limbs[limb.limb].name.clone()).or_insert(first);
                match limb.verdict {
                    Verdict::Wrong => counts.wrong += 1,
                    _ => counts.doubtful += 1,
                }
            }
        }
        doubts
    }
}

/// A limb may be doubtful in this share of a track's frames before the track is.
const DOUBTFUL_SHARE: f64 = 0.1;

/// Why a track is not to be trusted as it is; `None` where no frame is lost and hardly a limb doubtful.
pub fn why_doubtful(frames: usize, lost: usize, limbs: &BTreeMap<String, Doubts>) -> Option<String> {
    if lost > 0 {
        return Some(format!("{lost} of {frames} frames are lost"));
    }
    let (limb, counts) = limbs.iter().max_by_key(|(_, counts)| counts.doubtful + counts.wrong)?;
    let count = counts.doubtful + counts.wrong;
    let share = count as f64 / frames.max(1) as f64;
    (share > DOUBTFUL_SHARE).then(|| format!("{limb} is doubtful in {count} of {frames} frames"))
}

/// How a track was made, as its summary says it.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TrackMaking {
    /// The take, its path in full.
    pub take: PathBuf,
    /// The command line.
    pub command: String,
    /// The choices, by name.
    pub settings: BTreeMap<String, String>,
}

impl TrackPlan {
    /// Its choices in words, by name.
    pub fn settings(&self) -> BTreeMap<String, String> {
        let motion = match (self.motion, self.smoothing) {
            (Motion::Still, _) => "still".to_owned(),
            (Motion::Velocity, _) => "velocity".to_owned(),
            (Motion::Kalman(noise), None) if noise.steers => "steered".to_owned(),
            (Motion::Kalman(_), None) => "kalman".to_owned(),
            (Motion::Kalman(_), Some(smoothing)) => {
                smoothing.lag.map_or("smoothed".to_owned(), |lag| format!("smoothed, lag {lag} frames"))
            }
        };
        let search = match self.search {
            WhenToSearch::Never => "never",
            WhenToSearch::WhenPoor => "poor",
            WhenToSearch::Always => "always",
        };
        // Who is named is the preset, whatever prior goes with it.
        let plain = FitOptions { prior: None, ..(*self.fit).clone() };
        let prior = if self.fit.prior.is_some() { "likely poses" } else { "none" };
        let cues: Vec<&str> = self.cues.iter().map(|cue| cue.name()).collect();
        let cues = if cues.is_empty() { "none".to_owned() } else { cues.join(", ") };
        [
            ("preset", fit_words::fit_name(&plain)),
            ("fit", fit_words::fit_detail(&plain)),
            ("renderer", self.fit.renderer.to_string()),
            ("prior", prior.to_owned()),
            ("motion", motion),
            ("search", search.to_owned()),
            ("hypotheses", (self.rivals + 1).to_string()),
            ("cues", cues),
        ]
        .map(|(name, value)| (name.to_owned(), value))
        .into()
    }
}
