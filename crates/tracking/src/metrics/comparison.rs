//! A track beside a reference: another tool's recording, truth, or another track.
//!
//! First the clocks are set ([`ClockOffset`]) and the reference is laid into the track's world ([`WorldMap`]). Then, for joints a of
//! the track and b of the reference in one frame, millimetres:
//!
//! - raw |a − b|; nothing is taken off, but for a world that had to be fitted;
//! - placed, without where the reference's tool puts its markers (see [`MarkerOffset`](super::MarkerOffset)), learnt in other frames;
//! - root-aligned |(a − ā) − (b − b̄)| with ā, b̄ the middle of the hips (without hips, of all joints): the pose without its place;
//! - Procrustes |a − s R b − t| with the similarity that fits this frame best: the shape alone (PA-MPJPE in the literature);
//! - PCK, the share of joints whose raw error is at most a threshold.
//!
//! Angles are compared as they are, without their mean difference, and by correlation; see [`JointAngle`].

mod clock;
mod world;

use std::collections::BTreeMap;

use glam::DVec3;

use super::JointErrors;
use super::angles::JointAngle;
use super::trajectories::Trajectories;
use crate::body::{Model, Pose};
use crate::geometry::umeyama;
use crate::statistics::{Statistics, mean};

pub use clock::ClockOffset;
pub use world::{WorldMap, WorldMatch};

/// Thresholds of the PCK, millimetres.
pub const PCK_MM: [f64; 3] = [50.0, 100.0, 150.0];
/// Frames with an angle in both, of which anything is said.
const FEWEST_ANGLES: usize = 8;

/// How to compare.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ComparisonOptions {
    /// Offset of the clocks, seconds, where it is known: what the track shows at t, the reference shows at t + offset.
    pub offset_s: Option<f64>,
    /// Largest offset that is tried, seconds.
    pub most_offset_s: f64,
    /// The reference lies in the track's world, in metres: no axes, unit or place are found.
    pub same_world: bool,
}

impl Default for ComparisonOptions {
    fn default() -> Self {
        Self { offset_s: None, most_offset_s: 5.0, same_world: false }
    }
}

/// A track's body and poses, by frame; frame k is at k / `frame_rate` seconds.
#[derive(Debug, Clone, Copy)]
pub struct Posed<'a> {
    /// The body.
    pub model: &'a Model,
    /// Its poses.
    pub poses: &'a BTreeMap<usize, Pose>,
    /// Frames a second.
    pub frame_rate: f64,
}

/// Errors of one joint or of all, millimetres.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorStatistics {
    /// |a − b|.
    pub raw: Statistics,
    /// Mean, without the placement of markers; `None` of few frames.
    pub placed: Option<f64>,
    /// Of the pose without its place.
    pub root_aligned: Option<Statistics>,
    /// Of the shape alone.
    pub procrustes: Option<Statistics>,
    /// Shares of joints within [`PCK_MM`].
    pub pck: [f64; 3],
}

/// What joints are off by in one frame, millimetres, in the order of [`TrackComparison::joints`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ComparedFrame {
    /// The frame's number in the track.
    pub frame: usize,
    /// |a − b|; `None` where the reference has none.
    pub raw: Vec<Option<f64>>,
    /// The same without the place of the body.
    pub root_aligned: Vec<Option<f64>>,
    /// The same without place, size and turn; `None` of fewer than three joints.
    pub procrustes: Vec<Option<f64>>,
    /// The reference in the track's world, metres.
    pub reference: Vec<Option<DVec3>>,
}

/// How two curves of an angle agree, degrees.
#[derive(Debug, Clone, PartialEq)]
pub struct AngleAgreement {
    /// Which angle.
    pub angle: JointAngle,
    /// Root of the mean square difference.
    pub rms: f64,
    /// Mean of track − reference.
    pub offset: f64,
    /// The same root once the offset is taken off.
    pub rms_without_offset: f64,
    /// Pearson's; `None` where one of both does not move.
    pub correlation: Option<f64>,
    /// The reference counts the other way round (`OpenSim`'s older models bend knees towards −) and was turned.
    pub is_turned: bool,
    /// By frame of [`TrackComparison::numbers`]: of the track, and of the reference.
    pub curves: Vec<[Option<f64>; 2]>,
}

