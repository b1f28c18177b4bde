//! What two cameras' silhouettes have in common at one moment, over time.

use glam::DVec3;

use super::answer::PairCue;
use super::outline::{Recording, Sighting};
use crate::camera::{Camera, up_of};
use crate::statistics::upper_median;

/// Share of the shorter recording's silhouettes that must have tangents for these to be used.
const ENOUGH: f64 = 0.3;
/// A silhouette that fills more than this of the half-planes has no tangents, radians: the line through both cameras passes
/// through it, or nearly.
const WIDEST: f64 = 2.8;
/// An open corner this near to the extreme one may be what hides a farther one, share of the silhouette's extent.
const NEAR_EXTREME: f64 = 0.1;
/// Motion is measured over this many seconds.
const SPEED_OVER_S: f64 = 0.3;
/// Both cameras' signals are smoothed this many times. Between two samples the mean of both has half the noise of either, so
/// that without smoothing noisy masks draw offsets towards halves of a frame.
const SMOOTHED: usize = 2;
/// Frames farther apart than this many usual steps have a gap between them.
const GAP: f64 = 2.6;

/// A number over one camera's time.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Signal {
    pub(crate) samples: Vec<Sample>,
    /// The usual time between two samples, seconds.
    period: f64,
}

/// A signal at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sample {
    pub(crate) seconds: f64,
    pub(crate) value: f64,
    /// What one pixel at the point of touch is in the value's unit.
    pub(crate) pixel: f64,
    /// How fast the value grows, pixels a second, or spreads a second.
    pub(super) velocity: f64,
    /// Cosine of the angle from the line through both centres, first to second, to the ray of touch.
    pub(crate) along: f64,
}

/// The same number as two cameras have it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Common {
    pub(super) of: [Signal; 2],
    /// Its spread over both recordings, in pixels; 1 for numbers that are brought to one scale.
    pub(super) spread: f64,
}

/// All that two cameras have in common.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PairSignals {
    pub(super) cue: PairCue,
    pub(super) common: Vec<Common>,
}

impl PairSignals {
    pub(super) fn of(a: &Recording, b: &Recording) -> Self {
        let periods = [a.period(), b.period()];
        let tangents = Pencil::of([a, b]).map_or_else(Vec::new, |pencil| pencil.tangents([a, b]).into());
        let least = ENOUGH * a.seen().min(b.seen()) as f64;
        let has_enough = |common: &[[Vec<Sample>; 2]]| {
            common.iter().any(|of| of.iter().all(|samples| samples.len() as f64 >= least.max(2.0)))
        };
        let (cue, numbers) = if has_enough(&tangents) {
            (PairCue::EpipolarTangents, tangents)
        } else {
            (PairCue::HeightAndArea, height_and_area([a, b]))
        };
        let common = numbers.into_iter().filter_map(|of| {
            let [a, b] = of;
            let of = [Signal::new(a, periods[0]), Signal::new(b, periods[1])];
            let spreads = of.each_ref().map(Signal::spread);
            let common = match cue {
                PairCue::EpipolarTangents => Common { of, spread: 0.5 * (spreads[0] + spreads[1]) },
                PairCue::HeightAndArea => {
                    let [a, b] = of;
                    Common { of: [a.scaled()?, b.scaled()?], spread: 1.0 }
                }
            };
            Some(common)
        });
        Self { cue, common: common.collect() }
    }
}

impl Signal {
    pub(crate) fn new(mut samples: Vec<Sample>, period: f64) -> Self {
        for _ in 0..SMOOTHED {
            smooth(&mut samples, GAP * period);
        }
        let velocities: Vec<f64> = (0..samples.len()).map(|at| velocity(&samples, at)).collect();
        for (sample, velocity) in samples.iter_mut().zip(velocities) {
            sample.velocity = velocity;
        }
        Self { samples, period }
    }

    /// Half of the middle two thirds of its values, in pixels.
    fn spread(&self) -> f64 {
        let mut pixels: Vec<f64> = self.samples.iter().map(|sample| sample.pixel).collect();
        middle_spread(&self.values()) / upper_median(&mut pixels).unwrap_or(1.0)
    }

    fn values(&self) -> Vec<f64> {
        self.samples.iter().map(|sample| sample.value).collect()
    }

    /// The same about 0 with a spread of 1; `None` if it never changes.
    fn scaled(self) -> Option<Self> {
        let spread = middle_spread(&self.values());
        let middle = upper_median(&mut self.values())?;
        if spread <= 0.0 || !spread.is_finite() {
            return None;
        }
        let scaled = |sample: Sample| Sample {
            value: (sample.value - middle) / spread,
            velocity: sample.velocity / spread,
            ..sample
        };
        Some(Self { samples: self.samples.into_iter().map(scaled).collect(), period: self.period })
    }

