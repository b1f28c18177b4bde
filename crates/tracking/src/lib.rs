//! Silhouette-based markerless motion capture: the tracking core of Backlit.
//!
//! # The problem
//!
//! A person moves in front of calibrated cameras. Each picture is reduced to a silhouette. Wanted is the pose
//! of an articulated body whose outlines cover the silhouettes in all cameras at once. The method is that of
//! P. Kaimakis, "Markerless Motion Capture", University of Cambridge, 2004; equation numbers are that report's.
//!
//! # The equations
//!
//! - **Body** (4.11, 4.12). Chains of rigid limbs grow from one root. The state X is the root's position and one
//!   unit quaternion a joint; a joint lies at p = root + Σ sₘ Rₘ vₘ over the limbs before it, with length s and
//!   rest direction v. See [`body`].
//! - **Prediction** Λ(X) (4.16). A ray through each pixel passes a limb of radius r at distance d. A ramp turns
//!   that into a grey level, λ = 255 · clip(α d² + β, 0, 1), and over all limbs the darkest wins. See [`render`].
//! - **Measurement** D (4.24). The silhouette in the same grey levels: 0 subject, 255 background; pixels of which
//!   nothing is known weigh nothing. See [`segment`] and [`silhouette`].
//! - **Cost.** Σ w (D − Λ(X))² over all pixels of all cameras, in squared grey levels, plus priors. See
//!   [`residual`].
//! - **Step** (4.10). (JᵀJ + damping) δ = Jᵀρ with J = ∂Λ/∂X and ρ = D − Λ; X moves by X ⊕ δ. JᵀJ is never
//!   invertible (a limb's twist, undone by its children's, shows nowhere), so a step is damped or takes the
//!   pseudo-inverse. See [`optimize`].
//!
//! A pixel's derivative is a wrench on one limb, a force and a moment; wrenches are summed over pixels and mapped
//! to the state once a limb ([`render::wrench`]). That is exact, and its cost does not grow with the state.
//!
//! # Frames and units
//!
//! Metres, radians, seconds; pixels where a name ends in `_px`. World axes are the take's own. Camera axes are
//! OpenCV's: x right, y down, z forward, pixel centres at integers. A transform is named `a_from_b`, so
//! `point_in_camera = camera_from_world · point_in_world`. Quaternions are written w x y z; a rotation is relative
//! to its parent's frame, and tangent steps act there from the left, q ← exp(ω) q. Everything is f64 but pixels.
//!
//! # From masks to a pose
//!
//! ```
//! use std::sync::Arc;
//!
//! use backlit_tracking::prelude::*;
//!
//! let model = Arc::new(builtin::upper_body());
//! let columns = Parameters::Tangent.columns(model.rotation_count());
//! let truth = Pose::rest(&model).retract(Parameters::Tangent, &vec![0.1; columns]);
//! let joints = Kinematics::new(&model, &truth);
//!
//! // Two cameras, and the silhouette that each would see.
//! let mut views = Vec::new();
//! for (name, at) in [("left", DVec3::new(1.6, 0.4, 2.0)), ("right", DVec3::new(-1.9, 0.5, 1.7))] {
//!     let place = CameraFromWorld::looking_at(at, DVec3::Y * 0.3, DVec3::Y);
//!     let pinhole = Intrinsics { fx: 130.0, fy: 130.0, cx: 47.5, cy: 35.5 };
//!     let camera = Camera::new(name, [96, 72], pinhole, Distortion::None, place)?;
//!     let drawn = predict(&model, &joints, &camera, RendererKind::Capsule, Ramp::Half);
//!     views.push(FitView::of_mask(camera, drawn.to_mask()?));
//! }
//!
//! // Start a few degrees off and fit.
//! let off: Vec<f64> = (0..columns).map(|i| 0.06 * (i as f64).cos()).collect();
//! let start = truth.retract(Parameters::Tangent, &off);
//! let mut fit = Fit::new(model.clone(), views, start, FitOptions::preset(Preset::Robust))?;
//! let summary = fit.run(&CancelToken::new(), |iteration| println!("cost {:.0}", iteration.cost));
//!
//! let found = Kinematics::new(&model, &summary.pose);
//! for (found, truth) in found.ends().iter().zip(joints.ends()) {
//!     assert!(found.distance(*truth) < 0.02, "a joint is more than 20 mm off: {}", summary.termination);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # The modules, in the order of the data
//!
//! | module | holds |
//! |---|---|
//! | [`segment`] | from footage of a camera that stands still to masks: a background, and what differs from it |
//! | [`silhouette`] | masks, and views of them: measurements D, distance fields, overlap, outlines |
//! | [`body`] | the articulated body: limbs, poses, kinematics, built-in models; [`body::metrics`] compares poses with a reference |
//! | [`camera`] | calibrated cameras: pinhole, lens, place; pictures freed of the lens; [`camera::synchronise`] finds the offsets of their clocks |
//! | [`diagnosis`] | which camera of a calibration is wrong, and how |
//! | [`render`] | the soft silhouette Λ of a pose in a camera, and ∂Λ/∂X; a pixel's gradient as a [`render::wrench`] |
//! | [`residual`] | what pulls on a pose: silhouettes, priors, limits, points, residuals of one's own; [`residual::prior`] is learnt from motion files |
//! | [`optimize`] | least squares: normal equations, Gauss-Newton, Levenberg-Marquardt; [`optimize::gradient_check`] compares derivatives with differences |
//! | [`fit`] | one frame's fit: evidence, options, cost, iterations; [`fit::posing`] moves a body by hand |
//! | [`search`] | where a fit begins: other poses that the silhouettes allow, [`search::particles`], [`search::templates`], [`search::acquisition`] of a person's size, the [`search::visual_hull`] |
//! | [`track`] | following frames: motion, lost frames, smoothing by a [`track::filter`]; [`track::cues`] are what pictures say beside silhouettes |
//! | [`body_fit`] | the person's own lengths and radii, with the poses of several frames; [`body_fit::body_spheres`] a person of spheres |
//! | [`initialisation`] | ways to come by the first pose behind one trait: downhill, particles, templates, search, acquisition |
//! | [`observability`] | what the cameras see of a pose and what not: directions, covariances, sets of cameras |
//! | [`geometry`] | rotations, similarities and distances of rays, with their derivatives |
//! | [`statistics`] | medians, normal deviates, sums of logarithms |
//!
//! # Examples to run
//!
//! `cargo run -p backlit-tracking --example NAME`; each takes a second or two and needs no window.
//!
//! | name | shows |
//! |---|---|
//! | `frame_without_start` | one frame from PNG masks of four cameras, without a start |
//! | `track` | a swinging arm followed through twelve frames |
//! | `own_residual` | a [`Residual`](residual::Residual) of one's own in a fit |
//!
//! # What is stable
//!
//! The [`prelude`], what a fit or a track takes and returns, the equations, and the bits of results: a change of any of these
//! is listed in the change log. [`glam`] and [`image`] are re-exported in the version that signatures use. Options have public
//! fields and a `Default`; write `..Default::default()`, since fields are added. Below that, what [`render`] and [`residual`]
//! show of kernels and sums may change in any version.
//!
//! # Rules
//!
//! Data flow one way: footage → [`segment`] → [`silhouette`] (D); [`body`] + [`camera`] → [`render`] (Λ) →
//! [`residual`] → [`optimize`] → pose; [`fit`] runs a frame, [`track`] all. A test holds the table of who may use whom.
//! Not converging is an answer ([`optimize::Termination`]), not an error; results are the same to the bit in
//! every run, whatever the number of threads.

