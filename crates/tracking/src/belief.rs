//! How sure a fitted pose is: what silhouettes say against it, and how far each limb is believed.

mod conflict;
mod trust;

pub use conflict::{Conflicts, LimbConflict};
pub use trust::{LimbTrust, Reason, Verdict};

pub(crate) use conflict::px_per_metre;
pub(crate) use trust::{TrustInputs, trust};
