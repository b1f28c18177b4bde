//! A particle filter that looks for a pose: many bodies at once, weighted by what the silhouettes say of each.
//!
//! A particle is a pose xᵢ with a weight wᵢ. Its likelihood is that of the fit's own cost C, squared grey levels of D − Λ
//! over all cameras and joint limits beside them,
//!
//! ```text
//! P(z | xᵢ) ∝ exp(−β C(xᵢ)),   wᵢ = P(z | xᵢ) / Σⱼ P(z | xⱼ)
//! ```
//!
//! - **Partitions.** Forty dimensions are too many to be hit by chance. So the trunk is sampled first, weighted and
//!   resampled; then each chain (head, arm, leg) given the trunk, one after the other, likewise. What is not sampled yet in the
//!   first layer is not drawn either. After J. `MacCormick` and M. Isard, "Partitioned sampling, articulated objects, and
//!   interface-quality hand tracking", ECCV 2000.
//! - **Annealing.** Layers begin with wide ramps and wide noise and end with narrow ones. β is not chosen: it is what leaves a
//!   wanted share of the particles alive, the survival rate α = 1/(N Σ wᵢ²). After J. Deutscher, A. Blake and I. Reid,
//!   "Articulated body motion capture by annealed particle filtering", CVPR 2000.
//! - **Resampling** is systematic: one random number u, and particle i has as many children as there are (k + u)/N between
//!   its ends of the cumulated weights (N. Gordon, D. Salmond and A. Smith 1993; J. Carpenter, P. Clifford and P. Fearnhead 1999).
//!   A particle's first child stays where it is; the others move by the layer's noise.
//!
//! Costs are the fit's kernels' without derivatives. Every particle has random numbers of its own, by seed, step and index:
//! the result is the same bits for any number of threads.

mod filter;
mod likelihood;

pub use filter::{
    FilterSummary, Generation, Particle, ParticleError, ParticleFilter, ParticleOptions, Partition,
};
pub use likelihood::{Likelihood, LikelihoodMemory, resampled, tempered};
