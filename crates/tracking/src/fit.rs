//! Fitting one frame: what each camera contributes, the cost of a pose, and the way downhill.
//!
//! A [`Fit`] goes iteration by iteration and stage after stage down the cost of an [`Objective`]: what the [`FitView`]s of all
//! cameras say, by [`FitOptions`].

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
pub use options::{DataView, FitOptions, OptionsError, ParsePresetError, Preset, Stage};
pub use schedule::ApparentSize;
pub(crate) use schedule::MEANT_FOR_PX;
