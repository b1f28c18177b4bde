//! The report's experiments, to be run again: what was claimed, on simulated data of known truth.
//!
//! Every experiment is a file with `Options` (what to vary, with defaults that are the report's conditions where
//! those are known), a `run` that can be cancelled and says how far it is, and a `Report` of plain numbers that
//! can be written as it is. The same options give the same numbers.
//!
//! | file | holds |
//! |---|---|
//! | [`fig51`] | Fig. 5.1: one limb seen from the side, three renderers |
//! | [`fig52`] | Figs. 5.2 and 5.3: the upper body from many starts, one camera and two |
//! | [`fig54`] | Fig. 5.4: one frame of a sequence, iteration by iteration |
//! | [`fig55`] | Figs. 5.5 and 5.6: a sequence, large and tiny pictures |
//! | [`sequence`] | a sequence, simulated or a take's, in the report's small pictures |
//! | [`looks`] | D and Λ of a pose as pictures |
//! | [`inverse`] | (4.10) as written, the pseudo-inverse, and dampings |
//! | [`bias`] | where fits go that begin at the truth, by ramp, data and cameras |
//! | [`acquire`] | first bodies, grown from nothing known, beside fitted ones |
//! | [`begin`] | ways to begin: downhill, particles, templates, the search, from given starts and without |
//! | [`no_start`] | a take's frames without a start, by sets of cameras |
//! | [`track`] | the upper body at several speeds through noise, squats before two telephones: what carrying motion on is worth |
//! | [`robustness`] | the full body with one thing wrong at a time: masks, cameras, sizes |
//! | [`shadow`] | simulated rooms with shadows: pixels found and joints, by test; noise that passes for a subject |
//! | [`starts`] | starts of known distance from their truth |
//! | [`cues`](mod@cues) | limbs that silhouettes do not hold, with and without cues of the pictures |
//! | [`prior`](mod@prior) | recorded people followed with and without a prior learnt from others |
//! | [`curve`] | one fit, iteration by iteration, against its truth |
//! | [`sizes`] | the sizes of people of several builds, from silhouettes |
//! | [`own_sizes`] | the same in one go from a track with the average body, masks exact and too wide, and the track after |
//! | [`sync`] | clocks of cameras that are off, found from the motion of the silhouettes |
//! | [`scene`] | simulated data of a pose as a fit takes them |
//! | [`progress`] | how far an experiment is, and why one cannot run |

pub mod acquire;
pub mod begin;
pub mod bias;
pub mod cues;
pub mod curve;
pub mod fig51;
pub mod fig52;
pub mod fig54;
pub mod fig55;
pub mod inverse;
pub mod looks;
pub mod no_start;
pub mod own_sizes;
pub mod prior;
pub mod progress;
pub mod robustness;
pub mod scene;
pub mod sequence;
pub mod shadow;
pub mod sizes;
pub mod starts;
pub mod sync;
pub mod track;

pub use curve::Curve;
pub use progress::{ExperimentError, Progress};
pub use scene::Simulation;
