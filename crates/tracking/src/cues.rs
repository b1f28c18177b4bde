//! What pictures say of limbs that silhouettes do not hold (6.3 of the report's outlook).
//!
//! A silhouette shows a limb only where the limb's own boundary is seen. An arm before the trunk has none, and a fit is then
//! free to put it anywhere inside the silhouette. The report proposes edges, optic flow and stereo there; keypoints of
//! another tool are a fourth cue. Each gives pulls at limbs ([`CueSet`]) that the fit takes beside its pixels, each with its
//! own weight, robust loss and analytic Jacobian ([`residual::cue`](crate::residual::cue)).
//!
//! [`Tracker::with_cues`](crate::track::Tracker::with_cues) does the rest: each frame's fit starts where the motion leads,
//! the limbs that are covered there are asked for cues, and the fitted pose says what held them.
//!
//! ```
//! use std::sync::Arc;
//!
//! use backlit_tracking::body::{Kinematics, Pose, builtin};
//! use backlit_tracking::camera::{Camera, CameraFromWorld, Distortion, Intrinsics};
//! use backlit_tracking::cancel::CancelToken;
//! use backlit_tracking::cues::{CameraCues, CueOptions, FrameCues, JointKeypoint};
//! use backlit_tracking::fit::{Evidence, FitOptions, FitView};
//! use backlit_tracking::render::{Ramp, RendererKind, predict};
//! use backlit_tracking::silhouette::{Label, Mask};
//! use backlit_tracking::track::Tracker;
//! use glam::DVec3;
//!
//! let model = Arc::new(builtin::upper_body());
//! let pose = Pose::rest(&model);
//! let joints = Kinematics::new(&model, &pose);
//! let place = CameraFromWorld::looking_at(DVec3::new(0.0, 0.3, 2.4), DVec3::Y * 0.3, DVec3::Y);
//! let pinhole = Intrinsics { fx: 130.0, fy: 130.0, cx: 47.5, cy: 35.5 };
//! let camera = Arc::new(Camera::new("front", [96, 72], pinhole, Distortion::None, place)?);
//! let drawn = predict(&model, &joints, &camera, RendererKind::Capsule, Ramp::Half);
//! let label = |&level: &f32| if level < 127.5 { Label::Subject } else { Label::Background };
//! let mask = Arc::new(Mask::new(96, 72, drawn.lambda.iter().map(label).collect())?);
//!
//! // What the frame has beside its mask: where another tool saw a wrist, and how sure it is.
//! let limb = model.limb_index("right forearm").ok_or("no forearm")?;
//! let pixel = camera.project(joints.ends()[limb]).ok_or("behind the camera")?;
//! let keypoints = vec![JointKeypoint { limb, pixel, score: 0.9 }];
//! let cues = FrameCues { cameras: vec![CameraCues { keypoints, picture: None }] };
//!
//! let mut tracker =
//!     Tracker::new(model.clone(), FitOptions::default(), pose)?.with_cues(CueOptions::default())?;
//! let views = vec![FitView { camera, evidence: Evidence::Mask(mask), weight: 1.0 }];
//! let estimate = tracker.track_frame_with_cues(0, views, cues, &CancelToken::new())?;
//! for hold in &estimate.holds {
//!     let name = &model.limbs()[hold.limb].name;
//!     println!("{name}: {} cameras, {:?}, unsure: {}", hold.cameras, hold.cues, hold.is_unsure());
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod coverage;
mod edges;
mod flow;
mod keypoints;
mod options;
mod picture;
mod source;
mod stereo;
mod watch;

pub use crate::residual::cue::{Cue, CueError, CuePull, CueSet, CueTarget};
pub(crate) use coverage::unheld;
pub use coverage::{CoverageOptions, LimbHold, WatchedCamera};
pub use flow::follow_point;
pub use keypoints::KeypointOffsets;
pub use options::{CueOptions, CueReach, CueStrength};
pub use picture::{GreyPicture, GreyPictureError};
pub use source::{CameraCues, FrameCues, JointKeypoint};
pub use watch::{CueMemory, CueWatch};
