//! Which camera of a calibration is wrong, and how: cameras are checked against one another by the silhouettes they see.
//!
//! A half-plane through the centres of two cameras that touches the person touches both silhouettes
//! ([`synchronise`](crate::synchronise)). Its two extreme angles φ, low and high, therefore agree between two cameras of a right
//! calibration at every moment,
//!
//! ```text
//! r = (φ_a(t) − φ_b(t)) / pixel
//! ```
//!
//! and so does the angle of the half-plane through a joint, where keypoints show that. Three cameras or more tell besides whether
//! the hull of the others explains each silhouette: the gaps g of its edges (`coherence.rs`).
//!
//! Every way in which a calibration is usually wrong is a hypothesis H: one camera (or all of them), a kind of fault, and its
//! size θ. Its repair gives other cameras or clocks, and so other residuals r(θ). Small faults are fitted by Gauss and Newton with
//! a robust loss whose width shrinks from tens of pixels to the noise. Hypotheses are compared by evidence, in nats,
//!
//! ```text
//! E(H) = Σ 1/c max(0, ln(s/σ) − 5/2 ln(1 + r²/4σ²)) − ½ k ln n − ½ Σ (θ/θ₀)²
//! ```
//!
//! with s the spread of what does not fit at all, σ the noise under the best hypothesis and c the length over which residuals
//! hang together, of silhouettes, of keypoints and of gaps (r = g), k sizes and n samples (G. Schwarz, "Estimating the dimension
//! of a model", 1978), and θ₀ how large such faults usually are. Faults are fitted by the angles; gaps only compare them. What wins
//! by enough is a [`Finding`]; it is repaired, and the rest is looked at again, since a take may have two faults.
//!
//! Silhouettes cannot tell where the whole rig stands, turns and how large it is. That all lengths are in other units shows in
//! the size of the person alone; that two cameras are wrong out of two does not show which.

mod calibration;
mod coherence;
mod diagnose;
mod fault;
mod fitting;
mod hypothesis;
mod outlines;
mod pair_angles;
mod ranking;
mod state;
mod subject;

pub use calibration::turned_for;
pub use diagnose::{Diagnosis, DiagnosisError, DiagnosisOptions, Finding, PairAgreement, Rival, diagnose};
pub use fault::{ClockChange, FaultKind, Size};
