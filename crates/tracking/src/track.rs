//! Fitting a frame and following frames: what joins bodies, cameras, silhouettes and optimisers.
//!
//! | file | holds |
//! |---|---|
//! | [`options`] | [`FitOptions`]: every choice of a fit, and the presets that name sets of them |
//! | [`evidence`] | [`FitView`]: what one camera contributes to a frame |
//! | [`objective`] | the cost of a pose as a least-squares problem |
//! | [`fit`] | [`Fit`]: one frame's fit, iteration by iteration, stage after stage |
//! | [`hypotheses`] | other poses that the silhouettes allow, ranked |
//! | [`chains`] | the body taken apart into its trunk and its arms, legs and head |
//! | [`posing`] | moving a body by hand: chains follow through the same optimiser |
//! | [`start`] | where a fit begins: a pose from known joints, and noise on it |
//! | [`schedule`] | annealing by the size of what is seen |
//! | [`motion`] | how motion is carried from frame to frame: not at all, by velocity, by a Kalman filter |
//! | [`lost`] | noticing that a track was lost |
//! | [`tracker`] | [`Tracker`]: frame after frame |
//! | [`join`] | two tracks of the same frames, one forwards and one backwards, made one |
//! | [`fit_body`] | the person's own lengths and radii, with the poses of several frames |
//! | [`observability`] | what the cameras see of a pose and what not: directions, covariances, sets of cameras |
//! | [`metrics`] | joint errors against a reference |
//! | [`visual_hull`] | what all silhouettes leave of space |

pub mod chains;
pub mod evidence;
pub mod fit;
pub mod fit_body;
pub mod hypotheses;
pub mod join;
pub mod lost;
pub mod metrics;
pub mod motion;
pub mod objective;
pub mod observability;
pub mod options;
pub mod posing;
mod prepared;
mod reseed;
pub mod schedule;
mod sketch;
pub mod start;
pub mod tracker;
pub mod visual_hull;

pub use evidence::{Evidence, FitError, FitView};
pub use fit::{Fit, IterationRecord, SolverSummary};
pub use hypotheses::{Hypotheses, Hypothesis, HypothesisOptions};
pub use lost::Lost;
pub use motion::{KalmanOptions, Motion};
pub use options::{DataView, FitOptions, Preset, Stage};
pub use schedule::Scale;
pub use tracker::{FrameEstimate, Search, Track, Tracker};