#[cfg(test)]
extern crate self as backlit_tracking;

#[doc(hidden)]
pub mod acquisition;
pub mod belief;
pub mod body;
pub mod body_fit;
#[doc(hidden)]
pub mod body_spheres;
pub mod camera;
#[doc(hidden)]
pub mod cancel;
#[doc(hidden)]
pub mod cues;
pub mod diagnosis;
#[doc(hidden)]
pub mod filter;
pub mod fit;
#[cfg(test)]
#[path = "../tests/tracking/fixtures.rs"]
mod fixtures;
pub mod geometry;
pub mod initialisation;
#[doc(hidden)]
pub mod metrics;
#[doc(hidden)]
pub mod names;
pub mod numbers;
pub mod observability;
pub mod optimize;
#[doc(hidden)]
pub mod particles;
#[doc(hidden)]
pub mod people;
#[doc(hidden)]
pub mod posing;
#[doc(hidden)]
pub mod prior;
#[doc(hidden)]
pub mod processor;
pub mod render;
pub mod residual;
pub mod search;
pub mod segment;
pub mod silhouette;
pub mod statistics;
#[doc(hidden)]
pub mod synchronise;
#[doc(hidden)]
pub mod templates;
pub mod track;
#[doc(hidden)]
pub mod visual_hull;

pub use cancel::CancelToken;
#[doc(inline)]
pub use processor::use_narrow_vectors;
pub use {glam, image};

/// What most programs need.
pub mod prelude {
    pub use glam::DVec3;

    pub use crate::body::{Kinematics, Model, ModelSpec, Parameters, Pose, builtin};
    pub use crate::camera::{Camera, CameraFromWorld, Distortion, Intrinsics};
    pub use crate::cancel::CancelToken;
    pub use crate::fit::{Evidence, Fit, FitOptions, FitView, Preset};
    pub use crate::metrics::mean_joint_error_mm;
    pub use crate::optimize::{NormalEquations, Termination};
    pub use crate::render::{Ramp, RendererKind, predict};
    pub use crate::residual::{Residual, ResidualPoint};
    pub use crate::search::{WithoutStartOptions, without_start};
    pub use crate::silhouette::{Label, Mask};
    pub use crate::track::{Track, Tracker};
}
