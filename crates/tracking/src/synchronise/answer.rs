//! What was found of the cameras' clocks, and why something was not.

use std::fmt;

use crate::numbers::OptionError;
use thiserror::Error;

/// How offsets are looked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SynchroniseOptions {
    /// Offsets of two cameras are at most so far from those that their clocks have, seconds. Infinite: as far as their
    /// recordings overlap enough.
    pub farthest_s: f64,
    /// The least share of the shorter recording that two cameras are to have in common.
    pub least_overlap: f64,
    /// An offset is told where it is at least so probable, 0 to 1.
    pub least_probability: f64,
    /// An offset is told where the next best one has less than this share of its evidence.
    pub largest_rival: f64,
}

impl Default for SynchroniseOptions {
    fn default() -> Self {
        Self { farthest_s: f64::INFINITY, least_overlap: 0.3, least_probability: 0.95, largest_rival: 0.9 }
    }
}

/// The clocks of all cameras.
#[derive(Debug, Clone, PartialEq)]
pub struct Synchronisation {
    /// In the order of the recordings; the first is what the others are compared with.
    pub cameras: Vec<CameraOffset>,
    /// Pairs of cameras that had something to say, in order.
    pub pairs: Vec<PairOffset>,
    /// How far pairs that count contradict one another round loops: the root mean square of what each is off the offsets
    /// that were found for its two cameras, the surer ones counting more, seconds. `None` without a loop.
    pub loop_error_s: Option<f64>,
}

impl Synchronisation {
    /// A camera's offset, seconds: 0 for the first, `None` where it cannot be told.
    #[must_use]
    pub fn seconds(&self, camera: usize) -> Option<f64> {
        match self.cameras.get(camera)? {
            CameraOffset::Reference => Some(0.0),
            CameraOffset::Found(offset) => Some(offset.seconds),
            CameraOffset::Undecided(_) => None,
        }
    }
}

/// One camera's clock.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CameraOffset {
    /// The first camera, whose clock is the others' measure.
    Reference,
    /// How far its clock is ahead.
    Found(Offset),
    /// It cannot be told.
    Undecided(Undecided),
}

/// How far a camera's clock is ahead of the first camera's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Offset {
    /// The time by this camera's clock at which the first camera's shows 0 s.
    pub seconds: f64,
    /// Standard deviation, seconds, if this is the right peak.
    pub deviation_s: f64,
    /// How probable it is that this is the right peak, 0 to 1.
    pub probability: f64,
    /// The evidence for it, nats: how much better the other cameras predict this one so than no knowledge does.
    pub evidence: f64,
    /// The next best offset and its evidence, if there is any other peak.
    pub rival: Option<(f64, f64)>,
}

/// Why a camera's offset cannot be told.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Undecided {
    /// Too few silhouettes.
    FewSilhouettes {
        /// Frames with a silhouette.
        found: usize,
        /// Frames that are wanted.
        wanted: usize,
    },
    /// Nobody moves enough for moments to be told apart.
    NoMotion {
        /// How far edges of the silhouette move, pixels (half of the middle two thirds).
        spread_px: f64,
    },
    /// No offset makes this camera's silhouettes agree with another's.
    NoAgreement,
    /// Several offsets fit about as well, as where a movement repeats itself.
    Ambiguous {
        /// The best offset, seconds.
        best_s: f64,
        /// The next best.
        rival_s: f64,
        /// How probable the best is, 0 to 1.
        probability: f64,
    },
}

impl fmt::Display for Undecided {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::FewSilhouettes { found, wanted } => {
                write!(f, "only {found} frames have a silhouette; {wanted} are needed")
            }
            Self::NoMotion { spread_px } => {
                write!(f, "nothing moves enough to tell: the silhouette's edges move by {spread_px:.1} px")
            }
            Self::NoAgreement => f.write_str("no offset makes its silhouettes agree with another camera's"),
            Self::Ambiguous { best_s, rival_s, probability } => write!(
                f,
                "{best_s:+.3} s and {rival_s:+.3} s fit about as well (the first with probability {probability:.2})"
            ),
        }
    }
}

/// What two silhouettes were compared by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PairCue {
    /// The extreme half-planes through both cameras that touch them.
    EpipolarTangents,
    /// The height of their tops and their areas, where there are no such half-planes.
    HeightAndArea,
}

/// Two cameras' offset by themselves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairOffset {
    /// Indices of the recordings, the smaller first.
    pub cameras: [usize; 2],
    /// What they were compared by.
    pub cue: PairCue,
    /// The second's clock less the first's, seconds: the peak next to the offsets of all cameras, where there is one.
    pub seconds: f64,
    /// Its standard deviation, seconds.
    pub deviation_s: f64,
    /// The evidence there, nats.
    pub evidence: f64,
    /// How far it is from what was found for the two cameras, seconds.
    pub residual_s: f64,
    /// The pair's noise, pixels at the point of touch; shares of the signal's spread without tangents.
    pub noise: f64,
    /// Whether it counted for the offsets: not where it contradicts the others.
    pub is_used: bool,
}

/// Why nothing can be looked for.
#[derive(Debug, Error, Clone, Copy, PartialEq)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum SynchroniseError {
    #[error("there are recordings of {count} cameras; expected two or more")]
    Count { count: usize },
    #[error("camera {camera}: frame {frame} is at {seconds} s; expected times that grow from frame to frame")]
    Times { camera: usize, frame: usize, seconds: f64 },
    #[error("camera {camera}: the mask of frame {frame} is not of the camera's size")]
    Size { camera: usize, frame: usize },
    #[error(transparent)]
    Option(#[from] OptionError),
}
