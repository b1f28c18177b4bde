//! The person's own size: lengths and radii found together with the poses of several frames.
//!
//! Unknown are the tangent steps of every frame's pose, θ = log(size / start's size) of every free length and radius
//! (left and right share them by default), one size and one girth of the whole body. One least-squares problem holds
//! the silhouettes of all frames and cameras, the poses' priors and a prior of human proportions; Levenberg and
//! Marquardt's solver takes it as it takes a single pose. What the silhouettes do not show stays where the proportions
//! put it, and the report says so.
//!
//! | file | holds |
//! |---|---|
//! | [`options`] | every choice: stages, proportions, which sizes are free |
//! | [`scale`] | a first guess of the body's size: from known joints, or from silhouettes' places and areas |
//! | [`problem`] | poses and sizes as one least-squares problem |
//! | [`fit`] | [`fit_body`]: stage after stage |
//! | [`approach`](mod@approach) | from one frame's start to the poses of several frames, by tracking |
//! | [`frames`] | which frames to look at |
//! | [`report`] | what was found, and how well each size is seen |

pub mod approach;
pub mod fit;
pub mod frames;
pub mod options;
pub mod problem;
pub mod report;
pub mod scale;

pub use approach::{Approach, approach};
pub use fit::{BodyFitError, BodyFrame, BodyProgress, fit_body};
pub use options::{BodyFitOptions, BodyStage, CLOTHED};
pub use report::{BodyFit, SizeEstimate};
