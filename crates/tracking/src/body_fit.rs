//! The person's own size: lengths and radii found together with the poses of several frames.
//!
//! Unknown are the tangent steps of every frame's pose, θ = log(size / start's size) of every free length and radius
//! (left and right share them by default), one size and one girth of the whole body, and one widening of all silhouettes.
//! One least-squares problem holds the silhouettes of all frames and cameras, the poses' priors and a prior of human
//! proportions and girths ([`anthropometry`](crate::body::anthropometry)); Levenberg and Marquardt's solver takes it as it
//! takes a single pose. What the silhouettes do not show stays where the proportions put it, and the report says so.
//!
//! From a track with the average body, scaled ([`approach()`] does that), [`own_sizes()`] is all that a caller needs: it
//! chooses frames, fits, judges by frames held out, and says what it doubts. Then [`OwnSizes::model`] is the person, and
//! [`OwnSizes::as_seen`] the body to track with on masks as they are.
//!
//! [`refine_cameras`] takes the cameras as unknowns too, where a calibration is not to be trusted.
//!
//! Silhouettes that cannot be a person's are told beforehand ([`survey`](mod@survey)); [`find_person`] needs
//! nothing but silhouettes.

#[doc(inline)]
pub use crate::body_spheres;

mod approach;
mod cameras;
mod fit;
pub mod frames;
mod options;
mod own_sizes;
mod person;
mod problem;
mod refine;
mod report;
pub mod scale;
pub mod survey;
mod whole_frames;
pub mod widening;

pub use approach::{Approach, approach};
pub use cameras::{CameraChoice, CameraDeviations, CameraState};
pub use fit::{BodyFitError, BodyProgress, FirstSizes, fit_body};
pub use frames::{BodyFrame, PosedFrame};
pub use options::{BodyFitOptions, BodyStage, CLOTHED, WELL_SEEN};
pub use own_sizes::{
    Doubt, FEWEST_FRAMES, Judged, OwnSizes, OwnSizesError, OwnSizesOptions, OwnSizesProgress, own_sizes,
};
pub use person::{Person, PersonError, PersonOptions, PersonProgress, find_person};
pub use refine::{
    CameraRefinementError, CameraRefinementOptions, CameraRefinementProgress, CameraRefinementStep,
    FEWEST_CAMERAS, RefinedCamera, RefinedCameras, refine_cameras,
};
pub use report::{BodyFit, SizeEstimate};
