//! Fitting one frame: what each camera contributes, the cost of a pose, and the way downhill.
//!
//! | file | holds |
//! |---|---|
//! | `options` | [`FitOptions`]: every choice of a fit, and the presets that name sets of them |
//! | `evidence` | [`FitView`]: what one camera contributes to a frame |
//! | `objective` | [`Objective`]: the cost of a pose as a least-squares problem |
//! | `schedule` | [`ApparentSize`]: annealing by the size of what is seen |
//! | `fit` | [`Fit`]: iteration by iteration, stage after stage |

#[doc(inline)]
pub use crate::posing;

mod evidence;
#[expect(clippy::module_inception, reason = "the file is named after the type that it holds")]
mod fit;
mod objective;
mod options;
mod schedule;

pub(crate) use evidence::PreparedFit;
pub use evidence::{Evidence, FitError, FitView};
pub use fit::{Fit, SolverSummary};
pub use objective::Objective;
pub(crate) use options::LEAST_SCALE;
pub use options::{DataView, FitOptions, OptionsError, ParsePresetError, Preset, Stage};
pub use schedule::ApparentSize;
