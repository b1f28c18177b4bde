//! Looking for the pose elsewhere than downhill from the start.
//!
//! | file | holds |
//! |---|---|
//! | `hypotheses` | [`search`]: other poses that the silhouettes allow, ranked; [`fit_best`] goes on from the first |
//! | `options` | [`SearchOptions`]: how hard to look |
//! | `chains` | the body taken apart into its trunk and its arms, legs and head |
//! | `reseed` | new places for one chain while the rest of the body is held |
//! | `sketch` | flat limbs on coarse pictures, by which thousands of places are sifted |
//! | `without_start` | [`without_start()`]: a pose where no start is known, from the visual hull |
//! | [`start`] | where a fit begins: a pose from known joints, and noise on it |

#[doc(inline)]
pub use crate::{acquisition, particles, templates, visual_hull};

mod chains;
mod hypotheses;
mod options;
mod reseed;
mod sketch;
pub mod start;
mod without_start;

pub use chains::{Chain, Chains};
pub use hypotheses::{Hypotheses, Hypothesis, Origin, fit_best, search};
pub use options::SearchOptions;
pub use without_start::{
    Candidate, Doubt, Found, Heights, Rated, WithoutStart, WithoutStartError, hull_scale, standing,
    without_start,
};
pub(crate) use without_start::{Place, Stance, mask_of, reduced, turn_whole};