    /// The sample at a time, between two others; `None` beyond the ends and in gaps. `near` is where the last one was found
    /// and moves along.
    pub(crate) fn at(&self, seconds: f64, near: &mut usize) -> Option<Sample> {
        let time = |index: usize| self.samples.get(index).map(|sample| sample.seconds);
        while *near > 0 && time(*near).is_none_or(|time| time > seconds) {
            *near -= 1;
        }
        while time(*near + 1).is_some_and(|time| time <= seconds) {
            *near += 1;
        }
        let before = self.samples.get(*near)?;
        if before.seconds == seconds {
            return Some(*before);
        }
        let after = self.samples.get(*near + 1)?;
        let step = after.seconds - before.seconds;
        if before.seconds > seconds || step > GAP * self.period {
            return None;
        }
        let share = (seconds - before.seconds) / step;
        let between = |a: f64, b: f64| a + share * (b - a);
        Some(Sample {
            seconds,
            value: between(before.value, after.value),
            pixel: between(before.pixel, after.pixel),
            velocity: between(before.velocity, after.velocity),
            along: between(before.along, after.along),
        })
    }
}

/// Every value with a quarter of each neighbour's, unless there is a gap between them.
fn smooth(samples: &mut [Sample], gap: f64) {
    let old: Vec<(f64, f64)> = samples.iter().map(|sample| (sample.seconds, sample.value)).collect();
    for (at, sample) in samples.iter_mut().enumerate() {
        let own = sample.value;
        let beside = |index: Option<usize>| {
            let other = index.and_then(|index| old.get(index));
            other.filter(|other| (other.0 - sample.seconds).abs() <= gap).map_or(own, |other| other.1)
        };
        sample.value = 0.5 * own + 0.25 * (beside(at.checked_sub(1)) + beside(Some(at + 1)));
    }
}

/// How fast a signal grows about a sample, in pixels a second.
fn velocity(samples: &[Sample], at: usize) -> f64 {
    let is_near = |other: &Sample| (other.seconds - samples[at].seconds).abs() <= 0.5 * SPEED_OVER_S + 1e-9;
    let first = samples[..at].iter().rev().take_while(|sample| is_near(sample)).last();
    let last = samples[at + 1..].iter().take_while(|sample| is_near(sample)).last();
    let (first, last) = (first.unwrap_or(&samples[at]), last.unwrap_or(&samples[at]));
    let step = last.seconds - first.seconds;
    // At low rates no other sample is so near.
    let (first, last, step) = if step > 0.0 {
        (first, last, step)
    } else {
        let first = &samples[at.saturating_sub(1)];
        let last = &samples[(at + 1).min(samples.len() - 1)];
        (first, last, last.seconds - first.seconds)
    };
    if step > 0.0 { (last.value - first.value) / (samples[at].pixel * step) } else { 0.0 }
}

/// The half-planes that the line through two cameras' centres bounds.
pub(crate) struct Pencil {
    baseline: DVec3,
    /// Angle 0 and a quarter turn.
    zero: DVec3,
    quarter: DVec3,
}

impl Pencil {
    /// Angle 0 is towards the middle of what both see. `None` for cameras in one place.
    pub(crate) fn of(recordings: [&Recording; 2]) -> Option<Self> {
        let [a, b] = recordings.map(|recording| recording.camera.centre());
        let baseline = (b - a).try_normalize()?;
        let across = |recording: &Recording| -> DVec3 {
            let rays = recording.sightings.iter().flat_map(|sighting| sighting.hull.iter());
            rays.map(|corner| corner.ray.reject_from_normalized(baseline)).sum::<DVec3>().normalize_or_zero()
        };
        let zero = recordings.map(across).into_iter().sum::<DVec3>().try_normalize()?;
        Some(Self { baseline, zero, quarter: baseline.cross(zero) })
    }

    /// The low and the high angle of both cameras.
    pub(crate) fn tangents(&self, recordings: [&Recording; 2]) -> [[Vec<Sample>; 2]; 2] {
        let [[low, high], [other_low, other_high]] = recordings.map(|recording| self.extremes(recording));
        [[low, other_low], [high, other_high]]
    }

    /// The angles of joints that keypoints show, of both cameras, one pair a joint.
    pub(crate) fn joints(&self, recordings: [&Recording; 2]) -> Vec<[Vec<Sample>; 2]> {
        let joints = |recording: &Recording| {
            recording.sightings.iter().map(|sighting| sighting.keypoints.len()).max().unwrap_or(0)
        };
        let count = recordings.into_iter().map(joints).min().unwrap_or(0);
        (0..count).map(|joint| recordings.map(|recording| self.joint(recording, joint))).collect()
    }

    /// A ray's angle, and the sine and the cosine of its angle to the baseline.
    fn angle(&self, ray: DVec3) -> (f64, f64, f64) {
        let across = ray.reject_from_normalized(self.baseline);
        let angle = across.dot(self.quarter).atan2(across.dot(self.zero));
        (angle, across.length(), ray.dot(self.baseline))
    }