/// A track beside a reference.
#[derive(Debug, Clone, PartialEq)]
pub struct TrackComparison {
    /// How the reference's clock was set.
    pub clock: ClockOffset,
    /// How it was laid into the track's world.
    pub world: WorldMap,
    /// The joints that both have.
    pub joints: Vec<String>,
    /// Numbers of the track's frames.
    pub numbers: Vec<usize>,
    /// The frames in which a joint was compared.
    pub frames: Vec<ComparedFrame>,
    /// Of all joints; `None` where none was compared.
    pub overall: Option<ErrorStatistics>,
    /// By joint.
    pub by_joint: BTreeMap<String, ErrorStatistics>,
    /// Of the angles that both have.
    pub angles: Vec<AngleAgreement>,
}

/// Compares a track with a reference.
#[must_use]
pub fn compare(track: &Posed<'_>, reference: &Trajectories, options: &ComparisonOptions) -> TrackComparison {
    let ours = Trajectories::of_poses(track.model, track.frame_rate, track.poses);
    let joints = clock::common_joints(&ours, reference);
    let clock = match options.offset_s {
        Some(seconds) => ClockOffset { seconds, is_measured: false },
        None => clock::measure(&ours, reference, &joints, options.most_offset_s),
    };
    let matched = clock::matched(&ours, reference, &joints, clock.seconds);
    let world = if options.same_world {
        WorldMap::SAME
    } else {
        WorldMap::find(&matched.iter().flatten().flatten().copied().collect::<Vec<_>>())
    };
    let names: Vec<String> = joints.iter().map(|[column, _]| ours.joints[*column].clone()).collect();
    let numbers: Vec<usize> = track.poses.keys().copied().collect();
    let mut placed = JointErrors::default();
    let mut frames = Vec::new();
    for ((frame, pose), pairs) in track.poses.iter().zip(matched) {
        let pairs: Vec<Option<[DVec3; 2]>> =
            pairs.into_iter().map(|pair| pair.map(|[a, b]| [a, world.apply(b)])).collect();
        if pairs.iter().all(Option::is_none) {
            continue;
        }
        let seen = joints.iter().zip(&pairs).filter_map(|([limb, _], pair)| Some((Some(*limb), (*pair)?[1])));
        placed.add(track.model, pose, &seen.collect());
        frames.push(ComparedFrame::new(*frame, &names, &pairs));
    }
    let placed: BTreeMap<String, f64> = placed
        .placed(None)
        .into_iter()
        .filter_map(|(limb, errors)| {
            let limb = track.model.limb_index(limb)?;
            Some((ours.joints[limb].clone(), mean(errors)?))
        })
        .collect();
    let by_joint = names.iter().enumerate().filter_map(|(column, name)| {
        let of_joint = statistics(&frames, |index| index == column, placed.get(name).copied())?;
        Some((name.clone(), of_joint))
    });
    TrackComparison {
        clock,
        world,
        by_joint: by_joint.collect(),
        overall: statistics(&frames, |_| true, mean(placed.values().copied())),
        angles: agreements(&ours, reference, clock.seconds),
        joints: names,
        numbers,
        frames,
    }
}

impl ComparedFrame {
    fn new(frame: usize, joints: &[String], pairs: &[Option<[DVec3; 2]>]) -> Self {
        let mm = |pair: &Option<[DVec3; 2]>, b: &dyn Fn(DVec3) -> DVec3| {
            pair.map(|[ours, theirs]| 1000.0 * ours.distance(b(theirs)))
        };
        let hips = ["left hip", "right hip"].map(|hip| joints.iter().position(|joint| joint == hip));
        let hips = hips.map(|hip| pairs[hip?]);
        let roots: Vec<[DVec3; 2]> = match hips {
            [Some(left), Some(right)] => vec![left, right],
            _ => pairs.iter().flatten().copied().collect(),
        };
        let middle = |side: usize| roots.iter().map(|pair| pair[side]).sum::<DVec3>() / roots.len() as f64;
        let shift = middle(0) - middle(1);
        let (ours, theirs): (Vec<DVec3>, Vec<DVec3>) = pairs.iter().flatten().map(|[a, b]| (*a, *b)).unzip();
        let similarity = (ours.len() >= 3).then(|| umeyama(&theirs, &ours)).flatten();
        Self {
            frame,
            raw: pairs.iter().map(|pair| mm(pair, &|b| b)).collect(),
            root_aligned: pairs.iter().map(|pair| mm(pair, &|b| b + shift)).collect(),
            procrustes: pairs
                .iter()
                .map(|pair| similarity.and_then(|similarity| mm(pair, &|b| similarity.apply(b))))
                .collect(),
            reference: pairs.iter().map(|pair| pair.map(|[_, b]| b)).collect(),
        }
    }

