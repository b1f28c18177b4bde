//! How sure a fitted pose is: what silhouettes say against it, and how far each limb is believed.

mod conflict;
mod error_distribution;
mod learnt_errors;
mod signs;
mod spread;
mod trust;

pub use conflict::{Conflicts, LimbConflict};
pub use error_distribution::{ErrorDistribution, ErrorNetwork, KnownError, learn};
pub use signs::Signs;
pub use spread::deviation_m;
pub use trust::{LimbTrust, Reason, Verdict, WRONG_M};

pub(crate) use conflict::px_per_metre;
pub(crate) use signs::{TrustInputs, signs};
pub(crate) use spread::{end_covariances, end_jacobians};
pub(crate) use trust::trust;