    /// The low and the high angle over time, where they are the subject's own.
    fn extremes(&self, recording: &Recording) -> [Vec<Sample>; 2] {
        let mut both = [Vec::new(), Vec::new()];
        let pixel = 1.0 / recording.camera.intrinsics().mean_focal_px();
        for sighting in &recording.sightings {
            let angles: Vec<(f64, f64, f64)> =
                sighting.hull.iter().map(|corner| self.angle(corner.ray)).collect();
            let low = angles.iter().copied().min_by(|a, b| a.0.total_cmp(&b.0));
            let high = angles.iter().copied().max_by(|a, b| a.0.total_cmp(&b.0));
            let (Some(low), Some(high)) = (low, high) else { continue };
            let extent = high.0 - low.0;
            if !(extent > 0.0 && extent < WIDEST) {
                continue;
            }
            for (signal, extreme) in both.iter_mut().zip([low, high]) {
                let is_open = angles.iter().zip(&sighting.hull).any(|(angle, corner)| {
                    corner.is_open && (angle.0 - extreme.0).abs() <= NEAR_EXTREME * extent
                });
                if !is_open && extreme.1 > pixel {
                    signal.push(sample_of(extreme, pixel, sighting.seconds));
                }
            }
        }
        both
    }

    /// The angle of a joint over time, where a keypoint shows it.
    fn joint(&self, recording: &Recording, joint: usize) -> Vec<Sample> {
        let pixel = 1.0 / recording.camera.intrinsics().mean_focal_px();
        let sample = |sighting: &Sighting| {
            let angle = self.angle((*sighting.keypoints.get(joint)?)?);
            // Beyond, angles begin again from the other end.
            let is_clear = angle.1 > pixel && angle.0.abs() < WIDEST;
            is_clear.then(|| sample_of(angle, pixel, sighting.seconds))
        };
        recording.sightings.iter().filter_map(sample).collect()
    }
}

/// An [angle](Pencil::angle) that was seen at a time, with what a pixel in the middle of the picture is, radians.
fn sample_of((value, sine, along): (f64, f64, f64), pixel: f64, seconds: f64) -> Sample {
    Sample { seconds, value, pixel: pixel / sine, velocity: 0.0, along }
}

/// The height of the top over the horizon and the logarithm of the area.
fn height_and_area(recordings: [&Recording; 2]) -> Vec<[Vec<Sample>; 2]> {
    let up = up_of(recordings.map(|recording| &recording.camera)).unwrap_or(DVec3::Z);
    let sample = |sighting: &Sighting, value: f64| Sample {
        seconds: sighting.seconds,
        value,
        pixel: 1.0,
        velocity: 0.0,
        along: 0.0,
    };
    let top = |recording: &Recording| -> Vec<Sample> {
        let of = |sighting: &Sighting| {
            let top = sighting.hull.iter().max_by(|a, b| a.ray.dot(up).total_cmp(&b.ray.dot(up)))?;
            (!top.is_open).then(|| sample(sighting, top.ray.dot(up).asin()))
        };
        recording.sightings.iter().filter_map(of).collect()
    };
    let area = |recording: &Recording| -> Vec<Sample> {
        let whole = recording.sightings.iter().filter(|sighting| !sighting.hull.is_empty());
        let whole = whole.filter(|sighting| sighting.hull.iter().all(|corner| !corner.is_open));
        whole.map(|sighting| sample(sighting, sighting.area.max(1.0).ln())).collect()
    };
    vec![recordings.map(top), recordings.map(area)]
}

/// How far two cameras' silhouettes move, pixels, whatever they are compared by: the larger of what both see.
pub(super) fn image_motion(recording: &Recording) -> f64 {
    let camera: &Camera = &recording.camera;
    let focal = camera.intrinsics().mean_focal_px();
    let turned = camera.camera_from_world().rotation;
    let extreme = |of: &dyn Fn(DVec3) -> f64| {
        let values: Vec<f64> = recording
            .sightings
            .iter()
            .filter_map(|sighting| {
                sighting.hull.iter().map(|corner| focal * of(turned * corner.ray)).max_by(f64::total_cmp)
            })
            .collect();
        middle_spread(&values)
    };
    let directions: [&dyn Fn(DVec3) -> f64; 4] =
        [&|ray| ray.x / ray.z, &|ray| -ray.x / ray.z, &|ray| ray.y / ray.z, &|ray| -ray.y / ray.z];
    directions.into_iter().map(extreme).fold(0.0, f64::max)
}

/// Half of the middle two thirds: the standard deviation of normally distributed numbers, and little moved by outliers.
fn middle_spread(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = |share: f64| sorted.get((share * sorted.len() as f64) as usize).copied();
    at(0.841).zip(at(0.159)).map_or(0.0, |(high, low)| 0.5 * (high - low))
}