    /// Mean raw error of the frame's joints, millimetres.
    #[must_use]
    pub fn mean_raw(&self) -> Option<f64> {
        mean(self.raw.iter().flatten().copied())
    }
}

/// Statistics of some joints over all frames.
fn statistics(
    frames: &[ComparedFrame],
    is_one: impl Fn(usize) -> bool,
    placed: Option<f64>,
) -> Option<ErrorStatistics> {
    let all = |of: fn(&ComparedFrame) -> &Vec<Option<f64>>| -> Vec<f64> {
        let joints = frames.iter().flat_map(|frame| of(frame).iter().enumerate());
        joints.filter(|(joint, _)| is_one(*joint)).filter_map(|(_, error)| *error).collect()
    };
    let raw = all(|frame| &frame.raw);
    let within = |mm: f64| raw.iter().filter(|error| **error <= mm).count() as f64 / raw.len().max(1) as f64;
    Some(ErrorStatistics {
        pck: PCK_MM.map(within),
        raw: Statistics::of(&raw)?,
        placed,
        root_aligned: Statistics::of(&all(|frame| &frame.root_aligned)),
        procrustes: Statistics::of(&all(|frame| &frame.procrustes)),
    })
}

/// The angles that both recordings have, in enough frames.
fn agreements(ours: &Trajectories, reference: &Trajectories, offset: f64) -> Vec<AngleAgreement> {
    let moments = reference.moments();
    let agreement = |angle: JointAngle| {
        let theirs = reference.angle_curve(angle);
        let curves: Vec<[Option<f64>; 2]> = ours
            .times
            .iter()
            .enumerate()
            .map(|(frame, time)| {
                let then = moments.between(time + offset).and_then(|between| between.value(&theirs));
                [ours.angle(frame, angle), then].map(|value| value.map(f64::to_degrees))
            })
            .collect();
        AngleAgreement::of(angle, curves)
    };
    JointAngle::ALL.into_iter().filter_map(agreement).collect()
}

impl AngleAgreement {
    fn of(angle: JointAngle, mut curves: Vec<[Option<f64>; 2]>) -> Option<Self> {
        let both = |curves: &[[Option<f64>; 2]]| -> Vec<[f64; 2]> {
            curves.iter().filter_map(|[a, b]| Some([(*a)?, (*b)?])).collect()
        };
        let mut pairs = both(&curves);
        if pairs.len() < FEWEST_ANGLES {
            return None;
        }
        let correlation = correlation(&pairs);
        // Hinges bend one way only: a reference that counts the other way is turned, and this is told.
        let is_hinge = !matches!(
            angle,
            JointAngle::LeftHip | JointAngle::RightHip | JointAngle::LeftShoulder | JointAngle::RightShoulder
        );
        let is_turned = is_hinge
            && mean(pairs.iter().map(|pair| pair[1]))? < -1.0
            && correlation.is_some_and(|r| r < 0.0);
        if is_turned {
            curves.iter_mut().for_each(|pair| pair[1] = pair[1].map(|value| -value));
            pairs = both(&curves);
        }
        let difference = |[a, b]: &[f64; 2]| (a - b + 180.0).rem_euclid(360.0) - 180.0;
        let offset = mean(pairs.iter().map(difference))?;
        let rms = |off: f64| mean(pairs.iter().map(|pair| (difference(pair) - off).powi(2))).map(f64::sqrt);
        Some(Self {
            angle,
            rms: rms(0.0)?,
            offset,
            rms_without_offset: rms(offset)?,
            correlation: correlation.map(|r| if is_turned { -r } else { r }),
            is_turned,
            curves,
        })
    }
}

/// Pearson's correlation.
fn correlation(pairs: &[[f64; 2]]) -> Option<f64> {
    let middle = [0, 1].map(|side| mean(pairs.iter().map(|pair| pair[side])).unwrap_or(0.0));
    let sum = |a: usize, b: usize| -> f64 {
        pairs.iter().map(|pair| (pair[a] - middle[a]) * (pair[b] - middle[b])).sum()
    };
    let correlation = sum(0, 1) / (sum(0, 0) * sum(1, 1)).sqrt();
    correlation.is_finite().then_some(correlation)
}

#[cfg(test)]
mod tests;
